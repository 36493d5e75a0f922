"""The pair-wise formulas (8), (15) to (19) of the paper, as printed, agree with the one solver, for random responses.

The formulas test the solver, which knows none of them. Their arguments are scalars of two responses, SI units; each
returns (F_k, c).
"""

from __future__ import annotations

from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dampbalance.balance import Rows, slip_displacement, slip_time, slip_velocity
from dampbalance.features import of_numbers
from dampbalance.solver import pair


def eq_8(a_i, a_j, b_i, b_j, W_i, W_j):
    """Direct integration."""
    delta = a_i * b_j - a_j * b_i
    return (b_j * W_i - b_i * W_j) / delta, (a_i * W_j - a_j * W_i) / delta


def eq_15(k, omega, Y_1, Y_2, X_1, X_2, X_1s, X_2s, phi_1, phi_2):
    """X_s, individual phases."""
    q_1, q_2 = X_1 - X_1s, X_2 - X_2s
    below = q_1 * X_2**2 - q_2 * X_1**2
    F_k = pi * k * (Y_1 * X_1 * X_2**2 * sin(phi_1) - Y_2 * X_1**2 * X_2 * sin(phi_2)) / (2 * below)
    c = k * (q_1 * Y_2 * X_2 * sin(phi_2) - q_2 * Y_1 * X_1 * sin(phi_1)) / (omega * below)
    return F_k, c


def eq_16(k, omega, Y_1, Y_2, X_1, X_2, X_1s, X_2s, phi):
    """X_s, one phase for both."""
    q_1, q_2 = X_1 - X_1s, X_2 - X_2s
    below = q_1 * X_2**2 - q_2 * X_1**2
    F_k = pi * k * X_1 * X_2 * sin(phi) * (Y_1 * X_2 - Y_2 * X_1) / (2 * below)
    c = k * sin(phi) * (q_1 * Y_2 * X_2 - q_2 * Y_1 * X_1) / (omega * below)
    return F_k, c


def eq_17(k, omega, Y_1, Y_2, X_1, X_2, t_s1, t_s2, phi_1, phi_2):
    """t_s, individual phases and times; the paper gives F_k only."""
    below = X_2 * (1 + cos(omega * t_s1)) - X_1 * (1 + cos(omega * t_s2))
    return (pi * k * (Y_1 * X_2 * sin(phi_1) - Y_2 * X_1 * sin(phi_2)) / (2 * below),)


def eq_18(k, omega, Y_1, Y_2, X_1, X_2, t_s, phi):
    """t_s, one phase and one time for both."""
    F_k = pi * k * sin(phi) * (Y_1 * X_2 - Y_2 * X_1) / (2 * (1 + cos(omega * t_s)) * (X_2 - X_1))
    return F_k, k * sin(phi) * (Y_1 - Y_2) / (omega * (X_1 - X_2))


def eq_19(k, omega, Y_1, Y_2, X_1, X_2, V_s1, V_s2, phi):
    """V_s, one phase for both."""
    alpha_1 = omega * X_1 + sqrt((omega * X_1) ** 2 - V_s1**2)
    alpha_2 = omega * X_2 + sqrt((omega * X_2) ** 2 - V_s2**2)
    below = alpha_1 * X_2**2 - alpha_2 * X_1**2
    F_k = pi * k * omega * X_1 * X_2 * sin(phi) * (Y_1 * X_2 - Y_2 * X_1) / (2 * below)
    c = k * sin(phi) * (alpha_1 * Y_2 * X_2 - alpha_2 * Y_1 * X_1) / (omega * below)
    return F_k, c


def assert_same(formula, rows):
    """The solver and a formula give the same F_k and c (or F_k alone).

    Both solve one 2×2 system in different orders of operations, so they differ by a few roundings times its condition
    number, which reaches 60 with amplitudes a factor 1.2 apart: a few 1e-14, for which 1e-12 leaves room. They are
    measured against W over the column as well, for a F_k and b c may cancel in W and leave one unknown small.
    """
    estimate = pair(rows, 0, 1)
    for symbol, expected in zip(("F_k", "c"), formula, strict=False):
        floor = 1e-12 * float(np.max(np.abs(rows.W / rows.terms[symbol])))
        assert estimate[symbol] == pytest.approx(expected, rel=1e-12, abs=floor)


RATIO = st.floats(1.2, 5.0)


@given(
    a=st.tuples(st.floats(1e-3, 1.0), RATIO),
    b=st.tuples(st.floats(1e-4, 1.0), RATIO),
    W=st.tuples(st.floats(0.01, 10.0), st.floats(0.01, 10.0)),
)
def test_eq_8(a, b, W):
    # b grows faster than a, as it does with level: by ratio_a · ratio_b against ratio_a.
    a, b = a[0] * np.array([1.0, a[1]]), b[0] * np.array([1.0, a[1] * b[1]])
    assert_same(eq_8(*a, *b, *W), Rows({"F_k": a, "c": b}, np.array(W)))


# Two responses of an oscillator somewhere near the paper's: the second 1.2 to 5 times the first, slip setting in at
# different phases ψ = ωt_s up to 0.5 after the reversal, different phases φ.
BASE = {"k": (100.0, 1e5), "omega": (1.0, 300.0), "Y": (1e-4, 0.1), "gain": (0.2, 3.0)}
responses = st.fixed_dictionaries(
    {name: st.floats(*ends) for name, ends in BASE.items()}
    | {"Y_ratio": RATIO, "X_ratio": RATIO}
    | {"psi": st.tuples(*[st.floats(0.0, 0.5)] * 2), "phi": st.tuples(*[st.floats(0.3, 2.8)] * 2)}
)


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
    r |= {name: r[name][:1] * 2 for name in shared}
    omega, psi, phi = r["omega"], np.array(r["psi"]), np.array(r["phi"])
    Y = r["Y"] * np.array([1.0, r["Y_ratio"]])
    X = r["Y"] * r["gain"] * np.array([1.0, r["X_ratio"]])
    onsets = {"X_s": -X * np.cos(psi), "V_s": omega * X * np.sin(psi), "t_s": psi / omega}
    rows = row(of_numbers(omega, "drawn", Y=Y, X=X, phi=phi, **onsets), r["k"])
    taken = onsets[onset][: 1 if "psi" in shared else 2], phi[: 1 if "phi" in shared else 2]
    assert_same(formula(r["k"], omega, *Y, *X, *taken[0], *taken[1]), rows)
