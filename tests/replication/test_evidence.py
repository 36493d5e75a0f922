"""Test what agreement proves: counts by hand from the verdicts, the recipe's choices, inputs moved by other code."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from dampbalance.features import Features
from dampbalance.replication.claims import evidence, unprinted
from dampbalance.replication.claims.printed import Printed
from dampbalance.replication.numbers import by_key
from paper_case import LEVELS, PAIRS, PAPER, features_at
from replication.routes import CASE, CONFIG, PRINT, exact, numbers, unrounded

AT_OMEGA3 = Features.from_frame(exact().features["omega3"])


def test_routes_are_counted_apart_from_verdicts(claims):
    """45 by the simulation and 15 by arithmetic on printed tables; exact agreement moves four of the 45."""
    counted = evidence.by_route(claims)
    assert counted == {
        "exact": 12,  # ζ, f_n, ten of X and X_s
        "simulation": 45,  # t_s and its mean, the mean φ, eight of Table 2, Table 3
        "simulation_reproduced": 4,
        "print": 15,  # eleven of the least squares, two means, two deviations
        "print_elsewhere": 1,  # c of the pair 4-5
        "table_3_from_table_1": 6,
    }
    verdicts = claims["verdict"][claims["kind"] == "computed"].value_counts()
    assert verdicts["reproduced"] == counted["exact"] + evidence.chance(claims)["observed"] == 19
    assert verdicts["simulated"] == counted["simulation"] - counted["simulation_reproduced"]
    assert verdicts["from print"] == counted["print"] + counted["print_elsewhere"]


def test_the_six_numbers_from_table_1_are_the_c_of_three_pairs(claims):
    rows = claims[
        claims["id"].str.startswith("table3") & claims["agrees"].str.contains("from print")
    ]
    assert rows["id"].tolist() == [
        f"table3.{approach}.c.{pair}"
        for approach in ("t_s", "X_s")
        for pair in ("2-3", "3-4", "4-5")
    ]


def test_chance_is_one_in_ten_of_what_is_close(claims):
    close = observed = 0
    for row in claims[claims["kind"] == "computed"].to_dict("records"):
        in_V_s = row["id"].startswith("table1.V_s")  # judged by exact numbers, of which two miss
        if (row["judged"] == "exact" and not in_V_s) or row["exact"] == "":
            continue
        off = abs(float(row["exact"]) - float(row["printed"])) / Printed(row["printed"]).unit
        close, observed = close + (off < 5.0), observed + (off <= 0.5)
    assert observed == 7  # V_s 1, 4, 5, t_s 3, 5, F_k by t_s 4-5, mean φ
    assert evidence.chance(claims) == {
        "close": close,
        "expected": pytest.approx(0.1 * close),
        "observed": observed,
    }


def test_chance_follows_the_columns(claims):
    """A wrong exact number no longer counts; a column that exact numbers miss once counts whole."""
    was = evidence.chance(claims)
    wrong = claims["exact"].mask(claims["id"] == "text.phi_mean", "1.55")
    now = evidence.chance(claims.assign(exact=wrong))
    assert (now["observed"], now["close"]) == (was["observed"] - 1, was["close"] - 1)
    missed = claims["agrees"].mask(claims["id"] == "table1.X.2", "as published")
    now = evidence.chance(claims.assign(agrees=missed))
    assert (now["observed"], now["close"]) == (was["observed"] + 5, was["close"] + 5)


def test_choices_are_the_rules_of_the_configuration():
    """Scheme, cycle, two roundings, five samples, six rules of reading, the phase, the sign; and the step."""
    choices = evidence.free_choices(CASE)
    rules = CONFIG["as_published"]
    assert choices["continuous"] == {"step_s": rules["step_s"]}
    named = ["scheme", "cycles", "c_over_m_decimals", "k_over_m_decimals"]
    assert [choices["discrete"][name] for name in named] == [rules[name] for name in named]
    assert rules["two_point"].items() <= choices["discrete"].items()
    assert len(choices["discrete"]) == 4 + 5 + len(rules["two_point"]) + 2 == 17
    fewer = replace(
        CASE, numerics=replace(CASE.numerics, k_over_m_decimals=None, slip_samples=(1, 1, 1))
    )
    assert len(evidence.free_choices(fewer)["discrete"]) == 17 - 1 - 2


# ---- The inputs behind Table 3, moved by formulas of their own ------------------------------------------------------


def table_3(X, swing, t_s, phi, V_s, sign=+1.0):
    """Every number of Table 3 from its inputs, by id: Eqs. (16), (18) and (19) solved anew."""
    omega = 2.0 * math.pi * 4.92
    b, W = math.pi * omega * X**2, math.pi * PAPER.k * np.array(LEVELS) * X * math.sin(phi)
    travels = {
        "t_s": 2.0 * X * (1.0 + math.cos(omega * t_s)),
        "X_s": 2.0 * (2.0 * X - swing),
        "V_s": 2.0 * X * (1.0 + np.sqrt(1.0 + sign * (V_s / (omega * X)) ** 2)),
    }
    numbers = {}
    for name, a in travels.items():
        for i, j in PAIRS:
            determinant = a[i] * b[j] - a[j] * b[i]
            at = f"table3.{name}.{{}}.{i + 1}-{j + 1}"
            numbers[at.format("F_k")] = (W[i] * b[j] - W[j] * b[i]) / determinant
            numbers[at.format("c")] = (a[i] * W[j] - a[j] * W[i]) / determinant
    return numbers


def missed(**inputs):
    numbers = table_3(**inputs)
    assert len(numbers) == 30
    return sum(f"{v:.{PRINT[i].decimals}f}" != PRINT[i].text for i, v in numbers.items())


def test_the_digits_hang_on_nine_inputs():
    X = np.array([2.728, 4.387, 6.047, 7.707, 9.367]) * 1e-3
    V_s = unrounded()["V_s_m_per_s"].to_numpy()
    inputs = {"X": X, "swing": 13e-6, "t_s": 2.1e-3, "phi": 1.542, "V_s": V_s}
    found = evidence.inputs_of_table_3(CASE, by_key(numbers()))
    assert missed(**inputs) == 0
    assert found["given"] == 30
    assert found["inputs"] == len(found["moved"]) == 9
    signs = (-1.0, 1.0)
    for level in range(5):
        moved = [X + sign * 1e-6 * (np.arange(5) == level) for sign in signs]
        assert found["moved"][f"X_{level + 1}"] == [missed(**inputs | {"X": at}) for at in moved]
        assert min(found["moved"][f"X_{level + 1}"]) > 10
    of_X = [n for name, of in found["moved"].items() if name.startswith("X_") for n in of]
    assert found["moved_X"] == [min(of_X), max(of_X)]
    for name, key, step in (
        ("X + X_s", "swing", 1e-6),
        ("t_s", "t_s", 1e-4),
        ("phi", "phi", 1e-3),
    ):
        moved = [inputs | {key: inputs[key] + sign * step} for sign in signs]
        assert found["moved"][name] == [missed(**of) for of in moved]
    assert found["moved"]["t_s"] == [0, 0]
    assert found["moved"]["sign"] == [missed(**inputs, sign=-1.0)]
    X_exact = np.array([2.7279431, 4.3880136, 6.0481638, 7.7083934, 9.3686833]) * 1e-3
    assert found["given_by_exact_X"] == 30 - missed(**inputs | {"X": np.round(X_exact, 6)})
    printed = PRINT.values("V_s")
    assert found["missed_by_printed_V_s"] == missed(**inputs | {"V_s": printed}) == 0


def test_zero_decimals_are_a_step_of_a_whole_unit(monkeypatch):
    """X, φ and t_s kept in whole m, rad and s, all of them 0, 2 and 0, are moved by 1 m, 1 rad and 1 s."""
    seen = []

    def estimates(features, *_):
        seen.append((*features.X, features.phi[0], features.t_s[0]))
        return exact().estimates["omega1"]

    whole = dict.fromkeys(("X_decimals", "common_phi_decimals", "common_t_s_decimals"), 0)
    numerics = replace(CASE.numerics, two_point={**CASE.numerics.two_point, **whole})
    monkeypatch.setattr(evidence, "estimates", estimates)
    case = replace(CASE, numerics=numerics)
    evidence.inputs_of_table_3(case, by_key(numbers()))
    moves = np.array(seen) - [0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0]
    expected = [sign * step for step in np.eye(7) for sign in (-1.0, 1.0)]
    assert all(any(np.array_equal(move, step) for move in moves) for step in expected)


# ---- What is not printed -------------------------------------------------------------------------------------------


def errors_by_hand(X_m, phi_rad, draws):
    """The largest error of F_k and c at ω3 per draw, %, of the same random numbers by formulas written out."""
    random = np.random.default_rng(unprinted.SEED)
    of, omega = features_at(11.1), 2.0 * math.pi * 11.1
    moved = X_m * random.uniform(-1.0, 1.0, (5, draws))
    phi = np.mean(of.phi_reversal) + phi_rad * random.uniform(-1.0, 1.0, draws)
    X, Y, V_s = of.X[:, None] + moved, np.array(LEVELS)[:, None], of.V_s[:, None]
    b, W = math.pi * omega * X**2, math.pi * PAPER.k * Y * X * np.sin(phi)
    largest = np.zeros(draws)
    for a in (
        2.0 * X * (1.0 + math.cos(omega * np.mean(of.t_s))),
        2.0 * (2.0 * X - (of.X + of.X_s)[:, None]),
        2.0 * X * (1.0 + np.sqrt(1.0 + (V_s / (omega * X)) ** 2)),
    ):
        for i, j in PAIRS:
            determinant = a[i] * b[j] - a[j] * b[i]
            F_k, c = (W[i] * b[j] - W[j] * b[i], a[i] * W[j] - a[j] * W[i]) / determinant
            errors = np.abs(F_k / PAPER.F_k - 1.0), np.abs(c / PAPER.c - 1.0)
            largest = np.maximum(largest, np.maximum(*errors))
    return 100.0 * largest


@pytest.mark.parametrize("spread", [*unprinted.SPREADS, unprinted.ROUNDED])
def test_the_errors_of_the_draws_are_those_of_the_formulas(spread):
    errors = errors_by_hand(*spread, unprinted.DRAWS)
    (of,) = unprinted.drawn(AT_OMEGA3, CASE, 70.0, [spread])
    assert (of.X_m, of.phi_rad) == spread
    # differences of numbers that agree to three digits, of rounding 1e-16
    assert (of.low, of.high) == pytest.approx(np.quantile(errors, [0.05, 0.95]), rel=1e-9)
    assert of.share == np.mean(errors > 70.0)


def test_print_leaves_seventy_per_cent_open():
    """Shares from an independent computation with other random numbers: 7, 43 to 45 and 85 %."""
    drawn = unprinted.drawn(AT_OMEGA3, CASE, 70.0)
    assert [of.share for of in drawn] == pytest.approx([0.07, 0.44, 0.85], abs=0.02)
    assert unprinted.open_to(drawn)


def test_rounding_of_X_alone_stays_below_the_bound():
    (of,) = unprinted.drawn(AT_OMEGA3, CASE, 70.0, [unprinted.ROUNDED])
    assert (of.share, of.low, of.high) == pytest.approx((0.0, 66.6, 68.6), abs=0.1)
    assert not unprinted.open_to([of])


@pytest.mark.parametrize(("bound", "is_open"), [(50.0, False), (70.0, True), (95.0, False)])
def test_a_bound_far_from_all_draws_is_decided(bound, is_open):
    assert unprinted.open_to(unprinted.drawn(AT_OMEGA3, CASE, bound)) is is_open
