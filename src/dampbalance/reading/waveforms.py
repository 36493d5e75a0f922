"""One oscillator for all records: the exact steady waveforms that fit their harmonics best.

The waveform of a record is the steady orbit of the oscillator (m, c, k, K_z, F_k) under y = Y cos ωt. The stiffness k
is given; F_k, c, ρ = K_z^{−1/2} and, unless it is given, the mass m are common to all records, Y and the phase ψ of the
base are each record's own. Where the noise is white, harmonics taken by least squares over whole cycles hold all that a
record tells of a steady motion, so that

    χ² = Σ |x_n(model) e^{inψ} − x_n|²/σ_n² + (Y(model) − Y)²/σ_Y² + (Yψ)²/σ_Y²

is that of the fit to all samples, whatever drives, whatever answers and however long the record is. Its minimum is the
estimate of largest likelihood; χ² itself says whether the records are those of such an oscillator. Any regime has its
exact waveform: one slip onset per half cycle, several, none. In ρ the rigid contact, ρ = 0, is a regular point.

The harmonics tell the phase of the base, too: a time by which the response lags the base in the record (a skew between
two channels) turns harmonic n by n times its angle, and can be left free.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array, Complexes, Integers, Mask
from ..model import BaseMotion, Oscillator
from ..motion.orbit import NoSteadyOrbit, Orbit, steady_orbit
from ..solver import NORMAL_95
from .climb import Climb, Evaluation, NoConvergence, NoStart, climb
from .lines import SLIPS, Lines, improbable, starts

COMMON = ("F_k", "c", "rho", "m", "delay")
"""Unknowns common to all records; those of each record, Y and ψ, follow."""

_HARMONICS = 128  # odd ones of the waveform: beyond them lies less than 1e-6 of its velocity
_STARTS = (4, 12)  # of the candidates, the closest first, and of those of more masses
_SOFTENING = (1e-2, 1e-3, 0.0)  # parts of the amplitudes added to their errors: a smooth way down
_GAIN = 5e-8  # of half of χ², where the climb ends
_STEP = 1e-6  # of the finite differences: orbits are exact to 1e-13
_STIFFEST = 1e12  # of K_z/k: the contact that stands for a rigid one
_MOST = 30  # evaluations at each softening: a climb to where the records are takes about ten
_MOST_PHASES = 64  # of half a cycle: to follow a contact that rattles on takes long


@dataclass(frozen=True, eq=False)
class Fit:
    """The oscillator whose waveforms fit the harmonics of n records best.

    lines : of the records.   k : N/m.   point : the unknowns (COMMON, then Y, ψ of each record), SI, (p,).
    covariance : of the point, (p, p); zero where an unknown was given.
    response : of the point to the data in units of their errors, (p, data): dp = response · d(data)/σ; the data of a
    record are |Y|, its phase, Re x_n, Im x_n.   places : where the data of each record are.
    residual : (model − data)/σ, (data,).   chi_square : its square.   freedom : its degrees of freedom.
    rigid, undamped : whether ρ, c are at zero.
    """

    lines: tuple[Lines, ...]
    k: float
    point: Array
    covariance: Array
    response: Array
    places: tuple[slice, ...]
    residual: Array
    chi_square: float
    freedom: int
    rigid: bool
    undamped: bool

    @property
    def F_k(self) -> float:
        """Friction force, N."""
        return float(self.point[0])

    @property
    def c(self) -> float:
        """Viscous damping, N s/m."""
        return float(self.point[1])

    @property
    def rho(self) -> float:
        """K_z^{−1/2}, (m/N)^{1/2}; 0 for a rigid contact."""
        return 0.0 if self.rigid else float(self.point[2])

    @property
    def K_z(self) -> float:
        """Contact stiffness, N/m; infinite for a rigid contact."""
        return math.inf if self.rigid else self.rho**-2

    @property
    def m(self) -> float:
        """Mass, kg."""
        return float(self.point[3])

    @property
    def delay(self) -> float:
        """Time by which the response lags the base in the records beside what the motion makes it, s."""
        return float(self.point[4])

    def error(self, name: str) -> float:
        """Standard error of a common unknown, in its unit; 0 where it was given."""
        at = COMMON.index(name)
        return math.sqrt(self.covariance[at, at])

    @property
    def standard_errors(self) -> tuple[float, float, float]:
        """Of F_k (N), c (N s/m), K_z (N/m); infinite where the contact is rigid."""
        K_z = math.inf if self.rigid else 2.0 * self.K_z**1.5 * self.error("rho")
        return self.error("F_k"), self.error("c"), K_z

    @property
    def K_z_interval(self) -> tuple[float, float]:
        """95 % interval of K_z, N/m, from ρ ± 1.96 standard errors; unbounded above where ρ = 0 is within."""
        spread = NORMAL_95 * self.error("rho")
        low, high = self.rho - spread, self.rho + spread
        return high**-2, (low**-2 if low > 0.0 else math.inf)

    @property
    def natural_frequency_hz(self) -> float:
        """√(k/m)/2π, Hz: of the oscillator while its contact slips."""
        return math.sqrt(self.k / self.m) / (2.0 * math.pi)

    @property
    def misfit(self) -> float:
        """χ² per degree of freedom."""
        return self.chi_square / max(1, self.freedom)

    @property
    def adequate(self) -> bool:
        """Whether the records may be those of such an oscillator, as far as their noise tells."""
        return not improbable(self.chi_square, self.freedom, self.lines)

    @property
    def misfits(self) -> Array:
        """χ² of each record per datum, (n,)."""
        return np.array([np.mean(self.residual[place] ** 2) for place in self.places])

    @cached_property
    def orbits(self) -> tuple[Orbit, ...]:
        """The motion of each record."""
        return tuple(_orbit(self.point, i, one, self.k) for i, one in enumerate(self.lines))

    @property
    def slips(self) -> Mask:
        """Which records slip."""
        return np.array([orbit.regime in SLIPS for orbit in self.orbits])

    @cached_property
    def waveforms(self) -> tuple[Waveform, ...]:
        """What is read off the motion of each record."""
        return tuple(_waveform(self, i) for i in range(len(self.lines)))


@dataclass(frozen=True, eq=False)
class Waveform:
    """What features take from the motion of one record, with derivatives by the unknowns of the fit.

    fit : that it belongs to.   index : of the record.   orbit : its motion.
    onset : (V_s, t_s, λ), SI, λ = 4X − a the travel that sticking takes from 4X: 2L for one slip onset per half cycle.
    onset_slope : (3, p).   tail : harmonics x_n, n = 1, 3, 5 …, phases counted from the peak of y, m; tail_slope :
    their derivatives, (harmonics, p).
    """

    fit: Fit
    index: int
    orbit: Orbit
    onset: Array
    onset_slope: Array
    tail: Complexes
    tail_slope: Complexes

    @property
    def length(self) -> float:
        """L = 2F_k/K_z, m, freed of its bias of second order."""
        return 2.0 * self.fit.F_k * (self.fit.rho**2 - self.fit.error("rho") ** 2)

    @property
    def length_error(self) -> float:
        """Standard error of L, m."""
        slope = self.length_slope
        return math.sqrt(float(slope @ self.fit.covariance @ slope))

    @property
    def length_slope(self) -> Array:
        """Derivatives of L by the unknowns, (p,)."""
        slope = np.zeros(self.fit.point.size)
        slope[0], slope[2] = 2.0 * self.fit.rho**2, 4.0 * self.fit.F_k * self.fit.rho
        return slope

    @property
    def length_bound(self) -> float:
        """L is below it with 97.5 % confidence, m."""
        return 2.0 * self.fit.F_k * (self.fit.rho + NORMAL_95 * self.fit.error("rho")) ** 2


def fit_oscillator(lines: Sequence[Lines], k: float, *, thorough: bool = True) -> Fit | None:
    """The oscillator of largest likelihood; None where no oscillator that slips responds like the records.

    lines : of n ≥ 1 records.   k : stiffness, N/m.   thorough : whether more and more starts are tried until one leads
    to an oscillator that the records may be of.
    """
    best: Fit | None = None
    for wide in (False, True)[: 1 + thorough]:
        for F_k, c, K_z, m in starts(lines, k, wide=wide)[: _STARTS[wide]]:
            start = np.array([F_k, c, K_z**-0.5, m, 0.0])
            reached = _climbed(lines, k, start, {"delay"}, _SOFTENING)
            if reached is not None and (best is None or reached.chi_square < best.chi_square):
                best = reached
                if best.adequate:
                    return best
    return best


def with_delay(fit: Fit) -> Fit | None:
    """The fit with the delay between base and response left free, from there on."""
    given = set() if fit.error("m") else {"m"}
    return _climbed(fit.lines, fit.k, fit.point[: len(COMMON)], given, (0.0,))


def with_mass(fit: Fit, m: float) -> Fit | None:
    """The fit with the mass given, kg, from there on; None where nothing slips with that mass."""
    start = fit.point[: len(COMMON)].copy()
    start[3] = m
    return _climbed(fit.lines, fit.k, start, {"m", "delay"}, _SOFTENING)


def _climbed(
    lines: Sequence[Lines],
    k: float,
    common: Array,
    given: set[str],
    softenings: Sequence[float],
) -> Fit | None:
    """The fit that a climb from there ends in."""
    own = [(one.Y, 0.0) for one in lines]
    point = np.concatenate([common, np.ravel(own)])
    m = float(common[3])
    omega = max(one.omega for one in lines)
    least = [(1e-3 * one.Y, -math.inf) for one in lines]
    rigid = 1.0 / math.sqrt(_STIFFEST * k)
    lower = np.array([1e-9 * common[0], 0.0, rigid, 1e-6 * m, -math.inf, *np.ravel(least)])
    small = [common[0], 1e-3 * math.sqrt(k * m), 1e-3 * common[2], m, 1e-3 / omega]
    scale = np.array([*small, *np.ravel([(one.Y, 1.0) for one in lines])])
    free = np.array([i for i in range(point.size) if not given & set(COMMON[i : i + 1])])
    climbed: Climb[Evaluation] | None = None
    for softening in softenings:
        problem = _Problem(lines, k, point, free, softening)
        try:
            climbed = climb(
                problem.evaluate, point[free], lower[free], scale[free], gain=_GAIN, most=_MOST
            )
        except NoStart:
            return None
        except NoConvergence as stuck:
            climbed = stuck.best
        point = point.copy()
        point[free] = climbed.point
    assert climbed is not None
    here = climbed.evaluation
    assert here.residual is not None
    assert here.jacobian is not None
    solution = np.linalg.pinv(here.jacobian)
    size = point.size
    covariance, response = np.zeros((size, size)), np.zeros((size, here.residual.size))
    covariance[np.ix_(free, free)] = solution @ solution.T
    response[free] = solution
    ends = np.cumsum([2 + 2 * one.n.size for one in lines])
    starts_at = [0, *ends[:-1]]
    return Fit(
        lines=tuple(lines),
        k=k,
        point=point,
        covariance=covariance,
        response=response,
        places=tuple(slice(int(a), int(b)) for a, b in zip(starts_at, ends, strict=True)),
        residual=here.residual,
        chi_square=2.0 * here.value,
        freedom=here.residual.size - free.size,
        rigid=bool(point[2] <= rigid),
        undamped=bool(point[1] <= 0.0),
    )


def _orbit(point: Array, i: int, one: Lines, k: float) -> Orbit:
    """The motion of record i."""
    F_k, c, rho, m = point[:4].tolist()
    Y = float(point[len(COMMON) + 2 * i])
    return steady_orbit(Oscillator(m=m, c=c, k=k, K_z=rho**-2, F_k=F_k), BaseMotion(Y, one.omega))


def _steps(point: Array, one: Lines, k: float) -> list[float]:
    """Steps of the differences by F_k, c, ρ, m: a part of each, or of what matters where it is close to zero."""
    F_k, c, rho, m = point[:4].tolist()
    shortest = 1e-2 / (one.omega * math.sqrt(m))  # sticks for about 1e-2 of a cycle
    parts = (F_k, max(c, 2e-2 * math.sqrt(k * m)), max(rho, shortest), m)
    return [_STEP * part for part in parts]


def _moved(point: Array, j: int, step: float) -> Array:
    """The point with one unknown moved."""
    moved = point.copy()
    moved[j] += step
    return moved


@dataclass(frozen=True, eq=False)
class _Problem:
    """Residuals (model − data)/σ of all records as functions of the unknowns that are free.

    point : all unknowns.   free : which of them are.   softening : part of the amplitudes added to the errors.
    """

    lines: Sequence[Lines]
    k: float
    point: Array
    free: Integers
    softening: float

    def evaluate(self, free: Array) -> Evaluation | None:
        """Half of χ² with its derivatives; None where nothing slips, there is no orbit, or the contact rattles."""
        point = self.point.copy()
        point[self.free] = free
        residuals, slopes, slips = [], [], False
        for i, one in enumerate(self.lines):
            try:
                orbit = _orbit(point, i, one, self.k)
                if len(orbit.phases) > _MOST_PHASES:
                    return None
                x, by = _harmonics(point, i, one, self.k, orbit, one.n.size)
            except (NoSteadyOrbit, ValueError):
                return None
            slips |= orbit.regime in SLIPS
            at = len(COMMON) + 2 * i
            Y, psi = point[at], point[at + 1]
            error = np.hypot(one.x_error, self.softening * abs(one.x[0]))
            Y_error = math.hypot(one.Y_error, self.softening * one.Y)
            off, slope = (x - one.x) / error, by / error[:, None]
            lag = psi + one.omega * point[4]
            of_base = np.zeros((2, point.size))
            of_base[0, at] = 1.0 / Y_error
            of_base[1, at + 1], of_base[1, 4] = one.Y / Y_error, one.omega * one.Y / Y_error
            base = [(Y - one.Y) / Y_error, lag * one.Y / Y_error]
            residuals += [base, off.real, off.imag]
            slopes += [of_base, slope.real, slope.imag]
        if not slips:
            return None
        return Evaluation.of_residuals(np.concatenate(residuals), np.vstack(slopes)[:, self.free])


def _harmonics(
    point: Array, i: int, one: Lines, k: float, orbit: Orbit, count: int
) -> tuple[Complexes, Complexes]:
    """Harmonics of record i, turned by ψ, m, (h,), and their derivatives by all unknowns, (h, p).

    By F_k, c, ρ, m from orbits beside this one; by Y from ∂x/∂Y = (x − F_k ∂x/∂F_k)/Y, the motion being homogeneous of
    degree one in (Y, F_k).
    """
    at = len(COMMON) + 2 * i
    n = np.arange(1, 2 * count, 2)
    turn = np.exp(1j * n * point[at + 1])
    x = orbit.harmonics(count)
    slope = np.zeros((count, point.size), dtype=np.complex128)
    for j, step in enumerate(_steps(point, one, k)):
        beside = _orbit(_moved(point, j, step), i, one, k)
        slope[:, j] = (beside.harmonics(count) - x) / step
    slope[:, at] = (x - point[0] * slope[:, 0]) / point[at]
    slope[:, at + 1] = 1j * n * x
    return x * turn, slope * turn[:, None]


def _waveform(fit: Fit, i: int) -> Waveform:
    """What features take from the motion of record i."""
    one, orbit, point = fit.lines[i], fit.orbits[i], fit.point
    at = len(COMMON) + 2 * i
    onset, slope = _onset(orbit), np.zeros((3, point.size))
    for j, step in enumerate(_steps(point, one, fit.k)):
        slope[:, j] = (_onset(_orbit(_moved(point, j, step), i, one, fit.k)) - onset) / step
    degree = np.array([1.0, 0.0, 1.0])  # of V_s, t_s, λ in (Y, F_k)
    slope[:, at] = (degree * onset - point[0] * slope[:, 0]) / point[at]
    tail, tail_slope = _harmonics(point, i, one, fit.k, orbit, _HARMONICS)
    return Waveform(fit, i, orbit, onset, slope, tail, tail_slope)


def _onset(orbit: Orbit) -> Array:
    """(V_s, t_s, λ)."""
    return np.array([orbit.V_s, orbit.t_s, 4.0 * orbit.X - orbit.a])
