"""The page in a real Chromium without a network: it loads nothing, filters, folds and prints; by keyboard, on a phone.

Skipped where no Chromium is installed; publishing/chromium.py says where it looks.
"""

from __future__ import annotations

import io
import itertools
import re

import pypdf
import pytest

from dampbalance import identify
from dampbalance.replication.claims.verdicts import KINDS
from folders import ROOT
from publishing import axe
from publishing.chromium import CHROMIUM, REASON

pytestmark = [pytest.mark.slow, pytest.mark.skipif(CHROMIUM is None, reason=REASON)]

MOST_PAGES = 19
DESK, PHONE = {"width": 1280, "height": 900}, {"width": 390, "height": 844}
TALLEST = 12_000  # px, of the page as a phone opens it


@pytest.fixture(scope="module")
def computed(made):
    """The claims that are counted."""
    return made.claims[made.claims["kind"] == "computed"]


@pytest.fixture(scope="module")
def file(report):
    return report / "report.html"


@pytest.fixture(scope="module")
def address(file):
    return file.as_uri()


@pytest.fixture
def opened(visit, address):
    """Opens the page, which asks for nothing but itself and the program of its second thread, and has no complaint."""

    def page(viewport=DESK, open=visit, **options):
        return open(address, viewport=viewport, **options)

    yield page
    assert {url for url in visit.asked if not url.startswith("blob:")} <= {address}
    assert visit.said == []


FOLDS = "[...document.querySelectorAll('details')]"
RESTORE = f"""() => {{
  if (document.querySelector('#reasons[aria-pressed=true]')) document.getElementById('reasons').click();
  {FOLDS}.forEach((one, i) => {{ one.open = window.unfolded[i]; }});
  document.querySelector('button[type=reset]').click();
  document.activeElement?.blur();
  for (const one of document.querySelectorAll(':popover-open')) one.hidePopover();
  history.replaceState(null, '', location.pathname);
  scrollTo(0, 0);
}}"""


@pytest.fixture
def page(opened, visit):
    """The page on a desk, which tests share; what they fold, filter and choose is undone afterwards."""
    shared = opened(open=visit.again)
    shared.evaluate(f"window.unfolded ??= {FOLDS}.map(one => one.open)")
    yield shared
    shared.keyboard.press("Escape")
    shared.emulate_media(media="null", color_scheme="light")
    shared.evaluate(RESTORE)


def shown(page, kind="computed"):
    """The ids of the claims of a kind that can be seen."""
    return page.eval_on_selector_all(
        f"[data-kind={kind}]", "rows => rows.filter(r => r.checkVisibility()).map(r => r.id)"
    )


def found(page, words):
    """The ids of all claims that a search leaves."""
    page.fill("#filter-text", words)
    return [name for kind in KINDS for name in shown(page, kind)]


def test_every_printed_number_is_there_and_filters_choose(page, made, computed):
    claims = computed
    assert shown(page) == list(claims["id"])

    page.select_option("#filter-part", "Table 1")
    page.select_option("#filter-verdict", "reading")
    chosen = claims[claims["id"].str.startswith("table1") & (claims["verdict"] == "reading")]
    assert shown(page) == list(chosen["id"])
    counts = made.claims["kind"].value_counts()
    assert page.inner_text("#found") == (
        f"{len(chosen)} of {len(claims)} computed numbers, 0 of {counts['statement']} statements, "
        f"0 of {counts['given']} given values"
    )
    assert shown(page, "statement") == []

    page.click("button[type=reset]")
    assert shown(page) == list(claims["id"])

    page.fill("#filter-text", "LEVEL 3  t_s.3")
    assert shown(page) == ["table1.t_s.3"]
    page.fill("#filter-text", "-0.00272")  # as typed, with a hyphen for the minus
    assert "table1.X_s.1" in shown(page)
    page.fill("#filter-text", "no such words")
    assert shown(page) == []
    page.click("#clear")
    assert shown(page) == list(claims["id"])

    count = claims[claims["id"].str.startswith("table3") & (claims["verdict"] == "simulated")]
    page.click('.counts a[data-part="Table 3"][data-verdict="simulated"]')
    assert shown(page) == list(count["id"])


def test_reasons_open_on_demand_and_from_the_tables(page, made, computed):
    reason = page.locator('[id="table1.phi.1"] details p')
    assert not reason.is_visible()
    page.click('button[popovertarget="why.table1.phi.1"]')
    box = page.locator('[id="why.table1.phi.1"]')
    assert box.is_visible()
    assert made.claims.set_index("id")["verdict"]["table1.phi.1"] in box.inner_text()
    page.keyboard.press("Escape")
    assert not box.is_visible()
    page.select_option("#filter-part", "Table 3")  # hides the row that the link leads to
    page.click('button[popovertarget="why.table1.phi.1"]')
    box.locator("a").click()
    reason.wait_for(state="visible")
    assert not box.is_visible()
    page.click("#reasons")
    assert page.locator("#claims details[open]").count() == len(computed)
    statements = made.claims["kind"] == "statement"
    assert page.locator(".claims details[open]").count() == len(computed) + statements.sum()


def test_a_symbol_is_found_however_it_is_typed(page):
    by_word = found(page, "phi")
    assert set(by_word) >= {f"table1.phi.{level}" for level in range(1, 6)} | {"text.phi_mean"}
    for other in ("φ", "ϕ", "PHI"):
        assert found(page, other) == by_word
    by_index = found(page, "b_1")
    assert "table2.b.1" in by_index
    assert found(page, "b₁") == by_index
    assert "table1.X_s.3" in found(page, "x_s level 3")
    assert found(page, "F_k 1-2") == found(page, "F_k 1–2") != []


def test_a_search_opens_what_is_given_and_clearing_it_closes_it(page):
    assert found(page, "contact stiffness") == ["parameter.K_z"]
    assert "1 of 27 given values" in page.inner_text("#found")
    page.click("button[type=reset]")
    assert not page.evaluate("document.getElementById('given').open")
    assert page.locator("#given :is(a, button, input, [tabindex])").count() == 0  # one stop to Tab
    assert found(page, "no such words") == []
    assert page.locator("#none").is_visible()


def test_the_keyboard_reaches_everything_and_shows_where_it_is(opened):
    page = opened()
    reached = []
    for _ in range(page.locator("a, button, input, select, summary, [tabindex]").count()):
        page.keyboard.press("Tab")
        name, outline = page.evaluate(
            "() => { const e = document.activeElement; const s = getComputedStyle(e);"
            " return [e.id || e.getAttribute('href') || e.type || e.tagName, s.outlineStyle + s.outlineWidth]; }"
        )
        reached.append(name)
        assert outline == "solid3px", name
        if name == "reasons":
            break
    assert reached[0] == "#main"
    assert {"filter-part", "filter-verdict", "filter-text", "reset", "reasons"} <= set(reached)
    page.focus("#filter-text")
    page.keyboard.type("slip onset")
    assert 0 < len(shown(page)) < 40
    page.focus(".skip")
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.id") == "main"


@pytest.mark.parametrize("viewport", [PHONE, DESK], ids=["phone", "desk"])
def test_links_lead_to_headings_below_the_bar(opened, viewport):
    page = opened(viewport)
    folded = page.locator(".fold:not([open])").count()
    assert (folded > 0) == (viewport is PHONE)
    assert folded == 0 or page.evaluate("document.documentElement.scrollHeight") < TALLEST
    bar = page.locator("nav").bounding_box()["height"]
    page.emulate_media(reduced_motion="reduce")  # without smooth scrolling, which waits for frames
    for link in page.locator("nav a").all():
        link.click()
        section = page.locator(link.get_attribute("href"))
        heading = section.locator("h2")
        page.wait_for_function(
            "([id, bar]) => { const y = document.getElementById(id).getBoundingClientRect().top;"
            " const end = innerHeight + scrollY >= document.documentElement.scrollHeight - 2;"
            " return y >= bar - 1 && (y < bar + 80 || end); }",
            arg=[heading.get_attribute("id"), bar],
        )
        assert section.locator(":is(p, table)").first.is_visible()  # unfolded
    page.evaluate("location.hash = 'study-frequency'")  # inside a section that a phone folds
    page.locator("[id='study-frequency']").wait_for(state="visible")
    page.evaluate("document.querySelectorAll('details').forEach(one => { one.open = true; })")
    assert page.evaluate("document.documentElement.scrollWidth") == viewport["width"]


UNFOLD = "document.querySelectorAll('.fold, .more').forEach(one => { one.open = true; })"
TAGS = "all => all.map(one => one.getBoundingClientRect()).map(({ x, y, width, height }) => [x, y, width, height])"


def test_labels_of_the_levels_keep_apart_on_a_phone(opened):
    page = opened(PHONE)
    page.evaluate(UNFOLD)
    page.wait_for_selector("#off_resonance.ready .plane .tag")
    boxes = page.eval_on_selector_all("#off_resonance .plane .tag", TAGS)
    assert len(boxes) == 6  # five levels, and the truth
    for (x, y, wide, high), (u, v, *size) in itertools.combinations(boxes, 2):
        beside = x + wide <= u or u + size[0] <= x
        assert (
            beside or y + 0.8 * high <= v or v + 0.8 * size[1] <= y
        )  # a box has room above letters


@pytest.mark.parametrize("viewport", [PHONE, DESK], ids=["phone", "desk"])
def test_tables_that_scroll_say_so_and_no_others(opened, viewport):
    page = opened(viewport)
    page.evaluate(UNFOLD)
    wider = "one.scrollWidth > one.clientWidth + 1"
    shown = "[...document.querySelectorAll('.wide, .drawing')].filter(one => one.checkVisibility())"
    page.wait_for_function(
        f"() => {shown}.every(one => ({wider}) === one.classList.contains('scrolls'))"
    )
    names = page.evaluate(f"{shown}.filter(one => {wider}).map(one => one.ariaLabel)")
    assert ("Phases of the levels" in names) == (viewport is PHONE)


def test_print_shows_every_row_and_reason_on_white(page, made, computed):
    page.emulate_media(color_scheme="dark")
    page.select_option("#filter-part", "Table 3")
    page.emulate_media(media="print")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert shown(page) == list(computed["id"])
    assert page.locator("#claims details p >> visible=true").count() == len(computed)
    for kind in KINDS:
        assert len(shown(page, kind)) == (made.claims["kind"] == kind).sum()
    assert not page.locator("nav").is_visible()
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    page.evaluate("dispatchEvent(new Event('afterprint'))")
    assert page.locator("#claims details[open]").count() == 0


def test_it_prints_on_few_pages(page):
    pages = pypdf.PdfReader(io.BytesIO(page.pdf(format="A4", prefer_css_page_size=True))).pages
    assert len(pages) <= MOST_PAGES
    missing = {"Statements", "friction force 1.28"}  # what is folded on the screen is printed
    for printed in reversed(pages):
        text = " ".join(printed.extract_text().split())
        missing = {words for words in missing if words not in text}
        if not missing:
            break
    assert missing == set()


@pytest.mark.skipif(axe.SKIP, reason=axe.REASON)
def test_axe_finds_nothing_to_mend(browser, file, page):
    assert axe.found(browser, file) == []
    page.locator("button.cell").first.click()
    assert page.locator(".why:popover-open").count() == 1
    assert axe.violations(page, ".why:popover-open") == []


@pytest.mark.skipif(axe.SKIP, reason=axe.REASON)
def test_axe_would_find_what_is_wrong(opened):
    page = opened()
    page.evaluate("document.querySelector('h1').innerHTML += '<img src=\"data:,\">'")
    page.evaluate(
        "document.styleSheets[0].insertRule('.sources td a { min-height: 0 !important; }', 0)"
    )
    page.evaluate(axe.THIN)
    rules = {one.partition(":")[0] for one in axe.violations(page, contrast=False)}
    assert {"image-alt", "target-size"} <= rules


def test_without_a_script_everything_can_be_read(opened, computed):
    page = opened(java_script_enabled=False)
    assert page.locator("#claims tbody tr >> visible=true").count() == len(computed)
    assert page.locator(".drawing img >> visible=true").count() == 6
    assert not page.locator(".filter").is_visible()  # nothing that would not work
    page.click('[id="table1.phi.1"] summary')
    assert page.locator('[id="table1.phi.1"] details p').is_visible()
    assert re.search("needs? it", page.inner_text(".noscript"))


# --- the report of a measurement ------------------------------------------------------------------


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    records = sorted((ROOT / "config/records/example").glob("level*.csv"))[::2]
    path = tmp_path_factory.mktemp("report") / "report.html"
    path.write_text(identify(records, 2310.0).report(), encoding="utf-8")
    return path


@pytest.mark.skipif(axe.SKIP, reason=axe.REASON)
def test_axe_finds_nothing_to_mend_in_a_report(browser, measured):
    assert axe.found(browser, measured) == []


def test_a_report_fits_a_phone_and_shows_its_pictures(browser, measured):
    view = axe.opened(browser, measured, "phone", "dark")
    assert view.evaluate("document.documentElement.scrollWidth") <= axe.SIZES["phone"]["width"]
    drawn = view.evaluate(
        "Promise.all([...document.images].map(async (one) => { await one.decode(); return one.naturalWidth; }))"
    )
    assert len(drawn) == 4  # three pictures, and the rig
    assert min(drawn) > 0
    view.context.close()


def test_a_report_prints_on_few_pages_with_the_verdict_on_the_first(browser, measured):
    view = axe.opened(browser, measured, "desktop", "dark")
    pages = pypdf.PdfReader(io.BytesIO(view.pdf(format="A4"))).pages
    assert len(pages) <= 6
    assert "usable within" in " ".join(pages[0].extract_text().split())
    view.context.close()
