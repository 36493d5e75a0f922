"""Many steady orbits at once: the same numbers as one by one, in any shape, on any number of threads."""

from __future__ import annotations

import dataclasses
import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from hypothesis import given, settings
from matplotlib import colormaps, pyplot

from analytic.cases import SEVERAL_SLIPS, dimensions, drawn, orbit_of
from dampbalance import (
    NoSteadyOrbit,
    Orbits,
    Regime,
    steady_orbits,
)
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


@settings(max_examples=80)
@given(*drawn((1e-4, 10.0), (0.05, 10.0), (0.01, 1e5), (1e-4, 10.0)))
def test_one_case_bit_for_bit(zeta, r, K, F):
    assert_same_bits(zeta, r, K, F)


@pytest.mark.parametrize(
    "numbers",
    [*SEVERAL_SLIPS, (0.4, 0.8, 10.0, 0.0), (0.3, 0.7, 5.0, 3.0), (0.0, 1.0, 10.0, 0.1)],
    ids=str,
)
def test_every_regime_bit_for_bit(numbers):
    assert_same_bits(*numbers)


def assert_same_bits(*numbers):
    many, one = steady_orbits(**dimensions(*numbers)), one_by_one(**dimensions(*numbers))
    for name in NAMES:
        bits = [np.float64(value).tobytes() for value in (getattr(many, name)[()], one[name])]
        assert bits[0] == bits[1], name


@pytest.mark.parametrize(
    ("numbers", "regime"),
    [
        ((0.4, 0.8, 10.0, 0.3), Regime.ONE_SLIP),
        (next(iter(SEVERAL_SLIPS)), Regime.SEVERAL_SLIPS),
        ((0.3, 0.7, 5.0, 3.0), Regime.NO_SLIP),
        ((0.4, 0.8, 10.0, 0.0), Regime.NO_FRICTION),
    ],
    ids=str,
)
def test_the_zero_crossing_is_where_x_crosses_zero(numbers, regime):
    """It lags a quarter period and φ behind the peak of the base; as `Orbit` has it, and as x(t) does it."""
    numbers = dimensions(*numbers)
    many = steady_orbits(**numbers)
    assert many.regime == regime
    orbit = orbit_of(**numbers)
    assert many.phi_zero_crossing == orbit.phi_zero_crossing
    at = (many.phi_zero_crossing - 0.5 * math.pi) / numbers["omega"] + orbit.motion.period
    small = 1e-6 * orbit.motion.period
    before, there, after = orbit.state(np.array([at - small, at, at + small])).x
    assert abs(there) < 1e-13 * orbit.X
    assert before < 0.0 < after


def test_a_linear_resonance_is_kY_over_c_omega():
    """Whatever the units: here the impedance is a tenth of a newton per metre, and of a stuck contact a hundredth."""
    free = steady_orbits(m=1.0, c=0.1, k=1.0, K_z=10.0, F_k=0.0, Y=1.0, omega=1.0)
    assert (free.X, free.regime) == (pytest.approx(10.0), Regime.NO_FRICTION)
    stuck = steady_orbits(m=1.0, c=0.005, k=1.0, K_z=3.0, F_k=1e4, Y=1.0, omega=2.0)
    assert (stuck.X, stuck.regime) == (pytest.approx(100.0), Regime.NO_SLIP)
    endless = steady_orbits(m=1.0, c=0.0, k=1.0, K_z=10.0, F_k=0.0, Y=1.0, omega=1.0)
    assert endless.regime == Regime.NOT_FOUND
    assert all(math.isnan(getattr(endless, name)) for name in NAMES if name != "regime")


@pytest.mark.parametrize(("threads", "started"), [(1, 1), (3, 3)])
def test_as_many_threads_are_used_as_are_asked_for(monkeypatch, threads, started):
    asked = []

    class Pool(ThreadPoolExecutor):
        def __init__(self, max_workers):
            asked.append(max_workers)
            super().__init__(max_workers)

    monkeypatch.setattr("dampbalance.motion.orbits.ThreadPoolExecutor", Pool)
    steady_orbits(**PAPER_CASE, threads=threads)
    assert asked == [started]


@pytest.mark.parametrize("threads", [0, -2])
def test_no_thread_is_no_number_of_threads(threads):
    with pytest.raises(ValueError, match=f"threads must be a whole number, 1 to .*, got {threads}"):
        steady_orbits(**PAPER_CASE, threads=threads)


def test_any_number_of_threads_gives_the_same_bytes():
    # more than two blocks, so that the threads do share them
    cases = random_cases(2 * _BLOCK + 17)
    reference = steady_orbits(**cases, threads=1)
    assert len(np.unique(reference.regime)) == 3
    for threads in (2, 3, 8, None):
        others = steady_orbits(**cases, threads=threads)
        for name in NAMES:
            assert getattr(others, name).tobytes() == getattr(reference, name).tobytes(), name


def test_a_case_does_not_depend_on_its_neighbours():
    cases = random_cases(_BLOCK + 5)
    whole = steady_orbits(**cases)
    chosen = np.array([0, 7, _BLOCK - 1, _BLOCK, _BLOCK + 4])
    some = steady_orbits(**{n: v[chosen] if np.ndim(v) else v for n, v in cases.items()})
    for name in NAMES:
        np.testing.assert_array_equal(getattr(some, name), getattr(whole, name)[chosen], name)


@pytest.mark.parametrize(
    ("shapes", "expected"),
    [
        ({}, ()),
        ({"Y": (1,)}, (1,)),
        ({"Y": (5,)}, (5,)),
        ({"Y": (5,), "omega": (3, 1)}, (3, 5)),
        ({"Y": (2, 1, 1), "c": (3, 1), "F_k": (4,)}, (2, 3, 4)),
        ({"Y": (0,)}, (0,)),
        ({"Y": (0,), "omega": (3, 1)}, (3, 0)),
        (
            {"m": (2,), "c": (2,), "k": (2,), "K_z": (2,), "F_k": (2,), "Y": (2,), "omega": (2,)},
            (2,),
        ),
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
        assert isinstance(getattr(orbits, name), np.ndarray)
        assert getattr(orbits, name).shape == expected, name
        assert getattr(orbits, name).dtype == (np.uint8 if name == "regime" else np.float64)
    full = {name: np.broadcast_to(value, expected) for name, value in cases.items()}
    for index in np.ndindex(expected):
        one = one_by_one(**{name: float(value[index]) for name, value in full.items()})
        assert orbits.W[index] == one["W"]
        assert orbits.X_3[index] == one["X_3"]


def test_lists_integers_and_views_are_taken_as_they_are():
    Y = np.linspace(0.004, 0.012, 9)
    expected = steady_orbits(**PAPER_CASE | {"Y": Y[::2]}).X
    backwards = np.ascontiguousarray(Y[::-2])[::-1]
    for same in (list(Y[::2]), tuple(Y[::2]), backwards):
        np.testing.assert_array_equal(steady_orbits(**PAPER_CASE | {"Y": same}).X, expected)
    whole = steady_orbits(**PAPER_CASE | {"c": np.array([90, 91])}).X
    np.testing.assert_array_equal(whole, steady_orbits(**PAPER_CASE | {"c": [90.0, 91.0]}).X)


def test_inputs_are_left_alone():
    Y = np.linspace(0.004, 0.012, 5)
    Y.flags.writeable = False
    before = Y.tobytes()
    steady_orbits(**PAPER_CASE | {"Y": Y})
    assert Y.tobytes() == before


def test_no_orbit_is_nan_with_its_code_among_others():
    # undamped, at resonance, friction too weak: between two ordinary cases
    numbers = dimensions(np.array([0.1, 0.0, 0.1]), 1.0, 10.0, 0.1)
    orbits = steady_orbits(**numbers)
    np.testing.assert_array_equal(orbits.regime, [1, Regime.NOT_FOUND, 1])
    for name in NAMES[:-1]:
        np.testing.assert_array_equal(np.isnan(getattr(orbits, name)), [False, True, False], name)


BAD = (0.0, -1.0, math.nan, math.inf, -math.inf, "1e-6", ["a"], True, None, 1j, [None, 1.0])


@pytest.mark.parametrize("name", PAPER_CASE)
@pytest.mark.parametrize("bad", BAD, ids=repr)
def test_bad_values_name_the_argument(name, bad):
    may_be_zero, got = name in ("c", "F_k"), f"{bad}" if isinstance(bad, float) else ""
    if may_be_zero and bad == 0.0:
        assert steady_orbits(**PAPER_CASE | {name: bad}).X > 0.0
        return
    bound = "a number" if may_be_zero else "a positive number"
    among = np.where(np.arange(6).reshape(2, 3) == 4, bad, PAPER_CASE[name]) if got else bad
    for value in (bad, among):
        with pytest.raises(ValueError, match=f"^{name} must be {bound} of .*, got {got}"):
            steady_orbits(**PAPER_CASE | {name: value})


def test_shapes_that_do_not_fit_are_named():
    with pytest.raises(ValueError, match=r"do not broadcast to one shape: .*c \(3,\).*Y \(2,\)"):
        steady_orbits(**PAPER_CASE | {"Y": [0.004, 0.006], "c": [1.0, 2.0, 3.0]})


def test_arguments_are_named():
    with pytest.raises(TypeError, match="positional"):
        steady_orbits(*PAPER_CASE.values())
    with pytest.raises(TypeError, match="omega"):
        steady_orbits(**{n: v for n, v in PAPER_CASE.items() if n != "omega"})


AT_TWO_LEVELS = PAPER_CASE | {"Y": [[0.0002], [0.004]], "omega": [22.0, 31.0, 40.0]}


def test_they_show_values_first_and_all_in_a_frame():
    orbits = steady_orbits(**AT_TWO_LEVELS)
    assert orbits.varied == ("Y", "omega")
    first, second = repr(orbits).splitlines()[:2]
    assert first == "Orbits  shape (2, 3)"
    assert second.startswith(
        f"    Y = 0.0002 m, omega = 22 rad/s:  X = {orbits.X[0, 0]:.4g} m, φ = "
    )
    assert second.endswith("no slip: the contact only sticks")
    assert repr(orbits).endswith("… and 1 more")
    frame = orbits.to_frame()
    assert frame["Y_m"].tolist() == [0.0002] * 3 + [0.004] * 3
    assert frame["omega_rad_per_s"].tolist() == [22.0, 31.0, 40.0] * 2
    np.testing.assert_array_equal(frame["b_m2_per_s"], orbits.b.ravel())
    assert frame["regime"].tolist() == [str(Regime(code)) for code in orbits.regime.ravel()]
    assert f"{orbits.X[1, 2]:.6g}" in orbits._repr_html_()
    assert repr(steady_orbits(**{**AT_TWO_LEVELS, "Y": [], "omega": 22.0})) == "Orbits  shape (0,)"


@pytest.mark.parametrize(
    ("low", "high", "scale"),
    [(20.0, 40.0, np.asarray), (12.0, 130.0, np.log)],  # over a decade by the logarithm
)
def test_many_lines_are_coloured_by_the_argument_of_most_values(low, high, scale):
    omegas = np.linspace(low, high, 40)
    orbits = steady_orbits(PAPER, Y=np.linspace(0.004, 0.012, 50)[:, None], omega=omegas)
    axes = orbits.plot("phi_zero_crossing", "Y")
    assert axes.get_ylabel() == r"$\varphi_{\mathrm{zero\ crossing}}$ (rad)"
    (bar,) = (other for other in axes.figure.axes if other is not axes)
    assert bar.get_ylabel() == r"$\omega$ (rad/s)"
    assert bar.get_ylim() == pytest.approx((low, high))
    place = (scale(omegas) - scale(low)) / (scale(high) - scale(low))
    colours = [line.get_color() for line in axes.get_lines()]
    # one of 256 colours: neighbours differ by less than 0.02
    np.testing.assert_allclose(colours, colormaps["viridis"](place), atol=0.02)
    assert axes.get_legend() is None
    plain = orbits.plot("X", "Y", color="k")
    assert len(plain.figure.axes) == 1
    pyplot.close("all")


def test_a_feature_is_drawn_against_what_varies():
    orbits = steady_orbits(**AT_TWO_LEVELS)
    axes = orbits.plot()  # the frequencies are more
    assert axes.get_xlabel() == r"$\omega$ (rad/s)"
    for level, line in enumerate(axes.get_lines()):
        np.testing.assert_array_equal(line.get_xydata().T, [[22.0, 31.0, 40.0], orbits.X[level]])
    assert [text.get_text() for text in axes.get_legend().texts] == [
        "$Y$ = 0.0002 m",
        "$Y$ = 0.004 m",
    ]
    other = pyplot.figure().add_subplot()
    assert orbits.plot("W", "Y", ax=other, color="r") is other
    assert [line.get_color() for line in other.get_lines()] == ["r"] * 3
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
