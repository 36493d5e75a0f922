"""Free decays whose motion is known, for tests of their fits."""

from __future__ import annotations

import math

import numpy as np

from dampbalance import Oscillator, transient
from dampbalance.fit.decay import STATE, Decay, DecayFit, DecayProblem
from dampbalance.fit.fit import Fit
from dampbalance.motion.unknowns import OSCILLATOR_UNKNOWNS
from dampbalance.signals.bursts import Signal


def decay_of(
    point: np.ndarray, k: float, t: np.ndarray, noise: float, order: int = 0, seed: int = 5
) -> Decay:
    """A decay with one channel: exact samples of a point, whose last three unknowns are the start state, and noise.

    noise : standard deviation; of a channel of order 1 or 2, in parts of its largest value.
    """
    F_k, c, rho, m = point[:4].tolist()
    x, v, w = point[-3:].tolist()
    oscillator = Oscillator(m, c, k, rho**-2, F_k)
    state = transient(oscillator, None, t[-1], x=x, v=v, z=(w - 1.0) * oscillator.Z_m).state(t)
    exact = (state.x, state.v, state.acceleration)[order]
    sigma = noise * np.abs(exact).max() if order else noise
    values = exact + sigma * np.random.default_rng(seed).standard_normal(t.size)
    signal = Signal("displacement", order, t, values, sigma)
    return Decay("", 0.0, float(t[-1]), (signal,), 2.0 * math.pi * math.sqrt(m / k))


def fitted(decay: Decay, k: float, point: np.ndarray) -> DecayFit:
    """The fit in which a climb from F_k, c, ρ, m, offset and start state of a decay ends."""
    problem = DecayProblem((decay,), k)
    values = dict(zip((*OSCILLATOR_UNKNOWNS, "offset", *STATE), point.tolist(), strict=True))
    fit = problem.climb(problem.parameters(values, OSCILLATOR_UNKNOWNS))
    assert fit is not None
    return fit


def off(fit: Fit, **truth: float) -> float:
    """How far numbers of a fit are from the truth, in standard errors: the farthest of them."""
    return max(abs(fit.value(name) - true) / fit.error(name) for name, true in truth.items())
