"""The simulation and the read-outs behind the printed Tables 1–3, and which printed digits they give.

Nothing here feeds a printed number back: the simulation has the paper's parameters, and the printed tables are compared
at the very end. Scheme, step, cycle and rules of reading were chosen so that they agree.
"""

from __future__ import annotations

from decimal import Decimal

import numpy as np
import pytest

from dampbalance.balance import direct, slip_displacement, slip_time, slip_velocity_as_printed
from dampbalance.features import of_orbit, stack
from dampbalance.model import BaseMotion
from dampbalance.motion.orbit import steady_orbit
from dampbalance.replication.clean import of_record
from dampbalance.replication.fixed_step import simulate
from dampbalance.replication.read_out import ReadOut
from dampbalance.solver import pair
from paper_case import LEVELS, OMEGA, PAIRS, PAPER
from replication.routes import PRINT, with_digits_of

STEP = 5.0e-6

# The equation of motion divided by m, with 90/2.42 and 2310/2.42 rounded. Of 26 cycles the last three are kept; the
# first whole one from reversal to reversal among them is the one that starts in the 24th period.
NUMERICS = {
    "scheme": "backward-euler",
    "step": STEP,
    "cycles": 26,
    "keep_cycles": 3,
    "c_over_m": 37.19,
    "k_over_m": 954.545,
}
SLIP_SAMPLES = (1, 1, 2, 1, 2)  # after slip is seen: where a begins
TABLE_3 = ReadOut(
    X_decimals=6,  # whole micrometres
    X_s_mark=1e-6,  # and X_s at the first micrometre mark beyond the corner
    t_s_inset=2.0 * STEP,  # timed inside the microstick phase, a step in from either end,
    t_s_unit=1e-4,  # in whole tenths of a millisecond
    common_phi_decimals=3,
    common_t_s_decimals=4,
)


def records(**changed):
    return [simulate(PAPER, BaseMotion(Y, OMEGA), **NUMERICS | changed) for Y in LEVELS]


def read(of, reading="interpolated"):
    return stack(
        [
            of_record(record, OMEGA, PAPER.k, reading, begun)
            for record, begun in zip(of, SLIP_SAMPLES, strict=True)
        ]
    )


@pytest.fixture(scope="module")
def simulated():
    return records()


@pytest.fixture(scope="module")
def interpolated(simulated):
    return read(simulated)


@pytest.fixture(scope="module")
def sampled(simulated):
    return read(simulated, "sample")


LABELS = [f"{i + 1}-{j + 1}" for i, j in PAIRS]
numbers = PRINT.values


def table_3(features, readout):
    """The thirty cells of Table 3 as (column, printed, computed)."""
    rows = {
        "t_s": slip_time(readout.common(features), PAPER.k),
        "X_s": slip_displacement(readout.common(features), PAPER.k),
        "V_s": slip_velocity_as_printed(readout.common(features), PAPER.k),
    }
    cells = []
    for (i, j), label in zip(PAIRS, LABELS, strict=True):
        for name, of in rows.items():
            estimate = pair(of, i, j)
            for symbol in ("F_k", "c"):
                text = PRINT[f"table3.{name}.{symbol}.{label}"].text
                cells.append((f"{name} {symbol} {label}", text, estimate[symbol]))
    return cells


def misses(cells):
    return [name for name, text, value in cells if with_digits_of(text, value) != Decimal(text)]


# ---- Table 2 --------------------------------------------------------------------------------------------------------


def test_W_of_table_2(sampled):
    error = sampled.W / numbers("W") - 1.0
    assert np.max(np.abs(error)) < 4e-7
    # With the unrounded coefficients it is five times as far, at every level the same way.
    unrounded = read(records(c_over_m=None, k_over_m=None), "sample")
    assert np.all(unrounded.W / numbers("W") - 1.0 < -1.5e-6)


def test_b_of_table_2_to_the_last_digit_except_b_1(sampled):
    printed = [PRINT[f"table2.b.{level}"].text for level in range(1, 6)]
    computed = [with_digits_of(text, b) for text, b in zip(printed, sampled.b, strict=True)]
    assert computed[1:] == [Decimal(text) for text in printed[1:]]
    assert Decimal(printed[0]) - computed[0] == Decimal("0.00000001")


def test_b_1_of_table_2_contradicts_its_own_row():
    """With the F_k and c of the next rows, the printed a_1 and W_1 need the b_1 that the simulation has."""
    a_1, W_1 = (PRINT[f"table2.{symbol}.1"].value for symbol in ("a", "W"))
    for label in LABELS[1:4]:
        F_k, c = (PRINT[f"table2.{symbol}.{label}"].value for symbol in ("F_k", "c"))
        b_1 = (W_1 - a_1 * F_k) / c
        assert with_digits_of(PRINT["table2.b.1"].text, b_1) == Decimal("0.00072728")


def off_print_in_samples(features):
    """a less the printed a, in samples: one moves a by 2 V_s h."""
    return (features.a - numbers("a")) / (2.0 * features.V_s * STEP)


def test_a_of_table_2_to_a_thirtieth_of_a_sample(sampled):
    off = off_print_in_samples(sampled)
    assert np.max(np.abs(off)) < 0.034
    # Half a unit of print is 0.003 to 0.007 of a sample: three of the five are within a unit.
    units = (sampled.a - numbers("a")) / 1e-9
    assert np.count_nonzero(np.abs(units) < 1.0) == 3


@pytest.mark.parametrize("cycles", [22, 23, 24, 25])
def test_no_neighbouring_cycle_gives_a(cycles):
    """Whichever sample a begins at: the grid of samples lies elsewhere in the periods before."""
    off = off_print_in_samples(read(records(cycles=cycles), "sample"))
    assert np.min(np.abs(off - np.round(off))) > 0.1


def test_print_lies_between_what_the_19th_and_the_24th_period_give(sampled):
    """Five periods are 0.0325 of a step more than whole steps: no other period simulated is as close to this one."""
    period = 1.0 / 4.92 / STEP
    assert 5.0 * period - round(5.0 * period) == pytest.approx(0.0325, abs=1e-4)
    earlier = off_print_in_samples(read(records(cycles=21), "sample"))
    half_a_unit = 0.5e-9 / (2.0 * sampled.V_s * STEP)
    assert np.all(earlier < half_a_unit)
    assert np.all(off_print_in_samples(sampled) > -half_a_unit)


def test_displacements_of_the_8th_period_give_a_as_well(simulated):
    """The cycle is not unique: 2 (x(t_2) − x) there, begun 0, 1, 1, 1, 1 samples after slip is seen, is as close."""
    a, off = numbers("a"), []
    for record, begun, printed_a in zip(records(cycles=10), (0, 1, 1, 1, 1), a, strict=True):
        features = of_record(record, OMEGA, PAPER.k, "sample")
        corner = int(np.flatnonzero(record.x == features.X_s[0])[0])
        peak = np.max(record.x[corner : corner + round(0.5 / 4.92 / STEP)])
        travel = 2.0 * (peak - record.x[corner + begun])
        off.append((travel - printed_a) / (2.0 * features.V_s[0] * STEP))
    assert np.max(np.abs(off)) < 0.034


def test_pairs_of_table_2_without_level_1(sampled):
    rows = direct(sampled, PAPER.k)
    for line in (1, 2, 3):
        estimate = pair(rows, *PAIRS[line])
        F_k, c = (PRINT[f"table2.{symbol}.{LABELS[line]}"].value for symbol in ("F_k", "c"))
        # c of pair 4-5 is 90.01144, printed 90.0115: W, 6e-8 of itself off print, moves c by up to half a unit.
        assert estimate["c"] == pytest.approx(c, abs=0.6e-4)
        # W at level 2 is 3.4e-7 of itself off, which moves F_k of pair 2-3 by four times that: 5e-6.
        assert estimate["F_k"] == pytest.approx(F_k, abs=5e-6)


def test_no_other_scheme_gives_table_2():
    """After 6 cycles, in which a transient decays by e⁻²²."""
    W = numbers("W")
    for scheme in ("rk4", "trapezoidal", "semi-implicit-euler", "explicit-euler"):
        features = read(records(scheme=scheme, cycles=6), "sample")
        assert np.min(np.abs(features.W / W - 1.0)) > 1e-4, scheme


# ---- Table 1 --------------------------------------------------------------------------------------------------------


def test_exact_t_s_cut_to_tenths_of_a_millisecond_misses_level_4_by_8_microseconds():
    exact = stack([of_orbit(steady_orbit(PAPER, BaseMotion(Y, OMEGA))) for Y in LEVELS])
    missed = ReadOut(t_s_unit=1e-4).apply(exact).t_s - numbers("t_s")
    assert missed == pytest.approx([0.0, 0.0, 0.0, 1e-4, 0.0], abs=1e-9)
    assert exact.t_s[3] - 1.8e-3 == pytest.approx(8.1e-6, abs=5e-8)


def test_V_s_of_table_1_lies_between_the_corner_and_the_next_sample(
    simulated, sampled, interpolated
):
    V_s = numbers("V_s")
    accelerations = []
    for record, X_s in zip(simulated, sampled.X_s, strict=True):
        corner = int(np.flatnonzero(record.x == X_s)[0])
        accelerations.append(record.acceleration[corner])
    later = interpolated.V_s + STEP * np.array(accelerations)
    assert np.all(np.round(interpolated.V_s, 5) <= V_s + 1e-12)
    assert np.all(V_s <= np.round(later, 5) + 1e-12)


def test_phase_of_table_1_is_that_of_the_reversal_read_to_an_eighth_of_a_millisecond(interpolated):
    phi = numbers("phi")
    assert np.max(np.abs(phi - interpolated.phi_reversal)) < OMEGA * 0.125e-3
    assert np.min(np.abs(phi - interpolated.phi_zero_crossing)) > OMEGA * 0.6e-3


# ---- Table 3 --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("rules", "missed"),
    [
        ({"X_s_mark": 1e-6, "common_phi_decimals": None}, ["V_s c 3-4"]),
        ({"X_s_mark": None, "X_s_decimals": 6}, ["X_s c 1-2"]),
    ],
    ids=["unrounded mean phase", "X_s rounded to nearest"],
)
def test_each_rule_decides_a_digit_of_table_3(interpolated, rules, missed):
    fields = {name: getattr(TABLE_3, name) for name in TABLE_3.__slots__} | rules
    assert misses(table_3(interpolated, ReadOut(**fields))) == missed


def test_without_the_numerical_dissipation_most_of_table_3_comes_out_otherwise():
    cells = table_3(read(records(scheme="rk4", cycles=6)), TABLE_3)
    assert len(misses(cells)) > 20


def test_the_digits_do_not_hang_on_the_cycle_that_is_read():
    for cycles in (11, 20):
        assert misses(table_3(read(records(cycles=cycles)), TABLE_3)) == []
