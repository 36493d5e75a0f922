"""Sliders in parallel: closed forms against the play operator, which knows nothing of them, and the limits."""

from __future__ import annotations

import numpy as np
import pytest

from dampbalance.law.contact import Sliders, secant


def play(x, r):
    """Deflections of sliders that follow a sampled motion, (N, j): exact where x is monotone between samples."""
    z, deflections = np.zeros(r.size), []
    for step in np.diff(x, prepend=0.0):
        z = np.clip(z + step, -r, r)
        deflections.append(z)
    return np.array(deflections)


THETA = 2.0 * np.pi * np.arange(4096) / 4096


def test_secant_is_the_fundamental_of_the_play_operator():
    X, r = np.array([0.3, 1.0, 2.0, 7.0]), np.array([0.2, 0.5, 1.0, 3.0])
    turn = np.exp(-1j * THETA)
    # of a second cycle, whose sliders are steady
    cycles = [play(each * np.cos(np.tile(THETA, 2)), r)[THETA.size :] for each in X]
    sampled = np.array(
        [turn @ z / (turn @ (x * np.cos(THETA))) for x, z in zip(X, cycles, strict=True)]
    )
    # a corner between two samples shifts the fundamental by the square of their distance
    assert secant(X, r) == pytest.approx(sampled, abs=2e-6)


def test_loss_is_the_area_of_the_hysteresis_and_the_quadrature_stiffness():
    sliders = Sliders(np.array([0.1, 0.4, 5.0]), np.array([2.0, 3.0, 1.0]))
    x = 1.3 * np.cos(np.concatenate([THETA, THETA, THETA[:1]]))
    force = play(x, sliders.r) @ sliders.kappa
    last = slice(THETA.size, None)
    area = float(np.sum(0.5 * (force[last][1:] + force[last][:-1]) * np.diff(x[last])))
    X = np.array([1.3])
    assert float(sliders.loss(X)[0]) == pytest.approx(area, rel=1e-5)
    assert float(np.pi * X[0] ** 2 * sliders.secant(X).imag[0]) == pytest.approx(area, rel=1e-5)


def test_limits_are_a_spring_and_rigid_friction():
    X = np.array([0.2, 1.0])
    assert secant(X, np.array([1.0, 2.0])) == pytest.approx(np.ones((2, 2)))
    F, r = 0.7, 1e-9
    rigid = Sliders(np.array([r]), np.array([F / r])).secant(X)
    assert rigid.imag == pytest.approx(4.0 * F / (np.pi * X), rel=1e-8)
    # ϑ = 2√(r/X) is small: Re D = 2ϑ³/(3π)
    in_phase = (F / r) * (2.0 / (3.0 * np.pi)) * (2.0 * np.sqrt(r / X)) ** 3
    assert rigid.real == pytest.approx(in_phase, rel=1e-6)


def test_stiffness_and_friction_are_those_of_the_first_loading():
    sliders = Sliders(np.array([0.1, 0.4, 5.0]), np.array([2.0, 3.0, 1.0]))
    loading = play(np.array([0.0, 1e-3, 6.0]), sliders.r) @ sliders.kappa
    assert sliders.K_z == pytest.approx(loading[1] / 1e-3)
    assert sliders.F_k == pytest.approx(loading[-1])
