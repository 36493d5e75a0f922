"""Test what agreement proves: counts by hand from the verdicts, the recipe's choices, inputs moved by other code."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binom

from dampbalance.balance import APPROACHES
from dampbalance.project.files import read_csv
from dampbalance.replication.claims import evidence, unprinted
from dampbalance.replication.claims.printed import Printed
from dampbalance.replication.numbers import by_key
from dampbalance.solver import pair
from folders import PUBLISHED
from paper_case import LEVELS, PAPER, features_at
from replication.by_hand import estimates, missed
from replication.routes import CASE, CONFIG, numbers, unrounded


def test_routes_are_counted_apart_from_verdicts(claims, computed):
    """45 by the simulation and 15 by arithmetic on printed tables; exact agreement moves four of the 45."""
    counted = evidence.by_route(claims)
    assert counted == {
        "exact": 12,  # ζ, f_n, ten of X and X_s
        "simulation": 45,  # t_s and its mean, the mean φ, eight of Table 2, Table 3
        "simulation_reproduced": 4,
        "print": 15,  # eleven of the least squares, two means, two deviations
        "print_elsewhere": 1,  # c of the pair 4-5
        "table_3_from_table_1": 6,  # c of three pairs by X_s and t_s
    }
    verdicts = computed["verdict"].value_counts()
    assert verdicts["reproduced"] == counted["exact"] + evidence.chance(claims)["observed"] == 19
    assert verdicts["simulated"] == counted["simulation"] - counted["simulation_reproduced"]
    assert verdicts["from print"] == counted["print"] + counted["print_elsewhere"]


def test_chance_is_one_in_ten_of_what_is_close_in_columns_that_exact_numbers_miss(claims, computed):
    close = within = observed = 0
    for name, row in computed.iterrows():
        in_V_s = name.startswith("table1.V_s")  # judged by exact numbers, of which two miss
        if (row["judged"] == "exact" and not in_V_s) or row["exact"] == "":
            continue
        printed, exact = Printed(row["printed"]), float(row["exact"])
        off = abs(exact - printed.value) / printed.unit
        within, observed = within + (off < 5.0), observed + (off <= 0.5)
        digits = (f"{value / printed.unit:.0f}" for value in (exact, printed.value))
        close += len({text[:-1] for text in digits}) == 1
    assert (close, within) == (36, 40)  # counted by other code as well
    assert observed == 7  # V_s 1, 4, 5, t_s 3, 5, F_k by t_s 4-5, mean φ
    was = {"close": close, "within": within, "expected": 4.0, "observed": observed}
    was["p"] = binom.sf(6, 40, 0.1)
    assert evidence.chance(claims) == pytest.approx(was, rel=1e-12)
    # a wrong exact number no longer counts; a column that exact numbers miss once counts whole
    wrong = claims["exact"].mask(claims["id"] == "text.phi_mean", "1.55")
    missed = claims["agrees"].mask(claims["id"] == "table1.X.2", "as published")
    for changed, more in (({"exact": wrong}, -1), ({"agrees": missed}, 5)):
        now = evidence.chance(claims.assign(**changed))
        counts = [now[name] for name in ("observed", "close", "within")]
        assert counts == [observed + more, close + more, within + more]


def test_random_instants_agree_as_rarely_as_drawn_ones():
    """Of two instants on a circle the mean lies between them: P = 4d, exactly. Of five, those drawn within 2.2 d of the
    first, which all that agree are, agree as often as the volume of the drawn ones says, to 0.6 % of 200,000 draws."""
    assert evidence.chance_of_instants(0.03, 2) == pytest.approx(0.12, rel=1e-12)
    d, draws = 0.0201830, 200_000
    drawn = np.random.default_rng(63).uniform(-2.2 * d, 2.2 * d, (5, draws))
    drawn[0] = 0.0
    turns = np.exp(2j * np.pi * drawn)
    off = np.abs(np.angle(turns / turns.mean(axis=0))) / (2.0 * np.pi)
    share = np.mean(off.max(axis=0) <= d) * (4.4 * d) ** 4
    chance = evidence.chance_of_instants(d, 5)
    assert chance == pytest.approx(share, rel=0.02)
    # of 4,000,000 draws by independent code, with a standard error of 0.13 %
    assert chance == pytest.approx(7.95e-6, rel=0.004)


def test_the_exact_V_s_are_closer_to_print_than_the_simulated_ones():
    """Distances by independent code, to half a unit of the digits given: closed-form orbits, and backward Euler, read
    between samples and at the first that slips."""
    found = evidence.slip_velocities(numbers(), read_csv(PUBLISHED / "cycles.csv"))
    assert found["exact_units"] == pytest.approx(0.719, abs=0.0005)
    assert found["simulated_units.min"] == pytest.approx(0.86, abs=0.005)
    assert found["simulated_units.max"] == pytest.approx(2.96, abs=0.005)
    assert found["sampled_units.min"] == pytest.approx(0.081, abs=0.0005)
    assert found["sampled_units.max"] == pytest.approx(2.376, abs=0.0005)
    # five numbers between −5 and 5 units, all of them between −0.7192 and 0.7192
    assert found["chance"] == pytest.approx(0.14384**5, rel=1e-3)


def test_choices_are_the_rules_of_the_configuration():
    """Scheme, cycle, two roundings, five samples, six rules of reading, the phase, the sign; and the step."""
    choices = evidence.free_choices(CASE)
    assert choices["continuous"] == {"step_s": CONFIG["as_published"]["step_s"]}
    assert len(choices["discrete"]) == 17
    fewer = replace(CASE.numerics, k_over_m_decimals=None, slip_samples=(1, 1, 1))
    choices = evidence.free_choices(replace(CASE, numerics=fewer))
    assert len(choices["discrete"]) == 17 - 1 - 2


def test_the_digits_hang_on_nine_inputs():
    X = np.array([2.728, 4.387, 6.047, 7.707, 9.367]) * 1e-3
    V_s = unrounded()["V_s_m_per_s"].to_numpy()
    inputs = {"X": X, "way": 13e-6, "t_s": 2.1e-3, "phi": 1.542, "V_s": V_s}

    def missed_by(**inputs):
        return len(missed(**inputs))

    found = evidence.inputs_of_table_3(CASE, by_key(numbers()))
    assert missed_by(**inputs) == 0
    assert (found["given"], found["inputs"], len(found["moved"])) == (30, 9, 9)
    steps = {f"X_{level}": ("X", 1e-6 * (np.arange(1, 6) == level)) for level in range(1, 6)}
    steps |= {"X + X_s": ("way", 1e-6), "t_s": ("t_s", 1e-4), "phi": ("phi", 1e-3)}
    for name, (key, step) in steps.items():
        moved = [inputs | {key: inputs[key] + sign * step} for sign in (-1.0, 1.0)]
        assert found["moved"][name] == [missed_by(**of) for of in moved], name
    of_X = [n for name in steps if name.startswith("X_") for n in found["moved"][name]]
    assert found["moved_X"] == [min(of_X), max(of_X)]
    assert min(of_X) > 10
    assert found["moved"]["t_s"] == [0, 0]
    assert found["moved"]["sign"] == [missed_by(**inputs, sign=-1.0)]
    X_exact = np.array([2.7279431, 4.3880136, 6.0481638, 7.7083934, 9.3686833]) * 1e-3
    assert found["given_by_exact_X"] == 30 - missed_by(**inputs | {"X": np.round(X_exact, 6)})


# ---- What is not printed -------------------------------------------------------------------------------------------

AT_OMEGA3 = features_at(11.1)


def errors_by_hand(X_m, phi_rad):
    """The largest error of F_k and c at ω3 per draw, %, of the same random numbers by formulas written out."""
    random, of = np.random.default_rng(unprinted.SEED), AT_OMEGA3
    moved = X_m * random.uniform(-1.0, 1.0, (5, unprinted.DRAWS))
    phi = np.mean(of.phi_reversal) + phi_rad * random.uniform(-1.0, 1.0, unprinted.DRAWS)
    X, Y, V_s, way = (of[:, None] for of in (of.X, np.array(LEVELS), of.V_s, of.X + of.X_s))
    inputs = {"X": X + moved, "Y": Y, "V_s": V_s, "phi": phi, "t_s": np.mean(of.t_s), "way": way}
    largest = np.zeros(unprinted.DRAWS)
    for *_, (F_k, c) in estimates(2.0 * math.pi * 11.1, **inputs):
        errors = np.abs(F_k / PAPER.F_k - 1.0), np.abs(c / PAPER.c - 1.0)
        largest = np.maximum(largest, np.maximum(*errors))
    return 100.0 * largest


@pytest.mark.parametrize("spread", [*unprinted.SPREADS, unprinted.ROUNDED])
def test_the_errors_of_the_draws_are_those_of_the_formulas(spread):
    errors = errors_by_hand(*spread)
    (of,) = unprinted.drawn(AT_OMEGA3, CASE, 70.0, [spread])
    assert (of.X_m, of.phi_rad) == spread
    # differences of numbers that agree to three digits, of rounding 1e-16
    assert (of.low, of.high) == pytest.approx(np.quantile(errors, [0.05, 0.95]), rel=1e-9)
    assert of.share == np.mean(errors > 70.0)


# Median and 95th percentile, %, of 200,000 draws by independent code with other random numbers.
ROUNDED = {4.92: (3.469, 6.425), 3.5: (2.757, 5.600), 11.1: (7.879, 15.369)}
ONE_MORE = {4.92: (0.3480, 0.6438), 3.5: (0.2885, 0.5667), 11.1: (0.7839, 1.5248)}


@pytest.mark.parametrize("hz", ROUNDED)
def test_rounding_spreads_the_fourier_balance_as_in_an_independent_computation(hz):
    """2.5 %: three standard errors of a quantile of 10,000 draws."""
    exact = features_at(hz)
    for more, expected in enumerate((ROUNDED[hz], ONE_MORE[hz])):
        errors = unprinted.rounding_errors(exact, CASE, more)
        assert errors.shape == (unprinted.DRAWS,)
        assert np.quantile(errors, [0.5, 0.95]) == pytest.approx(expected, rel=0.025)


def test_without_rounding_the_error_of_the_harmonics_cut_off_is_left():
    """At 4.92 Hz 0.02 % or so, which the errors of ten further decimals do not change."""
    errors = unprinted.rounding_errors(features_at(4.92), CASE, more=10)
    rows = APPROACHES["fourier"](features_at(4.92), PAPER.k)
    of_pairs = [float(pair(rows, i, j)["F_k"]) / PAPER.F_k - 1.0 for i, j in CASE.pairs]
    assert errors == pytest.approx(
        np.full(unprinted.DRAWS, 100.0 * np.abs(of_pairs).max()), rel=1e-6
    )


def test_print_leaves_seventy_per_cent_open_and_a_bound_far_from_all_draws_not():
    """Shares from an independent computation with other random numbers: 7, 43 to 45 and 85 %."""
    drawn = unprinted.drawn(AT_OMEGA3, CASE, 70.0)
    assert [of.share for of in drawn] == pytest.approx([0.07, 0.44, 0.85], abs=0.02)
    assert unprinted.open_to(drawn)
    for bound in (50.0, 95.0):
        assert not unprinted.open_to(unprinted.drawn(AT_OMEGA3, CASE, bound))
    # rounding of X alone stays below the bound
    assert not unprinted.open_to(unprinted.drawn(AT_OMEGA3, CASE, 70.0, [unprinted.ROUNDED]))
