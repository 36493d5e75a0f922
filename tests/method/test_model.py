"""Oscillator and base motion: what they derive, and what they refuse."""

from __future__ import annotations

import dataclasses
import math
from fractions import Fraction

import numpy as np
import pytest

import paper_case
from dampbalance import BaseMotion, Oscillator

PAPER = dataclasses.asdict(paper_case.PAPER)
MOTION = {"Y": 0.004, "omega": 30.9}

FIELDS = [(Oscillator, PAPER, name) for name in PAPER]
FIELDS += [(BaseMotion, MOTION, name) for name in MOTION]
MAY_BE_ZERO = ("c", "F_k")


def ids(value):
    return value if isinstance(value, str) else None


def test_derived_quantities_of_the_paper():
    # ω_n/2π = 4.9172 Hz, Z_m = 6.154 µm: half a unit of the last digit
    oscillator = Oscillator(**PAPER)
    assert oscillator.omega_n / (2.0 * math.pi) == pytest.approx(4.9172, rel=0, abs=5e-5)
    assert oscillator.Z_m == pytest.approx(6.154e-6, rel=0, abs=5e-10)
    assert oscillator.zeta == pytest.approx(90.0 / (2.0 * math.sqrt(2310.0 * 2.42)), rel=1e-15)


def test_base_motion():
    motion = BaseMotion(Y=0.5, omega=4.0)
    assert motion.period == pytest.approx(math.pi / 2.0, rel=1e-15)
    assert motion.y(0.0) == 0.5
    t = np.array([[0.0, 0.25 * motion.period], [0.5 * motion.period, motion.period]])
    np.testing.assert_allclose(motion.y(t), [[0.5, 0.0], [-0.5, 0.5]], rtol=0, atol=1e-15)


@pytest.mark.parametrize("number", [2, np.float32(2.0), np.uint8(2)], ids=repr)
def test_any_real_number_becomes_a_float(number):
    oscillator = Oscillator(**PAPER | {"m": number})
    assert type(oscillator.m) is float
    assert oscillator.m == 2.0


def test_a_changed_copy_is_checked_and_nothing_else_is_changed():
    assert (
        Oscillator(**PAPER) == Oscillator(**PAPER | {"c": 90}) != Oscillator(**PAPER | {"c": 90.1})
    )
    assert hash(Oscillator(**PAPER)) == hash(Oscillator(**PAPER | {"c": 90}))
    with pytest.raises(dataclasses.FrozenInstanceError):
        Oscillator(**PAPER).m = 3.0
    with pytest.raises(ValueError, match=r"Oscillator\.m must be a positive number of kg"):
        dataclasses.replace(Oscillator(**PAPER), m=-1.0)
    with pytest.raises(ValueError, match="use a large finite K_z for a rigid contact"):
        Oscillator(**PAPER | {"K_z": math.inf})


@pytest.mark.parametrize(("kind", "values", "name"), FIELDS, ids=ids)
@pytest.mark.parametrize(
    "bad", [0.0, -0.0, -5e-324, math.nan, math.inf, "1e-6", True, [1.0], Fraction(1, 2)], ids=repr
)
def test_other_values_are_refused_by_name(kind, values, name, bad):
    wanted = "a positive number of .*"
    if name in MAY_BE_ZERO:
        wanted = r"a number of .*, 0 to 1e\+30"
        if bad == 0.0:
            assert getattr(kind(**values | {name: bad}), name) == 0.0
            return
    got = bad if isinstance(bad, float) else ""
    with pytest.raises(ValueError, match=rf"^{kind.__name__}\.{name} must be {wanted}, got {got}"):
        kind(**values | {name: bad})
