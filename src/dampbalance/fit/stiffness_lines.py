"""Lines of dynamic stiffness: steady responses at some frequencies and amplitudes, and what a contact and an oscillator
leave of them.

Each line is a complex number, the dynamic stiffness Z = (F/X)e^{iφ}, φ the lag of x behind the force F, of a table of a
stepped sine or of the fundamental of a forced record, F = kY:

    Z = k + ¾k_3X² − mω² + i Σ p g_p/(πX²) + Σ κ_j D(r_j/X)

with the integrals g_p of the terms (`law/terms.py`) and the describing function D of a contact (`law/contact.py`). The
imaginary part is the energy balance πX² Im Z = πFX sin φ, Eq. (14) of Liang & Feeny (2010), the real part the in-phase
row, which a contact lowers with the amplitude. Where the driven point moves with other modes, too, their residual
receptance R changes it:

    1/Z_measured = 1/Z + R,    X = X_measured |1 − R Z_measured|

Unknowns that are linear and not negative are solved for at each step of a climb in the others: F_k and ρ = K_z^{−1/2}
of one slider, and R. A gradual contact has sliders at many r, close to each other, none of them negative, and κ is as
smooth over ln r as it is asked to be.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Literal, NamedTuple

import numpy as np
from scipy import optimize

from ..arrays import Array, Complexes, Integers, Mask
from ..law.contact import Sliders, secant
from ..law.terms import FRICTION, KNOWN_TERMS
from .multistart import climb_on
from .parameters import Parameters

Contact = Literal["none", "one slider", "gradual"]

_LINEAR = {"k", "m", "k_3", *KNOWN_TERMS} - {FRICTION}  # unknowns

# Differences of κ r^{−1/2} are penalised: κ of bolted joints grows with a power of r between 0.2 and 1.2.
_GROWTH = 0.5
# r of one slider to start from, and the smallest, of the smallest amplitude
_TRIED, _RIGID = 60, 1e-3
# κ of a slider that is not found, of K_z, at the smallest amplitude: as large as keeps intervals of 95 % true for
# contacts of 2 to 30 sliders
_HIDDEN = 0.01
_SOFTEST = 1e-9  # of |Z|: a contact that is none
_LEAST = 1e-300  # size of a column that is zero
_STEP = 1e-4  # of an unknown, for central differences of a closed form: errors of 1e-8
_MULTIPLIED, _FLOOR = 60, 1e-9  # of the scatter: updates; least, of |Z|, of lines without noise


@dataclass(frozen=True, eq=False)
class StiffnessLines:
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

    def of_mode(self, R: float) -> StiffnessLines:
        """Return the lines without the residual receptance R, m/N, of the other modes."""
        ratio = 1.0 - R * self.Z
        return replace(self, X=self.X * np.abs(ratio), Z=self.Z / ratio)


def _part(name: str, lines: StiffnessLines, k: float) -> Complexes:
    """Return the part of Z by a linear unknown of unit size, N/m, (n,)."""
    omega, X = lines.omega, lines.X
    if name in KNOWN_TERMS:
        Y, phi = np.abs(lines.Z) * X / k, np.angle(lines.Z)  # of a base that drives
        g = KNOWN_TERMS[name].harmonic(omega, X, Y, phi, k)
        return np.asarray(1j * g / (math.pi * X**2))
    sizes = {"k": np.ones_like(X), "m": -(omega**2), "k_3": 0.75 * X**2}
    return np.asarray(sizes[name] + 0j)


class Misfit(NamedTuple):
    """The distance of lines from a law.

    loss, in_phase : root mean squares of (loss of the law)/W − 1 and of the in-phase difference, N/m.
    score : mean square of both in standard errors.
    """

    loss: float
    in_phase: float
    score: float


def _nonnegative(A: Array, y: Array) -> Array:
    """Return coefficients of least squares that are not negative."""
    size = np.maximum(np.linalg.norm(A, axis=0), _LEAST)
    # SciPy's ends the process without columns
    found = optimize.nnls(A / size, y, maxiter=100 * size.size)[0] if size.size else size
    return np.asarray(found / size)


def _inverse(J: Array) -> Array:
    """Return the pseudo-inverse of J, whose columns differ in size."""
    size = np.maximum(np.linalg.norm(J, axis=0), _LEAST)
    return np.asarray(np.linalg.pinv(J / size) / size[:, None])


@dataclass(frozen=True, eq=False)
class StiffnessProblem:
    """Residuals (model − data)/σ of the real, then of the imaginary parts of lines, as functions of the unknowns.

    lines : as measured.   start : the unknowns: k, m, k_3, terms, F_k and rho or kappa, and R, those that there are.
    contact : of the model.   sigma : standard errors of the parts of each measured Z, N/m, (2, n).   k : of the spring
    to a base that drives, N/m.   nodes : r at which κ of a gradual contact is an unknown, m.   smoothing : weight of
    the second derivative of κ.
    """

    lines: StiffnessLines
    start: Parameters
    contact: Contact
    sigma: Array
    k: float
    nodes: Array = field(default_factory=lambda: np.empty(0))
    smoothing: float = 0.0

    @property
    def samples(self) -> int:
        """Number of data."""
        return 2 * self.lines.X.size

    @cached_property
    def solved(self) -> Mask:
        """Which unknowns are linear and not negative, (p,)."""
        linear = np.array([name in ("kappa", *_LINEAR) for name in self.start.names])
        one_sided = (self.start.low >= 0.0) & np.isinf(self.start.high)
        return np.asarray(linear & self.start.free & one_sided)

    @cached_property
    def climbed(self) -> Parameters:
        """The unknowns, with those free that are not solved for."""
        return replace(self.start, free=self.start.free & ~self.solved)

    # --- the contact --------------------------------------------------------------------------

    @cached_property
    def kappa(self) -> Mask:
        """Which unknowns are κ of a gradual contact, (p,)."""
        return np.array(self.start.names) == "kappa"

    @cached_property
    def r(self) -> Array:
        """Deflections at which the sliders of a gradual contact slip, m, and that of one that no line moves where the
        last κ is its own."""
        stuck = int(np.count_nonzero(self.kappa)) - self.nodes.size
        return np.append(self.nodes, [self.lines.X.max()] * stuck)

    def sliders(self, values: Array) -> Sliders:
        """Return the sliders of the contact."""
        if self.contact != "one slider":
            return Sliders(self.r, values[self.kappa])
        F_k, rho = self._value(values, FRICTION), self._value(values, "rho")
        return Sliders(np.array([F_k * rho**2 or math.inf]), np.array([rho**-2 * (F_k > 0.0)]))

    # --- the model ----------------------------------------------------------------------------

    def _value(self, values: Array, name: str) -> float:
        return float(values[self.start.places[name]]) if name in self.start else 0.0

    def mode(self, values: Array) -> StiffnessLines:
        """Return the lines as the mode has them, without the other modes."""
        R = self._value(values, "R")
        return self.lines.of_mode(R) if R else self.lines

    @cached_property
    def _as_measured(self) -> Complexes:
        return self._columns(self.lines)

    def columns(self, mode: StiffnessLines) -> Complexes:
        """Return the parts of Z by linear unknowns of unit size, N/m, (n, p)."""
        return self._as_measured if mode is self.lines else self._columns(mode)

    def _columns(self, mode: StiffnessLines) -> Complexes:
        out = np.zeros((mode.X.size, len(self.start)), dtype=np.complex128)
        for i, name in enumerate(self.start.names):
            if name in _LINEAR:
                out[:, i] = _part(name, mode, self.k)
        out[:, self.kappa] = secant(mode.X, self.r)
        return out

    def law(self, values: Array, mode: StiffnessLines | None = None) -> Complexes:
        """Return Z of the mode by the model, N/m, (n,)."""
        mode = mode or self.mode(values)
        Z = self.columns(mode) @ values
        if self.contact == "one slider":
            rho = self._value(values, "rho")
            Z += secant(mode.X, np.array([self._value(values, FRICTION) * rho**2]))[:, 0] * rho**-2
        return np.asarray(Z)

    def weighted(self, Z: Complexes, values: Array) -> Array:
        """Return changes of the mode's Z, (n, …), as rows of the measured in standard errors, (2n, …)."""
        if R := self._value(values, "R"):
            Z = ((1.0 - R * self.lines.Z) ** 2 * Z.T).T
        return np.concatenate([(Z.real.T / self.sigma[0]).T, (Z.imag.T / self.sigma[1]).T])

    def residual(self, values: Array) -> Array:
        """Return (model − data)/σ, (2n,)."""
        mode = self.mode(values)
        return self.weighted(self.law(values, mode) - mode.Z, values)

    @cached_property
    def roughness(self) -> Array:
        """Second derivatives of κ r^{−1/2} by ln r by the unknowns, in units of the median column of a node."""
        if not self.smoothing:
            return np.zeros((0, len(self.start)))
        n, nodes = self.nodes.size, np.flatnonzero(self.kappa)[: self.nodes.size]
        own = self.weighted(self.columns(self.lines)[:, nodes], self.start.values)
        size = float(np.median(np.linalg.norm(own, axis=0)))
        rough = np.zeros((n - 2, len(self.start)))
        step = math.log(self.nodes[-1] / self.nodes[0]) / (n - 1)
        second = np.diff(np.eye(n), 2, axis=0) * (self.nodes / self.nodes[-1]) ** -_GROWTH
        rough[:, nodes] = self.smoothing * size / step**2 * second
        return rough

    def rows(self, values: Array) -> Array:
        """Return rows of the solved unknowns of unit size, and those of the smoothing, (2n + s, p)."""
        A = self.weighted(self.columns(self.mode(values))[:, self.solved], values)
        return np.vstack([A, self.roughness[:, self.solved]])

    def solve(self, values: Array) -> Array:
        """Return the unknowns with those of largest likelihood that are solved for."""
        return self._solved(values)[0]

    def _solved(self, values: Array) -> tuple[Array, Array, Array]:
        """Return the unknowns, the rows of those that are solved for and not zero, and the residual, smoothing
        included."""
        values = np.where(self.solved, 0.0, values)
        A, smooth = self.rows(values), np.zeros(len(self.roughness))
        y = -np.concatenate([self.residual(values), smooth])
        p = _nonnegative(A, y)
        values[self.solved] = p
        return values, A[:, p > 0.0], A @ p - y

    def slopes(self, values: Array, free: Mask) -> Array:
        """Return derivatives of the residual by unknowns that are not solved for, (2n, p), by central differences."""
        steps = _STEP * np.maximum(np.abs(values), self.start.scale)
        out = np.zeros((self.samples, values.size))
        for j in np.flatnonzero(free & ~self.solved):
            less, more = values.copy(), values.copy()
            less[j], more[j] = values[j] - steps[j], values[j] + steps[j]
            out[:, j] = (self.residual(more) - self.residual(less)) / (2.0 * steps[j])
        return out

    def derivatives(self, values: Array, free: Mask) -> Array:
        """Return derivatives of the residual by all unknowns that are free, (2n, p)."""
        out = self.slopes(values, free)
        out[:, self.solved] = self.rows(values)[: self.samples]
        return out

    def products(self, values: Array, free: Mask, trail: Any, out: Array) -> bool:
        """Set `out` to the products of derivatives and residuals, as `climb` takes them, with the linear unknowns
        solved for."""
        at, active, residual = self._solved(values)
        whole = np.zeros((residual.size, values.size + 1))
        whole[: self.samples, :-1], whole[:, -1] = self.slopes(at, free), residual
        q = np.linalg.qr(active)[0]
        whole[:, :-1] -= q @ (q.T @ whole[:, :-1])
        np.matmul(whole.T, whole, out=out)
        return bool(np.isfinite(out[-1, -1]))

    def ends(self, starts: Sequence[Parameters]) -> Parameters:
        """Return where the lowest of the climbs from some starts ends."""
        if not self.climbed.free.any():
            return self.start.at(self.solve(self.start.values))
        each = filter(None, (climb_on(self, start) for start in starts))
        best = min(each, key=lambda end: end.chi_square)
        return self.start.at(self.solve(best.point))

    # --- where it starts, and what it leaves --------------------------------------------------

    def with_slider(self, values: Array) -> Array:
        """Return the unknowns with the best of the sliders that are tried."""
        mode = self.mode(values)
        places = [self.start.places[key] for key in (FRICTION, "rho")]
        nothing = np.where(self.solved, 0.0, values)
        nothing[places[0]] = 0.0
        A, y = self.rows(nothing), -self.residual(nothing)
        r = np.geomspace(_RIGID * mode.X.min(), mode.X.max(), _TRIED + 1)[:-1]
        columns = self.weighted(secant(mode.X, r), values).T
        tried = [np.column_stack([A, column]) for column in columns]
        ends = [_nonnegative(one, y) for one in tried]
        left = [float(np.sum((one @ p - y) ** 2)) for one, p in zip(tried, ends, strict=True)]
        best = int(np.argmin(left))
        kappa = max(float(ends[best][-1]), _SOFTEST * float(np.abs(mode.Z).max()))
        nothing[places] = kappa * r[best], kappa**-0.5
        return nothing

    def misfit(self, values: Array) -> Misfit:
        """Return the distance of the lines from a law."""
        mode = self.mode(values)
        Z, law = mode.Z, self.law(values, mode)
        both = law.imag / Z.imag - 1.0, law.real - Z.real
        loss, stiffness = (math.sqrt(np.mean(one**2)) for one in both)
        return Misfit(loss, stiffness, float(np.mean(self.weighted(law - Z, values) ** 2)))

    def covariance(self, values: Array) -> Array:
        """Return the covariance of the unknowns, (p, p): a κ of zero may be that of a slider that hides."""
        free, rows = self.start.free, [self.derivatives(values, self.start.free), self.roughness]
        if self.nodes.size:
            slips = np.flatnonzero(self.kappa)[: self.nodes.size]
            kappa = values[slips]
            # between equal κ and equal forces; next to a slider, as the r of that is known no closer
            size = _HIDDEN * float(np.sum(kappa)) * np.sqrt(self.lines.X.min() / self.nodes)
            size = np.maximum(size, np.convolve(kappa, [1.0, 0.0, 1.0], "same")) + _SOFTEST
            rows.append((np.eye(values.size)[slips] / size[:, None])[kappa <= 0.0])
        by = _inverse(np.vstack(rows)[:, free])
        covariance = np.zeros((values.size, values.size))
        covariance[np.ix_(free, free)] = by @ by.T
        return covariance

    def unknowns(self, values: Array) -> float:
        """Return the effective number of unknowns, tr ∂(model)/∂(data), of which κ that are zero are none."""
        used = self.start.free & ~(self.kappa & (values <= 0.0))
        if not self.smoothing:
            return float(np.count_nonzero(used))
        J = self.derivatives(values, used)[:, used]
        by = _inverse(np.vstack([J, self.roughness[:, used]]))
        return float(np.sum(J.T * by[:, : self.samples]))

    def scatter(self, values: Array) -> Array:
        """Return standard errors of the real and the imaginary part of each Z, (2, n), from what the law leaves of
        them.

        Where lines state their errors, these count, or the errors of the fit times what each kind scatters by: the
        larger of the two. Else Var Re = α + β|Z|², Var Im = γ(Im Z)² + δ|Z|²: an error of the law in N/m or as a part
        of the loss, and one of the measurement; by largest likelihood (multiplicative updates).
        """
        n = self.lines.X.size
        left = self.residual(values).reshape(2, n) * self.sigma
        share = n / max(n - 0.5 * self.unknowns(values), 0.5)
        if self.lines.error is not None:
            mean = np.mean((left / self.sigma) ** 2, axis=1, keepdims=True)
            stated = np.abs(self.lines.Z) * self.lines.error
            return np.asarray(np.maximum(self.sigma * np.sqrt(mean * share), stated))
        # of the law, as the noise of measured values would bias the weights by its square
        Z, squares = self.lines.Z + left[0] + 1j * left[1], left**2 * share
        size, variances = np.abs(Z) ** 2, []
        for square, own in zip(squares, (np.full(n, np.mean(size)), Z.imag**2), strict=True):
            parts, shares = (
                np.array([own, size]),
                0.5 * np.full(2, np.mean(square / size) + _FLOOR**2),
            )
            for _ in range(_MULTIPLIED):
                variance = shares @ parts + _FLOOR**2 * size
                shares *= (parts @ (square / variance**2)) / (parts @ (1.0 / variance))
            variances.append(shares @ parts + _FLOOR**2 * size)
        return np.sqrt(variances)
