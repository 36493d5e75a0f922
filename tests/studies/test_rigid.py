"""A model of a rigid contact is the limit X_s → −X of every approach: what it costs follows in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from dampbalance.balance import APPROACHES
from paper_case import FREQUENCIES_HZ, LEVELS, PAPER, features_at, orbits_at


@pytest.fixture(scope="module")
def table(computed):
    """The table of cases, by drive frequency in Hz."""
    return computed("rigid")[1].set_index("frequency_hz")


def exact_rows(hertz):
    """a, b of the levels, from the orbits one by one."""
    orbits = orbits_at(hertz, LEVELS)
    return tuple(np.array([getattr(orbit, q) for orbit in orbits]) for q in ("a", "b"))


def test_every_approach_has_the_same_limit():
    features = features_at(levels=LEVELS)
    rigid = features.rigid()
    for name in ("direct", "X_s", "t_s", "V_s", "fourier"):
        compliant, limit = (APPROACHES[name](seen, PAPER.k) for seen in (features, rigid))
        np.testing.assert_allclose(limit.terms["F_k"], 4.0 * features.X, rtol=1e-15)
        # what does not depend on the onset of slip stays as it is
        assert np.array_equal(limit.terms["c"], compliant.terms["c"])
        assert np.array_equal(limit.W, compliant.W)
    # the spring swings from −Z_m to Z_m at either end of the stroke
    np.testing.assert_allclose(rigid.a - features.a, 4.0 * PAPER.Z_m, rtol=1e-9)
    # below the slip limit the true a is 0, and yet the rigid model takes a = 4X as for any other response
    stuck = features_at(levels=(1e-5,))
    assert stuck.a.tolist() == [0.0]
    assert stuck.rigid().a == pytest.approx(4.0 * stuck.X)


@pytest.mark.parametrize("hertz", FREQUENCIES_HZ.values())
@pytest.mark.parametrize("pair", [(1, 2), (2, 5)])
def test_two_levels_in_closed_form(table, hertz, pair):
    (a_1, a_2), (b_1, b_2) = (of[[pair[0] - 1, pair[1] - 1]] for of in exact_rows(hertz))
    delta = a_1 * b_2 - a_2 * b_1
    primed = delta + 4.0 * PAPER.Z_m * (b_2 - b_1)
    c_shift = 4.0 * PAPER.Z_m * PAPER.F_k * (a_2 - a_1) / primed
    expected = {"F_k": delta / primed - 1.0, "c": c_shift / PAPER.c}
    assert expected["F_k"] < 0.0 < expected["c"]
    for symbol, error in expected.items():
        found = table[f"{symbol}_relative_error__direct__rigid__pair_{pair[0]}_{pair[1]}"][hertz]
        # rounding, 1e-15 of the rows, grows by the condition of the pair, some 1e3
        assert found == pytest.approx(error, abs=1e-10)


@pytest.mark.parametrize("hertz", FREQUENCIES_HZ.values())
def test_least_squares_in_closed_form(table, hertz):
    """W = A′p − 4Z_m F_k with A′ of the rigid model: p′ = p − 4Z_m F_k (A′ᵀA′)⁻¹A′ᵀ1."""
    a, b = exact_rows(hertz)
    # columns of one size: the solution by normal equations then keeps nine digits
    rows = np.column_stack([(a + 4.0 * PAPER.Z_m) / a[0], b / b[0]])
    shift = np.linalg.solve(rows.T @ rows, rows.T @ np.full(5, -4.0 * PAPER.Z_m * PAPER.F_k))
    shift /= np.array([a[0] * PAPER.F_k, b[0] * PAPER.c])
    for symbol, expected in zip(("F_k", "c"), shift, strict=True):
        found = table[f"{symbol}_relative_error__direct__rigid__least_squares"][hertz]
        assert found == pytest.approx(expected, abs=1e-9)
        # with a rigid contact t_s, V_s and X_s see the same onset
        of_onset = f"{symbol}_relative_error__{{}}__{{}}reversal__individual__least_squares".format
        X_s, t_s, V_s = (table[of_onset(name, "rigid__")][hertz] for name in ("X_s", "t_s", "V_s"))
        assert (t_s, V_s) == pytest.approx((X_s, X_s), rel=1e-9)
        assert abs(table[of_onset("X_s", "")][hertz] - X_s) > 1e-6
