"""Steady responses to a harmonic force, line by line: contact, damping, stiffness and mass of largest likelihood.

Each line is a complex number, the dynamic stiffness Z = (F/X)e^{iφ}, φ the lag of x behind the force F:

    Z = k + ¾k_3X² − mω² + i Σ p g_p/(πX²) + Σ κ_j D(X/r_j)

with the integrals g_p of the terms (`law/terms.py`) and the secant D of a slider (`law/gradual.py`). πX² Im Z = πFX sin φ
is the energy balance, Eq. (14) of Liang & Feeny (2010); Re Z is the in-phase row, which a contact lowers with the
amplitude. Where the driven point moves with other modes, too, their residual receptance R changes what is measured:

    1/Z_measured = 1/Z + R,    X = X_measured |1 − R Z_measured|

All unknowns are linear and not negative, except R and the r of a single slider, which are profiled. κ of a gradual
contact is piecewise linear over ln r, and as smooth as the prediction of levels that are left out asks for.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np

from ..arrays import Array, Complexes, Integers, Mask
from ..law.gradual import Sliders, secant, secant_of_cycles
from ..law.terms import FRICTION, listed, term
from ..reading.one_thread import one_thread
from .mean_harmonics import Reading

Contact = Literal["none", "one slider", "gradual"]

_NODES, _BETWEEN = 32, 3  # of κ over ln r of a gradual contact; sliders from one node to the next
_LOWEST = 1.0 / 3.0  # r of its first node, of the smallest amplitude
_RIGID, _PROFILE = 1e-3, 120  # smallest r of one slider, likewise; how many are tried
# Differences of κ r^{−1/2} are penalised: κ of bolted joints grows with a power of r between 0.2 and 1.2.
_GROWTH = 0.5
_SMOOTHINGS = np.geomspace(1e-3, 10.0, 5)
# Of the smoothing that predicts best: its bias is then below the noise, and intervals hold what they say.
_LESS = 0.1
_LEVELS = 4  # from which on levels are left out to choose it
_RECEPTANCES, _LARGEST_RECEPTANCE = 25, 0.6  # values of R that are tried, in 1/|Z|
_FIRST_ERROR = 0.05  # of Z, where the iteration of errors starts
_ITERATIONS, _MULTIPLIED = 4, 60
_FLOOR = 1e-9  # of |Z|: scatter of lines without noise
_ALIKE = 1.05  # of amplitudes: closer ones count as one
_SINGULAR = 1e-7
_NORMAL, _CHI_SQUARE = 1.96, 3.84  # of intervals of 95 %
_POINTS = 512  # of a recorded cycle


@dataclass(frozen=True, eq=False)
class SteppedLines:
    """Steady responses to a harmonic force, one line each.

    omega : rad/s, (n,).   X : displacement amplitude, m, (n,).   Z : (F/X)e^{iφ}, N/m, (n,), φ the lag of the
    displacement behind the force.   level : index into `names`, the levels of excitation, (n,).
    error : relative standard error of each |Z|, and of φ, rad, (n,), where it is known.
    cycle : equidistant samples of one cycle of the motion, m, (n, N), where it was recorded.
    """

    omega: Array
    X: Array
    Z: Complexes
    level: Integers
    names: tuple[str, ...]
    error: Array | None = None
    cycle: Array | None = None

    def __getitem__(self, kept: Mask) -> SteppedLines:
        """Some of the lines."""
        parts = {
            name: values[kept]
            for name in ("omega", "X", "Z", "level", "error", "cycle")
            if (values := getattr(self, name)) is not None
        }
        return replace(self, **parts)

    def of_mode(self, R: float) -> SteppedLines:
        """The lines without the residual receptance R, m/N, of the other modes."""
        ratio = 1.0 - R * self.Z
        cycle = None if self.cycle is None else self.cycle * np.abs(ratio)[:, None]
        return replace(self, X=self.X * np.abs(ratio), Z=self.Z / ratio, cycle=cycle)

    @cached_property
    def reach(self) -> Array:
        """Largest displacement of each line from the middle of its motion, m, (n,)."""
        return self.X if self.cycle is None else 0.5 * np.ptp(self.cycle, axis=1)

    def secant(self, r: Array) -> Complexes:
        """D of sliders, (n, j): of the recorded cycles, or of a harmonic motion.   r : m, (j,)."""
        return secant(self.X, r) if self.cycle is None else secant_of_cycles(self.cycle, r)


def lines_of(readings: Sequence[Reading], k: float) -> SteppedLines:
    """Lines of forced records, one each: Z = kY/x_1, and the cycle as its harmonics give it.

    Use it to look for a gradual contact in records in time; their higher harmonics move the instants of slip, which the
    sliders follow.   readings : of records on a base that moves.   k : N/m.
    """
    means = [reading.mean for reading in readings]
    x, Y = (
        np.array([value[0] for value in parts])
        for parts in ([mean.x[0] for mean in means], [mean.Y for mean in means])
    )
    of = [reading.lines for reading in readings]
    error = [math.hypot(one.x_error[0] / abs(one.x[0]), one.Y_error / one.Y) for one in of]
    return SteppedLines(
        omega=np.array([one.omega for one in of]),
        X=np.abs(x),
        Z=k * Y / x,
        level=np.arange(len(of)),
        names=tuple(reading.steady.source for reading in readings),
        error=np.array(error),
        cycle=np.array([reading.averaged_cycle(_POINTS)["x"] for reading in readings]),
    )


class Band(NamedTuple):
    """A value and its interval of 95 %, each an array: loss per cycle in J, or stiffness in N/m."""

    value: Array
    low: Array
    high: Array


class Misfit(NamedTuple):
    """How far lines lie from a law.

    loss, in_phase : root mean squares of (loss of the law)/W − 1 and of the in-phase difference, N/m.
    loss_score, in_phase_score : mean squares of the same in standard errors.
    """

    loss: float
    in_phase: float
    loss_score: float
    in_phase_score: float

    @property
    def score(self) -> float:
        """Mean square of both in standard errors."""
        return 0.5 * (self.loss_score + self.in_phase_score)


_OF_SPRING: Mapping[str, Callable[[Array, Array], Array]] = {
    "k": lambda omega, X: np.ones_like(X),
    "m": lambda omega, X: -(omega**2),
    "k_3": lambda omega, X: 0.75 * X**2,
}


def _column(name: str, omega: Array, X: Array, stiffness: float | None) -> Complexes:
    """What an unknown of unit size adds to Z, (n,). Raises ValueError for a term that lines do not tell."""
    if name in _OF_SPRING:
        return np.asarray(_OF_SPRING[name](omega, X) + 0j)
    of = term(name)
    if of.force is None:
        raise ValueError(f'{FRICTION} belongs to the contact: ask for contact="one slider"')
    if of.linear and of.force(0.0, 1.0, 1.0, 1.0):
        raise ValueError(f"{name} acts against the base, whose motion the lines do not hold: use c")
    if stiffness is None and of.force(1.0, 0.0, 2.0, 1.0) != of.force(1.0, 0.0, 1.0, 1.0):
        raise ValueError(f"the force of {name} depends on the spring: state stiffness")
    return np.asarray(1j * of.harmonic(omega, X, 0.0, 0.0, stiffness or 1.0) / (math.pi * X**2))


@dataclass(frozen=True, eq=False)
class _Point:
    """Unknowns, and χ².   linear : coefficients of the free ones.   nodes : κ at the nodes.   r, kappa : sliders."""

    linear: Array
    nodes: Array
    r: Array
    kappa: Array
    chi_square: float


@dataclass(frozen=True, eq=False)
class _Rows:
    """Rows of the real and the imaginary part of each line in standard errors, for one residual receptance.

    lines : as measured.   free, given : unknowns that are linear, and those whose value is given.
    sigma : standard errors of the real and the imaginary part of each measured Z, N/m, (2, n).
    """

    lines: SteppedLines
    free: tuple[str, ...]
    given: Mapping[str, float]
    stiffness: float | None
    sigma: Array
    R: float = 0.0

    def __getitem__(self, kept: Mask) -> _Rows:
        return replace(self, lines=self.lines[kept], sigma=self.sigma[:, kept])

    @cached_property
    def mode(self) -> SteppedLines:
        return self.lines.of_mode(self.R) if self.R else self.lines

    def measured(self, Z: Complexes) -> Complexes:
        """Changes of the measured Z by those of the mode's, (n, …)."""
        return np.asarray(((1.0 - self.R * self.lines.Z) ** 2 * Z.T).T)

    def weighted(self, Z: Complexes) -> Array:
        """Columns (n, …) of the mode's Z as rows of the measured, (2n, …)."""
        Z = self.measured(Z)
        return np.concatenate([(Z.real.T / self.sigma[0]).T, (Z.imag.T / self.sigma[1]).T])

    def columns(self, names: Sequence[str]) -> Complexes:
        omega, X = self.mode.omega, self.mode.X
        columns = [_column(name, omega, X, self.stiffness) for name in names]
        return np.array(columns).reshape(len(names), X.size).T

    @cached_property
    def known(self) -> Complexes:
        return self.columns(tuple(self.given)) @ np.array(list(self.given.values()))

    @cached_property
    def linear(self) -> Array:
        return self.weighted(self.columns(self.free))

    @cached_property
    def target(self) -> Array:
        return self.weighted(self.mode.Z - self.known)

    def law(self, point: _Point) -> Complexes:
        """Z of the mode by a law."""
        linear = self.columns(self.free) @ point.linear
        return np.asarray(self.known + linear + self.mode.secant(point.r) @ point.kappa)

    def misfit(self, point: _Point) -> Misfit:
        """How far the lines lie from a law."""
        Z, law = self.mode.Z, self.law(point)
        both = law.imag / Z.imag - 1.0, law.real - Z.real
        in_phase, quadrature = np.split(self.weighted(law - Z), 2)
        loss, stiffness = (math.sqrt(np.mean(one**2)) for one in both)
        return Misfit(loss, stiffness, float(np.mean(quadrature**2)), float(np.mean(in_phase**2)))


def _nnls(A: Array, y: Array) -> Array:
    """Coefficients ≥ 0 of least squares."""
    from scipy import optimize  # slow to import

    size = np.linalg.norm(A, axis=0)
    size[size == 0.0] = 1.0
    return np.asarray(optimize.nnls(A / size, y, maxiter=100 * A.shape[1])[0] / size)


@dataclass(frozen=True, eq=False)
class _Design:
    """The rows of a contact, for one R or, near it, with R among the unknowns.

    nodes : r at which κ of a gradual contact is an unknown, m, or those that are tried for a single slider.
    direction : change of the rows with R, of length one, (2n,); all rows lose their part along it where R is free.
    """

    rows: _Rows
    contact: Contact
    nodes: Array
    direction: Array | None = None

    @classmethod
    def of(cls, rows: _Rows, contact: Contact) -> _Design:
        low, high = rows.mode.reach.min(), rows.mode.reach.max()
        if contact == "one slider":
            return cls(rows, contact, np.geomspace(_RIGID * low, high, _PROFILE + 1)[:-1])
        nodes = np.geomspace(_LOWEST * low, high, _NODES * (contact == "gradual"))
        return cls(rows, contact, nodes)

    def without_R(self, A: Array) -> Array:
        b = self.direction
        return A if b is None else A - np.multiply.outer(b, b @ A)

    @cached_property
    def stuck(self) -> bool:
        """Whether a slider that no line moves is an unknown: where k is free, it is a part of k."""
        return self.contact == "gradual" and "k" not in self.rows.free

    @cached_property
    def r(self) -> Array:
        """Sliders, m: of a gradual contact, more between its nodes."""
        at = np.arange((_NODES - 1) * _BETWEEN + self.stuck) / _BETWEEN
        fine = (
            np.interp(at, np.arange(self.nodes.size), np.log(self.nodes))
            if self.nodes.size
            else at[:0]
        )
        return np.exp(fine)

    @cached_property
    def spread(self) -> Array:
        """κ of the sliders by κ at the nodes, and of the one that is stuck."""
        if not self.nodes.size:
            return np.zeros((0, 0))
        at = np.arange((_NODES - 1) * _BETWEEN + self.stuck) / _BETWEEN
        hats = np.maximum(1.0 - np.abs(np.subtract.outer(at, np.arange(_NODES))), 0.0)
        return np.hstack([hats, np.eye(at.size)[:, -1:]]) if self.stuck else hats

    def sliders(self, r: Array) -> Array:
        return self.without_R(self.rows.weighted(self.rows.mode.secant(r)))

    @cached_property
    def linear(self) -> Array:
        return self.without_R(self.rows.linear)

    @cached_property
    def joined(self) -> Array:
        return np.hstack([self.linear, self.sliders(self.r) @ self.spread])

    @cached_property
    def roughness(self) -> Array:
        """Second differences of κ r^{−1/2} over ln r, in units of the median column of a node."""
        own, of = self.linear.shape[1], self.joined.shape[1]
        size = float(np.median(np.linalg.norm(self.joined[:, own:], axis=0)))
        second = np.diff(np.eye(_NODES), 2, axis=0) * (self.nodes / self.nodes[-1]) ** -_GROWTH
        rough = np.zeros((_NODES - 2, of))
        rough[:, own : own + _NODES] = size * second
        return rough

    @cached_property
    def reduced(self) -> tuple[Array, Array]:
        """Orthonormal columns and the triangle of `joined`."""
        q, triangle = np.linalg.qr(self.joined)
        return q, triangle

    def solve(self, target: Array, smoothing: float = 0.0) -> _Point:
        """The unknowns of largest likelihood for one right side.

        smoothing : of a gradual contact, weight of the second differences.
        """
        y = self.without_R(target)
        if self.contact == "one slider":
            return self._one_slider(y)
        q, triangle = self.reduced
        on = q.T @ y
        if self.contact == "gradual":
            triangle = np.vstack([triangle, smoothing * self.roughness])
            on = np.concatenate([on, np.zeros(_NODES - 2)])
        p = _nnls(triangle, on)
        own = self.linear.shape[1]
        kappa = self.spread @ p[own:]
        chi_square = float(np.sum((self.joined @ p - y) ** 2))
        return _Point(p[:own], p[own:], self.r, kappa, chi_square)

    def with_slider(self, ln_r: float, target: Array) -> _Point:
        """The unknowns of largest likelihood with one slider of this r, m."""
        r, y = np.exp([ln_r]), self.without_R(target)
        A = np.hstack([self.linear, self.sliders(r)])
        p = _nnls(A, y)
        return _Point(p[:-1], p[-1:], r, p[-1:], float(np.sum((A @ p - y) ** 2)))

    def _one_slider(self, y: Array) -> _Point:
        """The best r of those tried, polished between its neighbours."""
        from scipy import optimize  # slow to import

        q, across, inverse = self._across
        along = across.T @ (y - q @ (q.T @ y))
        tried = np.log(self.nodes)
        best = int(np.argmax(np.maximum(along, 0.0) ** 2 * inverse))
        found = self.with_slider(tried[best], y)
        if not found.linear.all():  # a bound holds, which this gain does not know
            best = int(np.argmin([self.with_slider(one, y).chi_square for one in tried]))
        polished = optimize.minimize_scalar(
            lambda ln_r: self.with_slider(ln_r, y).chi_square,
            bounds=(float(tried[max(best - 1, 0)]), float(tried[min(best + 1, tried.size - 1)])),
            method="bounded",
            options={"xatol": 1e-4},
        )
        points = (found, self.with_slider(float(polished.x), y))
        return min(points, key=lambda point: point.chi_square)

    @cached_property
    def _across(self) -> tuple[Array, Array, Array]:
        """Orthonormal linear columns; columns of sliders without their part along these; inverse squares of the rest."""
        q, columns = np.linalg.qr(self.linear)[0], self.sliders(self.nodes)
        across = columns - q @ (q.T @ columns)
        square, whole = (np.sum(A**2, axis=0) for A in (across, columns))
        return q, across, np.where(square > 1e-9 * whole, 1.0 / np.maximum(square, 1e-300), 0.0)


def _scatter(rows: _Rows, left: Complexes, unknowns: int) -> Array:
    """Standard errors of the real and the imaginary part of each Z, (2, n), from what the law leaves of them.

    Var Re = α + β|Z|², Var Im = γ(Im Z)² + δ|Z|²: an error of the law in N/m or as a part of the loss, and one of
    the measurement; by largest likelihood (multiplicative updates). Where lines state their errors, these count, times
    the factor by which the real or the imaginary parts scatter more than that.

    left : law less measured, N/m, (n,).   unknowns : of the law.
    """
    n, size = left.size, np.abs(rows.lines.Z) ** 2
    squares = np.array([left.real**2, left.imag**2]) * (2.0 * n / max(2.0 * n - unknowns, 1.0))
    if rows.lines.error is not None:
        stated = np.broadcast_to(rows.lines.error**2 * size, (2, n))
        factor = np.mean(squares / stated, axis=1, keepdims=True)
        return np.sqrt(stated * np.maximum(factor, 1.0))
    variances = []
    own = (np.full(n, np.mean(size)), (rows.lines.Z + left).imag ** 2)
    for square, of_law in zip(squares, own, strict=True):
        parts = np.array([of_law, size])
        share = 0.5 * np.full(2, np.mean(square / size) + _FLOOR**2)
        for _ in range(_MULTIPLIED):
            variance = share @ parts + _FLOOR**2 * size
            share *= (parts @ (square / variance**2)) / (parts @ (1.0 / variance))
        variances.append(share @ parts + _FLOOR**2 * size)
    return np.sqrt(variances)


@dataclass(frozen=True, eq=False)
class _Estimate:
    """A fit: its rows with their errors and its design, the unknowns, the smoothing and what chose it."""

    design: _Design
    point: _Point
    smoothing: float
    chosen_by: str = ""

    @property
    def rows(self) -> _Rows:
        return self.design.rows

    def _part(self, kept: Mask) -> _Design:
        return _Design(self.rows[kept], self.design.contact, self.design.nodes)

    @cached_property
    def _levels(self) -> list[tuple[Mask, _Design]]:
        """For each level: its lines, and the design of the others."""
        masks = [self.rows.lines.level == of for of in range(len(self.rows.lines.names))]
        return [(mask, self._part(~mask)) for mask in masks if not mask.all()]

    def held_out(self, smoothing: float) -> list[Misfit]:
        """Misfit of each level to the law of the others."""
        return [
            self.rows[mask].misfit(others.solve(others.rows.target, smoothing))
            for mask, others in self._levels
        ]

    def extrapolated(self) -> Misfit:
        """Misfit of the upper half of the levels, by amplitude, to the law of the lower half."""
        lines = self.rows.mode
        largest = [lines.reach[lines.level == of].max() for of in range(len(lines.names))]
        lower = np.isin(lines.level, np.argsort(largest)[: (len(largest) + 1) // 2])
        design = self._part(lower)
        return self.rows[~lower].misfit(design.solve(design.rows.target, self.smoothing))

    def smoothed(self) -> _Estimate:
        """With the smoothing that levels, or generalised cross-validation where they are few, ask for."""
        if len(self._levels) >= _LEVELS:
            by = "levels that are left out"
            scores = [np.mean([one.score for one in self.held_out(s)]) for s in _SMOOTHINGS]
        else:
            by = f"generalised cross-validation, as there are fewer than {_LEVELS} levels"
            scores = [self._generalised(s) for s in _SMOOTHINGS]
        smoothing = _LESS * float(_SMOOTHINGS[int(np.argmin(scores))])
        return _Estimate(self.design, self.design.solve(self.rows.target, smoothing), smoothing, by)

    def _generalised(self, smoothing: float) -> np.floating:
        """χ² over the square of the degrees of freedom that are left."""
        point = self.design.solve(self.rows.target, smoothing)
        active = np.concatenate([point.linear, point.nodes]) > 0.0
        A, L = self.design.joined[:, active], smoothing * self.design.roughness[:, active]
        size = np.linalg.norm(A, axis=0)
        normal = (A / size).T @ (A / size)
        used = np.trace(np.linalg.pinv(normal + (L / size).T @ (L / size)) @ normal)
        return np.float64(point.chi_square / max(len(A) - float(used), 1e-9) ** 2)


def _estimated(
    rows: _Rows, contact: Contact, residual: bool, steps: int = _ITERATIONS
) -> _Estimate:
    """The fit of a contact, its errors iterated; with one step, those of the rows are kept."""
    from scipy import optimize  # slow to import

    most = _LARGEST_RECEPTANCE / float(np.abs(rows.lines.Z).max())
    tried = np.linspace(-most, most, _RECEPTANCES) if residual else np.zeros(1)
    smoothing = _LESS * float(np.median(_SMOOTHINGS))

    def at(R: float) -> _Estimate:
        design = _Design.of(replace(rows, R=float(R)), contact)
        return _Estimate(design, design.solve(design.rows.target, smoothing), smoothing)

    for step in range(steps):
        found = min(map(at, tried), key=lambda one: one.point.chi_square)
        if residual:
            R, gap = found.rows.R, float(tried[1] - tried[0])
            polished = optimize.minimize_scalar(
                lambda R: at(R).point.chi_square,
                bounds=(R - gap, R + gap),
                method="bounded",
                options={"xatol": 1e-4 * most},
            )
            found = at(polished.x)
            tried = found.rows.R + gap * np.linspace(-1.0, 1.0, 5)
        if contact == "gradual":
            found = found.smoothed()
            smoothing = found.smoothing
        if step < steps - 1:
            own, point = found.rows, found.point
            left = own.measured(own.law(point) - own.mode.Z)
            used = int(np.count_nonzero(np.concatenate([point.linear, point.nodes])))
            rows = replace(
                rows, sigma=_scatter(own, left, used + (contact == "one slider") + residual)
            )
    return found


class _Draws(NamedTuple):
    """Replicates: linear unknowns by name, (B,), and sliders, (B, j)."""

    linear: Mapping[str, Array]
    r: Array
    kappa: Array


@dataclass(frozen=True, eq=False)
class ContactFit:
    """A contact and an oscillator identified from stepped lines.

    contact, terms : of the law.
    values : k, m, k_3, R and the coefficients of the terms, SI units, the given ones too.
    r, kappa : sliders, m and N/m, (j,).
    errors, intervals : standard errors and intervals of 95 % of what is not given, of F_k and K_z, and of the r of one
    slider. The upper end of K_z is infinite where the amplitudes are so large that lines tell only a lower limit.
    residuals : in-phase difference as a part of |Z|, the real part; (loss of the law)/W − 1, the imaginary part, (n,).
    misfit : root mean squares.   held_out : the same of each level, predicted from the others.
    X_range : amplitudes that were seen, m.
    smoothing, chosen_by : weight of the smoothness of κ, and what chose it.
    """

    contact: Contact
    terms: tuple[str, ...]
    values: Mapping[str, float]
    r: Array
    kappa: Array
    errors: Mapping[str, float]
    intervals: Mapping[str, tuple[float, float]]
    residuals: Complexes
    misfit: Misfit
    held_out: Mapping[str, Misfit]
    X_range: tuple[float, float]
    smoothing: float
    chosen_by: str
    stiffness_given: float | None = field(repr=False)
    draws: _Draws = field(repr=False)

    @property
    def sliders(self) -> Sliders:
        """Those that slip at the amplitudes seen."""
        slips = self.r < self.X_range[1]
        return Sliders(self.r[slips], self.kappa[slips])

    @property
    def K_z(self) -> float:
        """Stiffness of the contact that yields at the amplitudes seen, N/m."""
        return self.sliders.K_z

    @property
    def F_k(self) -> float:
        """Friction force of the contact that yields at the amplitudes seen, N."""
        return self.sliders.F_k

    def loss(self, X: Array | float, omega: Array | float) -> Band:
        """Energy lost per cycle at amplitudes X, m, and angular frequencies, rad/s, with its interval, J, each (n,).

        Raises ValueError outside of the amplitudes seen.
        """
        X = self._inside(X)
        omega = np.broadcast_to(np.asarray(omega, dtype=np.float64), X.shape)
        return self._band(X, omega, self.terms, lambda Z: math.pi * X**2 * Z.imag)

    def stiffness(self, X: Array | float) -> Band:
        """Stiffness of the fundamental, k + ¾k_3X² + Σ κ Re D, at amplitudes X, m, with its interval, N/m, each (n,).

        Raises ValueError outside of the amplitudes seen.
        """
        X = self._inside(X)
        return self._band(X, np.ones_like(X), ("k", "k_3"), lambda Z: Z.real)

    def _inside(self, X: Array | float) -> Array:
        X = np.atleast_1d(np.asarray(X, dtype=np.float64))
        low, high = self.X_range
        if not (X.min() >= low * (1.0 - 1e-9) and X.max() <= high * (1.0 + 1e-9)):
            raise ValueError(
                f"the law is known for the amplitudes that were seen, {low:.4g} to {high:.4g} m, got {X.min():.4g} to "
                f"{X.max():.4g} m: keep within them, or measure there"
            )
        return X

    def _band(
        self, X: Array, omega: Array, names: Sequence[str], of: Callable[[Complexes], Array]
    ) -> Band:
        names = [name for name in names if name in self.values]
        parts = np.array([_column(name, omega, X, self.stiffness_given) for name in names])
        drawn = self.draws
        values = np.array([[self.values[name], *drawn.linear.get(name, ())] for name in names])
        r = np.vstack([self.r, drawn.r])
        Z = np.zeros((len(r), X.size), dtype=np.complex128)
        for row, own, kappa in zip(Z, r, np.vstack([self.kappa, drawn.kappa]), strict=True):
            row += secant(X, own) @ kappa
        all_Z = of(Z + values.T @ parts) if names else of(Z)
        return Band(all_Z[0], *_interval(all_Z[0], all_Z[1:]))


def _interval(value: Array, drawn: Array) -> tuple[Array, Array]:
    """Interval of 95 % from replicates along the first axis: by their standard deviation, and by their bias, which
    smoothing causes and which is not subtracted as it is uncertain itself."""
    half = _NORMAL * np.hypot(np.std(drawn, axis=0, ddof=1), np.mean(drawn, axis=0) - value)
    return value - half, value + half


@one_thread
def fit_contact(
    lines: SteppedLines,
    *,
    contact: Contact,
    terms: Sequence[str] = ("c",),
    given: Mapping[str, float] | None = None,
    stiffness: float | None = None,
    mass: float | None = None,
    hardening: bool = True,
    residual: bool = False,
    replicates: int = 200,
    seed: int = 2010,
) -> ContactFit:
    """Identify a contact and the damping from steady responses at several amplitudes.

    Use it for tables of a stepped sine. "one slider" is the contact of the paper; a bolted joint, which yields
    gradually, needs "gradual"; `compare_contacts` says which one the lines support.

    lines : steady responses.
    contact : "none", "one slider" or "gradual".
    terms : of the damping in addition to the contact, of `law.terms.KNOWN_TERMS`.
    given : coefficients of terms that are known.
    stiffness, mass : k, N/m, and m, kg, where they are known.
    hardening : whether the spring may stiffen, ¾k_3X².
    residual : whether other modes move the driven point, too: R.
    replicates, seed : of the intervals.

    Raises ValueError for lines that do not determine the unknowns.
    """
    rows = _asked(lines, contact, terms, given or {}, stiffness, mass, hardening)
    return _fitted(_estimated(rows, contact, residual), tuple(terms), residual, replicates, seed)


def _asked(
    lines: SteppedLines,
    contact: Contact,
    terms: Sequence[str],
    given: Mapping[str, float],
    stiffness: float | None,
    mass: float | None,
    hardening: bool,
) -> _Rows:
    """Rows of what was asked for, with the errors to start from. Raises ValueError."""
    low, high = lines.reach.min(), lines.reach.max()
    alike = high < _ALIKE * low
    if contact != "none" and alike:
        raise ValueError(
            f"the amplitudes of all lines are alike, {low:.4g} to {high:.4g} m, and a contact shows in what changes "
            "with the amplitude: add levels of excitation"
        )
    own = {"k": stiffness, "m": mass} | {name: given.get(name) for name in terms}
    free = [name for name, value in own.items() if value is None]
    free += ["k_3"] * (hardening and not alike)
    known = {name: value for name, value in own.items() if value is not None}
    rows = _Rows(lines, tuple(free), known, stiffness, _FIRST_ERROR * np.abs([lines.Z] * 2))
    unknowns = len(free) + {"none": 0, "one slider": 2, "gradual": 6}[contact]
    if 2 * lines.X.size < unknowns + 2:
        raise ValueError(
            f"{lines.X.size} lines are too few for {unknowns} unknowns: add lines or levels, or state stiffness or mass"
        )
    columns = rows.linear / np.linalg.norm(rows.linear, axis=0)
    if free and np.linalg.svd(columns, compute_uv=False)[-1] < _SINGULAR:
        raise ValueError(
            f"the lines do not separate {', '.join(free)}: add lines at other frequencies or levels, or state "
            "stiffness or mass"
        )
    return rows


def _fitted(
    found: _Estimate, terms: tuple[str, ...], residual: bool, replicates: int, seed: int
) -> ContactFit:
    """The estimate with its intervals, from replicates of the lines about the law."""
    rows, point, contact = found.rows, found.point, found.design.contact
    design = _with_R(found) if residual else found.design
    law = rows.weighted(rows.law(point) - rows.known)
    targets = law + np.random.default_rng(seed).standard_normal((replicates, law.size))
    points = [design.solve(target, found.smoothing) for target in targets]
    draws = _Draws(
        dict(zip(rows.free, np.array([one.linear for one in points]).T, strict=True)),
        np.array([one.r for one in points]),
        np.array([one.kappa for one in points]),
    )
    reach = rows.mode.reach
    values = dict(rows.given) | dict(zip(rows.free, point.linear.tolist(), strict=True))
    estimates, drawn = {name: values[name] for name in rows.free}, dict(draws.linear)
    if residual:
        laws = np.array([rows.weighted(rows.law(one) - rows.known) for one in points])
        values["R"] = estimates["R"] = rows.R
        change = _of_receptance(found)
        drawn["R"] = rows.R + (targets - laws) @ change / float(change @ change)
    if contact != "none":
        for name, power in (("K_z", 0), ("F_k", 1)):
            parts = [one.kappa * one.r**power * (one.r < reach.max()) for one in (point, draws)]
            estimates[name], drawn[name] = float(np.sum(parts[0])), np.sum(parts[1], axis=1)
    if contact == "one slider":
        estimates["r"], drawn["r"] = float(point.r[0]), draws.r[:, 0]
    intervals = {}
    for name, of in drawn.items():
        low, high = (float(end) for end in _interval(np.array(estimates[name]), of))
        intervals[name] = (low if name == "R" else max(low, 0.0), high)
    if contact == "one slider":
        near = [design.with_slider(ln_r, rows.target) for ln_r in np.log(design.nodes)]
        best = min(one.chi_square for one in (*near, design.solve(rows.target)))
        allowed = [one.chi_square < best + _CHI_SQUARE for one in near]
        if allowed[0]:
            lowest = min(float(one.kappa[0]) for one, may in zip(near, allowed, strict=True) if may)
            intervals["K_z"] = (lowest, math.inf)
    Z, measured = rows.law(point), rows.mode.Z
    left = (Z.real - measured.real) / np.abs(measured) + 1j * (Z.imag / measured.imag - 1.0)
    held_out = found.held_out(found.smoothing)
    return ContactFit(
        contact,
        terms,
        values,
        point.r,
        point.kappa,
        {name: float(np.std(of, ddof=1)) for name, of in drawn.items()},
        intervals,
        left,
        rows.misfit(point),
        dict(zip(rows.lines.names, held_out, strict=bool(held_out))),
        (float(reach.min()), float(reach.max())),
        found.smoothing,
        found.chosen_by,
        rows.stiffness,
        draws,
    )


def _with_R(found: _Estimate) -> _Design:
    """The design with R among its unknowns."""
    change = _of_receptance(found)
    return replace(found.design, direction=change / np.linalg.norm(change))


def _of_receptance(found: _Estimate) -> Array:
    """Change of the rows of the law, less those measured, with R, (2n,)."""
    step = 1e-4 / float(np.abs(found.rows.lines.Z).max())
    sides = [replace(found.rows, R=found.rows.R + sign * step) for sign in (-1.0, 1.0)]
    low, high = (side.weighted(side.law(found.point) - side.mode.Z) for side in sides)
    return np.asarray((high - low) / (2.0 * step))


@dataclass(frozen=True, eq=False)
class ContactTrial:
    """A contact that was compared.

    name : "gradual", "one slider" or "none" with its terms.   fit : to all lines.   held_out : misfit of each level to
    the law of the others, in the standard errors of the gradual contact.   extrapolated : likewise of the upper half of
    the levels to the law of the lower half.
    """

    name: str
    fit: ContactFit
    held_out: tuple[Misfit, ...]
    extrapolated: Misfit

    def scores(self, which: str = "score") -> Array:
        """Mean square misfit of each level, in standard errors."""
        return np.array([getattr(misfit, which) for misfit in self.held_out])

    def as_good_as(self, other: ContactTrial, which: str = "score") -> bool:
        """Whether levels are predicted as well, within one standard error of the difference."""
        worse = self.scores(which) - other.scores(which)
        return float(np.mean(worse)) <= float(np.std(worse, ddof=1)) / math.sqrt(worse.size)


@dataclass(frozen=True, eq=False)
class ContactComparison:
    """Which contact stepped lines support.

    trials : simplest first.   supported : name of the simplest one that predicts levels as well as the best does.
    p : probability, for one slider, of a misfit that exceeds that of a gradual contact by as much.   indistinguishable :
    others that predict as well.   by_stiffness : those that predict the loss as well, and not the in-phase rows.
    """

    trials: tuple[ContactTrial, ...]
    supported: str
    p: float
    indistinguishable: tuple[str, ...]
    by_stiffness: tuple[str, ...]

    def __getitem__(self, name: str) -> ContactTrial:
        return next(trial for trial in self.trials if trial.name == name)

    def words(self) -> str:
        """The result in one sentence."""
        chosen = self[self.supported]
        loss, stiffness = chosen.fit.misfit[:2]
        said = (
            f"the lines support {_WORDS[chosen.fit.contact]} with {listed(chosen.fit.terms)} "
            f"(loss {100.0 * loss:.2g} %, in-phase {stiffness:.3g} N/m rms)"
        )
        if self.supported in ("one slider", "gradual"):
            enough = "is enough" if self.supported == "one slider" else "is not enough"
            said += f"; one slider {enough} (p = {self.p:.2g})"
        if self.indistinguishable:
            others = " or ".join(self.indistinguishable)
            said += f"; levels that are left out do not distinguish it from {others}: add levels"
        for name in self.by_stiffness:
            other = self[name].fit.misfit
            said += (
                f"; {name} has the same loss ({100.0 * other.loss:.2g} %), and the in-phase rows tell them apart "
                f"({other.in_phase:.3g} N/m)"
            )
        return said


_WORDS = {
    "none": "no contact",
    "one slider": "one slider",
    "gradual": "a contact that yields gradually",
}
_FALSE_ALARMS = 0.05  # of a gradual contact where one slider is the truth


@one_thread
def compare_contacts(
    lines: SteppedLines,
    *,
    terms: Sequence[str] = ("c",),
    given: Mapping[str, float] | None = None,
    stiffness: float | None = None,
    mass: float | None = None,
    hardening: bool = True,
    residual: bool = False,
    replicates: int = 200,
    seed: int = 2010,
) -> ContactComparison:
    """Compare no contact, with damping up to a cubic one, a single slider and a gradual contact.

    Use it before an answer is taken from stepped lines. Each level is left out and predicted by the law of the others.
    The simplest contact is supported that predicts as well as the best one, within one standard error of the difference
    over levels; a gradual contact, in addition, only if one slider is rejected at 5 % by the ratio of likelihoods, whose
    distribution comes from replicates of the lines about one slider.

    Arguments as for `fit_contact`. Raises ValueError for fewer than three levels.
    """
    if len(lines.names) < _COMPARED:
        raise ValueError(
            f"contacts are compared by levels that are left out, and there are {len(lines.names)}: add levels of "
            f"excitation, {_COMPARED} at least, or ask for one contact"
        )
    more = [name for name in ("c_2", "c_3") if name not in terms]
    laws: dict[str, tuple[Contact, tuple[str, ...]]] = {
        f"none ({', '.join(of)})": ("none", of)
        for of in ((*terms, *more[:count]) for count in range(len(more) + 1))
    }
    laws = dict(sorted([*laws.items(), ("one slider", ("one slider", tuple(terms)))], key=_size))
    laws["gradual"] = ("gradual", tuple(terms))
    asked = {
        name: _asked(lines, contact, of, given or {}, stiffness, mass, hardening)
        for name, (contact, of) in laws.items()
    }
    own = {name: _estimated(asked[name], laws[name][0], residual) for name in laws}
    sigma = own["gradual"].rows.sigma
    alike = {
        name: _estimated(replace(rows, sigma=sigma), laws[name][0], residual, steps=1)
        for name, rows in asked.items()
    }
    trials = [
        ContactTrial(
            name,
            _fitted(own[name], laws[name][1], residual, replicates, seed),
            tuple(found.held_out(found.smoothing)),
            found.extrapolated(),
        )
        for name, found in alike.items()
    ]
    p = _one_slider_is_enough(alike["one slider"], alike["gradual"], residual, replicates, seed)
    best = min(trials, key=lambda trial: float(np.mean(trial.scores())))
    good = [trial for trial in trials if trial.as_good_as(best)]
    supported = good[0].name
    if supported == "gradual" and p > _FALSE_ALARMS:
        supported = "one slider"
    chosen = next(trial for trial in trials if trial.name == supported)
    others = [trial for trial in trials if trial.name != supported]
    by_stiffness = [
        trial.name
        for trial in others
        if trial not in good and trial.as_good_as(chosen, "loss_score")
    ]
    return ContactComparison(
        tuple(trials),
        supported,
        p,
        tuple(trial.name for trial in others if trial in good),
        tuple(by_stiffness),
    )


def _one_slider_is_enough(
    one: _Estimate, gradual: _Estimate, residual: bool, replicates: int, seed: int
) -> float:
    """Probability, if one slider is the truth, that a gradual contact fits better by as much as it does."""
    designs = [
        (_with_R(found) if residual else found.design, found.smoothing) for found in (one, gradual)
    ]
    law = one.rows.weighted(one.rows.law(one.point) - one.rows.mode.Z)
    noise = np.random.default_rng(seed).standard_normal((replicates, law.size))

    def gain(moved: Array) -> float:
        misfits = [
            design.solve(design.rows.target + moved, smoothing).chi_square
            for design, smoothing in designs
        ]
        return misfits[0] - misfits[1]

    gained = gain(np.zeros(law.size))
    larger = sum(gain(law + of) >= gained for of in noise)
    return (1.0 + larger) / (replicates + 1.0)


def _size(law: tuple[str, tuple[Contact, tuple[str, ...]]]) -> float:
    """How many unknowns a law has; one slider comes before a damping with as many."""
    contact, terms = law[1]
    return len(terms) + 1.5 * (contact == "one slider")


_COMPARED = 3
