"""The records of a set: steady cycles sampled at any phase, each channel with independent noise."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from dampbalance.records.channel import Channel
from dampbalance.records.record import Record

from .cycles import Cycle, steady_cycle
from .truths import SEED, Truth

_DENSE = 4096  # phases that stand for a cycle
_NOISE = 1  # so that the noise is not drawn from the generator that drew the set


@dataclass(frozen=True, eq=False)
class Level:
    """The exact response at one level: what the records of it are drawn from."""

    truth: Truth
    level: int

    @cached_property
    def cycle(self) -> Cycle:
        """The steady cycle, without units."""
        truth, Y = self.truth, self.truth.Y[self.level]
        return steady_cycle(
            truth.zeta, truth.omega / truth.omega_n, truth.K_z / truth.k, truth.F_k / (truth.k * Y)
        )

    def signal(self, quantity: str, phase: np.ndarray) -> np.ndarray:
        """Return a channel without noise at phases ωt, SI."""
        truth = self.truth
        y = truth.Y[self.level] * np.cos(phase)
        if quantity == "base_displacement":
            return y
        if quantity == "base_acceleration":
            return -(truth.omega**2) * y
        if quantity == "force":
            return truth.k * y
        order = ("displacement", "velocity", "acceleration").index(quantity)
        return truth.Y[self.level] * truth.omega_n**order * self.cycle.state(phase)[order]

    def rms(self, quantity: str) -> float:
        """Return that of the channel without noise."""
        return float(np.sqrt(np.mean(self.signal(quantity, _phases()) ** 2)))

    def sigma(self, quantity: str) -> float:
        """Return standard deviation of the noise of a channel."""
        truth = self.truth
        if not truth.equal:
            return truth.noise * self.rms(quantity)
        others = [replace(self, level=j).rms(quantity) for j in range(len(truth.Y))]
        return truth.noise * float(np.median(others))

    @property
    def samples(self) -> int:
        """The value of each channel."""
        truth = self.truth
        return round(truth.cycles[self.level] * truth.rate_hz * 2.0 * math.pi / truth.omega)

    def third(self, quantity: str) -> float:
        """Return amplitude of the third harmonic of an answer over the standard error that the record gives it."""
        phase = _phases()
        amplitude = 2.0 * abs(np.mean(self.signal(quantity, phase) * np.exp(-3j * phase)))
        return float(amplitude / (self.sigma(quantity) * math.sqrt(2.0 / self.samples)))


def _phases() -> np.ndarray:
    return (np.arange(_DENSE) + 0.5) * (2.0 * math.pi / _DENSE)


def levels(truth: Truth) -> list[Level]:
    """Return the levels of a set, in the order of their amplitudes."""
    return [Level(truth, i) for i in range(len(truth.Y))]


def record(level: Level, seed: int | tuple[int, ...] | None = None) -> Record:
    """Return the record of one level, with the noise of (seed, set, level, channel).   seed : default, that of the
    set."""
    truth = level.truth
    t = np.arange(level.samples) / truth.rate_hz
    phase = truth.omega * t + 2.0 * math.pi * truth.start[level.level]
    channels = []
    for place, quantity in enumerate((truth.drive, *truth.answers)):
        key = (_NOISE, *np.atleast_1d(SEED if seed is None else seed).tolist())
        random = np.random.default_rng((*key, truth.index, level.level, place))
        values = level.signal(quantity, phase)
        values += level.sigma(quantity) * random.standard_normal(values.size)
        channels.append(Channel(quantity, t, values))
    return Record.of(f"set {truth.index}, level {level.level + 1}", channels)


def records(truth: Truth, seed: int | tuple[int, ...] | None = None) -> list[Record]:
    """Return the records of a set, one for each level."""
    return [record(level, seed) for level in levels(truth)]
