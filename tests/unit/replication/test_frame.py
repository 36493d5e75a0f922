"""What is shown of the frame, against motions and numbers known from elsewhere."""

from __future__ import annotations

import itertools
import math
from string import ascii_lowercase

import numpy as np
import pytest
from scipy import stats

from dampbalance.law.law import Law
from dampbalance.likelihood.mean_harmonics import Reading
from dampbalance.reading.conditioning import condition
from dampbalance.records.measurement import Channel, Measurement
from dampbalance.replication.frame.findings import (
    Findings,
    Prediction,
    drift,
    findings,
    friction_of_rows,
    load_line,
    speed_laws_of,
)
from dampbalance.replication.frame.friction import (
    SPEED_LAWS,
    Loop,
    Mass,
    friction_loop,
    linear,
    logarithmic,
    predicted,
    shape,
    static_force,
)
from dampbalance.replication.frame.pictures import loops as drawn_loops
from unit.reading.stopping import Stopping, steady

TWO = {1: 1.82e-3, 2: 2e-5j, 3: 1e-4}
ZERO = 3e-4  # m: of the transducer of the mass


def reading_of(t, base, x, k: float, terms: tuple[str, ...] = ()) -> Reading:
    channels = [Channel("base_displacement", t, base), Channel("displacement", t, x)]
    return Reading(condition(Measurement.of("synthetic", channels), k), joint=True, terms=terms)


def read(of: Stopping, noise: np.random.Generator | None = None) -> Reading:
    """What is read of 10.2 cycles, at 1000 samples a second."""
    t = np.arange(int(10.2 * 1000.0 * 2.0 * math.pi / of.omega)) / 1000.0
    added = 5e-7 * noise.standard_normal((2, t.size)) if noise else np.zeros(2)
    return reading_of(t, of.y(t) + added[0], steady(of).x(t) + ZERO + added[1], of.k)


def loop_of(of: Stopping) -> Loop:
    return friction_loop(read(of), of.m, {"c_r": of.c_r})


def test_the_line_is_that_of_linear_regression():
    load, force = [0.25, 0.35, 0.45, 0.55], [0.68, 0.99, 1.29, 1.62]
    line, off = load_line(load, force, [0.01] * 4)
    known = stats.linregress(load, force)
    t = stats.t.ppf(0.975, 2)
    assert line["slope_N_per_kg"] == pytest.approx(known.slope, rel=1e-12)
    assert line["coefficient"] == pytest.approx(known.slope / 9.80665, rel=1e-12)
    for name, value, error in (
        ("slope_interval_N_per_kg", known.slope, known.stderr),
        ("intercept_interval_N", known.intercept, known.intercept_stderr),
    ):
        assert line[name] == pytest.approx([value - t * error, value + t * error], rel=1e-10)
    left = np.array(force) - known.intercept - known.slope * np.array(load)
    assert off == pytest.approx(list(left / force), abs=1e-12)


def test_the_scatter_about_the_line_is_one_where_the_errors_make_it():
    rng, load = np.random.default_rng(3), np.array([0.2, 0.3, 0.45, 0.6])
    errors = np.array([0.01, 0.02, 0.005, 0.01])
    scatters = [
        load_line(load, 0.1 + 3.0 * load + errors * rng.standard_normal(4), errors)[0]["scatter"]
        for _ in range(4000)
    ]
    # 4,000 values know their mean square, of two degrees of freedom or fewer, to 3 %
    assert np.mean(np.square(scatters)) == pytest.approx(1.0, rel=0.08)


def test_cycles_that_do_not_differ_let_no_scatter_be_expected():
    load, force = [0.25, 0.35, 0.45, 0.55], [0.68, 0.99, 1.29, 1.62]
    line, _ = load_line(load, force, [0.0] * 4)
    # JSON has neither ∞ nor NaN
    assert line["scatter"] is None
    assert {**line, "scatter": 0.0} == load_line(load, force, [0.01] * 4)[0] | {"scatter": 0.0}


def test_the_loop_of_a_constant_friction_force_is_that_force():
    of = Stopping(base=TWO, forward=0.9, back=0.9, c_r=6.0)
    loop = loop_of(of)
    found = shape(loop, 0.9)
    # 31 harmonics of an acceleration that jumps at the stops ring by a few per cent near them, and less between
    assert found["rms"] < 0.02
    for name in ("along", "speed"):
        assert abs(found[name]) < 0.02
    # the law is rigid: at rest nothing moves but the ringing
    assert np.abs(found["given_way_m"]) == pytest.approx(0.0, abs=3e-3 * loop.X)
    assert found["part_at_rest"] == pytest.approx(steady(of).stopped, abs=0.06)


def test_the_level_of_the_force_takes_a_difference_between_the_directions():
    of = Stopping(base=TWO, forward=1.0, back=0.8, c_r=6.0)
    loop = loop_of(of)
    # half the difference between the directions, and what the spring holds in the mean, which the harmonics leave out
    held = of.k * steady(of).x(np.arange(4096) / 4096.0).mean()
    assert loop.level == pytest.approx(0.1 + held, abs=2e-3)
    assert shape(loop, 0.9)["rms"] < 0.02


def test_friction_that_grows_along_the_way_is_seen():
    of = Stopping(base=TWO, slope=60.0, c_r=6.0)
    loop = loop_of(of)
    x = loop.x + steady(of).x(np.arange(4096) / 4096.0).mean()
    middle = 0.5 * (x.max() + x.min())
    F = 1.0 + 60.0 * middle
    expected = 2.0 * 60.0 * loop.X / F
    # the straight line is through where the mass slides, and the ringing is in it
    forward = loop.sliding & (loop.v > 0.0)
    slope = np.polyfit(loop.x[forward], loop.force[forward], 1)[0]
    assert slope == pytest.approx(60.0, rel=0.05)
    assert shape(loop, F)["along"] == pytest.approx(expected, rel=0.1)


@pytest.mark.parametrize("hz", [9.0, 13.0, 22.0])
def test_a_ripple_is_found_with_its_frequency_and_size(hz):
    omega, F_k = 2.0 * math.pi, 2.0
    theta = np.linspace(0.0, 2.0 * math.pi, 4096, endpoint=False)
    x, v = -np.cos(theta), omega * np.sin(theta)
    wave = 0.1 * np.cos(2.0 * math.pi * hz * theta / omega + 0.4)
    loop = Loop(omega, x, v, F_k * np.sign(v) * (1.0 + wave), 0.0)
    found = shape(loop, F_k)
    assert found["ripple_hz"] == pytest.approx(hz, abs=0.11)  # steps of 0.1 Hz
    assert found["ripple"] == pytest.approx(0.1, rel=1e-3)
    assert found["explained"] == pytest.approx(1.0, abs=1e-3)
    assert found["rms"] == pytest.approx(0.1 * math.sqrt(0.5), rel=0.02)


@pytest.mark.parametrize(
    "of",
    [
        Stopping(base=TWO),
        Stopping(base={1: 6e-3}, c_r=2.0),
        Stopping(base={1: 2e-2}, c_r=2.0, omega=24.0),
    ],
    ids=["stops", "short stops", "none"],
)
def test_a_motion_is_predicted_as_another_integrator_has_it(of):
    known = steady(of)
    t = 0.1 + np.arange(2200) / 1000.0
    x = known.x(t)
    v = float(np.diff(known.x(t[0] + np.array([-1e-6, 1e-6])))[0]) / 2e-6
    mass = Mass(of.m, of.k, lambda speed: 1.0 + 0.0 * speed, {"c_r": of.c_r}, zero=-ZERO)
    found = predicted(mass, t, of.y(t) + ZERO, x[0], v, of.omega)
    # a cubic spline through samples 1/1000 (1/260) of a cycle apart is within 1e-8 of the base; rounding of the
    # difference is 1e-8 of the largest velocity
    np.testing.assert_allclose(found, x, atol=1e-6 * known.range)


def test_friction_that_grows_with_speed_is_a_damper_to_the_ground():
    of = Stopping(base=TWO)
    known, t = steady(of), np.arange(1100) / 1000.0
    by_friction, by_damper, without = (
        predicted(
            Mass(of.m, of.k, lambda speed, F_1=F_1: 0.8 + F_1 * speed, damping),
            *(t, of.y(t), known.x(t)[0], 0.0, of.omega),
        )
        for F_1, damping in ((6.0, {"c_r": of.c_r}), (0.0, {"c_r": of.c_r, "c": 6.0}), (0.0, {}))
    )
    # ten times the integrator's
    np.testing.assert_allclose(by_friction, by_damper, atol=1e-8 * known.range)
    assert np.abs(by_friction - without).max() > 0.01 * known.range


def loop_with(force) -> Loop:
    """A loop with rests at both ends, whose friction force has that dependence on the speed; at rest it is 0.9 F(0)
    until the mass leaves."""
    theta = np.linspace(0.0, 2.0 * math.pi, 4096, endpoint=False)
    toward = np.where(np.sin(theta) > 0.0, 1.0, -1.0)
    v = 0.04 * toward * np.maximum(np.abs(np.sin(theta)) - 0.5, 0.0)
    x = np.cumsum(v) * theta[1] / (2.0 * math.pi)
    stays = (v == 0.0) & (np.roll(v, -1) == 0.0)
    slow = np.abs(v) < 0.02 * np.abs(v).max()
    held = float(force(np.zeros(1))[0]) * np.where(stays, 0.9, 1.0)
    return Loop(2.0 * math.pi, x, v, toward * np.where(slow, held, force(np.abs(v))), 0.0)


def mean_on_the_way(loop: Loop, force) -> float:
    """∫F|ẋ|dt / ∫|ẋ|dt where the mass moves."""
    moving = np.where(loop.at_rest, 0.0, np.abs(loop.v))
    return float(moving @ force(np.abs(loop.v)) / moving.sum())


@pytest.mark.parametrize("F_1", [-2.0, 0.0, 5.0])
def test_the_linear_law_gives_back_the_friction_of_a_loop(F_1):
    def force(speed):
        return 1.2 + F_1 * speed

    loop = loop_with(force)
    law = linear(loop, mean_on_the_way(loop, force))
    # the points and the law are exact: rounding only
    assert law.coefficients == pytest.approx({"F_0_N": 1.2, "F_1_N_s_per_m": F_1}, abs=1e-10)


def test_the_logarithmic_law_gives_back_the_friction_of_a_loop():
    F_0, a, b, c, V, least = 1.1, 0.03, 0.05, 0.04, 3e-3, 1e-6

    def force(speed):
        u = np.asarray(speed) + least
        return F_0 + a * np.log(u / V) + b * np.log(c + V / u)

    loop = loop_with(force)
    assert static_force(loop) == pytest.approx(float(force(0.0)), rel=1e-12)
    law = logarithmic(loop, mean_on_the_way(loop, force))
    expected = {"F_0_N": F_0, "F_s_N": float(force(0.0)), "a_N": a, "b_N": b, "c": c}
    # the least squares end where a step changes their sum by 1e-8 of itself
    assert law.coefficients == pytest.approx(expected, rel=1e-3)
    assert law.force(np.zeros(1))[0] == pytest.approx(float(force(0.0)), rel=1e-12)


@pytest.mark.slow
def test_the_standard_error_of_the_slope_over_speed_is_its_scatter():
    of, rng = Stopping(base=TWO, c_r=6.0), np.random.default_rng(8)
    law, slopes, errors = Law(("F_k", "c_r"), {"c_r": 6.0}), [], []
    for _ in range(40):
        coefficients = speed_laws_of(read(of, rng), of.m, 1.0, law)["linear"].coefficients
        slopes.append(coefficients["F_1_N_s_per_m"])
        errors.append(coefficients["F_1_standard_error_N_s_per_m"])
    # so little noise that all 31 harmonics are taken every time: their choice is not in the error
    # 40 slopes know their scatter to 11 %, ten cycles theirs to 24 % each, the mean of 40 to 4 %
    assert np.mean(errors) == pytest.approx(np.std(slopes, ddof=1), rel=0.4)
    # what 31 harmonics ring near the stops, as a part of F_k at the largest speed
    assert abs(np.mean(slopes)) * 0.02 < 0.01


@pytest.mark.parametrize("name", SPEED_LAWS)
def test_every_law_of_friction_does_the_work_of_the_balance(name):
    loop = loop_of(Stopping(base=TWO, forward=0.9, back=0.9, c_r=6.0))
    law = SPEED_LAWS[name](loop, 0.93)
    assert mean_on_the_way(loop, law.force) == pytest.approx(0.93, rel=1e-10)


def test_the_drift_is_the_slope_of_linear_regression():
    forces = np.array([0.97, 0.98, 0.975, 0.99, 1.0, 0.995, 1.01, 1.005])
    line = drift(forces, 0.95, 4)
    known = stats.linregress(np.arange(8.0), forces)
    assert (line.slope, line.error, line.p) == pytest.approx(
        (known.slope, known.stderr, known.pvalue), rel=1e-10
    )
    assert line.significant == (known.pvalue < 0.0125)
    assert line.over_record == pytest.approx(7.0 * known.slope, rel=1e-12)
    scatter = math.sqrt(np.sum((forces - known.intercept - known.slope * np.arange(8.0)) ** 2) / 6)
    assert line.reach == pytest.approx(stats.t.ppf(0.975, 6) * scatter / math.sqrt(8), rel=1e-10)
    assert not drift(np.ones(5), 0.95, 1).significant


def test_forces_without_a_drift_rarely_have_one():
    rng = np.random.default_rng(5)
    sets = 1.0 + 0.01 * rng.standard_normal((4000, 4, 9))
    called = np.mean([any(drift(one, 0.95, 4).significant for one in four) for four in sets])
    # 1 − (1 − 0.05/4)⁴ = 0.0491; 4,000 sets know it to 0.0034
    assert called == pytest.approx(0.0491, abs=3.5 * 0.0034)


@pytest.mark.parametrize("grows", [0.0, 0.008])  # N in two cycles
def test_the_rows_of_a_record_show_a_friction_force_that_grows(grows):
    forces = (1.0 + grows * (np.arange(10) // 2)).tolist()
    known = {F: steady(Stopping(base=TWO, forward=F, back=F)) for F in {*forces}}
    cycles = [known[F] for F in forces]
    of = cycles[0].of
    t = np.arange(10_200) / 1000.0
    period = 2.0 * math.pi / of.omega
    which = np.minimum((t / period).astype(int), 9)
    x = np.choose(which, [one.x(t) for one in cycles]) + ZERO
    reading = reading_of(t, of.y(t), x, of.k, ("c_r",))
    line = drift(friction_of_rows(reading, {"c_r": of.c_r}), 0.95, 1)
    # the level of a rest is read to 1e-4 of the range; a cycle begins within a rest or a slip of the one before
    assert line.slope == pytest.approx(np.polyfit(np.arange(10), forces, 1)[0], abs=4e-4)
    assert line.significant == (grows > 0.0)


@pytest.mark.parametrize(
    ("records", "measured", "message"),
    [
        (3, {"mass_kg": None}, "frame: needs the mass of the records"),
        (2, {}, "loads_kg names 3 loads for 2 records"),
        (3, {"approaches": ["fourier"]}, "needs the approach direct"),
    ],
)
def test_what_does_not_fit_is_refused(records, measured, message):
    frame = {"loads_kg": [0.1, 0.2, 0.3], "cycles_identified": 5}
    of_set = {"stiffness_N_per_m": 1191.0, "mass_kg": 3.0} | measured
    with pytest.raises(ValueError, match=message):
        findings(["a"] * records, of_set, frame, {})


@pytest.mark.parametrize("loads", [3, 4, 5, 12])
def test_every_load_has_its_panels_with_letters_of_their_own(loads):
    t = np.linspace(0.0, 1.0, 9)
    loop = Loop(1.0, t, t, t, 0.0)
    rows = [{"record": f"{i} g", "F_k_N": 1.0} for i in range(loads)]
    cycles = Prediction(t, t, {"constant": t, "linear": t}, t)
    document = {"loads": rows, "speed_laws": {"constant": 0.08, "linear": 0.06}}
    figure = drawn_loops(Findings(document, (loop,) * loads, (cycles,) * loads))
    upper, lower = figure.axes[::2], figure.axes[1::2]
    letters = [axes.texts[0].get_text() for axes in (*upper, *lower)]
    assert letters == [f"({letter})" for letter in ascii_lowercase[: 2 * loads]]
    assert [axes.get_title() for axes in upper] == [row["record"] for row in rows]
    boxes = [axes.get_position() for axes in figure.axes]
    assert all(0.0 < box.x0 < box.x1 < 1.0 and 0.0 < box.y0 < box.y1 < 1.0 for box in boxes)
    for one, other in itertools.combinations(boxes, 2):
        assert one.x1 < other.x0 or other.x1 < one.x0 or one.y1 < other.y0 or other.y1 < one.y0
