"""The site in a real Chromium without a network: it searches, fits a phone, and hinders nobody.

Skipped where no Chromium is installed; publishing/chromium.py says where it looks.
"""

from __future__ import annotations

import pytest

from folders import shared
from publishing import axe
from publishing.chromium import CHROMIUM, REASON
from publishing.site_case import built

pytestmark = [pytest.mark.slow, pytest.mark.skipif(CHROMIUM is None, reason=REASON)]

PHONE = {"width": 375, "height": 800}
LAPTOP = {"width": 1280, "height": 800}
SAMPLE = (
    "index",
    "start/paper",
    "explain/balance",
    "explain/tour",
    "reference/api",
    "reference/case",
    "studies",
    "search",
    "start/case",
)


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    return shared(tmp_path_factory, "documentation", built) / "site"


@pytest.mark.parametrize(
    ("words", "leads"),
    [("steady_orbit", "reference/api.html"), ("F_k", "explain/"), ("jackknife", "uncertainty")],
)
def test_a_search_without_a_network_finds_it(site, visit, words, leads):
    page = visit(f"{(site / 'search.html').as_uri()}?q={words}")
    page.wait_for_selector("#search-results li a")
    page.wait_for_function(
        "() => /found|finished/i.test(document.querySelector('#search-results').innerText)"
    )
    links = page.eval_on_selector_all("#search-results li a", "all => all.map(a => a.href)")
    assert any(leads in link for link in links)


def test_the_first_screen_shows_a_figure_and_a_result(site, visit):
    page = visit((site / "index.html").as_uri(), viewport=LAPTOP)
    for wanted in ("article img", "article pre:has-text('maximum likelihood')"):
        box = page.locator(wanted).first.bounding_box()
        assert box["y"] + box["height"] < LAPTOP["height"]
        assert box["width"] > 60.0
    loaded = "all => all.every(one => one.naturalWidth > 100)"
    assert page.eval_on_selector_all("article img", loaded)


def test_no_block_is_cut_on_a_laptop_and_no_page_wider_than_a_phone(site, visit):
    """Code on all pages; tables on those that are not lists of numbers or keys."""
    page, sizes = visit("about:blank"), [LAPTOP, PHONE]
    wider = "all => all.filter(one => one.scrollWidth > one.clientWidth).map(one => one.innerText)"
    cut, wide, counted = [], [], 0
    for path in sorted(site.rglob("*.html")):
        name = path.relative_to(site).as_posix()
        if name.startswith(("files/", "run/")):
            continue
        page.goto(path.as_uri())
        for size in sizes:
            page.set_viewport_size(size)
            if size is PHONE:
                width = page.evaluate("document.documentElement.scrollWidth")
                wide += [f"{name}: {width}"] * (width > PHONE["width"])
                continue
            counted += page.locator("pre").count()
            cut += [(name, text) for text in page.eval_on_selector_all("pre", wider)]
            if not name.startswith(("reference/", "explain/")):
                tables = ".pst-scrollable-table-container"
                cut += [(name, text) for text in page.eval_on_selector_all(tables, wider)]
        sizes.reverse()  # the next page begins with the size of this one: no page is laid out in vain
    assert (cut, wide) == ([], [])
    assert counted > 60


def test_the_search_field_leads_to_the_results(site, visit):
    page = visit((site / "index.html").as_uri())
    page.keyboard.press("Control+k")
    page.keyboard.type("Coulomb")
    page.keyboard.press("Enter")
    page.wait_for_selector("#search-results li a")
    assert "search.html?q=Coulomb" in page.url


@pytest.mark.skipif(axe.SKIP, reason=axe.REASON)
@pytest.mark.parametrize("name", SAMPLE)
def test_it_hinders_nobody(site, browser, name):
    assert axe.found(browser, site / f"{name}.html") == []


def test_where_the_keyboard_is_can_be_seen(site, visit):
    """Each of the first twenty places that the Tab key reaches has an outline, a ring or a shadow."""
    page = visit((site / "explain/balance.html").as_uri())
    unseen = []
    for _ in range(20):
        page.keyboard.press("Tab")
        name, seen = page.evaluate(
            """() => {
                const at = document.activeElement, style = getComputedStyle(at);
                const ring = style.outlineStyle !== 'none' && parseFloat(style.outlineWidth) > 0;
                return [at.outerHTML.slice(0, 80), ring || style.boxShadow !== 'none'];
            }"""
        )
        if not seen:
            unseen.append(name)
    assert unseen == []
