"""The page in a real Chromium without a network: it loads nothing, filters, draws and prints; by keyboard, on a phone.

Skipped where no Chromium is installed; paper/chromium.py says where it looks.
"""

from __future__ import annotations

import io
import re

import pypdf
import pytest

from dampbalance.publishing.page import colours
from dampbalance.replication.claim_verdicts import KINDS
from paper import axe
from paper.chromium import CHROMIUM, REASON
from paper.page_case import page_of, results

pytestmark = [pytest.mark.slow, pytest.mark.skipif(CHROMIUM is None, reason=REASON)]

MOST_PAGES = 19
DESK, PHONE = {"width": 1280, "height": 900}, {"width": 360, "height": 740}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    return results(tmp_path_factory.mktemp("case"))


@pytest.fixture(scope="module")
def computed(made):
    """The claims that are counted."""
    return made.claims[made.claims["kind"] == "computed"]


@pytest.fixture(scope="module")
def file(made, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "report.html"
    path.write_text(page_of(made), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def address(file):
    return file.as_uri()


@pytest.fixture
def opened(visit, address):
    """Opens the page, which may ask for nothing but itself, and complain of nothing."""
    yield lambda viewport=DESK, **options: visit(address, viewport=viewport, **options)
    assert set(visit.asked) == {address}
    assert visit.said == []


def shown(page, kind="computed"):
    """The ids of the claims of a kind that can be seen."""
    return page.eval_on_selector_all(
        f"[data-kind={kind}]", "rows => rows.filter(r => r.checkVisibility()).map(r => r.id)"
    )


def found(page, words):
    """The ids of all claims that a search leaves."""
    page.fill("#filter-text", words)
    return [name for kind in KINDS for name in shown(page, kind)]


def drawn(page, name):
    """A chart, brought to the screen and drawn."""
    plot = page.locator(f"#{name}")
    plot.scroll_into_view_if_needed()
    page.wait_for_selector(f"#{name}.ready")
    return plot


def test_every_printed_number_is_there_and_filters_choose(opened, made, computed):
    page, claims = opened(), computed
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

    count = claims[claims["id"].str.startswith("table3") & (claims["verdict"] == "reconstructed")]
    page.click('.counts a[data-part="Table 3"][data-verdict="reconstructed"]')
    assert shown(page) == list(count["id"])


def test_reasons_open_on_demand_and_from_the_tables(opened, made, computed):
    page = opened()
    reason = page.locator('[id="table1.phi.1"] details p')
    assert not reason.is_visible()
    page.click('button[popovertarget="why.table1.phi.1"]')
    box = page.locator('[id="why.table1.phi.1"]')
    assert box.is_visible()
    assert "reading" in box.inner_text()
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


def test_a_symbol_is_found_however_it_is_typed(opened):
    page = opened()
    by_word = found(page, "phi")
    assert set(by_word) >= {f"table1.phi.{level}" for level in range(1, 6)} | {"text.phi_mean"}
    for other in ("φ", "ϕ", "PHI"):
        assert found(page, other) == by_word
    by_index = found(page, "b_1")
    assert "table2.b.1" in by_index
    assert found(page, "b₁") == by_index
    assert "table1.X_s.3" in found(page, "x_s level 3")
    assert found(page, "F_k 1-2") == found(page, "F_k 1–2") != []


def test_a_search_opens_what_is_given_and_clearing_it_closes_it(opened):
    page = opened()
    assert found(page, "contact stiffness") == ["parameter.K_z"]
    assert "1 of 27 given values" in page.inner_text("#found")
    page.click("button[type=reset]")
    assert not page.evaluate("document.getElementById('given').open")
    assert found(page, "no such words") == []
    assert page.locator("#none").is_visible()


def test_what_is_given_takes_one_stop_of_the_keyboard(opened, made):
    page = opened()
    stops = page.evaluate(
        """() => {
            for (const one of document.querySelectorAll('details')) one.open = true;
            return document.querySelectorAll('#given :is(a, button, summary, input, [tabindex])').length;
        }"""
    )
    assert stops == 1
    of_claims = page.locator("#numbers .claims summary").count()
    assert of_claims == int((made.claims["kind"] != "given").sum())


def test_the_keyboard_reaches_everything_and_shows_where_it_is(opened):
    page = opened()
    reached = []
    for _ in range(80):
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


def test_charts_draw_tell_values_and_zoom(opened, made):
    page = opened()
    plot = drawn(page, "figure3-b")
    plot.focus()
    page.keyboard.press("Home")
    told = plot.locator("+ [role=status]").inner_text()
    orbit = made.orbits[0]
    assert f"x: −{1e3 * orbit.X:.7g} mm" in told  # the reversal at −X, seven digits
    assert "phase: microstick" in told
    page.keyboard.press("ArrowRight")
    assert plot.locator("+ [role=status]").inner_text() != told
    page.keyboard.press("Escape")

    box = plot.locator("svg").bounding_box()
    # On the slip curve before the reversal, near the upper edge.
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.15 * box["height"])
    tip = plot.locator(".tip")
    tip.wait_for(state="visible")
    assert "m/s²" in tip.inner_text()
    page.mouse.move(0, 0)
    tip.wait_for(state="hidden")

    seen = "id => [...document.querySelectorAll(`#${id} .role-axis-label text`)].map(t => t.textContent).sort().join()"
    start = page.evaluate(seen, "figure3-b")
    plot.focus()
    page.keyboard.press("+")
    changed = f"([id, was]) => ![was, ''].includes(({seen})(id))"
    page.wait_for_function(changed, arg=["figure3-b", start])
    page.keyboard.press("0")
    page.wait_for_function(f"([id, was]) => ({seen})(id) === was", arg=["figure3-b", start])


def test_a_study_tells_the_values_of_all_curves_at_a_place(opened, made):
    page = opened()
    plot = drawn(page, "study-frequency-F-k-0")
    plot.focus()
    page.keyboard.press("End")
    told = plot.locator("+ [role=status]").inner_text()
    study, _ = made.studies[0]
    assert "ω/ωn: 2.6" in told  # the n is an index
    approaches = {fit.approach for fit in study.fits} - {"direct"}
    assert told.count(" %") == sum(1 if a == "fourier" else 2 for a in approaches)
    assert "Xs, common φ, ts: " in told


def test_every_chart_is_drawn_and_zooms(opened):
    page = opened()
    names = page.eval_on_selector_all(".plot", "plots => plots.map(p => p.id)")
    assert len(names) == 23
    for name in names:
        plot = drawn(page, name)
        before = plot.locator(".drawn svg").inner_html()
        plot.press("+")
        page.wait_for_function(
            "([id, was]) => document.querySelector(`#${id} .drawn svg`).innerHTML !== was",
            arg=[name, before],
        )
    lines = "plots => plots.map(p => p.querySelectorAll('.drawn .mark-line path, .drawn .mark-symbol path').length)"
    assert min(page.eval_on_selector_all(".plot", lines)) > 0
    assert page.locator(".plot > svg").count() == 0  # no still is left beside its chart


@pytest.mark.parametrize("viewport", [PHONE, DESK], ids=["phone", "desk"])
def test_nothing_sticks_out_sideways(opened, viewport):
    page = opened(viewport)
    for name in ("figure3-a", "error-Fk-omega1", "study-step-size-c"):
        drawn(page, name)
    page.click("#reasons")
    assert page.evaluate("document.documentElement.scrollWidth") == viewport["width"]


CONTRASTS = """() => {
  const parse = (c) => { const m = c.match(/[\\d.]+/g).map(Number); return m.length < 4 ? [...m, 1] : m; };
  const lum = ([r, g, b]) => [r, g, b].map(v => v / 255)
    .map(v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
    .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
  const found = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const e = node.parentElement;
    const text = node.textContent.trim();
    if (!text || !e.getClientRects().length) continue;
    if (e.closest('script, style, noscript, [popover], .unseen, option')) continue;
    let ground = e;
    const fill = element => parse(getComputedStyle(element).backgroundColor);
    while (ground && fill(ground)[3] === 0) ground = ground.parentElement;
    const style = getComputedStyle(e);
    const ink = parse(e.closest('svg') ? style.fill : style.color);
    const back = ground ? fill(ground) : parse('rgb(255, 255, 255)');
    const [low, high] = [lum(ink), lum(back)].sort((a, b) => a - b);
    const name = String(e.className.baseVal ?? e.className);
    found.push([(high + 0.05) / (low + 0.05), text.slice(0, 40), e.tagName, name]);
  }
  return found;
}"""


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
def test_all_text_can_be_read_light_and_dark_in_charts_too(opened, dark):
    page = opened(dark=dark)
    for name in ("figure3-b", "error-c-omega3", "study-frequency-c-1"):
        drawn(page, name)
    page.click("#reasons")
    found = page.evaluate(CONTRASTS)
    assert len(found) > 1500
    assert sum(kind == "text" for _, _, kind, _ in found) > 100  # of charts
    assert [one for one in found if one[0] < 4.5] == []
    palette = colours.palette("dark" if dark else "light")
    paper = "rgb({}, {}, {})".format(*(int(palette["paper"][i : i + 2], 16) for i in (1, 3, 5)))
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == paper


def test_print_shows_every_row_and_reason_on_white(opened, made, computed):
    page = opened(dark=True)
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


def test_it_prints_on_few_pages(opened):
    page = opened()
    pages = pypdf.PdfReader(io.BytesIO(page.pdf(format="A4", prefer_css_page_size=True))).pages
    assert len(pages) <= MOST_PAGES
    text = " ".join("".join(page.extract_text() for page in pages).split())
    assert "Statements" in text
    assert "friction force 1.28" in text  # what is folded on the screen is printed


@pytest.mark.skipif(axe.SKIP, reason=axe.REASON)
def test_axe_finds_nothing_to_mend(browser, file):
    assert axe.found(browser, file) == []


@pytest.mark.skipif(axe.SKIP, reason=axe.REASON)
def test_axe_finds_nothing_to_mend_in_a_reason(opened):
    page = opened()
    page.locator("button.cell").first.click()
    assert page.locator(".why:popover-open").count() == 1
    assert axe.violations(page) == []


@pytest.mark.skipif(axe.SKIP, reason=axe.REASON)
def test_axe_would_find_what_is_wrong(opened):
    page = opened()
    page.evaluate("document.querySelector('h1').innerHTML += '<img src=\"data:,\">'")
    page.evaluate(
        "document.styleSheets[0].insertRule('.sources td a { min-height: 0 !important; }', 0)"
    )
    rules = {one.partition(":")[0] for one in axe.violations(page)}
    assert {"image-alt", "target-size"} <= rules


def test_without_a_script_everything_can_be_read(opened, computed):
    page = opened(java_script_enabled=False)
    assert page.locator("#claims tbody tr >> visible=true").count() == len(computed)
    assert page.locator(".plot > svg >> visible=true").count() == 23
    assert not page.locator(".filter").is_visible()  # nothing that would not work
    page.click('[id="table1.phi.1"] summary')
    assert page.locator('[id="table1.phi.1"] details p').is_visible()
    assert re.search("needs? it", page.inner_text(".noscript"))
