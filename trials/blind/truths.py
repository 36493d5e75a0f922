"""Content of the blind set: each set of records drawn by (seed, index) alone."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

DRIVES = ("base_displacement", "base_acceleration", "force")
ANSWERS = ("displacement", "velocity", "acceleration")
NOISE = (0.001, 0.01, 0.05)
"""White noise of each channel, as a part of its rms."""

SEED = 2010

# One set in thirty, each: nothing slips at any level; several slips per half cycle and long stops.
_EVERY, _NOTHING, _SEVERAL = 30, 14, 29


class Linear:
    """The oscillator of a set without its contact."""

    m: float
    c: float
    k: float

    @property
    def omega_n(self) -> float:
        """√(k/m), rad/s."""
        return math.sqrt(self.k / self.m)

    @property
    def zeta(self) -> float:
        """c/(2 √(k m))."""
        return self.c / (2.0 * math.sqrt(self.k * self.m))


@dataclass(frozen=True)
class Truth(Linear):
    """One set: an oscillator, its levels, and how they are measured. SI units.

    kind : "model" of the design, "nothing slips", "several slips" (ζ at most 0.05, ω/ω_n 0.22–0.4).
    Y : amplitudes of the base, m.
    cycles, start : length of each record, and where in the cycle it begins, in cycles.   rate_hz : samples per second.
    answers : channels of the mass.   noise : part of the rms.
    equal : whether the noise of a channel is the same at all levels, of the median of its rms, or relative to each.
    """

    index: int
    kind: str
    m: float
    c: float
    k: float
    K_z: float
    F_k: float
    Y: tuple[float, ...]
    omega: float
    cycles: tuple[float, ...]
    start: tuple[float, ...]
    rate_hz: float
    drive: str
    answers: tuple[str, ...]
    noise: float
    equal: bool

    def parameter(self, symbol: str) -> float:
        """Return the true value of F_k, c, K_z or m."""
        return float(getattr(self, symbol))


def log_uniform(random: np.random.Generator) -> Callable[[float, float], float]:
    """Return draws a number between two others, its logarithm uniform."""
    return lambda low, high: float(math.exp(random.uniform(math.log(low), math.log(high))))


def draw(index: int, seed: int = SEED) -> Truth:
    """Set number `index` ≥ 0 of the blind set."""
    random = np.random.default_rng((seed, index))

    spread = log_uniform(random)
    place = index % _EVERY
    kind = {_NOTHING: "nothing slips", _SEVERAL: "several slips"}.get(place, "model")
    m, f_n = spread(0.1, 10.0), spread(1.0, 50.0)
    omega_n = 2.0 * math.pi * f_n
    k = m * omega_n**2
    zeta, K = spread(0.005, 0.5), spread(3.0, 300.0)
    r = spread(0.5, 2.5) if random.random() < 0.5 else float(random.uniform(0.5, 2.5))
    levels, ratio = int(random.integers(3, 7)), float(random.uniform(2.0, 6.0))
    Y = spread(1e-4, 1e-2) * np.geomspace(1.0 / ratio, 1.0, levels)
    friction = spread(0.01, 0.5) * k * Y[int(random.integers(levels))]
    if kind == "several slips":
        zeta, r, K = spread(0.005, 0.05), spread(0.22, 0.4), spread(10.0, 300.0)
    elif kind == "nothing slips":
        # the contact holds 1.05 to 5 times what the highest level asks of it
        stiff = 1.0 + K - r * r
        friction = K * k * Y[-1] / math.hypot(stiff, 2.0 * zeta * r) * spread(1.05, 5.0)
    answers = tuple(random.permutation(ANSWERS)[: 2 if random.random() < 0.15 else 1].tolist())
    omega = r * omega_n
    return Truth(
        index=index,
        kind=kind,
        m=m,
        c=2.0 * zeta * math.sqrt(k * m),
        k=k,
        K_z=K * k,
        F_k=float(friction),
        Y=tuple(Y.tolist()),
        omega=omega,
        cycles=tuple(random.uniform(50.0, 200.0, levels).tolist()),
        start=tuple(random.uniform(0.0, 1.0, levels).tolist()),
        rate_hz=spread(50.0, 400.0) * omega / (2.0 * math.pi),
        drive=str(random.choice(DRIVES)),
        answers=tuple(answer for answer in ANSWERS if answer in answers),
        noise=float(random.choice(NOISE)),
        equal=bool(random.random() < 0.3),
    )
