"""Fit of one oscillator to the fundamental of each record alone, where the higher harmonics are not those of the model.

A second mode, a sensor or a spring that is not linear, or a contact that yields gradually, show in the higher harmonics
first, and hardly in the fundamental, which carries nearly all of the energy. Its dynamic stiffness

    Z = kY/x_1 = k − mω² + K + i(E/(πX²) + Σ p_j g_j/(πX²))

has in-phase and quadrature parts for each level, with the describing function of the slider for x = X cos ωt,

    K = (K_z/π)(ϑ − sin ϑ cos ϑ),   cos ϑ = 1 − 2Z_m/X,   E = 4F_k(X − Z_m),   Z_m = F_k/K_z

(Caughey, J. Appl. Mech. 27, 1960). What it lacks of the exact orbit of that amplitude is added at the oscillator that
fits, and the fit repeated: the describing function only gives derivatives. Rows are relative to |Z|, which is the
drive over the response.

Two departures show in the fundamentals, and are fitted along where that lessens what the rows leave by more than
chance: a channel that turns the phase, by a delay or as much by a filter (Z e^{iωτ}), and a spring that is not linear
(Z + ¾k_3X²).

What the rows leave is no noise. Errors come from the scatter of the in-phase rows and of those in quadrature, with
Student's t of the rows less the unknowns that each kind determines, and are no less than those of the noise.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy import special

from ..arrays import Array, Complexes, Mask
from ..law.law import Law
from ..law.terms import FRICTION, term
from ..motion.law_steady import Response, added_by_base
from ..signals.lines import Lines
from ..signals.thresholds import P_CAUSE
from ..solver import NORMAL_95
from .climb import climb
from .fit import OscillatorFit
from .parameters import Parameters
from .starts import starts
from .waveforms import NO_MOTION, HarmonicProblem

_STEP = 1e-4  # of an unknown, for central differences of a closed form: errors of 1e-8


OSCILLATOR = ("rho", "m")


@dataclass(frozen=True, eq=False)
class Fundamentals(HarmonicProblem):
    """The fundamentals of records.   freed : names of unknowns that are fitted in addition to those of the law."""

    freed: tuple[str, ...] = OSCILLATOR

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the unknowns that the records share."""
        return (*self.law.keys, *OSCILLATOR, *self.nuisances)

    @cached_property
    def unknowns(self) -> Parameters:
        """The unknowns, of which those that are fitted are free."""
        held = self.parameters.held(*self.names)
        return held.freed(*self.law.unknowns, *self.freed)

    @property
    def free(self) -> Mask:
        """Which unknowns are fitted."""
        return self.unknowns.free


@dataclass(frozen=True, eq=False, kw_only=True)
class FundamentalFit(OscillatorFit):
    """The oscillator whose fundamentals are closest to those of n records.

    problem : names and places of the unknowns.   residual : (model − data)/|Z|, in phase and in quadrature, (2, n).
    by_rows : derivatives of the common unknowns by the relative error of each row, (p, 2n).
    reach : half of the 95 % interval of each common unknown, (p,).
    """

    problem: Fundamentals
    residual: Array
    by_rows: Array
    reach: Array

    @property
    def names(self) -> tuple[str, ...]:
        """Keys of the law's coefficients, then the other common unknowns."""
        return self.problem.names

    @property
    def law(self) -> Law:
        """The damping law whose coefficients are fitted."""
        return self.problem.law

    @property
    def departures(self) -> tuple[str, ...]:
        """Names of the nuisances that are fitted along."""
        return tuple(name for name in self.problem.freed if name not in OSCILLATOR)

    @property
    def turned(self) -> dict[str, float]:
        """Relative change of the common unknowns, by name, if a channel that turns the phase explained what the
        in-phase rows leave, where these are too few to show it; empty where they leave no more than noise does."""
        Z, error = _data(self.problem)
        square = float(np.sum((self.residual[0] * np.abs(Z) / error) ** 2))
        if len(Z) > len(self.problem.freed) + 1 or special.chdtrc(len(Z), square) > P_CAUSE:
            return {}
        problem = replace(self.problem, freed=(*self.problem.freed, "delay"))
        slopes = _linearised(problem, self.point, np.zeros_like(Z))[1] / np.abs(Z)
        matrix = np.concatenate([slopes.real, slopes.imag], axis=1).T
        moves = np.linalg.pinv(matrix) @ -self.residual.ravel()
        places = np.flatnonzero(problem.free[: len(self.names)])
        return {
            self.names[at]: abs(move / self.point[at])
            for at, move in zip(places.tolist(), moves.tolist(), strict=True)
            if self.point[at]
        }

    def has(self, departure: str) -> bool:
        """Return whether a departure is fitted along: any filter turns the phase like a delay."""
        return ("delay" if departure == "corner" else departure) in self.departures

    @cached_property
    def responses(self) -> tuple[Response, ...]:
        """The motion of each record."""
        records = range(len(self.problem.lines))
        return tuple(self.problem.response(self.point, i) for i in records)

    @property
    def misfit(self) -> float:
        """χ² per degree of freedom, in units of the noise."""
        return self.chi_square / self.freedom

    @property
    def scatter(self) -> float:
        """Root mean square of what the rows leave, relative to the drive."""
        return math.sqrt(float(np.sum(self.residual**2)) / self.freedom)

    def interval(self, name: str) -> tuple[float, float]:
        """Return the 95 % interval of a common unknown, in its unit, with Student's t for the scatter of the rows."""
        reach = float(self.reach[self.names.index(name)])
        return self.value(name) - reach, self.value(name) + reach

    def moved(self, relative: Complexes) -> Array:
        """Return the relative change of the common unknowns, (p, …), with that of the Z of each record, (n, …)."""
        Z = _data(self.problem)[0]
        part = (relative.T * Z / np.abs(Z)).T
        by = self.by_rows @ np.concatenate([part.real, part.imag])
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray((by.T / self.point[: len(self.names)]).T)


def fit_fundamentals(
    lines: Sequence[Lines], k: float, law: Law | None = None
) -> FundamentalFit | None:
    """Return the oscillator whose fundamentals are closest, with the departures that they show; None where the levels
    are too few to show how well they fit.

    lines : of n records.   k : stiffness, N/m.   law : default, F_k and c.
    """
    fit = _with(Fundamentals(law or Law(), tuple(lines), k))
    while fit is not None:
        freed = fit.problem.freed
        problems = (
            replace(fit.problem, freed=(*freed, name))
            for name in ("delay", "k_3")
            if name not in freed
        )
        others = (_with(problem, fit.point) for problem in problems) if _shows(fit) else ()
        better = min(filter(None, others), key=lambda one: one.chi_square, default=None)
        if better is None or not _shows(fit, better):
            break
        fit = better
    if fit is None or not fit.rigid or fit.has("delay"):
        return fit
    # a turn of the phase takes off what a contact adds to the stiffness of low levels
    return _with(replace(fit.problem, freed=(*fit.problem.freed, "delay")), fit.point) or fit


def _shows(fit: FundamentalFit, better: FundamentalFit | None = None) -> bool:
    """Return whether one more unknown explains more than chance would have it, next to noise and what is left of the
    rows; or, without it, whether one could."""
    if better is None:
        return bool(special.chdtrc(1.0, fit.chi_square) < P_CAUSE)
    freedom = better.freedom if better.misfit > 1.0 else 1e6  # F is χ² then
    F = (fit.chi_square - better.chi_square) / max(1.0, better.misfit)
    return F > 0.0 and bool(special.fdtrc(1.0, freedom, F) < P_CAUSE)


def _with(problem: Fundamentals, near: Array | None = None) -> FundamentalFit | None:
    """Return the fit with the unknowns that a problem frees; None without degrees of freedom left. near : a point to
    start from, too."""
    lines, damping = problem.lines, len(problem.law.unknowns)
    # stiffness, mass and the departures come from the in-phase rows, damping from those in quadrature
    freedom = np.array([len(lines) - len(problem.freed), len(lines) - damping])
    if freedom.min() < 1:
        return None
    ends = [end for at in _starts(problem, near) if (end := _fitted(problem, at)) is not None]
    if not ends:
        return None
    point, off, slopes = min(ends, key=lambda end: end.size)
    for at, one in zip(problem.at, lines, strict=True):
        point[at["Y"]] = one.Y
    Z, error = _data(problem)
    by_rows = np.zeros((len(problem.names), 2 * len(lines)))
    common = problem.free[: len(by_rows)]
    by_rows[common] = np.linalg.pinv(np.concatenate([slopes.real, slopes.imag], axis=1).T)
    residual = np.stack([off.real, off.imag])
    scattered = np.repeat(np.sum(residual**2, axis=1) / freedom, len(lines))
    t = np.repeat(special.stdtrit(freedom, 0.975), len(lines))
    noise = np.tile((error / np.abs(Z)) ** 2, 2)
    of_scatter, of_noise = by_rows**2 @ (scattered * t**2), by_rows**2 @ noise
    larger = np.maximum(scattered, noise)
    covariance = np.zeros((point.size, point.size))
    covariance[: len(by_rows), : len(by_rows)] = (by_rows * larger) @ by_rows.T
    return FundamentalFit(
        parameters=problem.unknowns.at(point),
        covariance=covariance,
        chi_square=float(np.sum(residual.ravel() ** 2 / noise)),
        problem=problem,
        residual=residual,
        by_rows=by_rows,
        reach=np.sqrt(np.maximum(of_scatter, NORMAL_95**2 * of_noise)),
        freedom=int(freedom.sum()),
    )


def _starts(problem: Fundamentals, near: Array | None) -> list[Array]:
    """Return points to start from: a point near, or those that balance the work of the fundamentals, the closest of
    some contact stiffnesses; with each turn of the phase where that is fitted."""
    points = [near] if near is not None else []
    if near is None:
        lines = [
            replace(one, **{name: getattr(one, name)[:1] for name in ("n", "x", "x_error")})
            for one in problem.lines
        ]
        candidates = starts(lines, problem.k)
        # a rigid contact next to a soft one are two minima: four stiffnesses
        first = np.sort(np.unique(candidates[:, 2], return_index=True)[1])[:4]
        points = [problem.start(candidate).values for candidate in candidates[first]]
    if "delay" in problem.freed and near is not None:
        points = [near.copy(), near.copy()]
        # rad: a filter of a laboratory turns the phase by that much
        for point, turn in zip(points, (-0.1, 0.1), strict=True):
            point[problem.names.index("delay")] += turn / problem.lines[0].omega
    return points


def _data(problem: Fundamentals) -> tuple[Complexes, Array]:
    """Return Z of each record, N/m, and the standard error of its real and of its imaginary part, (n,)."""
    Z = np.array([problem.k * one.Y / one.x[0] for one in problem.lines])
    return Z, np.abs(Z) * np.array([one.relative_error for one in problem.lines])


def _describing(problem: Fundamentals, points: Array, motion: Complexes) -> Complexes:
    """Return Z of each record by the describing function, N/m, (…, n).   points : (…, p).   motion : x_1, m, (n,)."""
    omega, Y = np.transpose([(one.omega, one.Y) for one in problem.lines])
    X, phi = np.abs(motion), -np.angle(motion)

    def of(name: str) -> Array:
        return np.asarray(points[..., [at[name] for at in problem.at]])

    friction, K_z = of(FRICTION), of("rho") ** -2
    held = np.clip(friction / (K_z * X), 0.0, 1.0)  # Z_m/X; a difference may step below zero
    theta = 2.0 * np.arcsin(np.sqrt(held))  # cos ϑ = 1 − 2 sin² ϑ/2
    # below 0.01 the first term of the series holds to 1e-5
    part = np.where(theta > 1e-2, theta - np.sin(theta) * np.cos(theta), theta**3 / 1.5)
    energy = 4.0 * friction * X * (1.0 - held)
    for symbol in problem.law.terms:
        if symbol != FRICTION:
            energy = energy + of(symbol) * term(symbol).harmonic(omega, X, Y, phi, problem.k)
    in_phase = problem.k - of("m") * omega**2 + K_z * part / math.pi
    return np.asarray(in_phase + 1j * energy / (math.pi * X**2))


def _read(problem: Fundamentals, points: Array, Z: Complexes) -> Complexes:
    """Return Z of each record as its channels read it, with what a spring that is not linear adds, N/m, (…, n)."""
    omega, X = np.transpose([(one.omega, abs(one.x[0])) for one in problem.lines])
    k_3, delay = (points[..., problem.names.index(name)] for name in ("k_3", "delay"))
    return np.asarray((Z + 0.75 * k_3[..., None] * X**2) * np.exp(1j * omega * delay[..., None]))


def _linearised(
    problem: Fundamentals, point: Array, correction: Complexes
) -> tuple[Complexes, Complexes]:
    """Return Z of each record, N/m, (n,), and its derivatives by the common unknowns that are fitted, (p, n).

    correction : of the describing function, N/m, (n,).
    """
    motion = np.array([one.x[0] for one in problem.lines])
    free = np.flatnonzero(problem.free[: len(problem.names)])
    sizes = _STEP * np.maximum(np.abs(point), problem.unknowns.scale)[free]
    points = np.tile(point, (2, free.size + 1, 1))
    points[0, np.arange(free.size), free] += sizes
    points[1, np.arange(free.size), free] -= sizes
    more, less = _read(problem, points, _describing(problem, points, motion) + correction)
    return more[-1], np.asarray((more - less)[:-1] / (2.0 * sizes[:, None]))


def _fundamental(problem: Fundamentals, point: Array, i: int) -> complex:
    """Return x_1 of the exact motion of a record without departures, with what the harmonics of its base add, m.

    Raises NO_MOTION.
    """
    bare = point.copy()
    bare[[problem.names.index(name) for name in problem.nuisances]] = 0.0
    response = problem.response(bare, i)
    added = added_by_base(problem.lines[i].base, response, 1)
    return complex(response.harmonics(1)[0] + added[0])


class _End(NamedTuple):
    """A point, (model − data)/|Z| there, (n,), and its derivatives by the unknowns that are fitted, (p, n)."""

    point: Array
    off: Complexes
    slopes: Complexes

    @property
    def size(self) -> float:
        """Norm of the residuals."""
        return float(np.linalg.norm(self.off))


def _fitted(problem: Fundamentals, start: Array) -> _End | None:
    """Return the end of a climb to the fundamentals; None where there is no motion."""
    Z, error = _data(problem)
    unit = np.abs(Z) * math.sqrt(float(np.mean((error / np.abs(Z)) ** 2)))
    motion = np.array([one.x[0] for one in problem.lines])
    free = np.flatnonzero(problem.free[: len(problem.names)])
    correction, point, best = np.zeros_like(Z), start, None
    rubs = np.array([name == FRICTION for name in problem.unknowns.names])
    low = np.where(rubs, 1e-9 * start, problem.unknowns.low)
    unknowns = replace(problem.unknowns, low=low)

    def products(at: Array, out: Array) -> bool:
        whole = np.zeros((at.size + 1, Z.size), dtype=np.complex128)
        model, slopes = _linearised(problem, at, correction)
        whole[free], whole[-1] = slopes / unit, (model - Z) / unit
        out[:] = (whole @ whole.conj().T).real
        return True

    # the correction is a few per cent, and falls by a factor of ten each time
    for _ in range(8):
        # a gain of 4 % of a standard error of the noise, and less of the scatter
        reached = climb(products, unknowns.at(point), gain=1e-3)
        if reached is None:
            break
        point = reached.point.copy()
        linear = _describing(problem, point, motion) + correction
        for at, drive in zip(problem.at, np.abs(linear * motion), strict=True):
            point[at["Y"]] = drive / problem.k  # moves the mass as far as it was read
        try:
            moved = [_fundamental(problem, point, i) for i in range(Z.size)]
        except NO_MOTION:
            break
        exact = np.array(moved)
        correction = np.abs(linear * motion) / exact - _describing(problem, point, exact)
        model, slopes = _linearised(problem, point, correction)
        end = _End(point, (model - Z) / np.abs(Z), slopes / np.abs(Z))
        if best is not None and end.size > 0.999 * best.size:  # a gain that does not matter
            break
        best = end
    return best
