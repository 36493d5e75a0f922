"""Fit of one oscillator to the fundamental of each record alone, where the higher harmonics are not those of the model.

A second mode, a sensor or a spring that is not linear, or a contact that yields gradually, show in the higher harmonics
first, and hardly in the fundamental, which carries nearly all of the energy. Its dynamic stiffness kY/x_1 is a line of
each record (`stiffness_lines.py`). What the describing function of the slider lacks of the exact orbit of that
amplitude is added at the oscillator that fits, and the fit repeated: it only gives derivatives. Rows are relative to
|Z|, which is the drive over the response.

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

import numpy as np
from scipy import special

from ..arrays import Array, Complexes, Mask
from ..law.law import Law
from ..law.terms import FRICTION
from ..motion.law_steady import Response, added_by_base
from ..signals.record_harmonics import RecordHarmonics
from ..signals.thresholds import P_CAUSE
from ..solver import NORMAL_95
from .fit import Fit, OscillatorFit
from .multistart import climbs
from .parameters import Parameters
from .starts import starts
from .stiffness_lines import StiffnessLines, StiffnessProblem
from .waveforms import NO_MOTION, HarmonicProblem

_GAIN = 1e-5  # in −log L: 0.4 % of a standard error of the noise, and less of the scatter


def stiffness_lines(lines: Sequence[RecordHarmonics], k: float) -> StiffnessLines:
    """Return the fundamentals of records as lines of dynamic stiffness, a level each.   k : of the spring, N/m."""
    X, Z, omega = np.transpose([(abs(one.x[0]), k * one.Y / one.x[0], one.omega) for one in lines])
    error, each = np.array([one.relative_error for one in lines]), np.arange(len(lines))
    return StiffnessLines(omega.real, X.real, Z, each, tuple(map(str, each)), error)


@dataclass(frozen=True, eq=False)
class FundamentalProblem(StiffnessProblem):
    """Residuals of the fundamentals of records.

    exact : the problem of their waveforms, which has all unknowns.   departures : those that are fitted along.
    """

    exact: HarmonicProblem = None  # type: ignore[assignment]
    departures: tuple[str, ...] = ()

    @classmethod
    def of_records(
        cls, exact: HarmonicProblem, departures: tuple[str, ...] = ()
    ) -> FundamentalProblem:
        """Return the problem of records, with the unknowns at rest."""
        start, k, lines = exact.parameters, exact.k, stiffness_lines(exact.lines, exact.k)
        fitted = {*exact.law.unknowns, "rho", "m", *departures}
        start = start.held(*(key for key in start.keys if key not in fitted)).freed(*fitted)
        assert lines.error is not None
        sigma = np.abs([lines.Z] * 2) * math.sqrt(float(np.mean(lines.error**2)))
        each = range(len(exact.lines))
        groups: dict[str, Mask] = {
            key: np.array([exact.law.key(key.symbol, i) == key for i in each])
            for key in exact.law.keys
        }
        return cls(
            *(lines, start, "one slider", sigma, k, groups), exact=exact, departures=departures
        )

    @property
    def degrees(self) -> Array:
        """Degrees of freedom of the in-phase rows, which tell stiffness, mass and departures, and of those in
        quadrature, which tell the damping, (2,)."""
        unknowns = [2 + len(self.departures), len(self.exact.law.unknowns)]
        return self.lines.X.size - np.array(unknowns, dtype=np.float64)

    def corrected(self, start: Parameters) -> FundamentalProblem | None:
        """Return the problem at the end of a climb, with what its model lacks of the exact motion there; None where
        there is no motion."""
        start, drawn = self.ends([start], gain=_GAIN), self.lines
        bare = start.values.copy()
        bare[[start.places[name] for name in self.exact.nuisances]] = 0.0
        # drives that move the mass as far as it was read
        drives = np.abs(self.law(bare, drawn)) * drawn.X
        for at, drive in zip(self.exact.at, drives, strict=True):
            bare[at["Y"]] = drive / self.k
        try:
            moved = [self._fundamental(bare, i) for i in range(drives.size)]
        except NO_MOTION:
            return None
        there = replace(drawn, X=np.abs(moved), Z=drives / np.array(moved))
        lacks = there.Z - (self.law(bare, there) - self.added)
        return replace(self, start=start, added=lacks)

    def response(self, values: Array, i: int) -> Response:
        """Return the exact motion of a record.   Raises NO_MOTION."""
        # next to a stiff contact, a friction as small as its lower limit has no orbit that is found: none has
        rubs = np.where(np.array(self.start.names) == FRICTION, values > self.start.low, True)
        return self.exact.response(values * rubs, i)

    def _fundamental(self, values: Array, i: int) -> complex:
        """Return x_1 of the exact motion of a record, with what the harmonics of its base add, m.   Raises
        NO_MOTION."""
        response, base = self.response(values, i), self.exact.lines[i].base
        return complex(response.harmonics(1)[0] + added_by_base(base, response, 1)[0])

    @property
    def size(self) -> float:
        """Norm of the residuals."""
        return float(np.linalg.norm(self.residual(self.start.values)))


@dataclass(frozen=True, eq=False)
class FundamentalFit(OscillatorFit):
    """The oscillator whose fundamentals are closest to those of n records.   problem : a `FundamentalProblem`."""

    @property
    def law(self) -> Law:
        """The damping law whose coefficients are fitted."""
        law: Law = self.problem.exact.law
        return law

    @property
    def departures(self) -> tuple[str, ...]:
        """Names of the nuisances that are fitted along."""
        departures: tuple[str, ...] = self.problem.departures
        return departures

    @cached_property
    def residual(self) -> Array:
        """(model − data)/|Z|, in phase and in quadrature, (2, n)."""
        rows = self.problem.residual(self.point).reshape(2, -1)
        return np.asarray(rows * self.problem.sigma / np.abs(self.problem.lines.Z))

    @cached_property
    def _by_rows(self) -> Array:
        by: Array = self.problem.by_rows(self.point)
        return by

    def interval(self, key: str) -> tuple[float, float]:
        """Return the 95 % interval of an unknown, in its unit, with Student's t for the scatter of either kind of rows;
        no shorter than by the noise."""
        problem, size = self.problem, np.abs(self.problem.lines.Z)
        degrees, row = problem.degrees, self._by_rows[self.parameters.places[key]]
        squares = (row.reshape(2, -1) * size / problem.sigma) ** 2
        reaches = special.stdtrit(degrees, 0.975) ** 2 * np.sum(self.residual**2, axis=1) / degrees
        noise = NORMAL_95**2 * float(np.sum(squares * problem.lines.error**2))
        reach = math.sqrt(max(float(reaches @ np.sum(squares, axis=1)), noise))
        return self.value(key) - reach, self.value(key) + reach

    @property
    def turned(self) -> dict[str, float]:
        """Relative change of the common unknowns, by name, if a channel that turns the phase explained what the
        in-phase rows leave, where these are too few to show it; empty where they leave no more than noise does."""
        problem = self.problem
        square = float(np.sum((self.residual[0] / problem.lines.error) ** 2))
        n = self.residual.shape[1]
        if problem.degrees[0] > 1.0 or special.chdtrc(n, square) > P_CAUSE:
            return {}
        freer = replace(problem, start=self.parameters.freed("delay"))
        moves = freer.by_rows(self.point) @ problem.residual(self.point)
        pairs = zip(self.parameters, moves.tolist(), strict=True)
        return {one.key: abs(by / one.value) for one, by in pairs if one.free and one.value}

    def has(self, departure: str) -> bool:
        """Return whether a departure is fitted along: any filter turns the phase like a delay."""
        return ("delay" if departure == "corner" else departure) in self.departures

    @cached_property
    def responses(self) -> tuple[Response, ...]:
        """The motion of each record."""
        records = range(self.residual.shape[1])
        return tuple(self.problem.response(self.point, i) for i in records)

    @property
    def scatter(self) -> float:
        """Root mean square of what the rows leave, relative to the drive."""
        return math.sqrt(float(np.sum(self.residual**2)) / self.freedom)

    def moved(self, relative: Complexes) -> Array:
        """Return the change of the unknowns, (p,), with relative ones of the Z of each record, (n,)."""
        part = relative * self.problem.lines.Z / self.problem.sigma[0]
        return np.asarray(self._by_rows @ np.concatenate([part.real, part.imag]))


def fit_fundamentals(
    lines: Sequence[RecordHarmonics], k: float, law: Law | None = None
) -> FundamentalFit | None:
    """Return the oscillator whose fundamentals are closest, with the departures that they show; None where the levels
    are too few to show how well they fit.

    lines : of n records.   k : stiffness, N/m.   law : default, F_k and c.
    """
    exact = HarmonicProblem(law or Law(), tuple(lines), k)

    def along(names: tuple[str, ...], near: Fit | None = None) -> FundamentalFit | None:
        return _with(FundamentalProblem.of_records(exact, names), near)

    fit = along(())
    while fit is not None and _shows(fit):
        freer = [name for name in ("delay", "k_3") if name not in fit.departures]
        others = [along((*fit.departures, name), fit) for name in freer]
        better = min(filter(None, others), key=lambda one: one.chi_square, default=None)
        if better is None or not _shows(fit, better):
            break
        fit = better
    if fit is None or not fit.rigid or fit.has("delay"):
        return fit
    # a turn of the phase takes off what a contact adds to the stiffness of low levels
    return along((*fit.departures, "delay"), fit) or fit


def _shows(fit: FundamentalFit, better: FundamentalFit | None = None) -> bool:
    """Return whether one more unknown explains more than chance would have it, next to noise and what is left of the
    rows; or, without it, whether one could."""
    if better is None:
        return bool(special.chdtrc(1.0, fit.chi_square) < P_CAUSE)
    freedom = better.freedom if better.misfit > 1.0 else 1e6  # F is χ² then
    F = (fit.chi_square - better.chi_square) / max(1.0, better.misfit)
    return F > 0.0 and bool(special.fdtrc(1.0, freedom, F) < P_CAUSE)


def _with(problem: FundamentalProblem, near: Fit | None = None) -> FundamentalFit | None:
    """Return the fit with the unknowns that a problem frees; None without degrees of freedom left. near : a fit from
    which to start."""
    if problem.degrees.min() < 1.0:
        return None
    points, unknowns = _starts(problem, near), problem.start
    if not points:
        return None
    rubs = np.array([name == FRICTION for name in unknowns.names])
    unknowns = replace(unknowns, low=np.where(rubs, 1e-9 * points[0], unknowns.low))
    problem = replace(problem, start=unknowns)
    found = climbs(problem, [problem.climbed.at(point) for point in points], math.inf)
    ends = [end for at in found if (end := _fitted(problem, at.parameters)) is not None]
    if not ends:
        return None
    problem = min(ends, key=lambda end: end.size)
    drives = {f"Y[{i}]": one.Y for i, one in enumerate(problem.exact.lines, 1)}
    problem = replace(problem, start=problem.start.moved(**drives))
    at, freedom, size = problem.start, problem.degrees, np.abs(problem.lines.Z)
    by = problem.by_rows(at.values) * (problem.scatter(at.values, freedom) / problem.sigma).ravel()
    noise = problem.sigma / (size * problem.lines.error)
    chi_square = float(np.sum((problem.residual(at.values) * noise.ravel()) ** 2))
    return FundamentalFit(at, by @ by.T, chi_square, float(freedom.sum()), problem)


def _fitted(problem: FundamentalProblem, start: Parameters) -> FundamentalProblem | None:
    """Return the problem at the end of climbs from a start, corrected; None where there is no motion."""
    best = None
    # the correction is a few per cent, and falls by a factor of ten each time
    for _ in range(8):
        corrected = problem.corrected(start)
        # a gain that does not matter
        if corrected is None or (best is not None and corrected.size > 0.999 * best.size):
            break
        problem = best = corrected
        start = problem.climbed
    return best


def _starts(problem: FundamentalProblem, near: Fit | None) -> list[Array]:
    """Return points from which to start: near a fit, if there is one, and where the work of the fundamentals is
    balanced, the closest of some contact stiffnesses; with each turn of the phase where that is fitted."""
    exact, delay = problem.exact, problem.start.places["delay"]
    # rad: a filter of a laboratory turns the phase by that much
    turns = (-0.1, 0.1) if "delay" in problem.departures else (0.0,)
    points = []
    for turn in turns:
        late = turn / exact.lines[0].omega
        one_harmonic = [
            replace(
                one,
                n=one.n[:1],
                x=one.x[:1] * np.exp(1j * one.omega * late),
                x_error=one.x_error[:1],
            )
            for one in exact.lines
        ]
        candidates = starts(one_harmonic, exact.k)
        # a rigid contact next to a soft one are two minima: four stiffnesses
        first = np.sort(np.unique(candidates[:, 2], return_index=True)[1])[:4]
        balanced = [exact.start(candidate).values for candidate in candidates[first]]
        own = [] if near is None else [near.point.copy()]
        for point in [*own, *(balanced if near is None or turn else [])]:
            point[delay] += late
            points.append(point)
    return [np.where(problem.solved, 0.0, point) for point in points]
