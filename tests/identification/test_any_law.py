"""Laws with any terms, groups of records and given coefficients, and which law the records support."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import pytest

from analytic.law_response import law_orbit
from dampbalance import BaseMotion, Oscillator, measured_orbit, steady_orbit
from dampbalance.identification.answer import USABLE
from dampbalance.identification.law_comparison import compare_laws
from dampbalance.law.law import Law
from dampbalance.signals.mean_harmonics import read_features
from fit.exact import off
from identification.levels import close, identified, read
from paper_case import PAPER

AT = [(hz, Y) for hz in (3.5, 7.0) for Y in (0.003, 0.006, 0.012)]
FEW = [(hz, Y) for hz, Y in AT if Y != 0.006]  # a search among laws takes as long as it has records
BARE = replace(PAPER, c=0.0)
LAWS = {
    "c_r": (BARE, {"c_r": 30.0}),
    "c_3": (BARE, {"c_3": 3000.0}),
    "eta": (BARE, {"eta": 0.3}),
    "c and c_2": (replace(PAPER, c=15.0), {"c_2": 150.0}),
}


@cache
def orbit_of(osc, law, hz, Y):
    """The response that the integrator finds."""
    return law_orbit(osc, BaseMotion(Y, 2.0 * math.pi * hz), dict(law))


def readings(osc, law, at=AT, noise=0.01, seed=1, cycles=50.0, rate_hz=500.0):
    """Records of responses under the law."""
    oscillators = osc if isinstance(osc, list) else [osc] * len(at)
    orbits = [orbit_of(one, (*law.items(),), *of) for one, of in zip(oscillators, at, strict=True)]
    return read(orbits, noise=noise, seed=seed, cycles=cycles, rate_hz=rate_hz)


def truth(osc, law):
    return {"F_k": osc.F_k, "c": osc.c, **law}


@pytest.mark.parametrize("name", LAWS)
def test_the_coefficients_of_any_law_are_found(name):
    osc, law = LAWS[name]
    true = {symbol: value for symbol, value in truth(osc, law).items() if value}
    found = identified(readings(osc, law), law=Law(tuple(true)))
    assert found.basis.common.waveforms_hold
    assert found.findings == []
    direct = found.estimates["direct"]
    assert set(direct.coefficients) == set(true)
    # one drawing: 4 standard errors are exceeded by chance in 6 of 100,000
    assert off(found.basis.common.fit, **true) < 4.0
    for symbol, value in true.items():
        error = direct.standard_errors[symbol]
        assert abs(direct.values[symbol] - value) < 4.0 * error < 0.04 * value
    assert found.answer.K_z.interval.low < osc.K_z < found.answer.K_z.interval.high
    assert direct.misfit < 5.0  # χ² per degree of freedom, of 3 or 4


def test_cycles_that_repeat_to_the_last_bit_support_the_law_that_they_have():
    """Whole numbers of samples in a cycle without noise: the scatter is zero, the harmonics hold the work to 1e-9."""
    osc = Oscillator(m=1.0, c=5.0, k=1000.0, K_z=50000.0, F_k=1.0)
    orbits = [steady_orbit(osc, BaseMotion(Y, 8.0 * math.pi)) for Y in (0.002, 0.004, 0.008)]
    records = [measured_orbit(orbit, rate_hz=1000.0, cycles=20.0) for orbit in orbits]
    laws = compare_laws([read_features(record, osc.k) for record in records], osc.k)
    assert laws.chosen == ("F_k", "c")
    # at one frequency structural damping is not tried: it acts like c
    assert not any("eta" in one.terms for one in laws.laws)
    assert "eta like c" in {one.code for one in laws.findings}


def test_each_load_has_its_friction_and_all_have_one_damper():
    """Two levels of a light and two of a heavy load on one contact."""
    heavy = replace(PAPER, F_k=2.0)
    two_loads = readings([PAPER, heavy] * 2, {}, at=sorted(FEW[:2] * 2))
    law = Law(groups={"F_k": ("light", "heavy") * 2})
    found = identified(two_loads, law=law)
    direct = found.estimates["direct"]
    assert found.basis.common.waveforms_hold
    for key, value in (("F_k[light]", 1.28), ("F_k[heavy]", 2.0), ("c", 90.0)):
        error = direct.standard_errors[key]
        assert abs(direct.values[key] - value) < 4.0 * error < 0.04 * value
    document = found.document()
    rows = document["approaches"]["direct"]["rows"]
    assert rows["a_light_m"][1] == 0.0 < rows["a_heavy_m"][1]
    assert document["law"]["groups"]["F_k"][:2] == ["light", "heavy"]
    # and no law without groups fits them
    assert compare_laws(two_loads, PAPER.k, law=law).chosen == ("F_k", "c")
    without = compare_laws(two_loads, PAPER.k)
    assert without.chosen is None
    assert without.findings[-1].code == "no law"


def test_what_is_given_sharpens_the_rest_and_one_record_is_enough():
    records = readings(PAPER, {}, at=AT[:2])
    both = identified(records).estimates["direct"]
    for used in (records, records[:1]):
        known = identified(used, law=Law(given={"c": 90.0})).estimates["direct"]
        assert list(known.coefficients) == ["F_k"]
        assert close(known, PAPER, ["F_k"])
        assert known.standard_errors["F_k"] < both.standard_errors["F_k"]


def test_a_group_whose_records_only_stick_has_no_usable_friction_force_and_the_others_have():
    stuck = replace(PAPER, F_k=60.0)
    records = readings([PAPER, PAPER, stuck], {}, at=[AT[0], AT[2], AT[1]])
    law = Law(groups={"F_k": ("loose", "loose", "stuck")})
    direct = identified(records, law=law).estimates["direct"]
    assert direct.verdicts["F_k[stuck]"].verdict != USABLE
    assert direct.verdicts["F_k[loose]"].verdict == USABLE
    assert direct.values["F_k[loose]"] == pytest.approx(1.28, rel=0.02)


def test_dampers_to_base_and_ground_together_say_what_a_skew_would_do():
    found = identified(readings(*LAWS["c_r"]), law=Law(("F_k", "c", "c_r")))
    assert found.basis.common.selection.weight("delay") == 0.0
    assert "skewed" in {one.code for one in found.findings}


# without friction: a contact that sticks all the time and is too soft to be seen
LINEAR = replace(PAPER, K_z=1e-6 * PAPER.k, F_k=10.0)


@pytest.mark.parametrize(
    ("osc", "law", "chosen"),
    [
        (*LAWS["eta"], ("F_k", "eta")),
        (*LAWS["c and c_2"], ("F_k", "c", "c_2")),
        (LINEAR, {}, ("c",)),
    ],
    ids=["structural", "two dampers", "no friction"],
)
def test_the_heaviest_law_is_the_true_one(osc, law, chosen):
    compared = compare_laws(readings(osc, law, at=FEW), osc.k)
    assert compared.chosen == chosen
    weights = {one.terms: one.weight for one in compared.laws}
    assert math.fsum(weights.values()) == pytest.approx(1.0)
    assert weights["F_k",] < 1e-6
    for symbol, (value, error) in compared.laws[0].coefficients.items():
        assert abs(value - truth(osc, law)[symbol]) < 4.0 * error


def test_dampers_that_noise_does_not_tell_apart_share_the_weight():
    """Three levels of a soft contact at one frequency and 30 % of noise: nothing says which damper acts along with
    friction, while two dampers have no stiffness that falls with the amplitude."""
    soft = replace(PAPER, K_z=4000.0, F_k=5.0, c=5.0)
    levels = [(3.5, Y) for Y in (0.006, 0.008, 0.01)]
    compared = compare_laws(readings(soft, {}, at=levels, noise=0.3), soft.k)
    alike = {compared.chosen, *compared.alike}
    assert ("F_k", "c") in alike
    assert len(alike) > 1
    assert all("F_k" in law for law in alike)
