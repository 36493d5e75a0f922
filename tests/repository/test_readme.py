"""The READMEs of the project and of the results say what is so: their numbers, pictures and examples; so do docstrings
of public names."""

from __future__ import annotations

import doctest
import inspect
import re

import numpy as np
import pandas as pd
import pytest

import dampbalance
from dampbalance import Oscillator, identify, measured_ring_down
from dampbalance.figures.cycle import figure3
from dampbalance.figures.rig_drawings import rigs
from dampbalance.figures.style import in_one_column, save
from dampbalance.project.wording import with_error
from dampbalance.replication.claims.causes import Sources
from dampbalance.replication.claims.evidence import chance, free_choices
from dampbalance.replication.claims.table import claims_table
from dampbalance.replication.claims.verdicts import VERDICTS, counts
from dampbalance.replication.comparison import off_resonance
from dampbalance.studies.reading_study import read_study
from folders import ROOT
from paper_case import FREQUENCIES_HZ, PAPER, orbits_at
from replication.routes import CASE, PRINT, approaches, judged, nothing
from rooms import PACKAGE
from sizes import ROW, rewritten

README = (ROOT / "README.md").read_text(encoding="utf-8")
CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
CITATION = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
RESULTS = (ROOT / "results/README.md").read_text(encoding="utf-8")
STUDIES = (ROOT / "config/studies/README.md").read_text(encoding="utf-8")
GALLERY = (ROOT / "paper/site/studies.md").read_text(encoding="utf-8")


def test_the_verdicts_are_those_on_record():
    recorded = pd.read_csv(ROOT / "paper/published/verdicts.csv", dtype=str)
    # What kind a claim is does not depend on what the routes give for it.
    kinds = claims_table(Sources(PRINT, CASE, nothing()))[["id", "kind"]]
    recorded = recorded.merge(kinds, on="id", validate="one_to_one")
    block = RESULTS.split("<!-- verdicts", 1)[1].split("-->", 1)[1].split("<!-- end", 1)[0]
    counted = counts(recorded)
    names = ["numbers", "computed", *VERDICTS, "given", "statements", "statements that hold"]
    columns = [
        (of.part, of.computed, *of.of_verdict.values(), of.given, of.statements, of.statements_held)
        for of in counted
    ]
    table = [line.strip("| ").split(" | ") for line in block.strip().splitlines()]
    del table[1]  # the rule below the head
    assert table == [[*map(str, row)] for row in zip(names, *columns, strict=True)]
    total = counted[-1].of_verdict
    near = sum(total[name] for name in ("last digit", "reading", "propagated"))
    choices = sum(len(of) for of in free_choices(CASE).values())
    for text in (README, CITATION):
        assert (
            f"Of {counted[-1].computed} computed numbers, {total['reproduced']} follow from the model alone, "
            f"{total['simulated']} from a reconstruction fitted to the digits ({choices} choices) and "
            f"{total['from print']} from the paper's own arithmetic; {near} are within one unit of the last digit or "
            f"the resolution of reading or rounding, {total['unexplained']} come close without a known cause, and "
            f"{total['differs']} differ."
        ) in " ".join(text.split())
    undecided = recorded["verdict"][recorded["kind"] == "statement"].eq("undecided").sum()
    assert f"{undecided} of the {counted[-1].statements} statements is." in RESULTS


def decay_with_fit():
    """A free decay, few samples with much noise, the fit, and above it the answer next to the truth."""
    truth = Oscillator(m=2.42, c=1.0, k=2310.0, K_z=208_000.0, F_k=0.5)
    decay = measured_ring_down(truth, x=0.01, rate_hz=250.0, duration=2.6, noise=0.02, seed=1)
    answer = identify(decay, stiffness=truth.k)
    figure = answer.pictures["decays"].drawn(answer.coordinate)
    words = [
        f"${symbol}$ = {with_error(0.5 * (low + high), 0.5 * (high - low))} {unit} (true: {true:g})"
        for symbol, unit, true in (("F_k", "N", truth.F_k), ("c", "N s/m", truth.c))
        for low, high in [answer.intervals[symbol]]
    ]
    figure.axes[0].set_title("\n".join(words), parse_math=True, size=9.0)
    return in_one_column(figure)


def test_the_pictures_are_those_that_are_drawn(tmp_path):
    drawn = {"figure3": figure3(orbits_at()), "decay": decay_with_fit(), "rigs": rigs()}
    for name, figure in drawn.items():
        save(figure, tmp_path / f"{name}.svg", tmp_path / f"{name}.png")
        new, shown = (
            np.array(re.findall(r"-?\d+\.\d+", (folder / f"{name}.svg").read_text("utf-8")), float)
            for folder in (tmp_path, ROOT / "paper/figures")
        )
        # In points: a hundredth is invisible, and leaves room for another machine's last bits.
        assert new.shape == shown.shape
        np.testing.assert_allclose(new, shown, atol=0.01)


def test_the_causes_of_failure_have_the_sizes_quoted():
    at, below, above = off_resonance(approaches(), FREQUENCIES_HZ)
    text = " ".join(RESULTS.split())
    for words in (
        f"F_k off by {at['peak']} at 4.92 Hz, {below['peak']} at 3.5 Hz and {above['peak']} at",
        f"F_k by {below['which']} percentage points at 3.5 Hz and by {above['which']} at 11.1 Hz",
        f"the second by {below['shared']} and {above['shared']},",
        f"and both together by {below['both']} and {above['both']}:",
        f"errs by {at['paper']}, {below['paper']} and {above['paper']}.",
    ):
        assert words in text


def test_the_exact_numbers_that_may_agree_by_chance_are_counted():
    n = chance(judged())
    assert (
        f"{n['close']} exact numbers agree in all digits but the last, and {n['within']} lie within five units of it. "
        f"Of these {n['within']}, one in ten, {n['expected']:.0f}, is expected to round to the printed number by "
        f"chance; {n['observed']} do (at least as many with probability {n['p']:.2f})"
    ) in " ".join(RESULTS.split())


def test_the_table_of_studies_counts_their_cases():
    rows = re.findall(r"^\| `(\w+\.yaml)` \| .* \| ([\d,]+) \|$", STUDIES, re.MULTILINE)
    folder = ROOT / "config/studies"
    assert {file: int(count.replace(",", "")) for file, count in rows} == {
        path.name: read_study(path).cases for path in folder.glob("*.yaml")
    }
    shown = re.findall(r"results/studies/(\w+)/summary\.md", GALLERY)
    assert shown == sorted(path.stem for path in folder.glob("*.yaml"))


def test_the_examples_run(tmp_path, monkeypatch):
    for file in (ROOT / "config/records/example").glob("level*.csv"):
        (tmp_path / file.name).write_bytes(file.read_bytes())
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for code in re.findall(r"```python\n(.*?)```", README + STUDIES, re.DOTALL):
        exec(code, names)
    low, high = names["found"].intervals["F_k"]
    assert low < PAPER.F_k < high
    assert (tmp_path / "found/summary.txt").exists()
    orbit, osc = names["orbit"], names["osc"]
    # A difference of numbers of some 0.08 J: a few units of rounding, 1e-17 J each.
    assert abs(orbit.a * osc.F_k + orbit.b * osc.c - orbit.W) < 1e-16
    assert "fourier__least_squares" in repr(names["studied"])


def test_every_file_that_a_page_links_to_is_there():
    folders = "config", "examples", "tests", "trials", "paper/published"
    pages = [page for folder in folders for page in (ROOT / folder).rglob("*.md")]
    for page in (*ROOT.glob("*.md"), ROOT / "results/README.md", *pages):
        for target in re.findall(r"\]\((?!https?:)([^)#\s]+)[^)]*\)", page.read_text("utf-8")):
            assert (page.parent / target).exists(), (page, target)


def test_the_sizes_are_those_of_the_code():
    """Within 2 % and 20 lines, so that few changes need `make sizes`; every room has a row."""
    shown, counted = (
        {name: size for _, name, size in ROW.findall(text.partition("<!-- sizes")[2])}
        for text in (CONTRIBUTING, rewritten(CONTRIBUTING, {}))
    )
    rooms = {f"{path.parent.name}/" for path in PACKAGE.glob("*/__init__.py")}
    assert rooms <= shown.keys()
    for name, size in counted.items():
        if re.fullmatch(r"[\d,]+", size):
            lines, old = (int(text.replace(",", "")) for text in (size, shown[name]))
            assert abs(lines - old) <= 0.02 * lines + 20, f"{name}: make sizes"


# ---- Docstrings -----------------------------------------------------------------------------------------------------

FINDER = doctest.DocTestFinder()


def examples(name):
    """The docstrings of a public name and its methods that hold examples."""
    return [test for test in FINDER.find(getattr(dampbalance, name), name) if test.examples]


@pytest.mark.parametrize("name", [name for name in dampbalance.__all__ if examples(name)])
def test_its_examples_say_what_comes_out(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said: list[str] = []
    for test in examples(name):
        doctest.DocTestRunner(verbose=False).run(test, out=said.append)
    assert "".join(said) == ""


def test_every_public_function_has_one_and_the_package_shows_no_other_name():
    functions = [n for n in dampbalance.__all__ if inspect.isfunction(getattr(dampbalance, n))]
    assert [name for name in functions if not examples(name)] == []
    assert dir(dampbalance) == sorted(["__version__", *dampbalance.__all__])
