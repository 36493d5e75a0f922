"""The page: what it says is what was found, it stands alone, and it can be read by everybody."""

from __future__ import annotations

import colorsys
import dataclasses
import io
import itertools
import json
import math
import re
from xml.etree import ElementTree

import altair
import numpy as np
import pandas as pd
import pytest

from dampbalance import balance
from dampbalance.figures import looks
from dampbalance.project import wording
from dampbalance.publishing.page import charts, colours, curves, digits, match, resonance, words
from dampbalance.publishing.page.match import match_picture
from dampbalance.publishing.page.origins import ORIGINS, link, study_origin
from dampbalance.publishing.page.report import LARGEST_PAGE
from dampbalance.replication.claim_verdicts import KINDS, VERDICTS, counts
from dampbalance.replication.printed_tables import claim_of
from paper.contrast import GRAPHICS_ON, TEXT_ON, contrast
from paper.html import Tree
from paper.page_case import PAGE, claims_of_paper, page_of, results
from paper.routes import CASE, ROOT


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    return results(tmp_path_factory.mktemp("case"))


@pytest.fixture(scope="module")
def html(made):
    return page_of(made)


@pytest.fixture(scope="module")
def tree(html):
    return Tree(html)


# --- what it says ----------------------------------------------------------------------------------


def test_every_claim_has_its_row_and_its_reason(tree, made):
    rows = {e["id"]: e for e in tree.named("tr", "li") if "data-kind" in e}
    claims = made.claims.set_index("id")
    for kind in KINDS:
        of_kind = [name for name, row in rows.items() if row["data-kind"] == kind]
        assert of_kind == list(claims.index[claims["kind"] == kind])
    assert len(rows) == len(claims)
    for name, row in rows.items():
        claim = claims.loc[name]
        if claim["kind"] == "given":  # no verdict to filter by, and nothing to open
            assert row["tag"] == "li"
            assert row["data-verdict"] == ""
            assert wording.minus(claim["printed"]) in row["text"]
            continue
        assert row["data-verdict"] == claim["verdict"]
        text = " ".join(row["text"].split())
        assert wording.minus(claim["printed"]) in text
        # Symbols are set in HTML: compare what is not one.
        reason = words.reason(wording.minus(claim["explanation"])).striptags()
        assert " ".join(reason.split()) in text


def test_the_headline_counts_what_is_computed(tree, made):
    computed = made.claims[made.claims["kind"] == "computed"]
    lead = tree.one("p", class_="lead")["text"]
    assert f"Of the {len(computed)} computed numbers" in lead
    for verdict, n in computed["verdict"].value_counts().items():
        said = verdict.replace("differs", "differ")
        assert re.search(rf"\b{n} (are )?(by )?{said}|\b{n} by reconstructing", lead), verdict
    besides = tree.one("p", class_="besides")["text"]
    of_kind = made.claims["kind"].value_counts()
    assert f"{of_kind['given']} given values" in besides
    assert f"{of_kind['statement']} statements" in besides


def test_a_given_value_that_the_configuration_does_not_hold_says_so(made):
    claims = made.claims.copy()
    claims.loc[claims["id"] == "parameter.m", "verdict"] = "differs"
    tree = Tree(page_of(dataclasses.replace(made, claims=claims, evidence=None, studies=[])))
    assert "differs" in tree.one("li", id="parameter.m")["text"]
    held = int((claims["kind"] == "given").sum()) - 1
    (fold,) = (e["text"] for e in tree.named("summary") if "given values" in e["text"])
    assert f"holds {held} of them" in fold


def test_every_printed_cell_of_a_table_leads_to_its_claim(tree, made):
    buttons = [e for e in tree.named("button") if "popovertarget" in e]
    claims = made.claims.set_index("id")
    for button in buttons:
        claim = claims.loc[button["popovertarget"].removeprefix("why.")]
        assert button["text"].startswith(
            wording.minus(claim["printed"]) + VERDICTS[claim["verdict"]].mark
        )
        assert claim["verdict"] in button["text"]  # in words, not by colour alone
    shown = {button["popovertarget"].removeprefix("why.") for button in buttons}
    of_tables = {name for name in claims.index if re.match(r"table\d", name) and ".Y." not in name}
    assert of_tables <= shown
    boxes = {e["id"] for e in tree.all if "popover" in e}
    assert boxes == {f"why.{name}" for name in shown}


@pytest.mark.parametrize(
    ("cell", "claim"),
    [
        (("table1", "4 mm", 1, "X_s"), "table1.X_s.1"),
        (("table2", "pair 2-3", 7, "F_k"), "table2.F_k.2-3"),
        (("table3", "pair 1-5", 5, "c by V_s"), "table3.V_s.c.1-5"),
        (("statistics", "t_s, least squares", 3, "residual"), "text.residual_ts_ls"),
        (("statistics", "direct, mean", 2, "c"), "text.c_direct_mean"),
    ],
)
def test_a_cell_knows_its_claim(cell, claim):
    assert claim_of(*cell) == claim
    assert claim in set(claims_of_paper()["id"])


def test_the_errors_are_those_of_the_table(tree, made):
    text = tree.one("table", class_="errors")["text"]
    rows = made.approaches.set_index(["frequency", "approach", "phase", "sharing"])
    worst = rows["F_k_error_percent"]["omega3", "X_s", "reversal", "common"]
    assert -67.0 < worst < -65.0  # findings: 65.8 % of least squares
    assert f"−{abs(worst):.1f}" in text
    assert text.count("(") == 6 * len(rows) // 3 + 0  # two quantities at three frequencies a line


def test_off_resonance_the_page_tells_both_causes_and_what_each_costs(tree, made):
    text = " ".join(tree.one("section", id="errors")["text"].split())
    assert "Which phase:" in text
    assert "One phase for all levels:" in text
    # findings: −16.2 % by the phase alone and −19.5 % by both at 3.5 Hz, +11.8 and −65.8 % at 11.1 Hz
    for sentence in (
        "At 3.5 Hz the first alone puts Fk off by −16.2 %, the second alone by −17.6 %, and both together by −19.5 %",
        "At 11.1 Hz the first alone puts Fk off by +11.8 %, the second alone by −66.6 %, and both together by −65.8 %",
    ):
        assert sentence in text
    shown = resonance.mends(made.approaches, CASE.frequencies_hz)
    assert [round(abs(row[2]), 1) for row in shown.values()] == [65.8, 11.8, 2.8, 66.6, 0.4, 0.0]
    assert "as in the paper+1.37−19.5−65.8" in text


@pytest.mark.slow
def test_a_case_without_a_paper_has_a_page_without_verdicts(made):
    blank = {
        frequency: {name: table.assign(printed="", verdict="") for name, table in of.items()}
        for frequency, of in made.tables.items()
    }
    own = dataclasses.replace(made, claims=None, tables=blank, evidence=None, studies=[])
    tree = Tree(page_of(own))
    text = tree.one("main")["text"]
    assert not [e for e in tree.all if "data-verdict" in e]
    assert "Figure 3" in text
    assert "Parameter studies" not in text
    assert not [e for e in tree.named("a") if e["href"][1:] in ("match", "numbers", "studies")]


# --- it stands alone -------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_same_results_give_the_same_bytes(made, html):
    charts._drawn.cache_clear()  # drawn afresh, later in the life of the process
    assert page_of(made) == html


@pytest.mark.slow
def test_it_is_small_enough_and_says_when_it_is_not(made, html, monkeypatch):
    assert len(html.encode()) < LARGEST_PAGE == 3_000_000
    monkeypatch.setattr("dampbalance.publishing.page.report.LARGEST_PAGE", 1000)
    with pytest.raises(ValueError, match=r"report\.html would have [\d,]+ bytes, more than 1,000"):
        page_of(made)


def test_it_loads_nothing_from_elsewhere(tree):
    assert [a for a in tree.addresses if re.match(r"(?:[a-z]+:)?//|https?:", a)] == []
    policy = next(e["content"] for e in tree.named("meta") if "http-equiv" in e)
    assert policy.startswith("default-src 'none'")
    assert "http" not in policy


def test_every_link_leads_somewhere(tree):
    folder = (ROOT / PAGE).parent
    for element in tree.named("a"):
        target = element["href"]
        if target.startswith("#"):
            assert target[1:] in tree.ids, target
            continue
        path = (folder / target).resolve()
        assert path.is_relative_to(ROOT.resolve()), target
        if not path.is_relative_to((ROOT / "results").resolve()):  # results need not be there
            assert path.exists(), target


@pytest.mark.parametrize(
    "source", [*ORIGINS.values(), study_origin("frequency")], ids=lambda s: s.what
)
def test_a_source_is_where_it_says(source):
    rules = (ROOT / source.rules).read_text(encoding="utf-8")
    assert re.search(rf"^ *rule {source.rule}:", rules, re.MULTILINE)
    for path in source.code:
        assert (ROOT / path).is_file()


def test_links_start_from_where_the_page_stands():
    assert link("src/a.py", "results/paper/report.html") == "../../src/a.py"
    assert link("src/a.py", "report.html") == "src/a.py"


# --- it can be read by everybody -------------------------------------------------------------------


@pytest.mark.parametrize("mode", ["light", "dark"])
@pytest.mark.parametrize(("text", "ground"), TEXT_ON)
def test_text_has_the_contrast_that_wcag_aa_asks_for(mode, text, ground):
    palette = colours.palette(mode)
    assert contrast(palette[text], palette[ground]) >= 4.5  # WCAG 2.2, 1.4.3


@pytest.mark.parametrize("mode", ["light", "dark"])
@pytest.mark.parametrize(("mark", "ground"), GRAPHICS_ON)
def test_graphics_have_the_contrast_that_wcag_aa_asks_for(mode, mark, ground):
    palette = colours.palette(mode)
    assert contrast(palette[mark], palette[ground]) >= 3.0  # WCAG 2.2, 1.4.11


@pytest.mark.parametrize("mode", ["light", "dark"])
def test_a_spare_look_has_the_contrast_of_the_others(mode):
    palette = colours.palette(mode)
    for look in looks.SPARE:
        for ground in ("paper", "raised"):
            assert contrast(getattr(look, mode), palette[ground]) >= 3.0


def test_an_approach_without_a_look_of_its_own_has_a_colour_and_a_mark(monkeypatch):
    for name in ("new", "newer"):
        monkeypatch.setitem(balance.APPROACHES, name, balance.Approach(balance.direct, name))
    assert colours.series_colour("newer") == "var(--other-2)"
    assert "--other-2: #7a4a21;" in colours.css_variables("light")
    assert 'fill="var(--other-2)"' in colours.shape(looks.look_of("newer"))


def test_every_verdict_has_a_rule_of_style_and_a_hue_of_its_own(html):
    for verdict in VERDICTS.values():
        assert f".v-{verdict.css} {{ --fill: var(--{verdict.css});" in html
    hues = sorted(
        360.0 * colorsys.rgb_to_hsv(*(int(fill[i : i + 2], 16) for i in (1, 3, 5)))[0]
        for fill in (colours.palette("dark")[verdict.css] for verdict in VERDICTS.values())
    )
    apart = [b - a for a, b in itertools.pairwise([*hues, hues[0] + 360.0])]
    assert min(apart) > 15.0  # degrees; symbol and word tell verdicts apart in any case


def test_contrast_is_that_of_wcag():
    assert contrast("#000000", "#ffffff") == pytest.approx(21.0)
    assert contrast("#777777", "#ffffff") == pytest.approx(4.48, abs=0.005)  # the well-known grey


def test_every_colour_of_the_page_is_one_that_is_checked(html):
    palette = colours.palette("light").keys()
    local = {"fill", "tint", "text"}  # stand for a verdict's colours in the style sheet
    used = set(re.findall(r"var\(--([\w-]+)\)", html.replace("\\", ""))) - local
    assert used <= palette
    checked = {name for pair in (*TEXT_ON, *GRAPHICS_ON) for name in pair}
    assert used - checked == {"rule"}  # lines of tables and grids, which only decorate
    style = (ROOT / "src/dampbalance/publishing/page/static/style.css").read_text(encoding="utf-8")
    assert re.findall(r"#[0-9a-fA-F]{3,8}\b", style) == []  # no colour outside the palette
    specs = Tree(html).one("script", id="charts")["text"]
    assert re.findall(r'"#[0-9a-fA-F]{3,8}"', specs) == []


def test_the_document_says_its_language_and_its_headings_are_in_order(tree, html):
    assert html.startswith("<!doctype html>")
    assert tree.all[0] | {"text": ""} == {"tag": "html", "text": "", "within": (), "lang": "en"}
    levels = [int(e["tag"][1]) for e in tree.named("h1", "h2", "h3", "h4", "h5", "h6")]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(after <= before + 1 for before, after in itertools.pairwise(levels))


def test_names_are_unique_and_references_meet_them(tree):
    names = set(tree.ids)
    assert len(tree.ids) == len(names)
    for element in tree.all:
        for key in ("aria-labelledby", "popovertarget", "for"):
            assert element.get(key) is None or element[key] in names, element


def test_tables_have_captions_and_scoped_heads(tree):
    tables = tree.named("table")
    assert len(tables) >= 4
    assert len(tree.named("caption")) == len(tables)
    assert {e.get("scope") for e in tree.named("th")} == {"col", "row", "colgroup", "rowgroup"}


def test_the_first_thing_to_reach_skips_to_the_content(tree):
    first = next(e for e in tree.all if e["tag"] in ("a", "button", "input", "select"))
    assert first["href"] == "#main"
    assert tree.one("main")["id"] == "main"


def test_every_chart_is_described_and_drawn_without_a_script(tree):
    plots = [e for e in tree.named("div") if e.get("class") == "plot"]
    assert len(plots) == 6 + 4 + 6 + 6 + 1  # digits, Figure 3, errors, and two studies
    for plot in plots:
        assert len(plot["aria-label"]) > 20
    drawn = [
        e
        for e in tree.named("svg")
        if "div" in e["within"] and e.get("viewbox", "").startswith("0 0 3")
    ]
    assert len(drawn) >= len(plots)


# --- charts ----------------------------------------------------------------------------------------


@pytest.mark.slow
def test_specifications_are_valid_vega_lite(tree):
    sent = json.loads(tree.one("script", id="charts")["text"])
    assert len(sent["charts"]) == 23
    for spec in sent["charts"].values():
        altair.Chart.from_dict({**spec, "config": sent["config"]}, validate=True)


def chart_rows(tree, name):
    """The table behind a chart, as text."""
    text = tree.one("script", id=f"rows.{name}")["text"]
    return pd.read_csv(io.StringIO(text), dtype=str, keep_default_na=False)


def test_a_chart_holds_the_values_that_were_found(tree, made):
    table = chart_rows(tree, "study-frequency-F-k-0").astype(float)
    study, cases = made.studies[0]
    truth = pd.read_parquet(cases)
    assert len(table) == study.cases
    error = 100.0 * truth["F_k_relative_error__X_s__reversal__common__least_squares"]
    # five significant digits
    np.testing.assert_allclose(table["X_s_common"], error, rtol=5.1e-5)


def test_the_loops_tell_x_and_its_derivatives(tree, made):
    table = chart_rows(tree, "orbit")
    orbit = made.orbits[0]
    stick = table[(table["phase"] == "microstick") & (table["branch"] == "0")]
    x = stick["x"].astype(float)
    assert x.iloc[0] == pytest.approx(-1e3 * orbit.X, rel=1e-6)  # seven digits
    assert x.iloc[-1] == pytest.approx(1e3 * orbit.X_s, rel=1e-6)
    assert float(stick["t"].iloc[-1]) == pytest.approx(1e3 * orbit.t_s, rel=1e-5)
    at = orbit.state(orbit.t_1 + 1e-3 * stick["t"].astype(float).to_numpy())
    # t keeps six digits of some ms: a nanosecond, in which x moves by 1e-11 m and v by 3e-9 m/s.
    np.testing.assert_allclose(1e-3 * x, at.x, rtol=1e-6)
    np.testing.assert_allclose(stick["v"].astype(float), at.v, rtol=6e-5, atol=1e-8)
    np.testing.assert_allclose(stick["acc"].astype(float), at.acceleration, rtol=6e-5)


def test_every_line_of_the_step_is_in_its_legend(made):
    (study,) = (study for study in made.studies if study[0].name == "step_size")
    (figure,) = (curves.study_charts(*study),)
    (chart,) = figure.charts
    named = {str(entry.words) for entry in figure.legend}
    drawn = [value for value in chart.says if value.column != "step_s"]
    assert named == {str(words.titled(value.name)) for value in drawn}
    assert len(drawn) == len(looks.SCHEME_LOOKS) + 1  # and the law mω²h


def test_the_story_of_the_digits_is_that_of_the_article(made):
    evidence, unit = made.evidence, CASE.numerics.tabulated["t_s_unit_s"]
    panels = digits.digit_charts(evidence, CASE.oscillator, CASE.numerics.step_s, unit)
    assert [chart.title[:3] for chart in panels] == ["(a)", "(b)", "(c)", "(d)", "(e)", "(f)"]
    assert all(chart.legend and chart.remark for chart in panels)
    scheme, _, coefficients, phase, slip_time, sign = (chart.table.columns for chart in panels)
    # findings: W lies 1.3e-4 and b 2.5e-4 below exact, as backward Euler has it and no other scheme does
    np.testing.assert_allclose(scheme["W_printed"], -1.3, atol=0.05)
    assert np.abs(scheme["W_printed"] - scheme["W_backward_euler"]).max() < 0.01
    others = [key for key in scheme if key.startswith("W_") and "printed" not in key]
    assert len(others) == len(looks.SCHEME_LOOKS)
    for key in set(others) - {"W_backward_euler"}:
        assert np.abs(scheme["W_printed"] - scheme[key]).min() > 1.0
    assert np.abs(coefficients["rounded"]).max() < np.abs(coefficients["exact"]).min()
    assert np.all(np.diff(phase["reversal"]) > 0)
    assert np.all(np.diff(phase["zero_crossing"]) < 0)
    # findings: the printed phase is that of the reversal within 0.004 rad
    assert np.abs(phase["printed"] - phase["reversal"]).max() < 0.004
    np.testing.assert_allclose(slip_time["printed"], slip_time["whole"], rtol=1e-12)
    for symbol in ("F_k", "c"):
        plus, minus = sign[f"{symbol}_X_s"], sign[f"{symbol}_V_s"]
        assert plus.max() < 0.5 < 3.0 < minus.min()


def test_a_thinned_curve_stays_where_it_was():
    x = np.linspace(0.0, 300.0, 601)
    points = np.column_stack([x, 100.0 + 80.0 * np.sin(0.05 * x)])
    kept = points[charts._needed(points)]
    assert 10 < len(kept) < 100
    between = np.interp(x, kept[:, 0], kept[:, 1])
    # Distances to the chord are at most OFF; straight up they are longer where it is steep, at most 4 : 1 here.
    assert np.abs(between - points[:, 1]).max() <= charts.OFF * math.hypot(1.0, 4.0)
    assert charts._needed(np.array([[0.0, 0.0], [1.0, 5.0], [0.0, 0.0]])).all()  # there and back


def test_only_coordinates_are_rounded():
    svg = '<svg><text transform="translate(1.234,5.678)">0.001</text></svg>'
    assert charts._lean(svg, "a") == '<svg><text transform="translate(1.2,5.7)">0.001</text></svg>'


@pytest.mark.parametrize(
    ("limits", "ticks"),
    [((0.01, 100.0), [0.01, 0.1, 1.0, 10.0, 100.0]), ((1.5e-6, 9e-6), [2e-6, 5e-6])],
)
def test_ticks_of_a_logarithmic_axis(limits, ticks):
    assert charts._named_ticks(*limits) == ticks


def test_what_stands_in_a_script_cannot_end_it():
    text = charts.as_json({"a": "</script><!-- x"})
    assert "</" not in text
    assert "<!--" not in text
    assert json.loads(text) == {"a": "</script><!-- x"}


# --- words -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("function", "text", "shown"),
    [
        (words.rich, "X_s of 1 < 2", "<i>X</i><sub>s</sub> of 1 &lt; 2"),
        (words.rich, "phi: phase", "<i>φ</i>: phase"),
        (words.rich, "ω/ω_n and omega_1", "ω/<i>ω</i><sub>n</sub> and <i>ω</i><sub>1</sub>"),
        (words.rich, "least_squares", "least_squares"),
        (words.rich, "F_k is 5 % off at 4 mm", "<i>F</i><sub>k</sub> is 5~% off at 4~mm"),
        (words.titled, "error of *c* by X_s < 1", "error of <i>c</i> by <i>X</i><sub>s</sub> &lt; 1"),
        (words.titled, "at ω₁, 4.92 Hz", "at <i>ω</i><sub>1</sub>, 4.92~Hz"),
        (words.quantity, "a: norm of w", "<i>a</i>: norm of <i>w</i>"),
        (words.quantity, "share of a bound", "share of a bound"),
        (words.reason, "c acts as c + mω²h = 90.01 N s/m, not as the author’s c",
         "<i>c</i> acts as <i>c</i> + <i>m</i>ω²<i>h</i> = 90.01~N s/m, not as the author’s <i>c</i>"),
        (words.italic, "c", "*c*"),
        (words.italic, "F_k", "F_k"),
        (wording.plain, "F_k by X_s, K_z", "Fₖ by Xₛ, K_z"),
        (wording.unit_of, "m^2/s", "m²/s"),
        (wording.minus, "-0.5 and 1e-5, x-1", "−0.5 and 1e-5, x-1"),
        (wording.frequency_name, "omega2", "ω₂"),
        (wording.frequency_name, "resonance", "resonance"),
        (wording.number, 90.0, "90.00000"),
        (wording.number, -0.00271563541, "−0.002715635"),
        (wording.number, 4.2915e-16, "4.291500·10⁻¹⁶"),
        (wording.number, 0.0, "0"),
        (wording.number, math.nan, "–"),
        (wording.power_of_ten, 3e-12, "10⁻¹¹"),  # a bound is not below what it bounds
        (wording.power_of_ten, 1e-11, "10⁻¹¹"),
    ],
)  # fmt: skip
def test_symbols_numbers_and_units_are_set(function, text, shown):
    """A tilde stands for a space at which no line breaks."""
    assert str(function(text)) == shown.replace("~", "\N{NO-BREAK SPACE}")


# --- the picture in the README ---------------------------------------------------------------------


def test_the_picture_of_the_match_is_up_to_date():
    shown = (ROOT / "paper/figures/match.svg").read_text(encoding="utf-8")
    assert match_picture(counts(claims_of_paper())) == shown


SVG = "{http://www.w3.org/2000/svg}"


def test_the_picture_says_its_numbers():
    found = counts(claims_of_paper())
    root = ElementTree.fromstring(match_picture(found))
    total = found[-1]
    description = root.find(f"{SVG}desc").text
    assert description.startswith(
        f"Of {total.computed} computed numbers: {total.of_verdict['reproduced']} reproduced"
    )
    titles = [title.text for title in root.iter(f"{SVG}title")][1:]
    expected = [
        f"{count.part}: {n} {verdict}"
        for count in found
        for verdict, n in count.of_verdict.items()
        if n
    ]
    assert titles == expected
    bars = [
        float(rect.get("width"))
        for rect in root.iter(f"{SVG}rect")
        if rect.find(f"{SVG}title") is not None
    ]
    room = match.WIDTH - match.LEFT - match.RIGHT
    ends = itertools.accumulate(sum(map(bool, count.of_verdict.values())) for count in found)
    for count, end in zip(found, ends, strict=True):
        shares = [n / count.computed for n in count.of_verdict.values() if n]
        widths = bars[end - len(shares) : end]
        # to a tenth of a pixel
        assert [width + match.GAP for width in widths] == pytest.approx(
            [room * share for share in shares], abs=0.06
        )


def test_the_legend_of_the_picture_holds_every_verdict_inside_it():
    root = ElementTree.fromstring(match_picture(counts(claims_of_paper())))
    words = {text.text: text for text in root.iter(f"{SVG}text")}
    for name in VERDICTS:
        # 8 px a letter at 14 px, and some room
        assert float(words[name].get("x")) + 8 * len(name) < match.WIDTH
        assert float(words[name].get("y")) < float(root.get("height"))
