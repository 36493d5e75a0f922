"""The cases that every method solves: the paper's oscillator, f from 3 to 12 Hz, Y from 4 to 12 mm."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.stats import qmc

from dampbalance import BaseMotion, steady_orbit
from dampbalance.model import parameters
from dampbalance.motion.events import PHASE_S, PHASE_T
from paper_case import PAPER

FREQUENCIES_HZ = (3.0, 12.0)
LEVELS_M = (0.004, 0.012)
FEATURES = ("X", "V_s", "t_s", "phi", "a", "b", "W")  # what each method has to deliver
SEED = 2010


@dataclass(frozen=True)
class Sweep:
    """n cases, spread over the sweep so that the first few stand for the whole. Y : m.   omega : rad/s."""

    Y: np.ndarray
    omega: np.ndarray

    def __len__(self) -> int:
        return len(self.Y)

    def take(self, n: int) -> Sweep:
        return Sweep(self.Y[:n], self.omega[:n])

    def motions(self) -> list[BaseMotion]:
        return [BaseMotion(float(Y), float(w)) for Y, w in zip(self.Y, self.omega, strict=True)]

    def arguments(self) -> dict[str, float | np.ndarray]:
        """Return arguments of `steady_orbits`."""
        o = PAPER
        fixed = {name: getattr(o, name) for name in ("m", "c", "k", "K_z", "F_k")}
        return {**fixed, "Y": self.Y, "omega": self.omega}


def sweep(n: int) -> Sweep:
    """Return the first n points of a Sobol sequence over the sweep."""
    points = qmc.Sobol(2, rng=np.random.default_rng(SEED)).random_base2(math.ceil(math.log2(n)))[:n]
    (f_low, f_high), (Y_low, Y_high) = FREQUENCIES_HZ, LEVELS_M
    return Sweep(
        Y_low + (Y_high - Y_low) * points[:, 0],
        2.0 * math.pi * (f_low + (f_high - f_low) * points[:, 1]),
    )


class Guess(NamedTuple):
    """The reversal at −X of the motion whose velocity is harmonic, against a rigid Coulomb contact. theta : rad."""

    X: float
    theta: float


def good_guess(motion: BaseMotion) -> Guess:
    """Return (k − mω²)² X² + (cωX + 4F_k/π)² = (kY)²,  tan φ = (cωX + 4F_k/π) / ((k − mω²) X),  θ = φ − π."""
    o, w = PAPER, motion.omega
    reactance, resistance, friction = o.k - o.m * w * w, o.c * w, 4.0 * o.F_k / math.pi
    square = reactance**2 + resistance**2
    half = resistance * friction
    X = (math.sqrt(half**2 + square * ((o.k * motion.Y) ** 2 - friction**2)) - half) / square
    return Guess(X, math.atan2(resistance * X + friction, reactance * X) - math.pi)


def forty_digits(cases: Sweep) -> np.ndarray:
    """Return FEATURES of the cases, (n, 7), solved to forty digits and then rounded: see tests/analytic/README.md."""
    from analytic.forty_digits import solve

    rows = []
    for motion in cases.motions():
        # where the root finder begins, and the pattern of slips
        start = steady_orbit(PAPER, motion)
        times, slips = list(start.phases[1:, PHASE_T]), [int(s) for s in start.phases[:, PHASE_S]]
        exact = solve(parameters(PAPER, motion), start.X, start.theta, times, slips)
        rows.append([float(getattr(exact, name)) for name in FEATURES])
    return np.array(rows)


def wrapped(phi):
    """Return a lag, rad, or an array of them, in [−π/2, 3π/2)."""
    return (phi + 0.5 * math.pi) % (2.0 * math.pi) - 0.5 * math.pi


def worst_error(features: np.ndarray, exact: np.ndarray) -> float:
    """Return largest relative error of any feature of any case."""
    return float(np.max(np.abs(features[: len(exact)] / exact - 1.0)))
