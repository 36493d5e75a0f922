"""The contact: closed forms against the definition, step by step, which knows nothing of them, and the limits."""

from __future__ import annotations

import numpy as np
import pytest

from dampbalance.law.contact import Sliders, describing, play, secant


def stepped(x, r):
    """Deflections of sliders that follow a sampled motion, (N, j): exact where x is monotone between samples."""
    z, deflections = np.zeros(r.size), []
    for step in np.diff(x, prepend=0.0):
        z = np.clip(z + step, -r, r)
        deflections.append(z)
    return np.array(deflections)


THETA = 2.0 * np.pi * np.arange(4096) / 4096


def test_loss_is_the_area_of_the_hysteresis_and_the_quadrature_stiffness():
    sliders = Sliders(np.array([0.1, 0.4, 5.0]), np.array([2.0, 3.0, 1.0]))
    x = 1.3 * np.cos(np.concatenate([THETA, THETA, THETA[:1]]))
    force = stepped(x, sliders.r) @ sliders.kappa
    last = slice(THETA.size, None)
    area = float(np.sum(0.5 * (force[last][1:] + force[last][:-1]) * np.diff(x[last])))
    X = np.array([1.3])
    assert float(sliders.loss(X)[0]) == pytest.approx(area, rel=1e-5)
    assert float(np.pi * X[0] ** 2 * sliders.secant(X).imag[0]) == pytest.approx(area, rel=1e-5)
    # stiffness and friction are those of the first loading
    loading = stepped(np.array([0.0, 1e-3, 6.0]), sliders.r) @ sliders.kappa
    assert (sliders.K_z, sliders.F_k) == pytest.approx((loading[1] / 1e-3, loading[-1]))


def test_limits_are_a_spring_and_rigid_friction():
    X = np.array([0.2, 1.0])
    assert secant(X, np.array([1.0, 2.0])) == pytest.approx(np.ones((2, 2)))
    F, r = 0.7, 1e-9
    rigid = Sliders(np.array([r]), np.array([F / r])).secant(X)
    assert rigid.imag == pytest.approx(4.0 * F / (np.pi * X), rel=1e-8)
    # ϑ = 2√(r/X) is small: Re D = 2ϑ³/(3π)
    in_phase = (F / r) * (2.0 / (3.0 * np.pi)) * (2.0 * np.sqrt(r / X)) ** 3
    assert rigid.real == pytest.approx(in_phase, rel=1e-6)


@pytest.mark.parametrize("part", [1e-9, 1e-7, 2e-5, 3e-5, 0.1, 0.5, 0.999, 1.0, 3.0])
def test_describing_is_the_integral_of_its_definition(part):
    """From the reversal at X on the element falls by up to 2r and slips; the other half of the cycle is its mirror."""
    # x = cos θ, smooth on either side of the corner
    corner = np.arccos(1.0 - 2.0 * min(part, 1.0))
    nodes, weights = np.polynomial.legendre.leggauss(60)
    in_phase = quadrature = 0.0
    for low, high in ((0.0, corner), (corner, np.pi)):
        theta = 0.5 * (high - low) * nodes + 0.5 * (high + low)
        # 1 − cos θ of small angles
        z = np.maximum(min(part, 1.0) - 2.0 * np.sin(0.5 * theta) ** 2, -min(part, 1.0))
        w = (high - low) / np.pi * weights
        # a constant has no part in phase: taken off, what is left of a small element is not lost in rounding
        in_phase += w @ ((z + min(part, 1.0)) * np.cos(theta))
        quadrature -= w @ (z * np.sin(theta))
    D = complex(describing(part))
    assert secant(np.array([2.0]), np.array([2.0 * part])) == pytest.approx(D, rel=1e-14)
    assert D.imag == pytest.approx(quadrature, rel=1e-9, abs=1e-15)
    assert D.real == pytest.approx(in_phase, rel=1e-8)


X_T = np.cumsum(np.append(0.0, np.random.default_rng(1).normal(size=400)))


def test_play_is_that_of_single_steps_for_any_motion():
    some = np.array([0.3, 0.6, 2.0, 50.0])
    np.testing.assert_allclose(play(X_T, some).T, stepped(X_T, some), atol=1e-12)


def test_a_corner_between_samples_is_passed():
    x, through = np.array([0.0, 1.0, 1.0]), np.array([1.0, 1.4])
    assert play(x, 0.5, through)[0].tolist() == pytest.approx([0.0, 0.5, 0.1])


def test_a_gap_is_the_dead_band_of_its_definition():
    """Spring and gap in series: the slider drags the middle of both, which is at rest while the force is below κr."""
    r, g = 0.7, 0.4
    at, forces = 0.0, []
    for x in X_T:
        at = min(max(at, x - r - g), x + r + g)
        forces.append(np.sign(x - at) * max(abs(x - at) - g, 0.0))
    np.testing.assert_allclose(play(X_T, r, g=g)[0], forces, atol=1e-12)


def test_a_friction_that_falls_follows_the_speed():
    """In slip the force is F_k (1 + fall e^{−(v/v_S)²}), in stick that of the spring, under any load."""
    t = np.linspace(0.0, 3.0, 3001)
    x, v = np.sin(2.0 * np.pi * t), 2.0 * np.pi * np.cos(2.0 * np.pi * t)
    sliders = Sliders(np.array([0.2]), np.array([5.0]), fall=0.4, v_S=2.0)
    z = sliders.deflections(x, v, load=0.5)[0]
    limit = 0.1 * (1.0 + 0.4 * np.exp(-((v / 2.0) ** 2)))
    deflection, expected = 0.0, []
    for step, most in zip(np.diff(x, prepend=x[0]), limit, strict=True):
        deflection = np.clip(deflection + step, -most, most)
        expected.append(deflection)
    np.testing.assert_allclose(z, expected, atol=1e-12)
    assert np.abs(z).max() == pytest.approx(0.14, abs=2e-3)  # shortly after a reversal
    assert np.abs(z[1000]) == pytest.approx(0.1, abs=1e-3)  # at full speed


@pytest.mark.parametrize(("n", "law"), [(1.0, lambda s: 1.0 - np.exp(-s)), (2.0, np.tanh)])
def test_a_rounded_knee_follows_its_closed_form(n, law):
    """dz/dx = 1 − (z/r)ⁿ from rest; after the reversal at z_0 z falls by the way back to zero, then as from rest."""
    r, top = 0.2, 0.5
    up = np.linspace(0.0, top, 101)
    x = np.concatenate([up, top - 2.0 * up[1:]])
    z = play(x, r, n=n)[0]
    np.testing.assert_allclose(z[:101], r * law(up / r), atol=1e-8)  # steps of fourth order
    z_0, back = z[100], top - x[100:]
    later = np.where(back < z_0, z_0 - back, -r * law(np.maximum(back - z_0, 0.0) / r))
    np.testing.assert_allclose(z[100:], later, atol=1e-8)


def test_a_contact_of_dahl_follows_its_exponential_either_way():
    """dz/dx = 1 − (z/r) sgn ẋ: from rest, and back from z_0 along −r + (z_0 + r) e^{−s/r}."""
    r, s = 0.2, np.linspace(0.0, 0.5, 101)
    z = play(np.concatenate([s, 0.5 - s[1:]]), r, n=0.0)[0]
    np.testing.assert_allclose(z[:101], r * (1.0 - np.exp(-s / r)), atol=1e-12)
    np.testing.assert_allclose(z[100:], (z[100] + r) * np.exp(-s / r) - r, atol=1e-12)
