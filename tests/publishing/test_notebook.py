"""The guided tour runs, says what is so, and shows the same each time."""

from __future__ import annotations

import os
import re
from dataclasses import replace

import nbformat
import numpy as np
import pytest

from dampbalance.publishing import notebook
from folders import ROOT

SOURCE = ROOT / "paper/notebook/tour.py"


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
    assert paper[at] < 0.015


def test_outcomes_of_the_exercises(names, error):
    features, approaches, k = names["features"], names["APPROACHES"], names["oscillator"].k
    assert abs(error(names["rigid"], "X_s")) < abs(error(features, "X_s"))  # 1: "better"
    below = names["features_at"](3.5)
    worse = error(below.replaced(X_s=-below.X), "X_s")
    assert worse < error(below, "X_s") < 0  # "where they add up"

    soft = [error(names["soft_features"], of, "F_k", names["soft"]) for of in ("X_s", "t_s", "V_s")]
    by_place, *others = np.abs(soft)  # 2: "suffer a little more"
    assert all(by_place < of < 1.1 * by_place for of in others)

    assert names["with_gentle"].regime[0].startswith("no slip")  # 3
    direct = approaches["direct"](names["with_gentle"], k)
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


def test_only_the_public_interface_is_used():
    taken = re.findall(r"^from (dampbalance\S*) import ", SOURCE.read_text("utf-8"), re.MULTILINE)
    assert "dampbalance" in taken
    assert not [module for module in taken if "._" in module]


# --- what it becomes -----------------------------------------------------------------------------


@pytest.mark.slow
def test_the_notebook_is_complete_described_and_the_same_on_one_core():
    written = notebook.write_notebook(notebook.run_notebook(SOURCE))
    cells = nbformat.reads(written, as_version=4).cells
    code = [cell for cell in cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in code] == list(range(1, len(code) + 1))
    assert not any("execution" in cell.metadata for cell in cells)  # no times
    outputs = [(cell, output) for cell in code for output in cell.outputs]
    pictures = [cell for cell, output in outputs if "image/svg+xml" in output.get("data", {})]
    assert len(pictures) == 6
    assert all(cell.metadata.get("alt") for cell in pictures)
    answers = [cell for cell in code if cell.metadata.get("tags") == ["outcome"]]
    assert len(answers) == 5
    assert all(cell.outputs for cell in answers)
    allowed = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(allowed)})  # inherited by the kernel
    try:
        assert notebook.write_notebook(notebook.run_notebook(SOURCE)) == written
    finally:
        os.sched_setaffinity(0, allowed)


def test_errors_are_named_and_what_goes_to_stderr_stays_out(tmp_path, capsys):
    source = tmp_path / "script.py"
    cells = ["import sys\nprint('a warning', file=sys.stderr)\nprint('a result')", "x = 1", "x / 0"]
    source.write_text("".join(f"# %%\n{cell}\n" for cell in cells[:2]), encoding="utf-8")
    executed = notebook.run_notebook(source)
    assert [output.text for output in executed.cells[0].outputs] == ["a result\n"]
    assert "a warning" in capsys.readouterr().err
    source.write_text("".join(f"# %%\n{cell}\n" for cell in cells), encoding="utf-8")
    with pytest.raises(notebook.NotebookError, match=r"cell 3 fails with ZeroDivisionError.*\n\nx"):
        notebook.run_notebook(source)
