"""Steady responses to a harmonic force, line by line: contact, damping, stiffness and mass of largest likelihood.

Each line is a complex number, the dynamic stiffness Z = (F/X)e^{iφ}, φ the lag of x behind the force F:

    Z = k + ¾k_3X² − mω² + i Σ p g_p/(πX²) + Σ κ_j D(X/r_j)

g_p are the integrals of the terms (`law/terms.py`), D is the secant of a slider (`law/gradual.py`). πX² Im Z = πFX sin φ
is the energy balance, Eq. (14) of Liang & Feeny (2010); Re Z the in-phase row, which a contact lowers with the amplitude.
Where the driven point moves with other modes, too, their residual receptance R changes what is measured:

    1/Z_measured = 1/Z + R,    X = X_measured |1 − R Z_measured|

All unknowns but R and the r of a single slider are linear and not negative; these two are profiled. A gradual contact
has sliders on a grid of r, and κ varies smoothly over ln r as far as levels that are left out ask for it.
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
from ..law.terms import FRICTION, term
from ..reading.one_thread import one_thread

Contact = Literal["none", "one slider", "gradual"]

NODES = 20
"""Sliders of a gradual contact, at equidistant ln r."""


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

    def __getitem__(self, kept: Mask | Integers) -> SteppedLines:
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

    @property
    def reach(self) -> Array:
        """Largest displacement of each line from the middle of its motion, m, (n,)."""
        return self.X if self.cycle is None else 0.5 * np.ptp(self.cycle, axis=1)

    def secant(self, r: Array) -> Complexes:
        """D of sliders, (n, j): of the recorded cycles, or of a harmonic motion.   r : m, (j,)."""
        return secant(self.X, r) if self.cycle is None else secant_of_cycles(self.cycle, r)


class Band(NamedTuple):
    """A value and its interval of 95 %, each an array: loss per cycle in J, or stiffness in N/m."""

    value: Array
    low: Array
    high: Array


class Misfit(NamedTuple):
    """How far lines lie from a law: root mean squares of (loss of the law)/W − 1 and of the in-phase part, N/m, and the
    mean square of both in standard errors."""

    loss: float
    in_phase: float
    score: float


def column(name: str, omega: Array, X: Array, stiffness: float | None) -> Complexes:
    """What one unknown of unit size adds to Z, (n,): k, m, k_3 or the coefficient of a term.

    Raises ValueError for a term that lines do not tell.
    """
    if name in _OF_SPRING:
        return np.asarray(_OF_SPRING[name](omega, X) + 0j)
    loss = term(name)
    if name == FRICTION:
        raise ValueError('F_k is a part of the contact: ask for contact="one slider"')
    if loss.force is None or loss.force(0.0, 1.0, 1.0, 1.0):
        raise ValueError(f"{name} acts against the base, whose motion lines do not tell: use c")
    if stiffness is None and loss.force(1.0, 0.0, 2.0, 1.0) != loss.force(1.0, 0.0, 1.0, 1.0):
        raise ValueError(f"{name} takes a part of the spring's force: state stiffness")
    g = loss.harmonic(omega, X, 0.0, 0.0, stiffness or 1.0)
    return np.asarray(1j * g / (math.pi * X**2))


_OF_SPRING: Mapping[str, Callable[[Array, Array], Array]] = {
    "k": lambda omega, X: np.ones_like(X),
    "m": lambda omega, X: -(omega**2),
    "k_3": lambda omega, X: 0.75 * X**2,
}


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
        return self.lines.of_mode(self.R)

    def weighted(self, Z: Complexes) -> Array:
        """Columns (n, …) of the mode's Z as rows of the measured, (2n, …)."""
        moved = ((1.0 - self.R * self.lines.Z) ** 2 * Z.T).T
        return np.concatenate([(moved.real.T / self.sigma[0]).T, (moved.imag.T / self.sigma[1]).T])

    def columns(self, names: Sequence[str]) -> Complexes:
        at = (self.mode.omega, self.mode.X, self.stiffness)
        return np.array([column(name, *at) for name in names]).reshape(len(names), at[0].size).T

    @cached_property
    def known(self) -> Complexes:
        return self.columns(tuple(self.given)) @ np.array(list(self.given.values()))

    @cached_property
    def linear(self) -> Array:
        return self.weighted(self.columns(self.free))

    @cached_property
    def target(self) -> Array:
        return self.weighted(self.mode.Z - self.known)

    def sliders(self, r: Array) -> Array:
        return self.weighted(self.mode.secant(r))

    def law(self, point: _Point) -> Complexes:
        """Z of the mode by a law."""
        linear = self.columns(self.free) @ point.linear
        return np.asarray(self.known + linear + self.mode.secant(point.r) @ point.kappa)

    def misfit(self, point: _Point) -> Misfit:
        """How far the lines lie from a law."""
        Z, law = self.mode.Z, self.law(point)
        squares = self.weighted(law - Z) ** 2
        parts = (law.imag / Z.imag - 1.0, law.real - Z.real)
        return Misfit(*(math.sqrt(np.mean(part**2)) for part in parts), float(np.mean(squares)))


@dataclass(frozen=True, eq=False)
class _Point:
    """Unknowns.   linear : coefficients of the free ones.   r, kappa : sliders.   R : residual receptance, m/N."""

    linear: Array
    r: Array
    kappa: Array
    R: float = 0.0
    chi_square: float = math.nan


def _nnls(A: Array, y: Array) -> Array:
    """Coefficients ≥ 0 of least squares."""
    from scipy import optimize  # slow to import

    size = np.linalg.norm(A, axis=0)
    size[size == 0.0] = 1.0
    return np.asarray(optimize.nnls(A / size, y, maxiter=100 * A.shape[1])[0] / size)


@dataclass(frozen=True, eq=False)
class _Design:
    """The rows of a contact, for one R or, near it, with R among the unknowns.

    grid : r of the sliders, m, or what a single one is sought among.   direction : change of the rows with R, of length
    one, (2n,); all rows lose their part along it where R is free.
    """

    rows: _Rows
    contact: Contact
    grid: Array | None = None
    direction: Array | None = None

    def without_R(self, A: Array) -> Array:
        b = self.direction
        return A if b is None else A - np.multiply.outer(b, b @ A)

    @cached_property
    def nodes(self) -> Array:
        """Grid of r, m: sliders that slip at no line act as k, and only where k is given one of them is kept."""
        if self.grid is not None or self.contact == "none":
            return np.zeros(0) if self.grid is None else self.grid
        X = self.rows.mode.reach
        one = self.contact == "one slider"
        lowest, count = (_RIGID, _PROFILE) if one else (_BELOW, NODES)
        grid = np.geomspace(lowest * X.min(), X.max(), count + 1)
        return grid[: count + (not one and "k" not in self.rows.free)]

    @cached_property
    def linear(self) -> Array:
        return self.without_R(self.rows.linear)

    @cached_property
    def sliders(self) -> Array:
        return self.without_R(self.rows.sliders(self.nodes))

    @cached_property
    def joined(self) -> Array:
        return np.hstack([self.linear, self.sliders])

    @cached_property
    def roughness(self) -> Array:
        """Second differences of κ over ln r, in units of the length of a slider's column, as rows of `joined`."""
        size = float(np.median(np.linalg.norm(self.sliders, axis=0)))
        second = np.diff(np.eye(NODES), 2, axis=0) * size
        zeros = np.zeros((NODES - 2, self.linear.shape[1])), np.zeros((NODES - 2, 1))
        return np.hstack([zeros[0], second, zeros[1][:, : self.nodes.size - NODES]])

    @cached_property
    def reduced(self) -> tuple[Array, Array]:
        """Orthonormal columns and the triangle of `joined`."""
        return np.linalg.qr(self.joined)

    def solve(self, target: Array, smoothing: float = 0.0) -> _Point:
        """The unknowns of largest likelihood, and χ², for one right side.

        smoothing : of a gradual contact: weight of the second differences of κ over ln r.
        """
        y = self.without_R(target)
        if self.contact == "one slider":
            return self._one_slider(y)
        q, triangle = self.reduced
        on = q.T @ y
        if self.contact == "gradual":
            triangle = np.vstack([triangle, smoothing * self.roughness])
            on = np.concatenate([on, np.zeros(NODES - 2)])
        return self._point(_nnls(triangle, on), self.nodes, self.joined, y)

    def _one_slider(self, y: Array) -> _Point:
        """The best r of the grid, polished between its neighbours."""
        from scipy import optimize  # slow to import

        free = y - self.basis @ (self.basis.T @ y)
        along = self.across.T @ free
        gain = np.where(along > 0.0, along, 0.0) ** 2 * self.inverse_square
        at = lambda ln_r: self._with_slider(math.exp(ln_r), y)
        best = int(np.argmax(gain))
        found = at(math.log(self.nodes[best]))
        if not found.linear.all():  # a bound holds, which the gain does not know
            tried = [at(math.log(r)).chi_square for r in self.nodes]
            best = int(np.argmin(tried))
        ends = np.log(self.nodes[[max(best - 1, 0), min(best + 1, self.nodes.size - 1)]])
        polished = optimize.minimize_scalar(
            lambda ln_r: at(ln_r).chi_square, bounds=ends, method="bounded", options={"xatol": 1e-4}
        )
        return min(found, at(float(polished.x)), key=lambda point: point.chi_square)

    @cached_property
    def basis(self) -> Array:
        return np.linalg.qr(self.linear)[0]

    @cached_property
    def across(self) -> Array:
        """Columns of sliders without their part along the linear unknowns."""
        return self.sliders - self.basis @ (self.basis.T @ self.sliders)

    @cached_property
    def inverse_square(self) -> Array:
        square, whole = (np.sum(A**2, axis=0) for A in (self.across, self.sliders))
        return np.where(square > 1e-9 * whole, 1.0 / np.maximum(square, 1e-300), 0.0)

    def _with_slider(self, r: float, y: Array) -> _Point:
        node = np.array([r])
        A = np.hstack([self.linear, self.without_R(self.rows.sliders(node))])
        return self._point(_nnls(A, y), node, A, y)

    def _point(self, p: Array, r: Array, A: Array, y: Array) -> _Point:
        own = self.linear.shape[1]
        chi_square = float(np.sum((A @ p - y) ** 2))
        return _Point(p[:own], r, p[own:], self.rows.R, chi_square)


_RIGID, _PROFILE = 1e-3, 120  # smallest r of one slider, of the smallest amplitude; its grid
_BELOW = 1.0 / 3.0  # smallest r of a gradual contact, likewise
_RECEPTANCES = 25
_LARGEST_RECEPTANCE = 0.6  # of 1/|Z|
_SMOOTHINGS = np.geomspace(1e-3, 30.0, 10)
_ITERATIONS = 4
_FLOOR = 1e-9  # of |Z|: scatter of lines without noise


def _scatter(rows: _Rows, residual: Complexes, unknowns: int) -> Array:
    """Standard errors of the real and the imaginary part of each Z, (2, n), from what is left of them.

    Var Re = α + β|Z|², Var Im = γ(Im Z)² + δ(Re Z)²: errors of the law in N/m and as a part of the loss, errors of the
    amplitude and of the phase. Where lines state their errors, these count, times the factor by which the real or the
    imaginary parts scatter more than that.   residual : measured less law.   unknowns : of the law.
    """
    Z = rows.lines.Z
    n = Z.size
    more = 2.0 * n / max(2.0 * n - unknowns, 1.0)
    squares = np.array([residual.real**2, residual.imag**2]) * more
    if rows.lines.error is not None:
        stated = np.broadcast_to(rows.lines.error * np.abs(Z), (2, n))
        factor = np.sqrt(np.mean(squares / stated**2, axis=1, keepdims=True))
        return np.asarray(stated * np.maximum(factor, 1.0))
    absolute, size = np.full(n, np.mean(np.abs(Z) ** 2)), np.abs(Z) ** 2
    variances = []
    for square, parts in zip(squares, ([absolute, size], [Z.imag**2, Z.real**2]), strict=True):
        A = np.array(parts).T
        variance = A[:, 0] * np.mean(square) / np.mean(A[:, 0])
        for _ in range(_ITERATIONS):
            weight = 1.0 / np.maximum(variance, _FLOOR**2 * size)
            variance = A @ _nnls(A * weight[:, None], square * weight)
        variances.append(np.maximum(variance, _FLOOR**2 * size))
    return np.sqrt(variances)


@dataclass(frozen=True, eq=False)
class _Estimate:
    """A fit: its rows with their errors, its design, the unknowns, the smoothing and how it was chosen."""

    design: _Design
    point: _Point
    smoothing: float = 0.0
    chosen_by: str = ""

    @property
    def rows(self) -> _Rows:
        return self.design.rows

    def without(self, kept: Mask) -> _Design:
        """The design of some lines."""
        return _Design(self.rows[kept], self.design.contact, self.design.nodes)

    @cached_property
    def halves(self) -> list[tuple[Mask, _Design]]:
        """For each level: its lines, and the design of the others."""
        level = self.rows.lines.level
        masks = [level == of for of in range(len(self.rows.lines.names))]
        return [(mask, self.without(~mask)) for mask in masks]

    def held_out(self, smoothing: float) -> list[Misfit]:
        """Misfit of each level to the law of the others."""
        return [
            self.rows[mask].misfit(others.solve(others.rows.target, smoothing))
            for mask, others in self.halves
        ]

    def extrapolated(self) -> Misfit:
        """Misfit of the upper half of the levels, by amplitude, to the law of the lower half."""
        lines = self.rows.mode
        largest = [lines.reach[lines.level == of].max() for of in range(len(lines.names))]
        lower = np.isin(lines.level, np.argsort(largest)[: (len(largest) + 1) // 2])
        design = self.without(lower)
        return self.rows[~lower].misfit(design.solve(design.rows.target, self.smoothing))

    def smoothed(self) -> _Estimate:
        """The smoothing that predicts levels best; of fewer than four levels, by generalised cross-validation."""
        target = self.rows.target
        if len(self.halves) >= _LEVELS:
            by = "levels left out"
            scores = [np.mean([one.score for one in self.held_out(s)]) for s in _SMOOTHINGS]
        else:
            by = "generalised cross-validation, since there are fewer than four levels"
            scores = [self._generalised(s) for s in _SMOOTHINGS]
        best = float(_SMOOTHINGS[int(np.argmin(scores))])
        return replace(self, point=self.design.solve(target, best), smoothing=best, chosen_by=by)

    def _generalised(self, smoothing: float) -> float:
        """Generalised cross-validation: χ² over the square of the degrees of freedom that are left."""
        point = self.design.solve(self.rows.target, smoothing)
        active = np.concatenate([point.linear, point.kappa]) > 0.0
        A, L = self.design.joined[:, active], smoothing * self.design.roughness[:, active]
        size = np.linalg.norm(A, axis=0)
        A, L = A / size, L / size
        used = float(np.trace(np.linalg.pinv(A.T @ A + L.T @ L) @ (A.T @ A)))
        return point.chi_square / max(len(A) - used, 1e-9) ** 2


_LEVELS = 4


def _estimated(rows: _Rows, contact: Contact, residual: bool) -> _Estimate:
    """The fit of a contact, its errors iterated."""
    from scipy import optimize  # slow to import

    most = _LARGEST_RECEPTANCE / float(np.abs(rows.lines.Z).max()) if residual else 0.0
    tried = np.linspace(-most, most, _RECEPTANCES) if residual else np.zeros(1)
    smoothing = _SMOOTHINGS[4]

    def at(R: float) -> _Estimate:
        design = _Design(replace(rows, R=R), contact)
        return _Estimate(design, design.solve(design.rows.target, smoothing), smoothing)

    for step in range(_ITERATIONS):
        found = min((at(float(R)) for R in tried), key=lambda one: one.point.chi_square)
        if residual:
            gap = tried[1] - tried[0]
            polished = optimize.minimize_scalar(
                lambda R: at(R).point.chi_square,
                bounds=(found.rows.R - gap, found.rows.R + gap),
                method="bounded",
                options={"xatol": 1e-4 * most},
            )
            found = at(float(polished.x))
            tried = found.rows.R + np.linspace(-gap, gap, 5)
        if contact == "gradual":
            found = found.smoothed()
            smoothing = found.smoothing
        if step < _ITERATIONS - 1:
            ratio = 1.0 - found.rows.R * rows.lines.Z
            left = (found.rows.mode.Z - found.rows.law(found.point)) * ratio**2
            rows = replace(rows, sigma=_scatter(rows, left, _count(found)))
    return found


def _count(found: _Estimate) -> int:
    """Unknowns that are not at a bound."""
    point = found.point
    one = found.design.contact == "one slider"
    return int(np.count_nonzero(point.linear) + np.count_nonzero(point.kappa)) + one


@dataclass(frozen=True, eq=False)
class ContactFit:
    """A contact and an oscillator identified from stepped lines.

    contact, terms : of the law.   values : k, m, k_3, R and the coefficients of terms, SI units, the given ones too.
    r, kappa : sliders, m and N/m, (j,).   errors, intervals : standard errors and intervals of 95 % of what is not
    given, of F_k and K_z, and of the r of one slider, by replicates.   residuals : (loss of the law)/W − 1 as the
    imaginary part, the in-phase difference as a part of |Z| as the real part, (n,).   misfit : their root mean squares.
    held_out : of each level, predicted from the others.   X_range : amplitudes that were seen, m.
    smoothing, chosen_by : weight of the smoothness of κ, and what chose it.
    lower_limit : whether lines tell only a lower limit of K_z: what slips, slips long before the amplitudes seen.
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
    lower_limit: bool
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
        """Friction force that the contact reaches at the amplitudes seen, N."""
        return self.sliders.F_k

    def loss(self, X: Array, omega: Array | float) -> Band:
        """Energy lost per cycle at amplitudes X, m, and angular frequencies, rad/s, with its interval, J, each (n,).

        Raises ValueError outside of the amplitudes seen.
        """
        X, omega = (
            self._inside(X),
            np.broadcast_to(np.asarray(omega, dtype=np.float64), np.shape(X)),
        )
        return self._band(X, omega, self.terms, lambda Z: math.pi * X**2 * Z.imag.T)

    def stiffness(self, X: Array) -> Band:
        """Stiffness of the fundamental, k + ¾k_3X² + Σ κ Re D, at amplitudes X, m, with its interval, N/m, each (n,).

        Raises ValueError outside of the amplitudes seen.
        """
        X = self._inside(X)
        return self._band(X, np.ones_like(X), ("k", "k_3"), lambda Z: Z.real.T)

    def _inside(self, X: Array) -> Array:
        X = np.atleast_1d(np.asarray(X, dtype=np.float64))
        low, high = self.X_range
        if not ((X >= low * (1.0 - 1e-9)) & (X <= high * (1.0 + 1e-9))).all():
            raise ValueError(
                f"the law holds for the amplitudes that were seen, {low:.4g} to {high:.4g} m, got "
                f"{X.min():.4g} to {X.max():.4g} m: keep within them, or measure there"
            )
        return X

    def _band(
        self, X: Array, omega: Array, names: Sequence[str], of: Callable[[Complexes], Array]
    ) -> Band:
        names = [name for name in names if name in self.values]
        parts = np.array([column(name, omega, X, self.stiffness_given) for name in names])

        def Z(values: Array, r: Array, kappa: Array) -> Complexes:
            D = secant(X, r.ravel()).reshape(X.size, *r.shape)
            return np.asarray(np.tensordot(values, parts, 1).T + np.sum(D * kappa, axis=-1))

        own = np.array([self.values[name] for name in names])
        value = of(Z(own[None], self.r[None], self.kappa[None]))[0]
        draws = self.draws
        drawn = of(Z(draws.of(names, self.values), draws.r, draws.kappa))
        return Band(value, *_interval(value, drawn))


class _Draws(NamedTuple):
    """Replicates: linear unknowns by name (B,), sliders (B, j)."""

    linear: Mapping[str, Array]
    r: Array
    kappa: Array

    def of(self, names: Sequence[str], given: Mapping[str, float]) -> Array:
        """Values of these unknowns, (B, p)."""
        count = len(self.r)
        return np.array([self.linear.get(n, np.full(count, given[n])) for n in names]).T


def _interval(value: Array, drawn: Array) -> tuple[Array, Array]:
    """Interval of 95 % from replicates, along their first axis."""
    low, high = np.quantile(drawn, [0.025, 0.975], axis=0)
    return low, high


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
    residual : whether other modes may move the driven point, R.
    replicates, seed : of the intervals.

    Raises ValueError for lines that do not determine the unknowns.
    """
    rows = _asked(lines, contact, terms, given or {}, stiffness, mass, hardening)
    estimate = _estimated(rows, contact, residual)
    return _fitted(estimate, tuple(terms), residual, replicates, seed)


def _asked(
    lines: SteppedLines,
    contact: Contact,
    terms: Sequence[str],
    given: Mapping[str, float],
    stiffness: float | None,
    mass: float | None,
    hardening: bool,
) -> _Rows:
    """The rows of what was asked for, each line with an error of 5 % to start with. Raises ValueError."""
    own = {"k": stiffness, "m": mass} | {name: given.get(name) for name in terms}
    known = {name: value for name, value in own.items() if value is not None}
    free = [name for name, value in own.items() if value is None]
    alike = lines.reach.max() < _ALIKE * lines.reach.min()
    if hardening and not alike:
        free.append("k_3")
    sigma = np.array([_FIRST * np.abs(lines.Z)] * 2)
    rows = _Rows(lines, tuple(free), known, stiffness, sigma)
    if contact != "none" and alike:
        raise ValueError(
            f"the amplitudes of all lines are alike, {lines.reach.min():.4g} to {lines.reach.max():.4g} m: a contact "
            "shows in what changes with the amplitude; add levels of excitation"
        )
    needed = len(free) + {"none": 0, "one slider": 2, "gradual": 6}[contact]
    if 2 * lines.X.size < needed + 2:
        raise ValueError(
            f"{lines.X.size} lines are too few for {needed} unknowns: add lines or levels, or state stiffness or mass"
        )
    size = np.linalg.norm(rows.linear, axis=0)
    if np.linalg.svd(rows.linear / size, compute_uv=False)[-1] < _SINGULAR:
        raise ValueError(
            f"the lines do not separate {', '.join(free)}: add lines at other frequencies or levels, or state "
            "stiffness or mass"
        )
    return rows


_FIRST = 0.05
_ALIKE = 1.05
_SINGULAR = 1e-7


def _fitted(
    found: _Estimate, terms: tuple[str, ...], residual: bool, replicates: int, seed: int
) -> ContactFit:
    """The estimate with its intervals."""
    rows, point, contact = found.rows, found.point, found.design.contact
    change = _of_receptance(found) if residual else np.zeros(0)
    size = float(np.linalg.norm(change))
    design = replace(found.design, direction=change / size if residual else None)
    random = np.random.default_rng(seed)
    law = rows.weighted(rows.law(point) - rows.known)
    noise = random.standard_normal((replicates, law.size))
    drawn = [design.solve(law + of, found.smoothing) for of in noise]
    linear = np.array([one.linear for one in drawn])
    draws = _Draws(
        dict(zip(rows.free, linear.T, strict=True)),
        np.array([one.r for one in drawn]),
        np.array([one.kappa for one in drawn]),
    )
    reach = rows.mode.reach
    values = dict(rows.given) | dict(zip(rows.free, point.linear.tolist(), strict=True))
    of_draws = dict(draws.linear)
    estimates = dict(zip(rows.free, point.linear, strict=True))
    if residual:
        values["R"] = estimates["R"] = rows.R
        moved = [rows.weighted(rows.law(one) - rows.known) for one in drawn]
        of_draws["R"] = rows.R + (law + noise - np.array(moved)) @ change / size**2
    if contact != "none":
        for name, power in (("K_z", 0), ("F_k", 1)):
            slips = (one.kappa * one.r**power * (one.r < reach.max()) for one in (point, draws))
            estimates[name], of_draws[name] = (np.sum(part, axis=-1) for part in slips)
    if contact == "one slider":
        estimates["r"], of_draws["r"] = point.r[0], draws.r[:, 0]
    intervals = {
        name: tuple(map(float, _interval(estimates[name], values)))
        for name, values in of_draws.items()
    }
    mode, Z = rows.mode, rows.law(point)
    left = (Z.real - mode.Z.real) / np.abs(mode.Z) + 1j * (Z.imag / mode.Z.imag - 1.0)
    held_out = found.held_out(found.smoothing) if len(rows.lines.names) > 1 else []
    return ContactFit(
        contact,
        terms,
        values,
        point.r,
        point.kappa,
        {name: float(np.std(values, ddof=1)) for name, values in of_draws.items()},
        intervals,
        left,
        rows.misfit(point),
        dict(zip(rows.lines.names, held_out, strict=False)),
        (float(reach.min()), float(reach.max())),
        found.smoothing,
        found.chosen_by,
        False,
        rows.stiffness,
        draws,
    )


def _of_receptance(found: _Estimate) -> Array:
    """Change of what the law leaves of the rows with R, (2n,)."""
    step = 1e-4 / float(np.abs(found.rows.lines.Z).max())
    sides = [replace(found.rows, R=found.rows.R + sign * step) for sign in (-1.0, 1.0)]
    low, high = (side.weighted(side.law(found.point) - side.mode.Z) for side in sides)
    return np.asarray((high - low) / (2.0 * step))
