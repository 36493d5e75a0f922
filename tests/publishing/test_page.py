"""The page: what it says is what was found, it stands alone, and it can be read by everybody."""

from __future__ import annotations

import itertools
import re
from dataclasses import replace

import numpy as np
import pytest

from dampbalance.figures.style import save_svg
from dampbalance.project import wording
from dampbalance.publishing import colours, typesetting
from dampbalance.publishing.match import match_figure, match_words
from dampbalance.publishing.page.report import LARGEST_PAGE
from dampbalance.replication import comparison
from dampbalance.replication.claims.verdicts import KINDS, VERDICTS, counts
from publishing.article_case import PAGE, page_of
from publishing.html import Tree
from replication.routes import CASE, ROOT


@pytest.fixture(scope="module")
def html(report):
    return (report / "report.html").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def tree(html):
    return Tree(html)


# --- what it says ----------------------------------------------------------------------------------

RAISED = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


def typeset(text):
    """Return a number as the page sets it: 2.9E-3 is 2.9·10⁻³."""
    small = re.compile(r"(\d)[eE]-0*(\d+)")
    return small.sub(lambda of: f"{of[1]}·10⁻{of[2].translate(RAISED)}", wording.minus(text))


def said(element):
    return " ".join(element["text"].split())


def test_every_claim_has_its_row_and_its_reason(tree, made):
    rows = {e["id"]: e for e in tree.named("tr", "li") if "data-kind" in e}
    claims = made.claims.set_index("id")
    assert len(rows) == len(claims)
    for kind in KINDS:
        of_kind = [name for name, row in rows.items() if row["data-kind"] == kind]
        assert of_kind == list(claims.index[claims["kind"] == kind])
    for name, row in rows.items():
        claim = claims.loc[name]
        assert typeset(claim["printed"]) in said(row)
        # no verdict to filter a given value by
        assert row["data-verdict"] == (claim["verdict"] if claim["kind"] != "given" else "")
        if claim["kind"] != "given":
            # Symbols are set in HTML: compare what is not one.
            reason = typesetting.reason(typeset(claim["explanation"])).striptags()
            assert " ".join(reason.split()) in said(row)


def test_every_printed_cell_of_a_table_leads_to_its_claim(tree, made):
    claims = made.claims.set_index("id")
    shown = set()
    for button in (e for e in tree.named("button") if "popovertarget" in e):
        name = button["popovertarget"].removeprefix("why.")
        printed, verdict = claims.loc[name, ["printed", "verdict"]]
        assert button["text"].startswith(typeset(printed) + VERDICTS[verdict].mark)
        assert verdict in button["text"]  # in words, not by colour alone
        shown.add(name)
    of_tables = {name for name in claims.index if re.match(r"table\d", name) and ".Y." not in name}
    assert of_tables <= shown
    assert {e["id"] for e in tree.all if "popover" in e} == {f"why.{name}" for name in shown}


def test_the_headline_counts_what_is_computed(tree, made):
    verdicts = made.claims["verdict"][made.claims["kind"] == "computed"]
    lead = tree.one("ol", class_="findings")["text"]
    assert f"Of the {len(verdicts)} computed numbers" in lead
    for verdict, n in verdicts.value_counts().items():
        assert re.search(rf"\b{n} {verdict.replace('differs', 'differ')}", lead), verdict
    headline = said(tree.one("p", id="headline"))
    total, *parts = map(int, re.findall(r"(?<!\()\b\d+", headline))  # choices are in brackets
    assert total == sum(parts) == len(verdicts)
    proof = said(tree.one("p", id="proof"))
    for name in ("close", "within", "observed"):
        assert f" {made.derived[f'chance.{name}']} " in proof, name


def test_off_resonance_the_page_states_three_causes_and_what_each_costs(tree, made):
    text = said(tree.one("section", id="errors"))
    # findings, derived by independent code
    assert (
        "At 11.1 Hz the third alone changes Fk by −0.356 %; from there the first shifts it by +12.2 percentage "
        "points, the second by −66.2, and both together by −65.5."
    ) in text
    assert "as in the paper’s least squares+0.678−16.2+11.8" in text
    table = comparison.approaches_table(made.numbers, CASE.frequencies_hz)
    shown = comparison.mends(table, CASE.frequencies_hz)
    assert [round(abs(row[2]), 1) for row in shown.values()] == [65.8, 11.8, 2.8, 66.6, 0.4, 0.0]


def test_another_case_or_verdict_changes_the_page(made):
    claims = made.claims.copy()
    claims.loc[claims["id"] == "parameter.m", "verdict"] = "differs"
    name = "</script><!-- x"  # what stands in a script cannot end it
    page = page_of(replace(made, claims=claims, studies=[], config={"a": name}))
    assert name not in page
    assert "differs" in Tree(page).one("li", id="parameter.m")["text"]
    held = int((claims["kind"] == "given").sum()) - 1
    assert f"holds {held} of them" in page
    # a case without a paper has a page without verdicts
    blank = {key: row | {"printed": "", "verdict": ""} for key, row in made.numbers.items()}
    figures = {name: made.figures[name] for name in ("figure3", "estimation_error")}
    own = {"claims": None, "numbers": blank, "derived": {}, "studies": [], "figures": figures}
    tree = Tree(page_of(replace(made, **own)))
    assert not [e for e in tree.all if "data-verdict" in e]
    assert "Parameter studies" not in tree.one("main")["text"]
    assert not [e for e in tree.named("a") if e["href"][1:] in ("match", "numbers", "studies")]


# --- it stands alone -------------------------------------------------------------------------------


def test_the_same_results_give_the_same_bytes_and_few(made, html, monkeypatch):
    assert len(html.encode()) < LARGEST_PAGE == 3_500_000
    monkeypatch.setattr("dampbalance.publishing.page.report.LARGEST_PAGE", 1000)
    with pytest.warns(UserWarning, match=r"report\.html has [\d,]+ bytes, more than the 1,000"):
        assert page_of(made) == html


def test_it_loads_nothing_from_elsewhere_and_every_link_leads_somewhere(tree):
    assert [a for a in tree.addresses if re.match(r"(?:[a-z]+:)?//|https?:", a)] == []
    policy = next(e["content"] for e in tree.named("meta") if "http-equiv" in e)
    assert policy.startswith("default-src 'none'")
    for target in (element["href"] for element in tree.named("a")):
        if target.startswith("#"):
            assert target[1:].partition("?")[0] in tree.ids, target  # an instrument with its state
            continue
        path = ((ROOT / PAGE).parent / target).resolve()
        assert path.is_relative_to(ROOT.resolve()), target
        # results need not be there
        assert path.exists() or path.is_relative_to((ROOT / "results").resolve()), target


# --- it can be read by everybody; in a browser axe asks for more ------------------------------------

OF_VERDICTS = tuple(verdict.css for verdict in VERDICTS.values())
SERIES = tuple(colours.series())
TEXT_ON = [
    *itertools.product(("ink", "muted", "link"), ("paper", "raised", "target")),
    *itertools.product(("slip", "stick"), ("paper",)),  # names of branches stand in their colour
    *(("on-verdict", verdict) for verdict in OF_VERDICTS),
    *((f"{verdict}-text", f"{verdict}-tint") for verdict in OF_VERDICTS),
    *((f"{verdict}-text", "paper") for verdict in OF_VERDICTS),
]
"""(text, ground) of everything that is read."""

GRAPHICS_ON = [
    *((name, "paper") for name in (*OF_VERDICTS, *SERIES, "edge", "focus", "muted")),
    *((name, "raised") for name in (*SERIES, "edge", "focus")),
]
"""(line, mark or outline, ground) of everything that is looked at."""


def contrast(one: str, other: str) -> float:
    """Contrast ratio of two colours #rrggbb, from 1 to 21, as WCAG 2.2 defines it."""

    def luminance(colour):
        channels = np.array([int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5)])
        curved = ((channels + 0.055) / 1.055) ** 2.4
        linear = np.where(channels <= 0.04045, channels / 12.92, curved)
        return float(linear @ [0.2126, 0.7152, 0.0722])

    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("mode", ["light", "dark"])
def test_contrasts_are_those_that_wcag_aa_asks_for(mode):
    assert contrast("#777777", "#ffffff") == pytest.approx(4.48, abs=0.005)  # the well-known grey
    palette = colours.palette(mode)
    for text, ground in TEXT_ON:
        assert contrast(palette[text], palette[ground]) >= 4.5, (text, ground)  # WCAG 2.2, 1.4.3
    for mark, ground in GRAPHICS_ON:
        assert contrast(palette[mark], palette[ground]) >= 3.0, (mark, ground)  # WCAG 2.2, 1.4.11


# --- the picture in results/README.md -------------------------------------------------------------


def test_the_picture_of_the_match_shows_the_shares_of_the_verdicts_and_is_up_to_date(
    made, tmp_path
):
    found = counts(made.claims)
    (axes,) = match_figure(found).axes
    for bars, verdict in zip(axes.containers, VERDICTS, strict=True):
        shares = [count.of_verdict[verdict] / count.computed for count in found if count.computed]
        assert [bar.get_width() for bar in bars] == pytest.approx(shares)
    save_svg(match_figure(found), tmp_path / "match.svg", match_words(found))
    new, shown = (
        np.array(re.findall(r"-?\d+\.\d+", file.read_text("utf-8")), float)
        for file in (tmp_path / "match.svg", ROOT / "paper/figures/match.svg")
    )
    # in points: a hundredth is invisible, and leaves room for another machine's last bits
    np.testing.assert_allclose(new, shown, atol=0.01)
