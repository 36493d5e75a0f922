"""The interface of identification: signatures are the documentation, and each kind refuses the options of others."""

from __future__ import annotations

import inspect
import math
import re
from dataclasses import asdict, replace

import numpy as np
import pytest

from dampbalance import (
    Oscillator,
    identify,
    identify_decays,
    identify_forced,
    measured_ring_down,
    steady_orbits,
)
from dampbalance.measured import WAYS
from dampbalance.project.case import read_case_schema
from dampbalance.project.options import OPTIONS, configured, contradictions
from folders import ROOT
from identification.levels import measured
from paper_case import PAPER

K = 2310.0
SOFT = Oscillator(m=2.42, c=1.0, k=K, K_z=20800.0, F_k=0.5)
DECAY = measured_ring_down(SOFT, x=0.01, rate_hz=500.0, duration=2.0, noise=0.001)
_T = np.arange(0.0, 8.0, 0.01)
_X, _F = np.cos(2.0 * math.pi * _T), np.clip(9.0 * np.cos(2.0 * math.pi * _T - 0.3), -5.0, 5.0)
SPEEDS = {"speed_rpm": [1, -1, 2, -2, 4, -4, 8, -8], "torque_N_m": [3, -3, 4, -4, 5, -5, 9, -9]}
RECORDS = {
    "forced": measured(rate_hz=500.0),
    "ring-down": DECAY,
    "stepped-sine": str(ROOT / "config/records/stepped/levels.csv"),
    "loops": {"time_s": _T, "displacement_mm": _X, "force_N": _F},
    "friction-speed": SPEEDS,
}
VALUES = {
    "frequency": 3.5,
    "terms": "F_k,c",
    "given": {"c": 90.0},
    "groups": {"F_k": "A,A,B"},
    "contact_to": "base",
    "fixture_mass": 0.1,
    "laws": True,
    "skip_cycles": 1,
    "pendulum": True,
    "contact": "gradual",
    "hardening": False,
    "residual": True,
    "normal_force": 5.0,
    "fixture_stiffness": 1e6,
    "backlash": False,
}
"""A value of each option that is not its default."""
TAKEN = {
    "forced": "frequency groups contact_to fixture_mass skip_cycles laws terms given",
    "ring-down": "pendulum laws",
    "stepped-sine": "terms given contact hardening residual",
    "loops": "skip_cycles normal_force fixture_stiffness backlash",
    "friction-speed": "",
}
MISPLACED = "is for .*, and these are .*: leave it out"


@pytest.mark.parametrize("kind", WAYS)
def test_each_kind_takes_its_options_and_refuses_others(kind):
    needs = {"stiffness": K} if kind in ("forced", "ring-down") else {}
    function = inspect.signature(WAYS[kind]).parameters
    for name, value in VALUES.items():
        wrong = dict(contradictions({"kind": kind, OPTIONS[name].key: value}))
        takes = name in TAKEN[kind].split()
        assert (name in function, OPTIONS[name].key in wrong) == (takes, not takes)
        if not takes:
            assert re.fullmatch(MISPLACED, wrong[OPTIONS[name].key])
            for stated in ("recognised", kind):
                with pytest.raises(ValueError, match=f"^{name} = .* {MISPLACED}$"):
                    identify(RECORDS[kind], kind=stated, **needs | {name: value})
    assert ("stiffness_N_per_m" in dict(contradictions({"kind": kind}))) == bool(needs)
    for given in {"stiffness": K}, {"mass": 2.0}:
        if kind in ("loops", "friction-speed"):
            with pytest.raises(ValueError, match=MISPLACED):
                identify(RECORDS[kind], kind=kind, **given)


def test_an_unknown_option_is_that_of_a_call_and_one_at_its_default_is_none():
    with pytest.raises(TypeError, match="unexpected keyword argument 'frequncy'"):
        identify(DECAY, K, frequncy=3.5)
    named = {name: OPTIONS[name].default for name in (*VALUES, "mass")}
    found, own = identify(DECAY, K, **named), identify_decays(DECAY, K)
    assert found.document() == own.document()
    assert found.mass == pytest.approx(2.42, rel=1e-3)  # noise of 0.1 %
    assert found.damping_ratio == pytest.approx(1.0 / (2 * math.sqrt(K * 2.42)), rel=0.1)


def test_docstrings_and_configurations_have_every_argument():
    for function in (identify, *WAYS.values()):
        words = inspect.getdoc(function)
        for name in inspect.signature(function).parameters:
            assert re.search(rf"^(\w+, )*{name}(, \w+)* : ", words, re.MULTILINE), name
    keys = read_case_schema()["properties"]["measured"]["items"]["properties"].keys()
    arguments = configured(dict.fromkeys(keys, 1.0) | {"kind": "forced"}).keys()
    assert {"records", *arguments} == inspect.signature(identify).parameters.keys()


def test_what_no_fit_determines_is_nan():
    """Nothing slips: a linear oscillator, whose mass no fit of a slider determines."""
    still = measured((0.002, 0.004), 4.0, osc=replace(PAPER, F_k=0.0), rate_hz=500.0, noise=0.0)
    found = identify_forced(still, K)
    assert found.values["c"] == pytest.approx(90.0, rel=1e-6)
    assert all(map(math.isnan, (found.mass, found.natural_frequency, found.damping_ratio)))


def test_an_oscillator_stands_for_its_numbers_in_steady_orbits():
    given = {"Y": 0.004, "omega": 22.0}
    softer = steady_orbits(PAPER, K_z=[208000.0, 2080.0], **given)
    one, other = (
        steady_orbits(**asdict(replace(PAPER, K_z=K_z)), **given) for K_z in (208e3, 2080.0)
    )
    assert [*softer.X] == [one.X, other.X]
    with pytest.raises(ValueError, match="oscillator must be an Oscillator, got 5"):
        steady_orbits(5, **given)
    with pytest.raises(ValueError, match=r"m must be a positive number of kg, .*got None"):
        steady_orbits(**given)
