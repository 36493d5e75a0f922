"""The site in a real Chromium without a network: it searches, fits a phone, and hinders nobody.

Skipped where no Chromium is installed; paper/chromium.py says where it looks.
"""

from __future__ import annotations

import pytest

from folders import shared
from paper import axe
from paper.chromium import CHROMIUM, REASON
from paper.site_case import built

pytestmark = [pytest.mark.slow, pytest.mark.skipif(CHROMIUM is None, reason=REASON)]

PHONE = {"width": 375, "height": 800}
SAMPLE = ("index", "start/paper", "explain/balance", "reference/api", "studies", "search")


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    return shared(tmp_path_factory, "documentation", built) / "site"


@pytest.mark.parametrize(
    ("words", "leads"),
    [("steady_orbit", "reference/api.html"), ("F_k", "explain/"), ("bootstrap", "uncertainty")],
)
def test_a_search_without_a_network_finds_it(site, visit, words, leads):
    page = visit(f"{(site / 'search.html').as_uri()}?q={words}")
    page.wait_for_selector("#search-results li a")
    page.wait_for_function(
        "() => /found|finished/i.test(document.querySelector('#search-results').innerText)"
    )
    links = page.eval_on_selector_all("#search-results li a", "all => all.map(a => a.href)")
    assert any(leads in link for link in links)


def test_the_search_field_leads_to_the_results(site, visit):
    page = visit((site / "index.html").as_uri())
    page.keyboard.press("Control+k")
    page.keyboard.type("Coulomb")
    page.keyboard.press("Enter")
    page.wait_for_selector("#search-results li a")
    assert "search.html?q=Coulomb" in page.url


def test_no_page_is_wider_than_a_phone(site, visit):
    page = visit("about:blank", viewport=PHONE)
    wide = []
    for path in sorted(site.rglob("*.html")):
        if "files" not in path.relative_to(site).parts:
            page.goto(path.as_uri())
            width = page.evaluate("() => document.documentElement.scrollWidth")
            if width > PHONE["width"]:
                wide.append(f"{path.relative_to(site)}: {width}")
    assert wide == []


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
