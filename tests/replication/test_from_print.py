"""The paper's printed inputs in its own equations give its printed results, to the last digit."""

from __future__ import annotations

from decimal import Decimal

import pytest

from dampbalance.balance import APPROACHES, slip_velocity_as_printed
from dampbalance.replication.claims.printed import (
    Printed,
    from_print,
    printed_features,
)
from dampbalance.replication.numbers import Key
from dampbalance.solver import least_squares
from replication.routes import CASE, PRINT, with_digits_of


def test_largest_errors_of_table_3():
    of_print = from_print(PRINT, CASE)
    largest = Key("omega1", "", "harmonic", "largest", "", "common", unit="%")
    F_k, c = (of_print[largest._replace(quantity=symbol)] for symbol in ("F_k", "c"))
    assert F_k == pytest.approx(100.0 * (1.299 / 1.28 - 1.0), rel=1e-12)  # X_s, pair 2-3
    assert c == pytest.approx(100.0 * (90.071 / 90.0 - 1.0), rel=1e-12)  # V_s, pair 1-2


def test_the_sign_slip_is_not_in_the_least_squares():
    """The text's V_s least squares use the minus of (19): with the plus of Table 3 they come out elsewhere."""
    features = printed_features(PRINT, CASE.omega("omega1"))
    text = PRINT["text.F_k_Vs_ls"].text
    minus = least_squares(APPROACHES["V_s"](features, 2310.0))["F_k"]
    plus = least_squares(slip_velocity_as_printed(features, 2310.0))["F_k"]
    assert with_digits_of(text, minus) == Decimal(text)
    assert abs(plus - Printed(text).value) > 5e-3
