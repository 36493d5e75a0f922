"""One slider or many from tables of a stepped sine: the truth is found, and the answer is whole and consistent."""

from __future__ import annotations

import math
import runpy

import numpy as np
import pandas as pd
import pytest
from matplotlib import pyplot

from dampbalance import Oscillator, identify, identify_joint, measured_ring_down, read_records
from dampbalance.fit.select import CLEAR
from dampbalance.identification.outputs import outputs_of
from dampbalance.identification.screen import limiting
from dampbalance.identification.sensitivities import Fault
from dampbalance.identification.stepped_sine import damping_at
from dampbalance.law.contact import Sliders
from dampbalance.records.synthetic import stepped_sine
from folders import ROOT
from slips import slips

OSCILLATOR = {"m": 2.0, "c": 6.0, "k": 180_000.0}
ONE = Sliders(np.array([7e-5]), np.array([4e4]))
MANY = Sliders(np.geomspace(2e-5, 2e-4, 16), 1e3 * np.linspace(2.0, 5.0, 16))
HZ = np.linspace(46.0, 56.0, 11)
AMPLITUDES = (2e-5, 5e-5, 1e-4, 2e-4, 4e-4)


def table(sliders=ONE, amplitudes=AMPLITUDES, noise=0.003):
    options = {"amplitudes": amplitudes, "frequencies_hz": HZ, "noise": noise, "seed": 1}
    return stepped_sine(OSCILLATOR, sliders, **options)


@pytest.fixture(scope="module")
def one():
    return identify(table())


@pytest.fixture(scope="module")
def many():
    return identify(table(MANY))


def test_one_slider_is_found_where_it_is_enough(one):
    assert next(iter(one.approaches)) == "one slider"
    truth = {"F_k": ONE.F_k, "c": OSCILLATOR["c"], "K_z": ONE.K_z}
    for symbol, value in truth.items():
        # four standard errors: chance leaves one of the three outside in one seed of 5,000
        assert abs(one.values[symbol] - value) < 4.0 * one.standard_errors[symbol], symbol
        assert one.verdicts[symbol].verdict == "usable"
    merit = one.answer.merit
    assert abs(merit["m_kg"] - 2.0) < 4.0 * merit["m_standard_error_kg"]
    assert abs(merit["k_N_per_m"] - 180_000.0) < 4.0 * merit["k_standard_error_N_per_m"]


def test_many_sliders_are_found_where_one_is_not_enough(many):
    assert list(many.approaches) == ["gradual", "one slider"]
    values = many.values
    # sliders at sixteen amplitudes are taken for a smooth distribution
    assert values["K_z"] == pytest.approx(MANY.K_z, rel=0.1)
    assert values["F_k"] == pytest.approx(MANY.F_k, rel=0.1)
    assert {v.verdict for v in many.verdicts.values()} == {"usable"}
    verdict = many.approaches["one slider"].verdicts["K_z"]
    assert verdict.verdict == "doubtful"
    assert [one.numbers["contact"] for one in verdict.findings] == ["gradual"]
    assert many.check[0].numbers["weight"] > CLEAR
    X = np.geomspace(3e-5, 3.5e-4, 20)
    omega = 2.0 * np.pi * 51.0
    exact = MANY.loss(X) + np.pi * omega * OSCILLATOR["c"] * X**2
    Z, reach = many.basis.fits["gradual"].law(X, omega)
    # between two levels it is known by its band alone, whose errors there depend on each other
    off = np.abs(np.pi * X**2 * Z.imag - exact) / (np.pi * X**2 * reach.imag)
    assert off.max() < 3.0
    assert np.mean(off < 1.5) > 0.8


def test_the_rows_are_the_balance(one):
    """a F_k + b c = W with a = 4(X − r)₊ and b = πωX², Eq. (14), and W = πFX sin φ of every line."""
    rows, columns = one.rows, table()
    assert list(rows) == ["a_m", "b_m2_per_s", "W_J", "standard_error_J", "misfit_J"]
    omega = 2.0 * np.pi * columns["frequency_Hz"]
    X = columns["acceleration_m_per_s2"] / omega**2
    phi = np.pi - np.radians(columns["phase_deg"])
    np.testing.assert_allclose(rows["W_J"], np.pi * columns["force_N"] * X * np.sin(phi), rtol=1e-9)
    np.testing.assert_allclose(rows["b_m2_per_s"], np.pi * omega * X**2, rtol=1e-12)
    travel = 4.0 * np.maximum(X - one.basis.fits["one slider"].all_sliders.r[0], 0.0)
    np.testing.assert_allclose(rows["a_m"], travel, rtol=1e-9, atol=1e-15)
    law = rows["a_m"] * one.values["F_k"] + rows["b_m2_per_s"] * one.values["c"]
    np.testing.assert_allclose(rows["misfit_J"], law - rows["W_J"], rtol=1e-6, atol=1e-12)
    assert list(rows.index.unique()) == [f"level {n}" for n in range(1, 6)]


def test_a_damping_that_may_be_zero_is_an_upper_limit():
    """Near the resonance it trades with the friction, which is known closely: no more of it could hide."""
    options = {"amplitudes": AMPLITUDES[2:], "frequencies_hz": HZ, "noise": 0.01, "seed": 1}
    lines = stepped_sine(OSCILLATOR | {"c": 0.0}, ONE, **options)
    found = identify_joint(lines, contact="one slider", hardening=False)
    errors = np.sqrt(np.diag(found.answer.covariance))
    np.testing.assert_allclose(errors, [*found.standard_errors.values()], rtol=1e-12)
    verdict = found.verdicts["c"]
    assert verdict.verdict == "usable"
    assert [one.code for one in verdict.findings] == ["upper limit"]


def test_a_level_is_its_line_nearest_to_resonance(one):
    for level, X in zip(one.levels, AMPLITUDES, strict=True):
        assert pytest.approx(X, rel=0.02) == level.X
        friction = 4.0 * ONE.F_k * max(level.X - 7e-5, 0.0)
        assert level.friction == pytest.approx(friction, rel=0.05, abs=1e-9)
        assert friction + np.pi * level.omega * 6.0 * level.X**2 == pytest.approx(level.W, rel=0.05)


def test_everything_of_an_identification_is_there(many, tmp_path):
    found, files = many, many.save(tmp_path)
    assert {file.name for file in files} == {*outputs_of("stepped-sine")}
    document = found.document()
    assert document["answer"] == next(iter(found.approaches)) == document["comparison"]["supported"]
    own = document["approaches"][document["answer"]]
    assert own["F_k_N"] == found.values["F_k"]
    assert len(own["rows"]["W_J"]) == len(own["rows"]["frequency_Hz"]) == 55
    zeta = found.values["c"] / (2.0 * math.sqrt(found.k * own["m_kg"]))
    assert document["damping"]["damping_ratio"] == pytest.approx(zeta, rel=1e-12)
    assert slips("\n".join([str(found), found.text(), *limiting(found)])) == []
    for name in ("loss", "stiffness"):
        (axes,) = found.plot(name)
        points = [len(of.get_xdata()) for of in axes.get_lines() if of.get_marker() == "."]
        assert (sum(points), len(axes.collections)) == (55, 2)  # lines, and bands of both laws
        pyplot.close(axes.figure)


EXAMPLE = ROOT / "config/records/stepped"


def test_an_uncertainty_of_a_stated_stiffness_widens_by_what_such_a_fault_does():
    """F_k does not follow an error of k: mass and contact take what the stiffness cannot."""
    k = 188_750.0
    found, stated = (
        identify(EXAMPLE / "levels.csv", of, contact="one slider") for of in (k, (k, 0.001 * k))
    )
    told = found.shifts({"k": Fault("", stiffness=0.001)}, found.answer.name)["k"]
    for symbol, error in stated.standard_errors.items():
        off = told[symbol] * found.values[symbol]
        assert error == pytest.approx(math.hypot(found.standard_errors[symbol], off), rel=1e-3)


def test_a_base_that_moves_is_a_force_of_the_known_stiffness():
    k = OSCILLATOR["k"]
    columns = table()
    of_base = {name: of for name, of in columns.items() if name != "force_N"}
    of_base["base_displacement_m"] = columns["force_N"] / k
    asked = {"contact": "one slider", "stiffness": (k, 900.0)}
    by_base, by_force = identify(of_base, **asked), identify(columns, **asked)
    for symbol, value in by_force.values.items():
        assert by_base.values[symbol] == pytest.approx(value, rel=1e-6)
    assert by_base.k == k
    # 0.5 % in k is 0.5 % in every number
    tight = identify(of_base, k, contact="one slider")
    for symbol, error in by_base.standard_errors.items():
        own = 0.005 * by_base.values[symbol]
        assert error == pytest.approx(math.hypot(tight.standard_errors[symbol], own), rel=1e-4)
    with pytest.raises(ValueError, match=r"the base drives.*give stiffness"):
        identify(of_base)


def test_two_levels_do_not_tell_whether_one_slider_is_enough():
    found = identify(table(amplitudes=(5e-5, 3e-4)))
    assert found.basis.compared is None
    assert set(found.approaches) == {"one slider", "gradual"}
    assert found.verdicts["K_z"].verdict == "doubtful"
    assert [one.code for one in found.verdicts["K_z"].findings] == ["two levels"]


def test_a_contact_asked_for_alone_is_doubtful_where_whole_levels_depart_from_it():
    found = identify(table(MANY), contact="one slider")
    assert {of.verdict for of in found.verdicts.values()} == {"doubtful"}


def test_no_contact_that_slips_is_an_answer_too():
    nothing = Sliders(np.array([1.0]), np.array([4e4]))
    found = identify(table(nothing))
    assert next(iter(found.approaches)) == "none (c)"
    assert found.values["c"] == pytest.approx(6.0, rel=0.02)
    assert found.verdicts["K_z"].verdict == "none"
    assert [one.code for one in found.verdicts["F_k"].findings] == ["no contact"]
    assert next(iter(found.rows)) == "b_m2_per_s"


def test_what_is_known_is_held():
    options = {"contact": "one slider", "mass": 2.0, "hardening": False, "terms": "F_k,c,c_2"}
    found = identify(table(), 180_000.0, given={"c_2": 0.0}, **options)
    fit = found.basis.fits[found.answer.name]
    assert (fit.value("k"), fit.value("m")) == (180_000.0, 2.0)
    assert set(found.values) == {"F_k", "c", "K_z"}
    assert "k_3" not in fit.parameters


@pytest.mark.parametrize(
    ("sliders", "answer", "by"),
    [
        (ONE, "one slider", 1.0),
        (ONE, "gradual", 0.8),
        (MANY, "gradual", 1.0),
        (MANY, "gradual", 1.05),
    ],
)
def test_a_stiffness_that_is_stated_is_tested_by_the_lines(sliders, answer, by):
    """Too large, none of the answers is usable; too small, a contact that sticks makes up for it, F_k and K_z are what
    they are with k free, and that is said."""
    stated = by * OSCILLATOR["k"]
    found = identify(table(sliders), stated)
    first = next(iter(found.approaches))
    doubted = {
        name: [v.findings[0].code for v in of.verdicts.values() if v.verdict == "doubtful"]
        for name, of in found.approaches.items()
    }
    assert first == answer
    assert (doubted[first] == ["stiffness differs"] * 3) == (by > 1.0)
    sticks = [one.numbers["k"] for one in found.findings if one.code == "sticks in every line"]
    assert sticks == ([stated] if by < 1.0 else [])
    if by < 1.0:
        assert doubted["one slider"] == ["stiffness differs"] * 3
        free = identify(table(sliders), contact="gradual")
        assert found.values == pytest.approx(free.values, rel=1e-3)
        of, stuck = (one.basis.fits["gradual"] for one in (free, found))
        assert stuck.stuck == pytest.approx(of.value("k") - stated, rel=1e-3)


def test_a_stated_uncertainty_of_the_stiffness_counts():
    for error, verdict in ((200.0, "doubtful"), (9e3, "usable")):
        found = identify(table(), (1.05 * OSCILLATOR["k"], error), contact="one slider")
        assert found.verdicts["K_z"].verdict == verdict


def test_tables_of_one_level_each_make_one_identification():
    whole = pd.DataFrame(table())
    parts = [own.drop(columns="level") for _, own in whole.groupby("level")]
    for number, part in enumerate(parts):
        part.attrs["name"] = f"run {number}"
    found = identify(parts, contact="one slider")
    assert [of.name for of in found.levels] == [f"run {n}" for n in range(5)]
    assert found.values == identify(table(), contact="one slider").values


SWING = measured_ring_down(
    Oscillator(m=2.0, c=1.5, k=2310.0, K_z=208000.0, F_k=0.5), x=0.012, rate_hz=500.0, duration=2.0
)


@pytest.mark.parametrize(
    ("records", "options", "message"),
    [
        (table(amplitudes=(1e-4,)), {}, "has one level of excitation.*give tables of two levels"),
        (table(), {"given": {"F_k": 1.0}}, "F_k depends on the amplitudes.*cannot be given"),
        (table(), {"contact": "two"}, "contact must be one of both, one slider, gradual"),
        ([table(), SWING], {}, "is no table of a stepped sine: identify it separately"),
        (read_records(table()), {"kind": "forced", "stiffness": 1.0}, "is a table of a stepped sine: identify it"),
        (SWING, {}, "stiffness .* is missing: free decays need it"),
    ],
)  # fmt: skip
def test_what_cannot_be_identified_is_refused(records, options, message):
    with pytest.raises(ValueError, match=message):
        identify(records, **options)


def test_the_example_is_what_its_page_says(tmp_path, monkeypatch):
    """Its lines are those that its program draws, and the numbers on its page those that its identification gives."""
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(ROOT / "paper/site/joint/lab.py"))
    drawn, held = (pd.read_csv(folder / "levels.csv") for folder in (tmp_path, EXAMPLE))
    np.testing.assert_allclose(drawn, held, rtol=1.1e-5)  # the last of six digits
    found = identify(EXAMPLE / "levels.csv")
    page = (EXAMPLE / "README.md").read_text(encoding="utf-8")
    table = found.text().partition("\nat 95 %")[2].partition("\n\n")[0]
    assert table in page


def test_the_damping_at_an_amplitude_is_that_of_the_sliders(many):
    X, hertz = np.array([1e-5, 3e-5, 1e-4, 3e-4, 5e-4]), 50.0
    omega = 2.0 * math.pi * hertz
    W = MANY.loss(X) + math.pi * omega * OSCILLATOR["c"] * X**2
    damping = damping_at(many, X, hertz)
    assert damping.isna().any(axis=1).tolist() == [True, *[False] * 3, True]  # the levels end
    damping["true"] = W / (2.0 * math.pi * OSCILLATOR["m"] * (omega * X) ** 2)
    of = damping.dropna()
    reach = 0.5 * (of["high"] - of["low"])
    assert ((of["damping_ratio"] - of["true"]).abs() < 2.0 * reach).all()
