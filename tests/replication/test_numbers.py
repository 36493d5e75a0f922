"""The table of numbers: what it says of a number is enough to find it, and each route's is the one of its tables."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance.replication.numbers import COLUMNS, Key, by_key, features_of, number
from replication.routes import CASE, PAPER, PRINT, as_published, exact, numbers, unrounded


@pytest.fixture(scope="module")
def rows():
    return by_key(numbers())


def test_every_number_has_its_own_key_and_every_printed_one_its_row(rows):
    assert len(rows) == len(numbers())
    assert {row["id"] for row in rows.values()} - {""} == set(PRINT.ids.values())
    for row in PRINT.rows.values():
        assert any(math.isfinite(rows[row.key][route]) for route in COLUMNS), row.id
        assert rows[row.key]["printed"] == PRINT[PRINT.ids[row.key]].text


def test_a_number_is_that_of_its_route(rows):
    """Of features with and without read-outs, of estimates, and of what is printed."""
    X = {"frequency": "omega2", "quantity": "X", "kind": "level", "line": "3", "unit": "m"}
    assert number(rows, "exact", **X) == exact().features["omega2"]["X_m"][2]
    assert number(rows, "as_published", **X) == as_published().features["omega2"]["X_m"][2]
    assert number(rows, "unrounded", **X | {"frequency": "omega1"}) == unrounded()["X_m"][2]
    c = {"quantity": "c", "approach": "t_s", "kind": "pair", "sharing": "common", "unit": "N s/m"}
    frame = as_published().estimates["omega3"].set_index(["approach", "phase", "pair"])
    of_frame = frame["c_N_s_per_m"]["t_s", "common", "1-5"]
    assert number(rows, "as_published", frequency="omega3", line="1-5", **c) == of_frame
    mean = {"quantity": "c", "approach": "direct", "kind": "mean", "unit": "N s/m"}
    printed = [90.0134, 90.0114, 90.0113, 90.0115, 90.0119]
    of_print = number(rows, "from_print", frequency="omega1", **mean)
    assert of_print == pytest.approx(np.mean(printed), rel=1e-15)
    assert math.isnan(number(rows, "from_print", frequency="omega2", **mean))


def test_the_largest_error_is_that_of_the_pairs(rows):
    pairs = exact().estimates["omega3"].query("kind == 'pair' and phase == 'common'")
    errors = 100.0 * (pairs["F_k_N"] / PAPER.F_k - 1.0).abs()
    largest = Key("omega3", "F_k", "", "largest", "", "common", unit="%")
    expected = {("harmonic", "any"): errors.max()}
    for approach in ("X_s", "t_s", "V_s"):
        expected[approach, "F_k"] = errors[pairs["approach"] == approach].max()
    for (approach, quantity), error in expected.items():
        found = rows[largest._replace(approach=approach, quantity=quantity)]["exact"]
        assert found == pytest.approx(error, rel=1e-12)


def test_features_come_back_as_they_were(rows):
    features = features_of(rows, "exact", "omega1", CASE.omega("omega1"))
    frame = exact().features["omega1"]
    for column, values in features.to_columns().items():
        if column != "regime":
            np.testing.assert_allclose(values, frame[column], rtol=1e-15)
