"""Rigs: a mount, whose contact and damper are held by the base; a damper to the base; a load cell with a fixture; a
stiffness that follows from the mass."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from dampbalance import Oscillator, identify, measured_ring_down
from dampbalance.findings.words import sentence
from dampbalance.identification.sensitivities import Fault
from dampbalance.records.coordinate import TRANSLATION
from identification.levels import THREE, changed, measured
from paper_case import PAPER

MOUNT = Oscillator(m=3.6, c=24.0, k=5200.0, K_z=160000.0, F_k=2.1)
HZ = 22.0 / (2.0 * math.pi)
OMEGA = 2.0 * math.pi * 5.0
ERRORS = 4.0  # standard errors: chance leaves one of three numbers outside in one seed of 5,000


def mount(kind, noise=0.01):
    """Tables of three levels: motion of the base and acceleration of the mass, or displacement against the base.

    m z̈ + c ż + k z + F = −m ÿ: z against the base is the motion of an oscillator on the ground whose force kY cos ωt
    is mω² times that of the base.
    """
    rng, part = np.random.default_rng(20261127), MOUNT.k / (MOUNT.m * OMEGA**2)
    options = {"osc": MOUNT, "rate_hz": 2000.0, "noise": 0.0, "channels": THREE}
    for record in measured(np.array([0.002, 0.0035, 0.0065]) / part, 5.0, **options):
        y, z, a = (record[q].values for q in THREE)
        table = {"base_displacement_m": part * y, "relative_displacement_m": 1.0 * z}
        if kind == "absolute":
            del table["relative_displacement_m"]
            table["acceleration_m_per_s2"] = a - OMEGA**2 * part * y
        for values in table.values():
            values += noise * np.std(values) * rng.standard_normal(values.size)
        yield {"time_s": record["displacement"].t, **table}


def forced(osc=PAPER, noise=0.005, **options):
    return measured(hz=HZ, osc=osc, noise=noise, **options)


def free():
    osc = replace(PAPER, c=9.0)
    return measured_ring_down(osc, x=0.012, rate_hz=2000.0, duration=3.0, noise=0.003)


def only(found, code):
    """The findings of this code."""
    return [one for one in found.findings if one.code == code]


@pytest.mark.parametrize("kind", ["absolute", "relative"])
def test_a_mount_is_identified_by_its_motion_against_the_base(kind):
    found = identify([*mount(kind)], "5200", mass="3.6±0.001", contact_to="base")
    for symbol in ("F_k", "c"):
        true, error = getattr(MOUNT, symbol), found.standard_errors[symbol]
        assert abs(found.values[symbol] - true) < ERRORS * error < 0.01 * true, symbol
        assert found.verdicts[symbol].verdict == "usable"
    # one noise leaves it open whether the contact yields gradually, which K_z feels alone
    assert abs(found.values["K_z"] - MOUNT.K_z) < ERRORS * found.standard_errors["K_z"]
    assert abs(found.mass - MOUNT.m) < ERRORS * found.mass_error + 0.001
    assert found.findings == []


def test_a_mount_that_is_taken_for_a_contact_to_the_ground_is_named():
    found = identify([*mount("absolute")][::2], 5200.0, mass="3.6±0.001")
    assert found.no_answer
    first = found.screen().replace("\n", " ")
    assert first.startswith("No answer: a mount, whose friction acts between base and mass")
    F_k, c = re.search(r"\(F_k = ([\d.]+) N, c = ([\d.]+) N s/m\)", first).groups()
    assert (float(F_k), float(c)) == pytest.approx((MOUNT.F_k, MOUNT.c), rel=0.01)
    # a contact to the ground is taken for none, also where the wrong mass fits neither
    assert only(identify(forced(), PAPER.k, mass=1.2 * PAPER.m), "mount") == []


def test_the_effect_of_a_wrong_mass_on_a_mount_is_that_of_giving_one():
    made = [*mount("absolute", noise=1e-4)][::2]
    given = {"stiffness": 5200.0, "contact_to": "base"}
    found, heavier = (identify(made, mass=(m, 1e-7), **given) for m in (3.6, 3.6036))
    said = found.shifts({"mass": Fault("", mass=1e-3)}, "direct")["mass"]
    before, after = (one.approaches["direct"].values for one in (found, heavier))
    for symbol in ("F_k", "c"):
        # to first order, and of what the waveform does
        assert after[symbol] / before[symbol] - 1.0 == pytest.approx(said[symbol], abs=2e-4), symbol


def test_a_damper_to_the_base_is_c_r():
    # damped against the base, kY + iωc_r Y drives: the oscillator with c of a base motion that leads
    drive, made = 1.0 + 1j * 22.0 * PAPER.c / PAPER.k, []
    for Y in (0.004, 0.008, 0.012):
        (record,) = measured((Y * abs(drive),), HZ, noise=0.003, seed=len(made))
        y = Y * np.cos(22.0 * record["displacement"].t - np.angle(drive))
        made.append(changed(record, "base_displacement", values=y))
    found = identify(made, PAPER.k, terms="F_k,c_r")
    assert [*found.values] == ["F_k", "c_r", "K_z"]
    assert abs(found.values["c_r"] - PAPER.c) < ERRORS * found.standard_errors["c_r"]
    assert found.verdicts["c_r"].verdict == "usable"


@pytest.mark.parametrize("given", [{}, {"mass": "2.42±0.002"}], ids=["no mass", "mass"])
def test_a_fixture_above_a_load_cell_moves_along(given):
    heavy = replace(PAPER, m=PAPER.m + 0.35)
    made = forced(heavy, channels=("force", "displacement"))
    found = identify(made, PAPER.k, fixture_mass="350 g", **given)
    assert abs(found.mass - PAPER.m) < ERRORS * max(found.mass_error, 0.002)
    hertz = math.sqrt(PAPER.k / PAPER.m) / (2.0 * math.pi)
    assert found.natural_frequency == pytest.approx(hertz, rel=1e-3)
    assert found.findings == []
    if given:
        (said,) = only(identify(made, PAPER.k, **given), "mass")
        assert (said.numbers["masses"][1], said.numbers["fixture"]) == (2.42, True)


@pytest.mark.parametrize(("made", "c"), [(forced, 90.0), (free, 9.0)])
def test_the_mass_alone_gives_the_stiffness(made, c):
    found = identify(made(), mass="2.42±0.005")
    k_error = found.options["stiffness_standard_error_N_per_m"]
    # of the mass, as the records know the frequency better
    assert 0.99 < k_error / found.k / (0.005 / 2.42) < 1.2
    assert abs(found.k - PAPER.k) < ERRORS * k_error
    assert found.mass == pytest.approx(PAPER.m, rel=1e-6)
    for symbol, true in (("F_k", PAPER.F_k), ("c", c)):
        assert abs(found.values[symbol] - true) < ERRORS * found.standard_errors[symbol]
        assert found.standard_errors[symbol] > 0.9 * k_error / found.k * true
    same = identify(made(), (found.k, k_error))
    for symbol, value in found.values.items():
        assert value == pytest.approx(same.values[symbol], rel=1e-6)
    assert (found.hint.code, found.hint.numbers["k"]) == ("k by the mass", (found.k, k_error))


@pytest.mark.parametrize(("drive", "share"), [("base_displacement", 0.1), ("force", 0.3)])
def test_a_stiffness_that_is_stated_too_high_is_named_where_nothing_slips(drive, share):
    made = forced(replace(PAPER, F_k=0.0), channels=(drive, "displacement"))

    def said(factor, **options):
        found = identify(made, factor * PAPER.k, **options)
        return found, only(found, "too stiff")

    found, (warning,) = said(1.0 + share, mass=PAPER.m)
    assert warning.numbers["too_high"] == pytest.approx(share, abs=5e-3)
    assert found.verdicts["c"].verdict == "doubtful"
    assert found.verdicts["c"].within > 0.99 * share
    # a contact that only sticks adds to it, and one frequency without the mass tells nothing
    for factor, options in ((1.0, {"mass": PAPER.m}), (0.9, {"mass": PAPER.m}), (1.3, {})):
        assert said(factor, **options)[1] == []
    assert said(1.0 + share, mass=(PAPER.m, share * PAPER.m))[1] == []


@pytest.mark.parametrize(
    ("drive", "given", "words"),
    [
        ("base_displacement", {}, "stiffness .* is missing.*known weights.*the mass alone"),
        ("base_displacement", {"contact_to": "base", "mass": 3.6}, "needs stiffness and mass"),
        ("base_displacement", {"contact_to": "base", "stiffness": 5.0}, "needs stiffness and mass"),
        ("base_displacement", {"contact_to": "wall", "stiffness": 1.0}, "contact_to.*ground.*base"),
        ("base_displacement", {"stiffness": 5.0, "fixture_mass": 0.1}, "fixture_mass .* no force"),
        ("base_displacement", {"stiffness": 5.0, "fixture_mass": -0.1}, "fixture_mass must be"),
        ("force", {"mass": 2.42}, "a force drives; stiffness is missing.*known weights"),
        ("force", {"stiffness": 1.0, "mass": 1.0, "contact_to": "base"}, "contact_to = base is"),
    ],
)
def test_what_a_rig_lacks_or_does_not_allow_is_named(drive, given, words):
    with pytest.raises(ValueError, match=words):
        identify(forced(channels=(drive, "displacement")), kind="forced", **given)


@pytest.mark.parametrize(
    ("k", "m", "meant"),
    [
        (PAPER.k / 1000.0, PAPER.m, "k = 2.31 N/mm or m = 2.42 g?"),
        (PAPER.k / 9.80665, PAPER.m, "k = 236 kgf/m or m = 2.42 N?"),
        (PAPER.k, PAPER.m / 0.45359237, "m = 5.34 lb?"),
        (PAPER.k, 0.9 * PAPER.m, ""),
    ],
)
def test_a_unit_that_was_meant_is_asked_for(k, m, meant):
    (warning,) = only(identify(forced(), k, mass=(m, 0.001 * m)), "mass")
    said = sentence(warning, TRANSLATION)
    asked = f"did you mean {meant} Otherwise check" if meant else "check mass, stiffness"
    assert asked in said
    assert ("did you mean" in said) == bool(meant)
