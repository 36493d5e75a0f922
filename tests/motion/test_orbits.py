"""Many steady orbits at once: the same numbers as one by one, in any shape, on any number of threads."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from matplotlib import colormaps, pyplot

from analytic.cases import dimensions, drawn, orbit_of
from dampbalance import NoSteadyOrbit, Orbits, Regime, steady_orbits
from dampbalance.motion.orbits import _BLOCK
from paper_case import PAPER

NAMES = [field.name for field in dataclasses.fields(Orbits) if field.name != "given"]
MODEL = ("m", "c", "k", "K_z", "F_k")
PAPER_CASE = {name: getattr(PAPER, name) for name in MODEL} | {"Y": 0.004, "omega": 30.9}


def one_by_one(**numbers):
    """Every field of `Orbits` for one case, from `steady_orbit`."""
    try:
        orbit = orbit_of(**numbers)
    except NoSteadyOrbit:
        return dict.fromkeys(NAMES, math.nan) | {"regime": 0}
    values = {n: getattr(orbit, n) for n in NAMES if hasattr(orbit, n)}
    for n in (1, 3, 5):
        values[f"X_{n}"], values[f"phi_{n}"] = orbit.harmonic(n)
    return values


def random_cases(n, seed=0):
    rng = np.random.default_rng(seed)
    zeta, r, K, F = (
        low * (high / low) ** rng.random(n)
        for low, high in ((1e-3, 3.0), (0.2, 3.0), (0.1, 1e3), (1e-3, 3.0))
    )
    return dimensions(zeta, r, K, F)


@settings(max_examples=40)
@given(*drawn((1e-4, 10.0), (0.05, 10.0), (0.01, 1e5), (1e-4, 10.0)))
@example(0.02377, 0.3433, 132.3, 0.03655)  # several slips
@example(0.4, 0.8, 10.0, 0.0)
@example(0.3, 0.7, 5.0, 3.0)
@example(0.0, 1.0, 10.0, 0.1)  # no orbit
def test_one_case_bit_for_bit(zeta, r, K, F):
    numbers = dimensions(zeta, r, K, F)
    many, one = steady_orbits(**numbers), one_by_one(**numbers)
    for name in NAMES:
        bits = [np.float64(value).tobytes() for value in (getattr(many, name)[()], one[name])]
        assert bits[0] == bits[1], name


def test_a_linear_resonance_is_kY_over_c_omega():
    """Whatever the units: here the impedance is a tenth of a newton per metre, and of a stuck contact a hundredth."""
    free = steady_orbits(m=1.0, c=0.1, k=1.0, K_z=10.0, F_k=0.0, Y=1.0, omega=1.0)
    assert (free.X, free.regime) == (pytest.approx(10.0), Regime.NO_FRICTION)
    stuck = steady_orbits(m=1.0, c=0.005, k=1.0, K_z=3.0, F_k=1e4, Y=1.0, omega=2.0)
    assert (stuck.X, stuck.regime) == (pytest.approx(100.0), Regime.NO_SLIP)
    endless = steady_orbits(m=1.0, c=0.0, k=1.0, K_z=10.0, F_k=0.0, Y=1.0, omega=1.0)
    assert endless.regime == Regime.NOT_FOUND
    assert all(math.isnan(getattr(endless, name)) for name in NAMES if name != "regime")


def test_a_case_depends_on_neither_threads_nor_neighbours():
    # more than two blocks, so that the threads do share them
    cases = random_cases(2 * _BLOCK + 17)
    reference = steady_orbits(**cases, threads=1)
    assert len(np.unique(reference.regime)) == 3
    chosen = np.array([0, 7, _BLOCK - 1, _BLOCK, 2 * _BLOCK + 4])
    some = steady_orbits(**{n: v[chosen] if np.ndim(v) else v for n, v in cases.items()})
    for threads in (3, None):
        others = steady_orbits(**cases, threads=threads)
        for name in NAMES:
            assert getattr(others, name).tobytes() == getattr(reference, name).tobytes(), name
            np.testing.assert_array_equal(getattr(some, name), getattr(others, name)[chosen], name)


@pytest.mark.parametrize(
    ("shapes", "expected"),
    [
        ({}, ()),
        ({"Y": (5,), "omega": (3, 1)}, (3, 5)),
        ({"Y": (2, 1, 1), "c": (3, 1), "F_k": (4,)}, (2, 3, 4)),
        ({"Y": (0,), "omega": (3, 1)}, (3, 0)),
    ],
    ids=str,
)
def test_shapes(shapes, expected):
    rng = np.random.default_rng(1)
    cases = PAPER_CASE | {
        name: PAPER_CASE[name] * rng.uniform(0.8, 1.2, shape) for name, shape in shapes.items()
    }
    orbits = steady_orbits(**cases)
    for name in NAMES:
        assert getattr(orbits, name).shape == expected, name
        assert getattr(orbits, name).dtype == (np.uint8 if name == "regime" else np.float64)
    full = {name: np.broadcast_to(value, expected) for name, value in cases.items()}
    for index in np.ndindex(expected):
        one = one_by_one(**{name: float(value[index]) for name, value in full.items()})
        assert orbits.W[index] == one["W"]
        assert orbits.X_3[index] == one["X_3"]


def test_no_orbit_is_nan_with_its_code_among_others():
    # undamped, at resonance, friction too weak: between two ordinary cases
    numbers = dimensions(np.array([0.1, 0.0, 0.1]), 1.0, 10.0, 0.1)
    orbits = steady_orbits(**numbers)
    np.testing.assert_array_equal(orbits.regime, [1, Regime.NOT_FOUND, 1])
    for name in NAMES[:-1]:
        np.testing.assert_array_equal(np.isnan(getattr(orbits, name)), [False, True, False], name)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"m": 0.0}, "^m must be a positive number of kg, .*, got 0.0"),
        (
            {"K_z": [[1.0, math.inf], [-1.0, 2.0]]},
            "^K_z must be a positive number of N/m, .*, got inf",
        ),
        (
            {"c": [90.0, math.nan]},
            "^c must be a number of N s/m, 0 to .*, got nan .missing or masked",
        ),
        ({"F_k": "1.28"}, "^F_k must be a number of N"),
        ({"Y": [None, 1.0]}, "^Y must be a positive number of m"),
        ({"omega": True}, "^omega must be a positive number of rad/s"),
        ({"Y": [1.0, 2.0], "c": [1.0, 2.0, 3.0]}, r"broadcast to one shape: .*c \(3,\).*Y \(2,\)"),
        ({"threads": 0}, "threads must be a whole number, 1 to .*, got 0"),
        ({"device": "gpu"}, "device must be one of cpu, cuda"),
    ],
)
def test_what_makes_no_sense_is_refused(wrong, message):
    with pytest.raises(ValueError, match=message):
        steady_orbits(**PAPER_CASE | wrong)


AT_TWO_LEVELS = PAPER_CASE | {"Y": [[0.0002], [0.004]], "omega": [22.0, 31.0, 40.0]}


def test_they_show_values_first_and_all_in_a_frame():
    orbits = steady_orbits(**AT_TWO_LEVELS)
    assert orbits.varied == ("Y", "omega")
    first, second, *_ = repr(orbits).splitlines()
    assert first == "Orbits  shape (2, 3)"
    assert second.startswith(f"    Y = 0.0002 m, omega = 22 rad/s:  X = {orbits.X[0, 0]:.4g} m")
    assert second.endswith("no slip: the contact only sticks")
    assert repr(orbits).endswith("… and 1 more")
    frame = orbits.to_frame()
    assert frame["Y_m"].tolist() == [0.0002] * 3 + [0.004] * 3
    assert frame["omega_rad_per_s"].tolist() == [22.0, 31.0, 40.0] * 2
    np.testing.assert_array_equal(frame["b_m2_per_s"], orbits.b.ravel())
    assert frame["regime"].tolist() == [str(Regime(code)) for code in orbits.regime.ravel()]
    assert f"{orbits.X[1, 2]:.6g}" in orbits._repr_html_()


@pytest.mark.parametrize(
    ("low", "high", "scale"),
    [(20.0, 40.0, np.asarray), (12.0, 130.0, np.log)],  # over a decade by the logarithm
)
def test_many_lines_are_coloured_by_the_argument_of_most_values(low, high, scale):
    omegas = np.linspace(low, high, 40)
    orbits = steady_orbits(PAPER, Y=np.linspace(0.004, 0.012, 50)[:, None], omega=omegas)
    axes = orbits.plot("phi_zero_crossing", "Y")
    (bar,) = (other for other in axes.figure.axes if other is not axes)
    assert bar.get_ylim() == pytest.approx((low, high))
    place = (scale(omegas) - scale(low)) / (scale(high) - scale(low))
    colours = [line.get_color() for line in axes.get_lines()]
    # one of 256 colours: neighbours differ by less than 0.02
    np.testing.assert_allclose(colours, colormaps["viridis"](place), atol=0.02)
    assert axes.get_legend() is None
    assert len(orbits.plot("X", "Y", color="k").figure.axes) == 1
    pyplot.close("all")


def test_a_feature_is_drawn_against_what_varies():
    orbits = steady_orbits(**AT_TWO_LEVELS)
    axes = orbits.plot()  # the frequencies are more
    for level, line in enumerate(axes.get_lines()):
        np.testing.assert_array_equal(line.get_xydata().T, [[22.0, 31.0, 40.0], orbits.X[level]])
    names = [text.get_text() for text in axes.get_legend().texts]
    assert names == ["$Y$ = 0.0002 m", "$Y$ = 0.004 m"]
    both = steady_orbits(**{**AT_TWO_LEVELS, "Y": [0.012, 0.004], "omega": [22.0, 31.0]})
    (line,) = both.plot("X", "Y").get_lines()  # they vary together: one line, from left to right
    np.testing.assert_array_equal(line.get_ydata(), both.X[::-1])
    pyplot.close("all")
    with pytest.raises(ValueError, match=r"feature must be one of X, .* got 'Q'"):
        orbits.plot("Q")
    with pytest.raises(ValueError, match="against must be one of Y, omega, got 'k'"):
        orbits.plot("X", "k")
    with pytest.raises(ValueError, match="nothing varies in these orbits: give arrays"):
        steady_orbits(**{**AT_TWO_LEVELS, "Y": 0.004, "omega": 22.0}).plot()
