"""One screen everywhere: terminal, details, notebook, report and table have the same numbers and remedies."""

from __future__ import annotations

import ast
import functools
import math
import re
import shlex
from dataclasses import replace

import numpy as np
import pytest

from dampbalance import Oscillator, identify, measured_ring_down
from dampbalance.commands.main import main
from dampbalance.findings.sentences import SENTENCES
from dampbalance.identification.screen import numbers
from dampbalance.project.options import OPTIONS
from dampbalance.project.spelling import in_a_shell, spelled
from fit.test_loops import SINE, T, loop
from folders import ROOT
from identification.levels import THREE, clipped, measured
from publishing.html import in_a_line, words

OSC = Oscillator(m=1.74, c=31.0, k=3150.0, K_z=92000.0, F_k=2.1)
SWUNG = Oscillator(m=1.3, c=0.9, k=2100.0, K_z=60000.0, F_k=0.37)


SPEEDS = {"velocity_m_per_s": [1, -1, 2, -2, 4, -4], "force_N": [3, -3, 4, -4, 6, -6.1]}


def levels(osc=OSC, **options):
    return measured((0.004, 0.007, 0.011), 5.2, osc, **options)


def decay(seed=0):
    return measured_ring_down(SWUNG, x=0.012, rate_hz=300.0, duration=4.0, noise=0.004, seed=seed)


@functools.cache
def without_an_answer():
    """The last response, clipped at 80 % of its peak, is that of no oscillator."""
    *sound, last = levels(rate_hz=500.0, channels=THREE)
    return identify([*sound, clipped(last, "acceleration", 0.8)], OSC.k)


def loops():
    """Of twenty amplitudes."""
    x = (0.2 + 0.05 * np.floor(T)) * SINE
    return {"time_s": T, "displacement_m": x, "force_N": loop(x).f}


CASES = {
    "forced": lambda: identify(levels(), OSC.k),
    "laws": lambda: identify(levels(), (OSC.k, 30.0), mass=(1.745, 0.02), laws=True),
    "decay": lambda: identify(decay(), SWUNG.k),
    "loops": lambda: identify(loops()),
    "stepped": lambda: identify(ROOT / "config/records/stepped/levels.csv"),
    "speeds": lambda: identify(SPEEDS),
    "none": without_an_answer,
    "linear": lambda: identify(levels(osc=replace(OSC, F_k=0.0)), OSC.k),
}


@pytest.fixture(scope="module", params=CASES)
def found(request):
    return CASES[request.param]()


def test_the_screen_is_one_and_the_details_have_all_of_it(found):
    said, whole = found.screen(80), in_a_line(found.text())
    assert len(said.splitlines()) <= 24
    assert all(len(line) <= 80 for line in [*said.splitlines(), *found.text(80).splitlines()])
    *parts, _ = said.split("\n\n")
    if not found.laws:  # of which the screen counts those that it leaves out
        assert all(in_a_line(line) in whole for part in parts for line in part.splitlines())


def test_every_place_shows_the_same_numbers(found):
    text, html = in_a_line(found.text()), words(found._repr_html_())
    table = found.summary()
    assert all(len(line) <= 80 for line in repr(table).splitlines())
    assert [*table.index] == [of.symbol for of in numbers(found)]
    for of in numbers(found):
        name, unit = of.name(found.coordinate), of.unit(found.coordinate)
        row = f"{name} ({unit}) {of.text}"
        assert row in text
        assert row in html
        values = re.findall(rf"(?<!\S){name} = ([−\d.]+ ± [\d.]+)", text.partition(" law ")[0])
        assert {*values} <= {of.text}
        low, value, high = table.loc[of.symbol, ["low", "value", "high"]]
        assert math.isnan(value) or low <= value <= high
        assert table.loc[of.symbol, "verdict"] == of.verdict.verdict


def test_without_an_answer_the_cause_comes_first_and_the_numbers_last():
    found, cause, remedy = without_an_answer(), "acceleration is clipped", "raise the measuring"
    assert {v.verdict for v in found.verdicts.values()} <= {"doubtful", "none"}
    assert cause in found.document()["no_answer"]
    for said, last in ((found.text(), "F_k (N)"), (words(found.report()), "95 % interval")):
        order = [in_a_line(said).index(of) for of in (f"No answer: {cause}", remedy, last)]
        assert sorted(order) == order


def test_mass_frequency_and_damping_ratio_have_the_errors_that_they_have():
    """Of ten decays the squares of error over standard error add up to χ² of ten degrees of freedom, which is between
    2.5 and 25 with a probability of 0.985."""
    omega = math.sqrt(SWUNG.k / SWUNG.m)
    truth = {"m": SWUNG.m, "f_n": omega / (2.0 * math.pi), "zeta": 0.5 * SWUNG.c / SWUNG.m / omega}
    off = []
    for seed in range(10):
        own = identify(decay(seed), SWUNG.k).oscillator
        assert [*own] == [*truth]
        reach = {s: 0.5 * (p.interval.high - p.interval.low) / 1.96 for s, p in own.items()}
        off.append([(own[s].value - truth[s]) / reach[s] for s in truth])
    squares = np.sum(np.square(off), axis=0)
    assert ((squares > 2.5) & (squares < 25.0)).all(), squares


def test_an_error_of_the_stiffness_moves_the_mass_but_neither_frequency_nor_ratio():
    """m, c and k are in proportion: f_n and ζ are pure numbers of the motion."""
    sure, stated = (identify(decay(), k).oscillator for k in (SWUNG.k, (SWUNG.k, 0.02 * SWUNG.k)))
    assert stated["m"].within == pytest.approx(1.96 * 0.02, rel=0.01)  # of noise there is 1e-4
    for symbol in ("f_n", "zeta"):
        assert stated[symbol].within == pytest.approx(sure[symbol].within, rel=0.02)


# --- remedies: as their reader types them --------------------------------------------------------------


def test_an_option_in_a_sentence_is_one():
    words = " ".join(f"{of.words} {of.remedy}" for of in SENTENCES.values())
    named = {name.replace("-", "_") for name in re.findall(r"--([a-z][a-z-]*)", words)}
    assert named
    assert named <= {*OPTIONS, "kind"}


def test_a_remedy_can_be_typed_where_it_is_read(tmp_path, capsys):
    """The stiffness with the uncertainty that is proposed is taken, and the remedy is gone."""
    file, k = tmp_path / "swing.csv", 1e6 * SWUNG.k
    decay().to_frame().to_csv(file)

    def shown(*typed):
        assert main(["identify", str(file), "--details", *typed]) == 0
        return in_a_line(capsys.readouterr().out)

    argument = re.search(r'stiffness=("[^"]*")', in_a_line(identify(file, k).text()))[1]
    assert "state their" not in identify(file, ast.literal_eval(argument)).text()
    said = shown("--stiffness", f"{k:g}")
    assert "stiffness=" not in said
    assert "state their" not in shown(*shlex.split(re.search(r'--stiffness "[^"]*"', said)[0]))


@pytest.mark.parametrize(
    ("name", "value", "python", "shell"),
    [
        ("skip_cycles", "12", "skip_cycles=12", "--skip-cycles 12"),
        ("laws", "", "laws=True", "--laws"),
        ("kind", "ring-down", 'kind="ring-down"', "--kind ring-down"),
        ("stiffness", "2 ± 1 %", 'stiffness="2 ± 1 %"', '--stiffness "2 ± 1 %"'),
    ],
)
def test_an_option_is_spelled_for_its_reader(name, value, python, shell):
    with in_a_shell():
        assert spelled(name, value) == shell
    assert spelled(name, value) == python
