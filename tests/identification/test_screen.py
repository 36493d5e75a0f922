"""One screen everywhere: terminal, details, notebook, report and table have the same numbers and remedies."""

from __future__ import annotations

import ast
import math
import re
import shlex
from dataclasses import replace
from html import unescape

import numpy as np
import pytest

from dampbalance import Oscillator, identify, measured_ring_down
from dampbalance.commands.main import main
from dampbalance.findings.sentences import SENTENCES
from dampbalance.identification.screen import numbers
from dampbalance.project.options import OPTIONS
from dampbalance.project.spelling import in_a_shell, spelled
from folders import ROOT
from identification.levels import clipped, measured

OSC = Oscillator(m=1.74, c=31.0, k=3150.0, K_z=92000.0, F_k=2.1)
SWUNG = Oscillator(m=1.3, c=0.9, k=2100.0, K_z=60000.0, F_k=0.37)


SPEEDS = {"velocity_m_per_s": [1, -1, 2, -2, 4, -4], "force_N": [3, -3, 4, -4, 6, -6.1]}


def levels(osc=OSC):
    return measured((0.004, 0.007, 0.011), 5.2, osc)


def decay(seed=0):
    return measured_ring_down(SWUNG, x=0.012, rate_hz=900.0, duration=4.0, noise=0.004, seed=seed)


def without_an_answer():
    *sound, last = levels()
    return identify([*sound, clipped(last, "displacement", 0.8)], OSC.k)


def loops():
    """Of twenty amplitudes, one slider with a damper."""
    t = np.arange(0.0, 40.0, 0.004)
    x = 1e-3 * (0.2 + 0.05 * np.floor(t / 2.0)) * np.sin(4.0 * math.pi * t)
    forces, f = [], 0.0
    for step in np.diff(x, prepend=x[0]):
        f = float(np.clip(f + 4e4 * step, -6.5, 6.5))
        forces.append(f)
    noise = 0.02 * np.random.default_rng(3).standard_normal(t.size)
    return {"time_s": t, "displacement_m": x, "force_N": forces + 11.0 * np.gradient(x, t) + noise}


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


@pytest.fixture(scope="module")
def known():
    return {}


@pytest.fixture
def found(case, known):
    if case not in known:
        known[case] = CASES[case]()
    return known[case]


def plain(text):
    return " ".join(text.split())


def cells(html):
    """Text of a page, a blank for each mark."""
    return plain(unescape(re.sub(r"<[^>]*>", " ", html)))


EACH = pytest.mark.parametrize("case", CASES)


@EACH
def test_the_screen_is_one_and_the_details_have_all_of_it(found):
    said, whole = found.screen(80), plain(found.text())
    assert len(said.splitlines()) <= 24
    assert all(len(line) <= 80 for line in [*said.splitlines(), *found.text(80).splitlines()])
    *parts, _ = said.split("\n\n")
    if not found.laws:  # of which the screen counts those that it leaves out
        assert all(plain(line) in whole for part in parts for line in part.splitlines())


@EACH
def test_every_place_shows_the_same_numbers(found):
    text, html, report = plain(found.text()), cells(found._repr_html_()), found.report()
    table = found.summary()
    assert all(len(line) <= 80 for line in repr(table).splitlines())
    assert [*table.index] == [of.symbol for of in numbers(found)]
    for of in numbers(found):
        name, unit = of.name(found.coordinate), of.unit(found.coordinate)
        row = f"{name} ({unit}) {of.text}"
        assert row in text
        assert row in html
        assert of.text.split(" ")[0] in report
        values = re.findall(rf"(?<!\S){name} = ([−\d.]+ ± [\d.]+)", text.partition(" law ")[0])
        assert {*values} <= {of.text}
        low, value, high = table.loc[of.symbol, ["low", "value", "high"]]
        assert math.isnan(value) or low <= value <= high
        assert table.loc[of.symbol, "verdict"] == of.verdict.verdict


def test_mass_frequency_and_damping_ratio_have_the_errors_that_they_have():
    """Of ten decays the squares of error over standard error add up to χ² of ten degrees of freedom, which is between
    2.5 and 25 with a probability of 0.985."""
    truth = {
        "m": SWUNG.m,
        "f_n": math.sqrt(SWUNG.k / SWUNG.m) / (2.0 * math.pi),
        "zeta": SWUNG.c / (2.0 * math.sqrt(SWUNG.k * SWUNG.m)),
    }
    off = []
    for seed in range(10):
        own = identify(decay(seed), SWUNG.k).oscillator
        assert [*own] == [*truth]
        reach = {s: 0.5 * (p.interval.high - p.interval.low) / 1.96 for s, p in own.items()}
        off.append([(own[s].value - truth[s]) / reach[s] for s in truth])
    squares = np.sum(np.square(off), axis=0)
    assert (squares < 25.0).all(), squares
    assert (squares > 2.5).all(), squares


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
    command = ["identify", str(file), "--details"]
    decay().to_frame().to_csv(file)
    argument = re.search(r'stiffness=("[^"]*")', plain(identify(file, k).text()))[1]
    assert "state their" not in identify(file, ast.literal_eval(argument)).text()
    assert main([*command, "--stiffness", f"{k:g}"]) == 0
    said = plain(capsys.readouterr().out)
    assert "stiffness=" not in said
    typed = re.search(r'--stiffness "[^"]*"', said)[0]
    assert main([*command, *shlex.split(typed)]) == 0
    assert "state their" not in capsys.readouterr().out


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
