"""A browser for the tests of page and site."""

from __future__ import annotations

import pickle

import pytest

from folders import shared
from publishing.chromium import ARGUMENTS, CHROMIUM, REASON


@pytest.fixture(scope="session")
def article(tmp_path_factory):
    """The article and all that it is made of, by the scripts of the workflow in a folder of their own."""
    from publishing.article_case import Project, build

    return Project(shared(tmp_path_factory, "article", build))


@pytest.fixture(scope="session")
def report(article, tmp_path_factory):
    """The folder with the page of the paper's case, report.html, and what it shows."""

    def make(folder):
        from publishing.page_case import page_of, results

        (folder / "files").mkdir()
        made = results(folder / "files", article.folder)
        (folder / "report.html").write_text(page_of(made), encoding="utf-8")
        (folder / "shown.pickle").write_bytes(pickle.dumps(made))

    return shared(tmp_path_factory, "report", make)


@pytest.fixture(scope="module")
def made(report):
    """What the page shows."""
    return pickle.loads((report / "shown.pickle").read_bytes())


@pytest.fixture(scope="session")
def browser():
    """A Chromium; the test is skipped where there is none."""
    if CHROMIUM is None:
        pytest.skip(REASON)
    from playwright.sync_api import sync_playwright

    with sync_playwright() as player:
        started = player.chromium.launch(executable_path=CHROMIUM, args=ARGUMENTS)
        yield started
        started.close()


class Visits:
    """Opens pages without network: visit(address, …) -> page, until the test ends; visit.again(address, …), until the
    module ends, for tests that leave a page as they found it.

    visit.asked, visit.said, visit.failed : the addresses that the pages asked for, what they wrote to the console, and
    the errors of their scripts, during a test.
    """

    def __init__(self, browser):
        self.browser, self.opened, self.kept = browser, [], {}
        self.asked, self.said, self.failed = [], [], []

    def __call__(self, address, dark=False, **options):
        scheme = "dark" if dark else "light"
        context = self.browser.new_context(offline=True, color_scheme=scheme, **options)
        self.opened.append(context)
        page = context.new_page()
        page.set_default_timeout(120_000)  # a busy machine
        page.on("console", lambda message: self.said.append(message.text))
        page.on("pageerror", lambda error: self.failed.append(str(error)))
        page.on("request", lambda request: self.asked.append(request.url))
        page.goto(address)
        return page

    def again(self, address, **options):
        name = (address, repr(sorted(options.items())))
        if name not in self.kept:
            self.kept[name] = self(address, **options)
            self.opened.pop()
        return self.kept[name]


@pytest.fixture(scope="module")
def visits(browser):
    made = Visits(browser)
    yield made
    for page in made.kept.values():
        page.context.close()


@pytest.fixture
def visit(visits):
    """Opens pages. No script may fail, and no other machine be asked."""
    visits.asked, visits.said, visits.failed = [], [], []
    yield visits
    while visits.opened:
        visits.opened.pop().close()
    assert visits.failed == []
    assert [url for url in visits.asked if not url.startswith(("file:", "data:", "blob:"))] == []
