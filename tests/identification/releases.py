"""The oscillator whose releases the tests of free decays begin with."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numba import njit

from blind.decays import draw
from dampbalance.records.channel import Channel
from dampbalance.records.record import Record

# of an estimate: once in 16,000 of normal errors; the records are fixed
FAR = 4.0
PLUCKED = replace(
    draw(0),
    **{"m": 1.0, "c": 0.3, "k": 400.0, "K_z": 6000.0, "F_k": 0.1},
    **{"starts": (("pluck", 0.005),), "lead": (0.2,), "lasts": (5.0,), "pull": (0.4,)},
    **{"rate_hz": 500.0, "answers": ("displacement",), "noise": 0.01},
)


@njit(cache=True)
def _struck(numbers, impulse, start, lasts, step, samples, finer):
    """(x, x′, x″) of a mass at rest under a hammer's pulse of half a sine, by Euler's symplectic method."""
    m, c, k, K_z, F_k = numbers
    out, h, limit = np.zeros((3, samples)), step / finer, F_k / K_z
    x = v = z = 0.0
    for i in range(samples * finer):
        t = i * h - start
        pushes = 0.0 < t < lasts
        push = impulse * math.pi / (2.0 * lasts) * math.sin(math.pi * t / lasts) if pushes else 0.0
        a = (push - c * v - k * x - K_z * z) / m
        if i % finer == 0:
            out[0, i // finer], out[1, i // finer], out[2, i // finer] = x, v, a
        v += h * a
        x += h * v
        z = min(max(z + h * v, -limit), limit)
    return out


def struck(decay, instant, lasts, cycles=8.0, noise=1e-3):
    """The acceleration of a mass that a hammer strikes an instant after the first sample, both times in cycles."""
    period = 2.0 * math.pi / decay.omega_n
    numbers = (decay.m, decay.c, decay.k, decay.K_z, decay.F_k)
    impulse, samples = decay.m * 0.1, round(cycles * period * decay.rate_hz)
    # 50 steps of the ringing of the stuck mass a cycle: 1 % of the noise
    motion = _struck(
        numbers, impulse, instant * period, lasts * period, 1.0 / decay.rate_hz, samples, 50
    )
    values = motion[2]
    spread = noise * np.abs(values).max() * np.random.default_rng(1).standard_normal(samples)
    return Record.of(
        "struck", [Channel("acceleration", np.arange(samples) / decay.rate_hz, values + spread)]
    )
