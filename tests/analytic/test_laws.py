"""Laws that hold for every orbit: energy balance, orthogonality, similarity; far beyond any measured system every case
has one, and what is NaN has its reason. README.md, sections 7, 8 and 10."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import example, given, settings

from analytic.cases import dimensions, drawn, spread
from dampbalance import Regime, steady_orbits

FEATURES = ("X", "X_s", "V_s", "t_s", "phi", "a", "b", "W", "X_1", "phi_1", "X_3", "X_5")


# ζ, ω/ω_n, K_z/k, F_k/kY: the range the accuracy is promised for, and far beyond
PROMISED = ((0.02, 2.0), (0.3, 2.5), (2.0, 300.0), (0.01, 2.0))
WIDE = ((1e-4, 10.0), (0.05, 10.0), (0.01, 1e5), (1e-4, 10.0))


@pytest.fixture(scope="module", params=["promised", "wide", "undamped"])
def population(request):
    """(arguments, orbits, range) of thousands of cases."""
    zeta, *others = spread(1024, 1, *(PROMISED if request.param == "promised" else WIDE))
    arguments = dimensions(zeta * (request.param != "undamped"), *others)
    orbits = steady_orbits(**arguments)
    counts = np.bincount(orbits.regime, minlength=5)
    assert np.all(counts[[Regime.ONE_SLIP, Regime.SEVERAL_SLIPS, Regime.NO_SLIP]] > 10)
    return arguments, orbits, request.param


def assert_nan_has_its_reason(orbits):
    assert not np.any(orbits.regime == Regime.NOT_FOUND)
    for name in (*FEATURES, "phi_3", "phi_5"):
        expected = (orbits.regime == Regime.NO_SLIP) & (name in ("X_s", "V_s", "t_s"))
        np.testing.assert_array_equal(np.isnan(getattr(orbits, name)), expected, name)


def test_every_case_has_an_orbit(population):
    _, orbits, _ = population
    assert_nan_has_its_reason(orbits)
    assert np.all(orbits.X > 0.0)
    # no energy can come out; without damping and slip W is nought, and rounding of πkYX₁
    nought = orbits.W <= 0.0
    assert np.all(np.abs(orbits.W[nought]) <= 1e-14 * math.pi * orbits.X_1[nought])
    assert np.all(orbits.regime[nought] == Regime.NO_SLIP)


@pytest.mark.parametrize(
    ("zeta", "r", "K", "F"),
    [
        # resonance of both phases, of the stick phase alone, and at multiples of the drive, with damping and without
        ([[1.0], [0.0]], [1.0, 2.0, 0.2, 1.0 / 3.0], [1.0, 3.0, 24.0, 8.0], [1.0, 0.25, 0.5, 0.5]),
        # slow and stiff: the contact chatters at its own frequency, some 6000 times that of the drive
        ([1e-4, 1e-2], 0.05, 1e5, [0.5, 0.2]),
    ],
    ids=["resonances", "hundreds of events"],
)
def test_so_has_each_of_the_hardest(zeta, r, K, F):
    arrays = (np.array(of) for of in (zeta, r, K, F))
    assert_nan_has_its_reason(steady_orbits(**dimensions(*arrays)))


def test_energy_balance(population):
    # W = a F_k + b c: the three integrals are computed independently of each other
    arguments, o, kind = population
    dissipated = o.a * arguments["F_k"] + o.b * arguments["c"]
    # W is πkYX₁ sin φ₁ (k = Y = 1): where φ₁ is small, the rounding of the phase is all that is left of it
    product = math.pi * o.X_1
    # Far out, a hardly damped motion near a superharmonic resonance multiplies rounding by 1/ζ, up to 1e4; without any
    # damping by what a weak friction leaves, measured 4e-12.
    rounding = {"promised": 1e-15, "wide": 2e-12, "undamped": 2e-11}[kind]
    assert np.all(np.abs(o.W - dissipated) <= 1e-12 * o.W + rounding * product)
    slips = o.a > 0.0
    if kind == "promised":
        assert np.all(np.abs(o.W - dissipated)[slips] <= 1e-12 * o.W[slips])


def test_work_is_that_of_the_fundamental(population):
    # W = πkYX₁ sin φ₁ by orthogonality, k = Y = 1; φ₁ ≤ π is rounded to 4e-16 rad: room for five such errors
    _, o, _ = population
    np.testing.assert_allclose(
        o.W, math.pi * o.X_1 * np.sin(o.phi_1), rtol=1e-14, atol=2e-15 * math.pi * o.X_1.max()
    )


def test_viscous_integral_is_bounded_by_its_harmonics(population):
    # Parseval: b = πω Σ n²X_n² over all odd n, so the first three bound it from below (1e-12: rounding)
    arguments, o, _ = population
    omega = arguments["omega"]
    three = math.pi * omega * (o.X_1**2 + 9.0 * o.X_3**2 + 25.0 * o.X_5**2)
    assert np.all(o.b >= three * (1.0 - 1e-12))
    # and |ẋ| ≤ its largest value: b ≤ max|ẋ| ∮|ẋ| dt; without slip the orbit is harmonic and both are equal
    sticks = o.regime == Regime.NO_SLIP
    np.testing.assert_allclose(o.b[sticks], three[sticks], rtol=1e-12)


# --- similarity ----------------------------------------------------------------------------------


@settings(max_examples=40)
@given(*drawn(*PROMISED, (1e-26, 1e26), (1e-6, 1e6)))
@example(0.04417, 0.4204, 21.1, 0.4329, 1e-27, 1e3)
def test_forces_lengths_and_times_scale(zeta, r, K, F, length, rate):
    # only ratios matter: no threshold in metres or newtons hides anywhere; all forces times s leave the motion
    base = dimensions(zeta, r, K, F)
    scaled = base | {
        "Y": length,
        "F_k": length * base["F_k"],
        "omega": rate * base["omega"],
        "c": base["c"] / rate,
        "m": base["m"] / rate**2,
    }
    forced = base | {name: 2.0**7 * base[name] for name in ("m", "c", "k", "K_z", "F_k")}
    first, second, third = (steady_orbits(**of) for of in (base, scaled, forced))
    assert first.regime == second.regime == third.regime
    for name in FEATURES:  # a power of 2 leaves no rounding: bit for bit
        factor = 2.0**7 if name == "W" else 1.0
        np.testing.assert_array_equal(factor * getattr(first, name), getattr(third, name), name)
    speed = length * rate
    factors = {"X": length, "X_s": length, "V_s": speed, "t_s": 1.0 / rate, "phi": 1.0}
    factors |= {"a": length, "b": length * speed, "W": length**2}
    factors |= {"X_1": length, "phi_1": 1.0}
    for name, factor in factors.items():
        # 1e-11: what is promised; X_s may pass through zero and is held to X, a phase to the radian
        floor = 1e-11 * {"X_s": length * first.X, "phi": 1.0, "phi_1": 1.0}.get(name, 0.0)
        np.testing.assert_allclose(
            getattr(second, name), factor * getattr(first, name), rtol=1e-11, atol=floor
        )
