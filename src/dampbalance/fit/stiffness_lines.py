"""Lines of steady responses to a harmonic force, and the contact and oscillator of largest likelihood.

Each line is a complex number, the dynamic stiffness Z = (F/X)e^{iφ}, φ the lag of x behind the force F:

    Z = k + ¾k_3X² − mω² + i Σ p g_p/(πX²) + Σ κ_j D(X/r_j)

with the integrals g_p of the terms (`law/terms.py`) and the secant D of a slider (`law/contact.py`). The imaginary part
is the energy balance πX² Im Z = πFX sin φ, Eq. (14) of Liang & Feeny (2010), the real part the in-phase row, which a
contact lowers with the amplitude. Where the driven point moves with other modes, too, their residual receptance R
changes what is measured:

    1/Z_measured = 1/Z + R,    X = X_measured |1 − R Z_measured|

All unknowns are linear and not negative, except R and the r of a single slider, which are profiled. κ of a gradual
contact is piecewise linear over ln r, and as smooth as the prediction of levels that are left out asks for.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, NamedTuple, TypeAlias

import numpy as np
from scipy import optimize

from ..arrays import Array, Complexes, Integers, Mask
from ..law.contact import secant
from ..law.terms import FRICTION, term

Contact = Literal["none", "one slider", "gradual"]

_NODES, _BETWEEN = 32, 3  # of κ over ln r of a gradual contact; sliders from one node to the next
_LOWEST = 0.1  # r of its first node, of the smallest amplitude, at which it is felt
_RIGID, _PROFILE = 1e-3, 120  # smallest r of one slider, likewise; how many are tried
# Differences of κ r^{−1/2} are penalised: κ of bolted joints grows with a power of r between 0.2 and 1.2.
_GROWTH = 0.5
_SMOOTHINGS = np.geomspace(1e-3, 10.0, 5)
# A part of the smoothing that predicts best: its bias is then below the noise, and intervals hold what they say.
LESS = 0.1
_LEVELS = 4  # from which on levels are left out to choose it
_RECEPTANCES, _LARGEST_RECEPTANCE = 25, 0.6  # values of R that are tried, in 1/|Z|
_ITERATIONS, _MULTIPLIED = 4, 60
_FLOOR = 1e-9  # of |Z|: scatter of lines without noise


@dataclass(frozen=True, eq=False)
class SteppedLines:
    """Steady responses to a harmonic force, one line each.

    omega : rad/s, (n,).   X : displacement amplitude, m, (n,).   Z : (F/X)e^{iφ}, N/m, (n,), φ the lag of the
    displacement behind the force.   level : index into `names`, the levels of excitation, (n,).
    error : relative standard error of each |Z|, and of φ, rad, (n,), where it is known.
    """

    omega: Array
    X: Array
    Z: Complexes
    level: Integers
    names: tuple[str, ...]
    error: Array | None = None

    def __getitem__(self, kept: Mask) -> SteppedLines:
        """Some of the lines."""
        parts = {
            name: values[kept]
            for name in ("omega", "X", "Z", "level", "error")
            if (values := getattr(self, name)) is not None
        }
        return replace(self, **parts)

    def of_mode(self, R: float) -> SteppedLines:
        """Return the lines without the residual receptance R, m/N, of the other modes."""
        ratio = 1.0 - R * self.Z
        return replace(self, X=self.X * np.abs(ratio), Z=self.Z / ratio)


class Misfit(NamedTuple):
    """The distance of lines from a law.

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


StiffnessPart: TypeAlias = "tuple[Complexes, float]"
"""Part of Z by an unknown of unit size: its value at an amplitude of 1 m and the frequency of each line, (n,), and the
power of the amplitude with which it grows."""

_SPRING_PARTS: Mapping[str, tuple[Callable[[Array], Array], float]] = {
    "k": (np.ones_like, 0.0),
    "m": (lambda omega: -(omega**2), 0.0),
    "k_3": (lambda omega: np.full_like(omega, 0.75), 2.0),
}


def stiffness_part(name: str, omega: Array, stiffness: float | None) -> StiffnessPart:
    """Return the part of Z by an unknown of unit size. Raises ValueError for a term that lines do not tell."""
    if name in _SPRING_PARTS:
        size, power = _SPRING_PARTS[name]
        return np.asarray(size(omega) + 0j), power
    of = term(name)
    if of.force is None:
        raise ValueError(f'{FRICTION} belongs to the contact: ask for contact="one slider"')
    if of.linear and of.force(0.0, 1.0, 1.0, 1.0):
        raise ValueError(
            f"{name} acts against the base, whose motion the lines do not contain: use c"
        )
    if stiffness is None and of.force(1.0, 0.0, 2.0, 1.0) != of.force(1.0, 0.0, 1.0, 1.0):
        raise ValueError(f"the force of {name} depends on the spring: state stiffness")
    loss = of.harmonic(omega, 1.0, 0.0, 0.0, stiffness or 1.0)
    return np.asarray(1j * loss / math.pi), of.order - 1.0


@dataclass(frozen=True, eq=False)
class Point:
    """Unknowns, and χ².   linear : coefficients of the free ones.   nodes : κ at the nodes.   r, kappa : sliders."""

    linear: Array
    nodes: Array
    r: Array
    kappa: Array
    chi_square: float


@dataclass(frozen=True, eq=False)
class StiffnessRows:
    """Rows of the real and the imaginary part of each line in standard errors, for one residual receptance.

    lines : as measured.   free, given : unknowns that are linear, and those whose value is given.
    parts : of Z, by each of them.
    sigma : standard errors of the real and the imaginary part of each measured Z, N/m, (2, n).
    """

    lines: SteppedLines
    free: tuple[str, ...]
    given: Mapping[str, float]
    stiffness: float | None
    parts: Mapping[str, StiffnessPart]
    sigma: Array
    R: float = 0.0

    def __getitem__(self, kept: Mask) -> StiffnessRows:
        parts = {name: (size[kept], power) for name, (size, power) in self.parts.items()}
        return replace(self, lines=self.lines[kept], parts=parts, sigma=self.sigma[:, kept])

    @cached_property
    def mode(self) -> SteppedLines:
        """The lines of the mode, without R."""
        return self.lines.of_mode(self.R) if self.R else self.lines

    def measured(self, Z: Complexes) -> Complexes:
        """Return changes of the measured Z by those of the mode's, (n, …)."""
        return np.asarray(((1.0 - self.R * self.lines.Z) ** 2 * Z.T).T)

    def weighted(self, Z: Complexes) -> Array:
        """Return columns (n, …) of the mode's Z as rows of the measured, (2n, …)."""
        Z = self.measured(Z)
        return np.concatenate([(Z.real.T / self.sigma[0]).T, (Z.imag.T / self.sigma[1]).T])

    def columns(self, names: Sequence[str]) -> Complexes:
        """Return the parts of Z by unknowns of unit size, (n, p)."""
        X = self.mode.X
        columns = [size * X**power for size, power in map(self.parts.__getitem__, names)]
        return np.array(columns).reshape(len(names), X.size).T

    @cached_property
    def known(self) -> Complexes:
        """The part of Z by the given unknowns, (n,)."""
        return self.columns(tuple(self.given)) @ np.array(list(self.given.values()))

    @cached_property
    def linear(self) -> Array:
        """Rows of the free unknowns, (2n, p)."""
        return self.weighted(self.columns(self.free))

    @cached_property
    def target(self) -> Array:
        """Rows of the measured Z without what is given, (2n,)."""
        return self.weighted(self.mode.Z - self.known)

    def law(self, point: Point) -> Complexes:
        """Return Z of the mode by a law."""
        linear = self.columns(self.free) @ point.linear
        return np.asarray(self.known + linear + secant(self.mode.X, point.r) @ point.kappa)

    def misfit(self, point: Point) -> Misfit:
        """Return the distance of the lines from a law."""
        Z, law = self.mode.Z, self.law(point)
        both = law.imag / Z.imag - 1.0, law.real - Z.real
        in_phase, quadrature = np.split(self.weighted(law - Z), 2)
        loss, stiffness = (math.sqrt(np.mean(one**2)) for one in both)
        return Misfit(loss, stiffness, float(np.mean(quadrature**2)), float(np.mean(in_phase**2)))


def _nnls(A: Array, y: Array) -> Array:
    """Return coefficients ≥ 0 of least squares."""
    size = np.linalg.norm(A, axis=0)
    size[size == 0.0] = 1.0
    return np.asarray(optimize.nnls(A / size, y, maxiter=100 * A.shape[1])[0] / size)


@dataclass(frozen=True, eq=False)
class Design:
    """The rows of a contact, for one R or, near it, with R among the unknowns.

    nodes : r at which κ of a gradual contact is an unknown, m, or those that are tried for a single slider.
    direction : change of the rows with R, of length one, (2n,); all rows lose their part along it where R is free.
    """

    rows: StiffnessRows
    contact: Contact
    nodes: Array
    direction: Array | None = None

    @classmethod
    def of(cls, rows: StiffnessRows, contact: Contact) -> Design:
        """Return the design with the grid of r that the amplitudes of the lines ask for."""
        low, high = rows.mode.X.min(), rows.mode.X.max()
        if contact == "one slider":
            return cls(rows, contact, np.geomspace(_RIGID * low, high, _PROFILE + 1)[:-1])
        nodes = np.geomspace(_LOWEST * low, high, _NODES * (contact == "gradual"))
        return cls(rows, contact, nodes)

    def without_R(self, A: Array) -> Array:
        """Return rows without their part along the change with R, where R is free."""
        b = self.direction
        return A if b is None else A - np.multiply.outer(b, b @ A)

    @cached_property
    def stuck(self) -> bool:
        """Whether a slider that no line moves is an unknown: where k is free, it is a part of k."""
        return self.contact == "gradual" and "k" not in self.rows.free

    @cached_property
    def r(self) -> Array:
        """Sliders, m: of a gradual contact, more between its nodes."""
        if not self.nodes.size:
            return self.nodes
        at = np.arange((_NODES - 1) * _BETWEEN) / _BETWEEN
        fine = np.exp(np.interp(at, np.arange(_NODES), np.log(self.nodes)))
        return np.append(fine, self.nodes[-1:] if self.stuck else [])  # exact: it does not slip

    @cached_property
    def spread(self) -> Array:
        """κ of the sliders by κ at the nodes, and of the one that is stuck."""
        if not self.nodes.size:
            return np.zeros((0, 0))
        at = np.arange((_NODES - 1) * _BETWEEN + self.stuck) / _BETWEEN
        hats = np.maximum(1.0 - np.abs(np.subtract.outer(at, np.arange(_NODES))), 0.0)
        return np.hstack([hats, np.eye(at.size)[:, -1:]]) if self.stuck else hats

    def sliders(self, r: Array) -> Array:
        """Return rows of sliders of unit stiffness, (2n, j).   r : m, (j,)."""
        return self.without_R(self.rows.weighted(secant(self.rows.mode.X, r)))

    @cached_property
    def linear(self) -> Array:
        """Rows of the free unknowns, (2n, p)."""
        return self.without_R(self.rows.linear)

    @cached_property
    def joined(self) -> Array:
        """Rows of the free unknowns and of the nodes."""
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

    def solve(self, target: Array, smoothing: float = 0.0) -> Point:
        """Return the unknowns of largest likelihood for one right side.

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
        return Point(p[:own], p[own:], self.r, kappa, chi_square)

    def solve_each(self, targets: Iterable[Array], smoothing: float = 0.0) -> list[Point]:
        """Return the unknowns of largest likelihood for each of several right sides."""
        return [self.solve(target, smoothing) for target in targets]

    def with_slider(self, ln_r: float, target: Array) -> Point:
        """Return the unknowns of largest likelihood with one slider of this r, m."""
        r = np.exp([ln_r])
        return self._with_slider(r, self.sliders(r), self.without_R(target))

    def with_each_slider(self, target: Array) -> list[Point]:
        """Return the unknowns of largest likelihood with each of the sliders that are tried."""
        y, each = self.without_R(target), np.arange(self.nodes.size)[:, None]
        return [self._with_slider(self.nodes[i], self.tried[:, i], y) for i in each]

    def _with_slider(self, r: Array, column: Array, y: Array) -> Point:
        A = np.hstack([self.linear, column])
        p = _nnls(A, y)
        return Point(p[:-1], p[-1:], r, p[-1:], float(np.sum((A @ p - y) ** 2)))

    def _one_slider(self, y: Array) -> Point:
        """Return the best r of those tried, polished between its neighbours."""
        tried, free = np.log(self.nodes), np.ones(self.linear.shape[1], dtype=np.bool_)
        for _ in range(2):  # again without the linear unknowns that are at their bound
            q, across, inverse = self._across(tuple(free.tolist()))
            along = across.T @ (y - q @ (q.T @ y))
            best = int(np.argmax(np.maximum(along, 0.0) ** 2 * inverse))
            found = self._with_slider(self.nodes[[best]], self.tried[:, [best]], y)
            if found.linear.all():
                break
            free = found.linear > 0.0
        polished = optimize.minimize_scalar(
            lambda ln_r: self.with_slider(ln_r, y).chi_square,
            bounds=(float(tried[max(best - 1, 0)]), float(tried[min(best + 1, tried.size - 1)])),
            method="bounded",
            options={"xatol": 1e-4},
        )
        points = (found, self.with_slider(float(polished.x), y))
        return min(points, key=lambda point: point.chi_square)

    def _across(self, free: tuple[bool, ...]) -> tuple[Array, Array, Array]:
        """Return orthonormal free columns; those of sliders without their part along these; inverse squares of the
        rest."""
        if free in self.kept:
            return self.kept[free]
        q, columns = np.linalg.qr(self.linear[:, list(free)])[0], self.tried
        across = columns - q @ (q.T @ columns)
        square, whole = (np.sum(A**2, axis=0) for A in (across, columns))
        self.kept[free] = (
            q,
            across,
            np.where(square > 1e-9 * whole, 1.0 / np.maximum(square, 1e-300), 0.0),
        )
        return self.kept[free]

    @cached_property
    def tried(self) -> Array:
        """Rows of the sliders that are tried."""
        return self.sliders(self.nodes)

    @cached_property
    def kept(self) -> dict[tuple[bool, ...], tuple[Array, Array, Array]]:
        """Results of `_across`, by the columns that are free."""
        return {}


def _scatter(rows: StiffnessRows, left: Complexes, unknowns: int) -> Array:
    """Return standard errors of the real and the imaginary part of each Z, (2, n), from what the law leaves of them.

    Var Re = α + β|Z|², Var Im = γ(Im Z)² + δ|Z|²: an error of the law in N/m or as a part of the loss, and one of
    the measurement; by largest likelihood (multiplicative updates). Where lines state their errors, these count, times
    the factor by which the real or the imaginary parts scatter more than that.

    left : law less measured, N/m, (n,).   unknowns : of the law.
    """
    # of the law, as the noise of measured values would bias the weights by its square
    Z = rows.lines.Z + left
    n, size = left.size, np.abs(Z) ** 2
    squares = np.array([left.real**2, left.imag**2]) * (2.0 * n / max(2.0 * n - unknowns, 1.0))
    if rows.lines.error is not None:
        stated = np.broadcast_to(rows.lines.error**2 * size, (2, n))
        factor = np.mean(squares / stated, axis=1, keepdims=True)
        return np.sqrt(stated * np.maximum(factor, 1.0))
    variances = []
    own = (np.full(n, np.mean(size)), Z.imag**2)
    for square, of_law in zip(squares, own, strict=True):
        parts = np.array([of_law, size])
        share = 0.5 * np.full(2, np.mean(square / size) + _FLOOR**2)
        for _ in range(_MULTIPLIED):
            variance = share @ parts + _FLOOR**2 * size
            share *= (parts @ (square / variance**2)) / (parts @ (1.0 / variance))
        variances.append(share @ parts + _FLOOR**2 * size)
    return np.sqrt(variances)


@dataclass(frozen=True, eq=False)
class ContactEstimate:
    """A fit: its rows with their errors and its design, the unknowns, and the smoothing."""

    design: Design
    point: Point
    smoothing: float

    @property
    def rows(self) -> StiffnessRows:
        """The rows of the fit."""
        return self.design.rows

    def scatter(self, residual: bool) -> Array:
        """Return standard errors of the rows that its misfit shows, N/m, (2, n). residual : whether R is an unknown."""
        own, point = self.rows, self.point
        used = np.count_nonzero(np.concatenate([point.linear, point.nodes])) + residual
        left = own.measured(own.law(point) - own.mode.Z)
        return _scatter(own, left, int(used) + (self.design.contact == "one slider"))

    def _part(self, kept: Mask) -> Design:
        return Design(self.rows[kept], self.design.contact, self.design.nodes)

    @cached_property
    def _levels(self) -> list[tuple[Mask, Design]]:
        """For each level: its lines, and the design of the others."""
        masks = [self.rows.lines.level == of for of in range(len(self.rows.lines.names))]
        return [(mask, self._part(~mask)) for mask in masks if not mask.all()]

    def held_out(self, smoothing: float) -> list[Misfit]:
        """Return misfit of each level to the law of the others."""
        return [
            self.rows[mask].misfit(others.solve(others.rows.target, smoothing))
            for mask, others in self._levels
        ]

    def smoothed(self) -> ContactEstimate:
        """Return the fit with the smoothing that levels, or generalised cross-validation where they are few, ask
        for."""
        if len(self._levels) >= _LEVELS:
            scores = [np.mean([one.score for one in self.held_out(s)]) for s in _SMOOTHINGS]
        else:
            scores = [self._generalised(s) for s in _SMOOTHINGS]
        smoothing = LESS * float(_SMOOTHINGS[int(np.argmin(scores))])
        return ContactEstimate(
            self.design, self.design.solve(self.rows.target, smoothing), smoothing
        )

    def _generalised(self, smoothing: float) -> np.floating:
        """Return χ² over the square of the degrees of freedom that are left."""
        point = self.design.solve(self.rows.target, smoothing)
        active = np.concatenate([point.linear, point.nodes]) > 0.0
        A, L = self.design.joined[:, active], smoothing * self.design.roughness[:, active]
        size = np.linalg.norm(A, axis=0)
        normal = (A / size).T @ (A / size)
        used = np.trace(np.linalg.pinv(normal + (L / size).T @ (L / size)) @ normal)
        return np.float64(point.chi_square / max(len(A) - float(used), 1e-9) ** 2)


def estimated(
    rows: StiffnessRows, contact: Contact, residual: bool, steps: int = _ITERATIONS
) -> ContactEstimate:
    """Return the fit of a contact, its errors iterated; with one step, those of the rows are kept."""
    most = _LARGEST_RECEPTANCE / float(np.abs(rows.lines.Z).max())
    tried = np.linspace(-most, most, _RECEPTANCES) if residual else np.zeros(1)
    smoothing = LESS * float(np.median(_SMOOTHINGS))

    def at(R: float) -> ContactEstimate:
        design = Design.of(replace(rows, R=float(R)), contact)
        return ContactEstimate(design, design.solve(design.rows.target, smoothing), smoothing)

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
            rows = replace(rows, sigma=found.scatter(residual))
    return found
