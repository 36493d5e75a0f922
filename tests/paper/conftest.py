"""A browser for the tests of page and tour."""

from __future__ import annotations

import pickle

import pytest

from folders import shared
from paper.chromium import ARGUMENTS, CHROMIUM, REASON


@pytest.fixture(scope="session")
def article(tmp_path_factory):
    """The article and all that it is made of, by the scripts of the workflow in a folder of their own."""
    from paper.article_case import Project, build

    return Project(shared(tmp_path_factory, "article", build))


@pytest.fixture(scope="session")
def report(article, tmp_path_factory):
    """The folder with the page of the paper's case, report.html, and what it shows."""

    def make(folder):
        from paper.page_case import page_of, results

        (folder / "files").mkdir()
        made = results(folder / "files", article.folder)
        (folder / "report.html").write_text(page_of(made), encoding="utf-8")
        (folder / "shown.pickle").write_bytes(pickle.dumps(made))

    return shared(tmp_path_factory, "report", make)


@pytest.fixture(scope="module")
def made(report):
    """What the page shows."""
    return pickle.loads((report / "shown.pickle").read_bytes())


@pytest.fixture(scope="module")
def browser():
    """A Chromium; the test is skipped where there is none."""
    if CHROMIUM is None:
        pytest.skip(REASON)
    from playwright.sync_api import sync_playwright

    with sync_playwright() as player:
        started = player.chromium.launch(executable_path=CHROMIUM, args=ARGUMENTS)
        yield started
        started.close()


@pytest.fixture
def visit(browser):
    """Opens a page without network: visit(address, …) -> page. No script may fail, and no other machine be asked.

    visit.asked, visit.said : the addresses that the pages asked for, and what they wrote to the console.
    """
    contexts, asked, said, failed = [], [], [], []

    def opened(address, dark=False, **options):
        scheme = "dark" if dark else "light"
        contexts.append(browser.new_context(offline=True, color_scheme=scheme, **options))
        page = contexts[-1].new_page()
        page.set_default_timeout(120_000)  # a busy machine
        page.on("console", lambda message: said.append(message.text))
        page.on("pageerror", lambda error: failed.append(str(error)))
        page.on("request", lambda request: asked.append(request.url))
        page.goto(address)
        return page

    opened.asked, opened.said = asked, said
    yield opened
    for context in contexts:
        context.close()
    assert failed == []
    assert [url for url in asked if not url.startswith(("file:", "data:", "blob:"))] == []
