"""Measured loops as the data of a fit: their columns, the blocks of their cycles, and a contact in their motion."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..arrays import Array, Integers
from ..law.contact import Sliders
from ..signals.loops import Loop
from .parameters import Parameter

MOST_BLOCKS = 24
"""Largest number of blocks in a jackknife: with that many Student's t is close to the normal distribution."""

FEW = 1e-3  # of a size, of a parameter that is near zero
_WIDER = 1e-4  # part of the deflections at which sliders slip, of a difference quotient
ZERO = 1e-300  # added to divisors that may be zero
# part of X between reversals, and quartiles of the speed there, which of a sine are 21 % apart
_BETWEEN, _STEADY = 0.8, 0.1
_PHASES = 100  # of a cycle, at which a residual is averaged over cycles
_INDEPENDENT = 0.1  # of a column, which no combination of those before it makes


def deflections_of(contact: Sliders, loop: Loop) -> Array:
    """Return the deflection of each element of a contact in the motion of a loop, m, (j, n)."""
    return contact.deflections(loop.x, loop.v, loop.through, loop.load)


def force_of(contact: Sliders, loop: Loop) -> Array:
    """Return the force of a contact in the motion of a loop, N, (n,)."""
    return np.asarray(contact.kappa @ deflections_of(contact, loop))


def slope_of(contact: Sliders, loop: Loop) -> Array:
    """Return the derivative of this force by ln F_k at the same stiffness, N, (n,)."""
    wider = replace(contact, r=contact.r * (1.0 + _WIDER))
    return (force_of(wider, loop) - force_of(contact, loop)) / _WIDER


def lost(loop: Loop, contact: Sliders, values: Mapping[str, float]) -> Array:
    """Return the energy that a contact and dampers take in each cycle of a motion, J, (cycles,).   values : of c and
    c_2, where there are."""
    damped = values.get("c", 0.0) + values.get("c_2", 0.0) * np.abs(loop.v)
    return loop.by_cycle(force_of(contact, loop) + damped * loop.v)


def motions_of(loop: Loop) -> dict[str, Array]:
    """Return the columns of the terms that a motion has beyond friction and spring, by symbol, (n,)."""
    inertia = np.gradient(loop.v, loop.t)
    return {"c": loop.v, "c_2": loop.v * np.abs(loop.v), "m": inertia, "k_3": loop.x**3}


class Design:
    """Rows that are linear in the unknowns, and the blocks of cycles, of some loops."""

    def __init__(self, loops: Sequence[Loop]) -> None:
        """Stack the cycles of the loops."""
        self.loops, self.timed = loops, all(loop.timed for loop in loops)
        cycles = [own.stop - own.start for loop in loops for own in loop.slices]
        self.ends, self.cycle = np.cumsum([0, *cycles]), np.repeat(np.arange(len(cycles)), cycles)
        self.blocks = min(MOST_BLOCKS, len(cycles))
        first = self.ends[-(-np.arange(self.blocks + 1) * len(cycles) // self.blocks)]
        self.own = [slice(*pair) for pair in itertools.pairwise(first.tolist())]
        self.f = self.centred(self.stacked([loop.f for loop in loops]))
        self.X = max(float(loop.amplitudes.max()) for loop in loops)
        self.fastest = max(float(np.abs(loop.v).max()) for loop in loops)
        drifts = [
            self.stacked([of.t if of is loop else 0.0 * of.t for of in loops]) for loop in loops
        ]
        self.base = self.centred(np.array([self.stacked([loop.x for loop in loops]), *drifts]))
        self.v = self.stacked([loop.v for loop in loops])
        motions = [motions_of(loop) for loop in loops]
        self.motions = {
            name: self.centred(self.stacked([of[name] for of in motions])) for name in motions[0]
        }
        self.load = self.stacked([np.full(loop.x.size, loop.load) for loop in loops])

    def stacked(self, of_loops: Sequence[Array]) -> Array:
        """Return the samples inside cycles of values of each loop, (…, n)."""
        pairs = zip(of_loops, self.loops, strict=True)
        return np.concatenate([of[..., loop.own] for of, loop in pairs], axis=-1)

    def centred(self, values: Array) -> Array:
        """Return values less their mean in each cycle, which a separate offset of each cycle takes off, (…, n)."""
        lengths = np.diff(self.ends)
        means = np.add.reduceat(values, self.ends[:-1], axis=-1) / lengths
        return np.asarray(values - np.repeat(means, lengths, axis=-1))

    def forces(self, contact: Sliders) -> Array:
        """Return the force of a contact in all loops, N, (n,)."""
        return self.stacked([force_of(contact, loop) for loop in self.loops])

    def by_block(self, left: Array) -> Array:
        """Return the sum of squares of each block, (blocks,)."""
        return np.array([left[own] @ left[own] for own in self.own])

    @cached_property
    def _place(self) -> tuple[Integers, Array]:
        """Record and phase of each sample, (n,) each."""
        cycles = [loop.cycles for loop in self.loops]
        phase = np.concatenate([np.arange(float(of)) / of for of in np.diff(self.ends).tolist()])
        return np.repeat(np.arange(len(cycles)), cycles)[self.cycle], phase

    def shared(self, left: Array) -> float:
        """Return the mean square of what of a residual all cycles of a record have in common, N², to which the scatter
        between cycles is blind: of its means at each phase, without what the scatter makes of them."""
        record, phase = self._place
        at = (record * _PHASES + (_PHASES * phase).astype(int)).astype(int)
        counts = np.maximum(np.bincount(at), 1)
        values = float(np.unique(at).size)
        common = float(np.sum(np.bincount(at, left) ** 2 / counts)) / left.size
        scatter = (float(np.mean(left**2)) - common) * values / max(left.size - values, 1.0)
        return max(0.0, common - scatter * (1.0 + 2.0 * math.sqrt(2.0 / values)))

    def patterns(self, count: int, points: int) -> Array:
        """Return patterns that all cycles of a record share, each with either sign, (2 count, n): lines between random
        points of unit size.   points : in a cycle."""
        draw = np.random.default_rng(1).normal(size=(count, len(self.loops), points))
        record, phase = self._place
        before, part = (points * phase).astype(int), points * phase % 1.0
        after = (before + 1) % points
        lines = (1.0 - part) * draw[:, record, before] + part * draw[:, record, after]
        # the mean square of a line between two of them is two thirds
        return self.centred(np.concatenate([lines, -lines]) * math.sqrt(1.5))

    @cached_property
    def with_c(self) -> bool:
        """Whether the speed between reversals is known, and varies enough to separate c from friction."""
        speeds = []
        for loop in self.loops:
            x, v = loop.x[loop.own], loop.v[loop.own]
            between = np.abs(x - x.mean()) < _BETWEEN * loop.amplitudes.max()
            speeds.append(np.abs(v[between]))
        low, middle, high = np.percentile(np.concatenate(speeds), (25.0, 50.0, 75.0))
        return self.timed and bool(high - low > _STEADY * middle)

    @cached_property
    def extensions(self) -> tuple[str, ...]:
        """Names of the extensions that these motions determine: at one frequency m ẍ is a spring, and two speeds cannot
        show whether the force is curved."""

        def independent(y: Array, columns: Sequence[Array]) -> bool:
            A = np.array(columns).T
            rest = y - A @ np.linalg.lstsq(A, y)[0]
            return float(rest @ rest) > _INDEPENDENT**2 * float(y @ y)

        curved = self.with_c and independent(self.motions["c_2"], [self.v, np.sign(self.v)])
        inertia = self.timed and independent(self.motions["m"], [*self.base])
        open_to = {"gap": True, "fall": curved, "knee": True, "dahl": True, "rounded": self.with_c}
        open_to |= {"c_2": curved, "m": inertia, "k_3": True}
        return tuple(name for name in open_to if open_to[name])

    def linear(self, names: Sequence[str]) -> Array:
        """Return the rows other than friction: x, drifts, and the terms named, (p, n)."""
        return np.array([*self.base, *(self.motions[name] for name in names)])

    def parameters(self, names: Sequence[str]) -> list[Parameter]:
        """Return the coefficients of these rows, N/m, N/s and so on."""
        keys = [("k", ""), *(("drift", str(i + 1)) for i in range(len(self.loops)))]
        keys += [(name, "") for name in names]
        sizes = FEW * np.linalg.norm(self.f) / (np.linalg.norm(self.linear(names), axis=1) + ZERO)
        rows = zip(keys, sizes.tolist(), strict=True)
        return [Parameter(name, 0.0, scale=size, group=group) for (name, group), size in rows]


def without_each_block(design: Design, A: Array, left: Array) -> Array:
    """Return by how much coefficients of least squares change without each block, (blocks, p).   A : rows, (p, n).
    left : residual of the best fit."""
    scale = np.sqrt(np.mean(A**2, axis=1)) + ZERO
    A = A / scale[:, None]
    G = A @ A.T
    out = [
        -np.linalg.pinv(G - A[:, own] @ A[:, own].T, rcond=1e-12, hermitian=True)
        @ (A[:, own] @ left[own])
        for own in design.own
    ]
    return np.array(out) / scale
