"""Page, site and the report of a measurement in a real Chromium without a network: they load nothing, filter, fold,
search and print; by keyboard, on a phone, and for readers whom a page can hinder."""

from __future__ import annotations

import io
from typing import Any

import pypdf
import pytest

from dampbalance import identify
from dampbalance.replication.claims.verdicts import KINDS
from folders import ROOT, shared
from publishing.site_case import built

pytestmark = pytest.mark.slow

OPTIONS = {
    # WCAG 2.2, levels A and AA, which takes in 2.0 and 2.1; and what axe recommends beyond it.
    "runOnly": {
        "type": "tag",
        "values": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"],
    },
    "rules": {"target-size": {"enabled": True}},  # 2.5.8, which axe leaves out by default
    "resultTypes": ["violations"],
}
VIEWS = {
    "desktop": {"viewport": {"width": 1280, "height": 900}, "color_scheme": "light"},
    "phone": {"viewport": {"width": 375, "height": 800}, "color_scheme": "dark"},
}
# Everything unfolded, of the tables below drawings the first. Of entries of a list, rows of a table, marks of a drawing
# and boxes that open which are made alike, down to what is empty in them, three stay.
_UNFOLD_AND_THIN = r"""() => {
  for (const one of document.querySelectorAll('details:not(.values)')) one.open = true;
  const values = document.querySelector('.values');
  if (values) values.open = true;
  const counts = new Map();
  for (const one of document.querySelectorAll('tr, li, svg *, [popover]')) {
    const make = one.outerHTML.replace(/>[^<]*[^<\s][^<]*</g, '>x<').replace(/="[^"]+"/g, '=x');
    if (!counts.has(one.parentElement)) counts.set(one.parentElement, {});
    const count = counts.get(one.parentElement);
    count[make] = (count[make] ?? 0) + 1;
    if (count[make] > 3) one.remove();
  }
}"""


def hindrances(browser: Any, address: str) -> list[str]:
    """What axe-core finds on a page with everything unfolded, at desktop width in light and at phone width in dark."""
    wrong = []
    for name, view in VIEWS.items():
        page = browser.new_page(offline=True, reduced_motion="reduce", **view)
        page.goto(address)
        page.evaluate(_UNFOLD_AND_THIN)
        wrong += [f"{name}: {one}" for one in violations(page)]
        page.close()
    return wrong


def violations(page: Any, within: str | None = None) -> list[str]:
    """What axe-core finds on a page of playwright as it stands: rule, place and element.   within : a selector."""
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    return [
        f"{one['id']}: {' '.join(map(str, node['target']))}: {node['html'][:120]}"
        for one in axe.run(page, within, OPTIONS).response["violations"]
        for node in one["nodes"]
    ]


# Texts of boxes that scroll sideways, or could.
WIDER = """all => all.filter(one => one.clientWidth && one.scrollWidth > one.clientWidth).map(one => one.innerText)"""
PHONE, LAPTOP = VIEWS["phone"]["viewport"], VIEWS["desktop"]["viewport"]


def width(page):
    return page.evaluate("document.documentElement.scrollWidth")


def printed(page):
    """The text of each page on paper."""
    pages = pypdf.PdfReader(io.BytesIO(page.pdf(format="A4", prefer_css_page_size=True))).pages
    return [" ".join(one.extract_text().split()) for one in pages]


# --- the page -------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def address(report):
    return (report / "report.html").as_uri()


@pytest.fixture
def page(window, address):
    """The page as it opens."""
    window.goto(address)
    return window


@pytest.fixture(scope="module")
def computed(made):
    """The claims that are counted."""
    return made.claims[made.claims["kind"] == "computed"]


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
    ids = computed["id"]
    assert shown(page) == [*ids]
    page.select_option("#filter-part", "Table 1")
    page.select_option("#filter-verdict", "reading")
    chosen = ids[ids.str.startswith("table1") & (computed["verdict"] == "reading")]
    assert shown(page) == [*chosen]
    assert page.inner_text("#found").startswith(f"{len(chosen)} of {len(computed)} computed")
    page.click("button[type=reset]")
    assert shown(page) == [*ids]
    assert found(page, "LEVEL 3  t_s.3") == ["table1.t_s.3"]
    assert "table1.X_s.1" in found(page, "-0.00272")  # as typed, with a hyphen for the minus
    assert found(page, "contact stiffness") == ["parameter.K_z"]
    for same in (("phi", "φ", "PHI"), ("b_1", "b₁"), ("F_k 1-2", "F_k 1–2")):
        one, *others = (found(page, words) for words in same)
        assert one != []
        assert all(other == one for other in others)
    assert found(page, "no such words") == []
    page.click("#clear")
    page.click('.counts a[data-part="Table 3"][data-verdict="simulated"]')
    simulated = ids[computed["verdict"] == "simulated"]
    assert shown(page) == [*simulated[simulated.str.startswith("table3")]]


def test_reasons_open_on_demand_from_the_tables_and_on_paper(page, made, computed):
    reason = page.locator('[id="table1.phi.1"] details p')
    box = page.locator('[id="why.table1.phi.1"]')
    assert not reason.is_visible()
    page.select_option("#filter-part", "Table 3")  # hides the row that the link leads to
    page.click('button[popovertarget="why.table1.phi.1"]')
    assert made.claims.set_index("id")["verdict"]["table1.phi.1"] in box.inner_text()
    box.locator("a").click()
    reason.wait_for(state="visible")
    assert not box.is_visible()
    page.select_option("#filter-part", "Table 3")
    page.emulate_media(media="print")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert page.locator("#claims details p >> visible=true").count() == len(computed)
    for kind in KINDS:
        assert len(shown(page, kind)) == (made.claims["kind"] == kind).sum()
    page.emulate_media(media="null")
    assert len(printed(page)) <= 19


def test_it_fits_a_phone_and_needs_no_script(visit, address, computed):
    phone = visit(address, viewport=PHONE)
    height = phone.evaluate("document.documentElement.scrollHeight")
    assert height < 12_000  # px: sections are folded
    phone.evaluate("document.querySelectorAll('details').forEach(one => { one.open = true; })")
    assert width(phone) == PHONE["width"]
    page = visit(address, java_script_enabled=False)
    assert page.locator("#claims tbody tr >> visible=true").count() == len(computed)
    assert page.locator(".drawing img >> visible=true").count() == 6
    assert not page.locator(".filter").is_visible()  # nothing that would not work
    page.click('[id="table1.phi.1"] summary')
    assert page.locator('[id="table1.phi.1"] details p').is_visible()


def test_axe_finds_nothing_to_mend(browser, address, page):
    assert hindrances(browser, address) == []
    page.locator("button.cell").first.click()
    assert violations(page, ".why:popover-open") == []
    page.evaluate("document.querySelector('h1').innerHTML += '<img src=\"data:,\">'")
    assert any("image-alt" in one for one in violations(page, "h1"))  # it would see that


def test_a_report_of_a_measurement_fits_a_phone_and_prints_with_the_verdict_on_the_first_page(
    browser, visit, tmp_path
):
    records = sorted((ROOT / "config/records/example").glob("level*.csv"))[::2]
    path = tmp_path / "report.html"
    path.write_text(identify(records, 2310.0).report(), encoding="utf-8")
    assert hindrances(browser, path.as_uri()) == []
    view = visit(path.as_uri(), viewport=PHONE, color_scheme="dark")
    assert width(view) <= PHONE["width"]
    assert view.eval_on_selector_all("*", WIDER) == []
    verdicts = view.locator("td .verdict").all()
    ends = [of["x"] + of["width"] for of in (one.bounding_box() for one in verdicts)]
    assert len(ends) == 6  # of F_k, c, K_z, m, f_n and ζ
    assert max(ends) <= PHONE["width"]
    # pictures are in the form for a phone, which is 90 mm wide: letters keep their size
    shown = view.eval_on_selector_all("picture img", "all => all.map(one => one.naturalWidth)")
    assert shown[:3] == pytest.approx([90.0 / 25.4 * 96.0] * 3, abs=1.0)
    decoded = "all => Promise.all(all.map(one => one.decode().then(() => one.naturalWidth)))"
    drawn = view.eval_on_selector_all("img", decoded)
    assert len(drawn) == 4  # three pictures, and the rig
    assert min(drawn) > 0
    pages = printed(view)
    assert len(pages) <= 6
    assert "usable within" in pages[0]


# --- the site -------------------------------------------------------------------------------------


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
    ended = "() => /found|finished/i.test(document.querySelector('#search-results').innerText)"
    page.wait_for_function(ended)
    links = page.eval_on_selector_all("#search-results li a", "all => all.map(a => a.href)")
    assert any(leads in link for link in links)


def test_no_block_is_cut_on_a_laptop_and_no_page_wider_than_a_phone(site, window):
    """Code on all pages; tables on those that are not lists of numbers or keys."""
    cut, wide = [], []
    for path in sorted(site.rglob("*.html")):
        name = path.relative_to(site).as_posix()
        if name.startswith(("files/", "run/")):
            continue
        window.set_viewport_size(LAPTOP)
        window.goto(path.as_uri())
        lists = name.startswith(("reference/", "explain/"))
        blocks = "pre" if lists else "pre, .pst-scrollable-table-container"
        cut += [(name, text) for text in window.eval_on_selector_all(blocks, WIDER)]
        window.set_viewport_size(PHONE)
        wide += [name] * (width(window) > PHONE["width"])
    assert (cut, wide) == ([], [])


@pytest.mark.parametrize("name", ["index", "explain/tour", "reference/case", "studies", "search"])
def test_it_hinders_nobody(site, browser, name):
    assert hindrances(browser, (site / f"{name}.html").as_uri()) == []
