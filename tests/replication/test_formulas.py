"""The pair-wise formulas (8), (15) to (19) of the paper agree with the one solver, for random responses."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dampbalance.balance import Rows, slip_displacement, slip_time, slip_velocity
from dampbalance.features import of_numbers, stack
from dampbalance.solver import pair
from replication.formulas import eq_8, eq_15, eq_16, eq_17, eq_18, eq_19

# Two responses of an oscillator somewhere near the paper's: the second 1.2 to 5 times the first, slip setting in at
# different phases ωt_s up to 0.5 after the reversal, different phases φ.
responses = st.fixed_dictionaries(
    {
        "k": st.floats(100.0, 1e5),
        "omega": st.floats(1.0, 300.0),
        "Y": st.floats(1e-4, 0.1),
        "ratio_Y": st.floats(1.2, 5.0),
        "gain": st.floats(0.2, 3.0),
        "ratio_X": st.floats(1.2, 5.0),
        "psi_1": st.floats(0.0, 0.5),
        "psi_2": st.floats(0.0, 0.5),
        "phi_1": st.floats(0.3, 2.8),
        "phi_2": st.floats(0.3, 2.8),
    }
)


def two(r):
    """The drawn responses as features, and as the plain numbers that the formulas take."""
    omega = r["omega"]
    Y = (r["Y"], r["Y"] * r["ratio_Y"])
    X = (r["Y"] * r["gain"], r["Y"] * r["gain"] * r["ratio_X"])
    psi, phi = (r["psi_1"], r["psi_2"]), (r["phi_1"], r["phi_2"])
    plain = {
        "Y": Y,
        "X": X,
        "X_s": tuple(-x * math.cos(p) for x, p in zip(X, psi, strict=True)),
        "V_s": tuple(omega * x * math.sin(p) for x, p in zip(X, psi, strict=True)),
        "t_s": tuple(p / omega for p in psi),
        "phi": phi,
    }
    features = stack(
        [
            of_numbers(omega, "drawn", **{name: values[i] for name, values in plain.items()})
            for i in (0, 1)
        ]
    )
    return features, plain


def assert_same(solved, formula, rows):
    """The solver and a formula give the same F_k and c (or F_k alone).

    Both solve one 2×2 system in different orders of operations, so they differ by a few roundings times its condition
    number, which reaches 60 with amplitudes a factor 1.2 apart: a few 1e-14, for which 1e-12 leaves room. They are
    measured against W over the column as well, for a F_k and b c may cancel in W and leave one unknown small.
    """
    for value, expected, column in zip(solved, formula, rows.terms.values(), strict=False):
        floor = 1e-12 * float(np.max(np.abs(rows.W / column)))
        assert value == pytest.approx(expected, rel=1e-12, abs=floor)


def solved(rows):
    estimate = pair(rows, 0, 1)
    return estimate["F_k"], estimate["c"]


@given(
    a=st.tuples(st.floats(1e-3, 1.0), st.floats(1.2, 5.0)),
    b=st.tuples(st.floats(1e-4, 1.0), st.floats(1.2, 5.0)),
    W=st.tuples(st.floats(0.01, 10.0), st.floats(0.01, 10.0)),
)
def test_eq_8(a, b, W):
    # b grows faster than a, as it does with level: by ratio_a · ratio_b against ratio_a.
    a_i, a_j = a[0], a[0] * a[1]
    b_i, b_j = b[0], b[0] * a[1] * b[1]
    rows = Rows({"F_k": np.array([a_i, a_j]), "c": np.array([b_i, b_j])}, np.array(W))
    assert_same(solved(rows), eq_8(a_i, a_j, b_i, b_j, *W), rows)


@pytest.mark.parametrize(
    ("formula", "row", "onset", "shared"),
    [
        (eq_15, slip_displacement, "X_s", ()),
        (eq_16, slip_displacement, "X_s", ("phi",)),
        (eq_17, slip_time, "t_s", ()),
        (eq_18, slip_time, "t_s", ("psi", "phi")),
        (eq_19, slip_velocity, "V_s", ("phi",)),
    ],
)
@given(r=responses)
def test_eq_15_to_19(formula, row, onset, shared, r):
    """shared : what both responses have in common, which the formula takes once."""
    features, p = two(r | {f"{name}_2": r[f"{name}_1"] for name in shared})
    rows = row(features, r["k"])
    onsets, phases = (
        p[name][: 1 if angle in shared else 2] for name, angle in ((onset, "psi"), ("phi", "phi"))
    )
    expected = formula(r["k"], r["omega"], *p["Y"], *p["X"], *onsets, *phases)
    assert_same(solved(rows), expected if formula is not eq_17 else (expected,), rows)
