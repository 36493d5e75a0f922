"""The article, the page, and a browser for the tests of page and site."""

from __future__ import annotations

import os
import pickle
import shutil

import pytest

from folders import shared

# First the one without a window, which spares a tenth of the work.
BROWSERS = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
# Each window would load two pages with suggestions for its address bar: as much work as the page that a test opens.
SUGGESTIONS = "--disable-features=WebUIOmniboxPopup,WebUIOmniboxAimPopup"
MISSING = (
    "no Chromium: apt-get install chromium-headless-shell, or name one in the variable CHROMIUM"
)


@pytest.fixture(scope="session")
def article(tmp_path_factory):
    """The article and all that it is made of, by the scripts of the workflow in a folder of their own."""
    from publishing.article_case import Project, build

    return Project(shared(tmp_path_factory, "article", build))


@pytest.fixture(scope="session")
def report(article, tmp_path_factory):
    """The folder with the page of the paper's case, report.html, and what it shows."""

    def make(folder):
        from publishing.article_case import page_content, page_of

        (folder / "files").mkdir()
        made = page_content(folder / "files", article.folder)
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
    sync_api = pytest.importorskip("playwright.sync_api", reason=MISSING)
    with sync_api.sync_playwright() as player:
        found = (os.environ.get("CHROMIUM"), *map(shutil.which, BROWSERS))
        path = next(filter(None, found), player.chromium.executable_path)
        if not os.path.exists(path):
            pytest.skip(MISSING)
        arguments = ["--no-sandbox", "--disable-gpu", SUGGESTIONS]
        started = player.chromium.launch(executable_path=path, args=arguments)
        yield started
        started.close()


@pytest.fixture(scope="module")
def visit(browser):
    """Opens windows without network: visit(address, …). No script may fail or complain, no other machine be asked."""
    opened, wrong = [], []

    def asked(request):
        if not request.url.startswith(("file:", "data:", "blob:", "about:")):
            wrong.append(request.url)

    def said(message):
        # a file that is asked for and not there is no complaint of a script
        if message.type in ("error", "warning") and "ERR_FILE_NOT_FOUND" not in message.text:
            wrong.append(message.text)

    def window(address, **options):
        context = browser.new_context(offline=True, reduced_motion="reduce", **options)
        opened.append(context)
        page = context.new_page()
        page.set_default_timeout(120_000)  # a busy machine
        page.on("console", said)
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.on("request", asked)
        page.goto(address)
        return page

    yield window
    for context in opened:
        context.close()
    assert wrong == []


@pytest.fixture(scope="module")
def window(visit):
    """A window that the tests of a module share."""
    return visit("about:blank")
