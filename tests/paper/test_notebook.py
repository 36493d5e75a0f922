"""The guided tour runs, says what is so, shows the same each time, and needs no network to be read."""

from __future__ import annotations

import ast
import html
import importlib
import os
import re
from base64 import b64decode, b64encode
from dataclasses import replace
from io import BytesIO

import nbformat
import numpy as np
import pandas as pd
import pytest
from fontTools.ttLib import TTFont

from dampbalance.figures.style import DARK
from dampbalance.publishing import formulas, notebook
from folders import ROOT
from paper import axe
from paper.html import Tree

FOLDER = ROOT / "paper/notebook"
SOURCE = FOLDER / "tour.py"
STYLE = (FOLDER / "page.css").read_text(encoding="utf-8")
TEMPLATE = FOLDER / "page.html"


def shown(source):
    """The executed notebook, and the bytes of its two files."""
    executed = notebook.run(source)
    return executed, notebook.write(executed), notebook.page(executed, STYLE, TEMPLATE)


@pytest.fixture(scope="module")
def tour():
    return shown(SOURCE)


@pytest.fixture(scope="module")
def executed(tour):
    return tour[0]


@pytest.fixture(scope="module")
def page(tour):
    return tour[2]


def script(folder, *cells):
    """A notebook script of these cells, each with what stands on its %% line."""
    path = folder / "script.py"
    path.write_text("\n".join(f"# %%{head}\n{body}\n" for head, body in cells), encoding="utf-8")
    return path


TITLE = (" [markdown]", "# # A title")


# --- what it says --------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def names():
    """What the cells define, run one after the other without a kernel."""
    import matplotlib.pyplot as plt

    cells = re.split(r"^# %%(.*)$", SOURCE.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]
    found: dict = {}
    with plt.rc_context():
        for head, body in zip(cells[::2], cells[1::2], strict=True):
            if "[markdown]" not in head:
                exec(body, found)
        plt.close("all")
    return found


@pytest.fixture(scope="module")
def error(names):
    """Relative error of F_k (or c) by least squares of an approach on features."""

    def of(features, approach, quantity="F_k", oscillator=names["oscillator"]):
        fit = names["least_squares"](names["APPROACHES"][approach](features, oscillator.k))
        return float(fit[quantity]) / getattr(oscillator, quantity) - 1.0

    return of


def test_numbers_of_the_first_sections(names):
    oscillator, orbit = names["oscillator"], names["orbit"]
    assert oscillator.K_z / oscillator.k == pytest.approx(90, abs=0.5)  # "ninety times stiffer"
    assert 1e6 * oscillator.Z_m == pytest.approx(6, abs=0.5)  # "six thousandths of a millimetre"
    assert 1e3 * orbit.t_s == pytest.approx(3, abs=0.5)  # "some three milliseconds"
    from_slope = -oscillator.m * names["slope"] - oscillator.k
    assert 1 - from_slope / oscillator.K_z == pytest.approx(0.06, abs=0.005)  # "some six per cent"
    rows = names["APPROACHES"]["direct"](names["features"], oscillator.k)
    share = (rows.terms["F_k"] * oscillator.F_k / rows.W)[-1]
    assert share == pytest.approx(0.06, abs=0.005)  # "six per cent of the energy"
    assert 0.01 / share == pytest.approx(1 / 6, abs=0.01)  # "by a sixth"


def test_it_works_at_resonance_and_breaks_away_from_it(names, error):
    at = names["features"]
    for approach in ("X_s", "t_s", "V_s"):
        assert 0 < error(at, approach) < 0.01  # "within a hundredth"
        assert abs(error(at, approach, "c")) < 0.001  # "within a thousandth"
    shown = names["errors_by_pair"](names["features_above"])
    assert list(shown.columns) == ["pair 1-2", "pair 2-3", "pair 3-4", "pair 4-5", "pair 1-5"]
    assert set(shown.loc["direct"]) == {"+0.0%"}  # "does not mind"
    harmonic = shown.drop(index="direct").map(lambda text: float(text.rstrip("%")))
    # findings: 66.5 % for the pair furthest off; "two thirds", and "the same wrong story"
    assert float(harmonic.loc["X_s"].min()) == pytest.approx(-66.5, abs=0.1)
    assert ((harmonic < -64) & (harmonic > -67)).all(axis=None)


def test_the_blame_is_on_the_work_and_its_phase(names):
    features, k = names["features_above"].with_common("phi", "t_s"), names["oscillator"].k
    exact, harmonic = (names["APPROACHES"][name](features, k) for name in ("direct", "X_s"))
    # "right to the last digit"; X and X_s are differences of a few units of rounding
    np.testing.assert_allclose(harmonic.terms["F_k"], exact.terms["F_k"], rtol=1e-13)
    of_W = harmonic.W / exact.W - 1
    assert of_W[0] < -0.03 < 0.03 < of_W[-1]  # "too small at the lowest level, too large at …"
    assert np.all(np.diff(of_W) > 0)
    of_b = harmonic.terms["c"] / exact.terms["c"] - 1
    assert np.abs(of_b).max() < 0.1 * np.abs(of_W).max()


def test_the_two_causes_are_of_the_sizes_that_the_text_tells(names):
    (off_below, spread_below), (off_at, spread_at), (off_above, spread_above) = names["found"]
    assert abs(off_at) < 0.001  # "the sine is at its maximum, and forgives both"
    assert spread_at < 1e-5
    assert 0.5 < abs(off_below) / spread_below < 2.0  # "of one size"
    assert spread_above > 5 * abs(off_above)  # "by far the larger"


def test_each_mend_does_what_the_text_tells(names):
    mended = [names["mended"][f"{hertz} Hz"] for hertz in (3.5, 4.92, 11.1)]
    paper, a, b, c, d, e = np.abs(np.transpose(mended))
    below, at, above = 0, 1, 2
    assert paper[above] == pytest.approx(0.658, abs=0.001)  # findings: 65.8 % of least squares
    assert a[below] == pytest.approx(0.162, abs=0.001)  # findings: the phase alone costs 16 %
    assert c[below] == pytest.approx(0.176, abs=0.001)
    assert d[below] == pytest.approx(0.04, abs=0.0005)  # "+4 %"; the others have a minus there
    both = paper[below] + d[below]
    assert min(a[below], c[below]) + d[below] > 0.8 * both  # "nearly as far as both"
    assert a[below] + c[below] + 2.0 * d[below] > 1.5 * both  # "do not add"
    assert d[at] == pytest.approx(paper[at], rel=0.05)  # "all of the error"
    assert c[above] > 0.99 * paper[above]  # "the better phase of (c) helps nothing"
    assert a[above] == pytest.approx(0.118, abs=0.001)  # findings: 11.8 %, "far better"
    for place in (below, above):
        assert d[place] < b[place] < a[place]  # "lies between"
    assert max(d) < 0.04  # "within a few per cent"
    assert max(e) < 0.0005
    assert all(e < d)
    assert len(paper) == len(e) == 3
    assert paper[at] < 0.015


def test_the_errors_over_frequency_are_as_described(names):
    recipes = list(names["MENDS"].values())
    errors = [
        [abs(names["error_of_F_k"](*mend(each))) for each in names["by_frequency"]]
        for mend in recipes
    ]
    paper, fourier = errors[0], errors[-1]
    assert max(fourier) == fourier[0] < 1 / 300  # holds "throughout"
    assert paper[0] > 0.3  # "only near resonance"
    assert min(paper[40:]) > 0.05  # beyond 6 Hz


def test_outcomes_of_the_exercises(names, error):
    features = names["features"]
    assert abs(error(names["rigid"], "X_s")) < abs(error(features, "X_s"))  # 1: "better"
    below = names["features_at"](3.5)
    worse = error(below.replaced(X_s=-below.X), "X_s")
    assert worse < error(below, "X_s") < 0  # "where they add up"

    soft, oscillator = names["soft_features"], names["soft"]  # 2: "suffer a little more"
    by_place = abs(error(soft, "X_s", oscillator=oscillator))
    for approach in ("t_s", "V_s"):
        assert by_place < abs(error(soft, approach, oscillator=oscillator)) < 1.1 * by_place

    assert names["with_gentle"].regime[0].startswith("no slip")  # 3
    assert round(names["oscillator"].k * 0.0005, 2) == 1.16  # "1.16 N"
    direct = names["APPROACHES"]["direct"](names["with_gentle"], names["oscillator"].k)
    assert direct.usable.all()
    assert direct.terms["F_k"][0] == 0.0

    scatter = names["scatter"]  # 4: "best … worst … worse than the pair 1-5"
    assert scatter["pair 1-5"] == min(scatter.values())
    assert scatter["pair 4-5"] == max(scatter.values())
    weighed = [replace(rows, weights=rows.W**-2.0) for rows in names["experiments"]]
    divided = np.std([names["least_squares"](rows)["F_k"] for rows in weighed])
    assert divided < scatter["pair 1-5"]  # "divide each row by its W first, and see"

    # 5: "the first step makes things worse", "both … about one per cent at most"
    phase, in_W, in_both = (np.abs(errors) for errors in names["steps"].values())
    assert all(in_W > phase)
    assert max(in_both) < 0.011
    assert all(in_both < phase)


# --- how it is written ---------------------------------------------------------------------------


def test_only_the_public_interface_is_used():
    tree = ast.parse(SOURCE.read_text(encoding="utf-8"))
    taken = [
        (node.module, alias.name)
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("dampbalance")
        for alias in node.names
    ]
    assert ("dampbalance", "steady_orbit") in taken
    for module, name in taken:
        assert not any(part.startswith("_") for part in [*module.split("."), name])
        assert hasattr(importlib.import_module(module), name)
    public_of_tuples = {"_fields", "_replace"}  # documented parts of a NamedTuple
    hidden = {
        node.attr
        for node in ast.walk(tree)
        if isinstance(node, ast.Attribute) and re.match(r"_(?!_)", node.attr)
    }
    assert hidden <= public_of_tuples


@pytest.mark.slow
def test_every_exercise_has_an_outcome(executed):
    questions = [
        i for i, cell in enumerate(executed.cells) if re.match(r"\*\*\d\. ", cell.source)
    ] + [i for i, cell in enumerate(executed.cells) if re.search(r"^\*\*1\. ", cell.source, re.M)]
    assert len(set(questions)) == 5
    for i in questions:
        answer = executed.cells[i + 1]
        assert answer.metadata.tags == ["outcome"]
        assert answer.outputs


@pytest.mark.slow
def test_a_notebook_shows_figures_without_being_told_of_pyplot(tmp_path):
    path = script(
        tmp_path,
        TITLE,
        ("", "from dampbalance.figures.style import page, place\nfigure = page(40.0, 30.0)"),
        (' alt="A frame."', "place(figure, 5.0, 5.0, 30.0, 20.0)\nfigure"),
    )
    assert shown(path)[2].count("<img") == 1


# --- what it becomes -----------------------------------------------------------------------------


@pytest.mark.slow
def test_the_notebook_is_valid_and_complete(tour):
    read = nbformat.reads(tour[1], as_version=4)
    nbformat.validate(read)
    code = [cell for cell in read.cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in code] == list(range(1, len(code) + 1))
    assert len({cell.id for cell in read.cells}) == len(read.cells)
    assert not any("execution" in cell.metadata for cell in read.cells)  # no times
    streams = [o for cell in code for o in cell.outputs if o.output_type == "stream"]
    assert {stream.name for stream in streams} == {"stdout"}


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="cores cannot be chosen here")
def test_one_core_shows_the_same_bytes(tour):
    allowed = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(allowed)})  # inherited by the kernel
    try:
        _, ipynb, html = shown(SOURCE)
    finally:
        os.sched_setaffinity(0, allowed)
    assert ipynb == tour[1]
    assert html == tour[2]


@pytest.mark.slow
def test_the_page_loads_nothing_and_its_links_lead_somewhere(page):
    tree = Tree(page)
    assert [a for a in tree.addresses if not a.startswith(("data:", "#"))] == []
    within = {a[1:] for a in tree.addresses if a.startswith("#")}
    assert within
    assert within - set(tree.ids) == set()
    assert tree.named("script", "link", "iframe", "object") == []
    assert "@import" not in page
    assert re.findall(r"url\((.{14})", page) == ['"data:font/otf']


@pytest.mark.slow
def test_formulas_are_mathml_and_pictures_are_described(page, executed):
    tree = Tree(page)
    assert len(tree.named("math")) > 50
    assert "\\ddot" not in re.sub(r"<pre.*?</pre>", "", page, flags=re.S)
    apart = re.sub(r'<span class="together">.*?</span>', "", page, flags=re.S)
    assert apart != page
    assert not re.search(r"</math>(?:</span>)?[,.;:)]", apart)  # no line begins with a comma
    pictures = [
        cell
        for cell in executed.cells
        if any("image/svg+xml" in o.get("data", {}) for o in cell.get("outputs", []))
    ]
    assert [e.get("alt") for e in tree.named("img")] == [cell.metadata.alt for cell in pictures]
    assert len(pictures) == 6
    assert len(tree.named("details")) == 5


@pytest.mark.slow
def test_the_font_has_all_characters_of_the_formulas_and_its_table_for_mathematics(page):
    """And little else: without the one, ẍ has its dots anywhere; without the other, another font steps in."""
    made = formulas.font_for(page)
    assert b64encode(made).decode() in page
    font = TTFont(BytesIO(made))
    assert "MATH" in font
    for latex, shown in (
        (r"\ddot x", "\N{MATHEMATICAL ITALIC SMALL X}"),
        ("K_z", "𝐾𝑧"),
        ("h", "ℎ"),
    ):
        assert set(shown) <= formulas.characters(formulas.inline(latex))
    assert formulas.characters(page) - set(map(chr, font.getBestCmap())) == set()
    assert len(made) < 60_000


@pytest.mark.slow
def test_pictures_follow_the_screen_and_have_no_colour_that_does_not(page):
    pictures = [b64decode(p).decode() for p in re.findall(r"svg\+xml;base64,([^\"]*)", page)]
    palette = {colour.lower() for colour in DARK}
    for picture in pictures:
        assert picture.count("@media (prefers-color-scheme: dark)") == 1
        drawn = picture.partition("</style>")[2]
        assert set(re.findall(r"(?:fill|stroke): (#\w+)", drawn)) - palette == set()


@pytest.mark.slow
def test_what_is_said_beside_a_table_is_shown(page):
    """An identification says what it is made of and what limits it, around its table."""
    text = html.unescape(re.sub(r"<[^>]+>", "", page))
    space = "\N{NO-BREAK SPACE}"
    assert f"5 records at 3.5{space}Hz; the answer first, with 95{space}% intervals" in text
    assert "<ul><li>* <i>X</i><sub>s</sub>, <i>t</i><sub>s</sub> and" in page
    assert "<style" not in page.split("<body", 1)[1]


@pytest.mark.slow
@pytest.mark.parametrize(("width", "dark"), [(1200, False), (360, True)])
def test_a_browser_without_network_shows_it(page, tmp_path, visit, width, dark):
    file = tmp_path / "tour.html"
    file.write_text(page, encoding="utf-8")
    view = visit(file.as_uri(), dark, viewport={"width": width, "height": 800})
    seen = view.evaluate(
        """() => ({
            wide: document.documentElement.scrollWidth,
            formula: document.querySelector('math[display=block]').getBoundingClientRect().height,
            pictures: [...document.images].map(i => i.complete && i.naturalWidth > 0),
            paper: getComputedStyle(document.body).backgroundColor,
            cut: [...document.querySelectorAll('.equation')].filter(e => e.scrollWidth > e.clientWidth).length,
            fonts: [...document.fonts].filter(f => f.status === 'loaded').length,
            pushed: [...document.querySelectorAll('pre')].filter(p => p.scrollWidth > p.clientWidth).length,
            open: [...document.querySelectorAll('details')].filter(d => d.open).length,
        })"""
    )
    view.keyboard.press("Tab")
    skip = view.evaluate("document.activeElement.className")
    assert visit.said == []
    assert seen["wide"] <= width  # nothing has to be pushed sideways but tables, figures, equations
    assert seen["formula"] > 10
    assert seen["pictures"] == [True] * 6
    assert seen["open"] == 0
    assert (seen["pushed"], seen["cut"], seen["fonts"]) == (0, 0, 1)
    assert (seen["paper"] == "rgb(255, 255, 255)") == (not dark)
    assert skip == "skip"  # the first thing that the keyboard reaches


@pytest.mark.slow
@pytest.mark.skipif(axe.SKIP, reason=axe.REASON)
def test_axe_finds_nothing_to_mend(page, tmp_path, browser):
    file = tmp_path / "tour.html"
    file.write_text(page, encoding="utf-8")
    assert axe.found(browser, file) == []


# --- what can go wrong ---------------------------------------------------------------------------


def test_a_failing_cell_is_named_with_its_error(tmp_path):
    source = script(tmp_path, TITLE, ("", "x = 1"), ("", "x / 0"))
    with pytest.raises(notebook.NotebookError, match=r"cell 3 fails with ZeroDivisionError.*\n\nx"):
        notebook.run(source)


def test_what_goes_to_stderr_stays_out(tmp_path, capsys):
    body = "import sys\nprint('a warning', file=sys.stderr)\nprint('a result')"
    executed = notebook.run(script(tmp_path, TITLE, ("", body)))
    assert "a warning" not in notebook.write(executed).split('"outputs"', 1)[1].split('"source"')[0]
    assert [output.text for output in executed.cells[1].outputs] == ["a result\n"]
    assert "a warning" in capsys.readouterr().err


def made(*cells):
    return nbformat.v4.new_notebook(cells=list(cells))


def picture(**metadata):
    cell = nbformat.v4.new_code_cell("draw()", id="cell-02", metadata=metadata)
    data = {"image/svg+xml": "<svg/>", "text/plain": "<Figure>"}
    cell.outputs = [nbformat.v4.new_output("display_data", data=data)]
    return cell


@pytest.mark.parametrize(
    ("cells", "message"),
    [
        ([nbformat.v4.new_markdown_cell("no title")], "must begin with its title"),
        ([nbformat.v4.new_markdown_cell("# A title"), picture()], "cell-02 shows a picture: say"),
        (
            [
                nbformat.v4.new_markdown_cell(
                    '# A title\n\n<img alt="x" src="https://example.org/x.png">'
                )
            ],
            "would load from elsewhere",
        ),
    ],
)
def test_a_page_that_would_lack_something_is_refused(cells, message):
    with pytest.raises(notebook.NotebookError, match=message):
        notebook.page(made(*cells), STYLE, TEMPLATE)


def table_of(frame):
    return shown_of(frame.to_html(notebook=True))


def shown_of(text):
    cell = nbformat.v4.new_code_cell("table", id="cell-07")
    cell.outputs = [nbformat.v4.new_output("execute_result", data={"text/html": text})]
    return notebook.body(made(cell))


def test_html_that_cannot_be_read_is_refused():
    with pytest.raises(notebook.NotebookError, match="cell-07 shows HTML that is not well-formed"):
        shown_of("<div><p>one<br>two</p></div>")


def test_a_table_keeps_its_heads_and_loses_its_own_look():
    frame = pd.DataFrame(
        {"X_s (mm)": [-1.5], "F_k < 2": ["(a) *x*"]}, index=pd.Index([4], name="Y")
    )
    assert table_of(frame).splitlines()[3:-2] == [
        '<div class="table" tabindex="0" role="region" aria-label="Table">',
        "<table>",
        "<thead>",
        '<tr><th scope="col">Y</th><th scope="col"><i>X</i><sub>s</sub> (mm)</th>'
        '<th scope="col"><i>F</i><sub>k</sub> &lt; 2</th></tr>',
        "</thead>",
        "<tbody>",
        '<tr><th scope="row">4</th><td>−1.5</td><td>(a) *x*</td></tr>',
        "</tbody>",
    ]


def test_heads_above_several_columns_say_so_and_an_empty_corner_is_no_head():
    columns = pd.MultiIndex.from_tuples([("3.5 Hz", "F_k"), ("3.5 Hz", "c")])
    text = table_of(pd.DataFrame([[1, 2]], columns=columns, index=["direct"]))
    assert (
        '<td rowspan="2"></td><th scope="colgroup" colspan="2">3.5\N{NO-BREAK SPACE}Hz</th></tr>'
        in text
    )
    assert '<tr><th scope="col"><i>F</i><sub>k</sub></th><th scope="col">c</th></tr>' in text
    assert "<th></th>" not in text
