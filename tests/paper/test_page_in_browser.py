"""The page in a browser: it can be used by everybody, searched, and printed."""

from __future__ import annotations

import io

import pytest

from paper import axe
from paper.page_case import page_of, results

pypdf = pytest.importorskip("pypdf")
pytestmark = pytest.mark.slow
MOST_PAGES = 19


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    return results(tmp_path_factory.mktemp("case"))


@pytest.fixture(scope="module")
def file(made, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "report.html"
    path.write_text(page_of(made), encoding="utf-8")
    return path


@pytest.fixture
def view(browser, file):
    context = browser.new_context(offline=True, reduced_motion="reduce")
    view = context.new_page()
    complaints = []
    view.on("console", lambda message: complaints.append(message.text))
    view.on("pageerror", lambda problem: complaints.append(str(problem)))
    view.goto(file.as_uri())
    yield view
    context.close()
    assert complaints == []


@pytest.mark.skipif(axe.SKIP, reason=axe.REASON)
def test_axe_finds_nothing_to_mend(browser, file):
    assert axe.found(browser, file) == []


@pytest.mark.skipif(axe.SKIP, reason=axe.REASON)
def test_axe_finds_nothing_to_mend_in_a_reason(view):
    view.locator("button.cell").first.click()
    assert view.locator(".why:popover-open").count() == 1
    assert axe.violations(view) == []


@pytest.mark.skipif(axe.SKIP, reason=axe.REASON)
def test_axe_would_find_something(view):
    view.evaluate("document.querySelector('.plot').removeAttribute('aria-label')")
    view.evaluate(
        "document.querySelector('h1').insertAdjacentHTML('afterend', '<img src=\"data:,\">')"
    )
    assert any(one.startswith("image-alt") for one in axe.violations(view))


def found(view, words):
    """The claims that a search leaves."""
    view.fill("#filter-text", words)
    return view.evaluate(
        "[...document.querySelectorAll('[data-kind]')].filter(r => r.checkVisibility()).map(r => r.id)"
    )


def test_a_symbol_is_found_however_it_is_typed(view):
    by_word = found(view, "phi")
    assert set(by_word) >= {f"table1.phi.{level}" for level in range(1, 6)} | {"text.phi_mean"}
    for other in ("φ", "ϕ", "PHI"):
        assert found(view, other) == by_word
    by_index = found(view, "b_1")
    assert "table2.b.1" in by_index
    assert found(view, "b₁") == by_index
    assert "table1.X_s.3" in found(view, "x_s level 3")
    assert found(view, "F_k 1-2") == found(view, "F_k 1–2") != []


def test_a_search_opens_what_is_given_and_clearing_it_closes_it(view):
    assert found(view, "contact stiffness") == ["parameter.K_z"]
    assert "1 of 27 given values" in view.inner_text("#found")
    view.click("button[type=reset]")
    assert not view.evaluate("document.getElementById('given').open")
    assert found(view, "no such words") == []
    assert view.locator("#none").is_visible()


def test_what_is_given_takes_one_stop_of_the_keyboard(view, made):
    stops = view.evaluate(
        """() => {
            for (const one of document.querySelectorAll('details')) one.open = true;
            return document.querySelectorAll('#given :is(a, button, summary, input, [tabindex])').length;
        }"""
    )
    assert stops == 1
    of_claims = view.locator("#numbers .claims summary").count()
    assert of_claims == int((made.claims["kind"] != "given").sum())


def test_it_prints_on_few_pages(view):
    pages = pypdf.PdfReader(io.BytesIO(view.pdf(format="A4", prefer_css_page_size=True))).pages
    assert len(pages) <= MOST_PAGES
    text = "".join(page.extract_text() for page in pages)
    assert "Statements" in text
    assert "friction force 1.28" in " ".join(
        text.split()
    )  # what is folded on the screen is printed
