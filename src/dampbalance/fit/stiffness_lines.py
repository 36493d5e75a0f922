"""Lines of dynamic stiffness: steady responses at some frequencies and amplitudes, and what a contact and an oscillator
leave of them.

Each line is a complex number, the dynamic stiffness Z = (F/X)e^{iφ}, φ the lag of x behind the force F, of a table of a
stepped sine or of the fundamental of a forced record, F = kY:

    Z = k + ¾k_3X² − mω² + i Σ p g_p/(πX²) + Σ κ_j D(r_j/X)

with the integrals g_p of the terms (`law/terms.py`) and the describing function D of a contact (`law/contact.py`). The
imaginary part is the energy balance πX² Im Z = πFX sin φ, Eq. (14) of Liang & Feeny (2010), the real part the in-phase
row, which a contact lowers with the amplitude. Channels read it otherwise: a delay τ of the response turns it, and
where the driven point moves with other modes, too, their residual receptance R changes it:

    1/Z_measured = e^{−iωτ}/Z + R,    X = X_measured |1 − R Z_measured|

Unknowns that are linear and not negative are solved for at each step of a climb in the others: F_k and ρ = K_z^{−1/2}
of one slider, k_3 where a spring may soften, τ and R. A gradual contact has sliders at many r, close to each other,
none of them negative, and κ is as smooth over ln r as it is asked to be.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Literal, NamedTuple, Self

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
_TRIED, _RIGID = (
    60,
    1e-3,
)  # r of one slider to start from, and the smallest, of the smallest amplitude
# κ of a slider that is not found, of K_z, at the smallest amplitude: as large as keeps intervals of 95 % true for
# contacts of 2 to 30 sliders
_HIDDEN = 0.01
_SOFTEST = 1e-9  # of |Z|: a contact that is none
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

    def __getitem__(self, kept: Mask) -> StiffnessLines:
        """Some of the lines."""
        parts = {
            name: values[kept]
            for name in ("omega", "X", "Z", "level", "error")
            if (values := getattr(self, name)) is not None
        }
        return replace(self, **parts)

    def of_mode(self, R: float = 0.0, delay: float = 0.0) -> StiffnessLines:
        """Return the lines without the residual receptance R, m/N, of the other modes, and a delay, s."""
        ratio = 1.0 - R * self.Z
        turned = self.Z * np.exp(-1j * self.omega * delay)
        return replace(self, X=self.X * np.abs(ratio), Z=turned / ratio)


def stiffness_part(name: str, lines: StiffnessLines, k: float) -> Complexes:
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


def _nnls(A: Array, y: Array) -> Array:
    """Return coefficients ≥ 0 of least squares."""
    if not A.shape[1]:  # SciPy's ends the process
        return np.empty(0)
    size = np.linalg.norm(A, axis=0)
    size[size == 0.0] = 1.0
    return np.asarray(optimize.nnls(A / size, y, maxiter=100 * A.shape[1])[0] / size)


@dataclass(frozen=True, eq=False)
class StiffnessProblem:
    """Residuals (model − data)/σ of the real, then of the imaginary parts of lines, as functions of the unknowns.

    lines : as measured.   start : the unknowns: k, m, k_3, terms, F_k and rho or kappa, delay and R, those that there
    are.   contact : of the model.   sigma : standard errors of the parts of each measured Z, N/m, (2, n).
    k : of the spring, N/m, for what it drives, and for the stiffness itself where that is no unknown.
    of : lines to which an unknown of a group belongs.   nodes : r at which κ of a gradual contact is an unknown, m.
    smoothing : weight of the second derivative of κ.   added : to the Z of the model, N/m, (n,).
    """

    lines: StiffnessLines
    start: Parameters
    contact: Contact
    sigma: Array
    k: float
    of: Mapping[str, Mask] = field(default_factory=dict)
    nodes: Array = field(default_factory=lambda: np.empty(0))
    smoothing: float = 0.0
    added: Complexes | float = 0.0

    def __getitem__(self, kept: Mask) -> Self:
        """The problem of some of the lines."""
        of = {key: mask[kept] for key, mask in self.of.items()}
        added = self.added if isinstance(self.added, float) else self.added[kept]
        lines, sigma = self.lines[kept], self.sigma[:, kept]
        return replace(self, lines=lines, sigma=sigma, of=of, added=added)

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

    def _places(self, name: str) -> list[int]:
        return [i for i, own in enumerate(self.start.names) if own == name]

    # --- the contact --------------------------------------------------------------------------

    @cached_property
    def r(self) -> Array:
        """Deflections at which the sliders of a gradual contact slip, m, and that of one that no line moves where the
        last κ is its own."""
        return np.append(self.nodes, [self.lines.X.max()] * self._stuck)

    @property
    def _stuck(self) -> int:
        """Number of unknown sliders that no line moves."""
        return len(self._places("kappa")) - self.nodes.size

    def sliders(self, values: Array) -> Sliders:
        """Return the sliders of the contact; of one, the mean over its groups."""
        if self.contact == "gradual":
            return Sliders(self.r, values[self._places("kappa")])
        if self.contact == "none":
            return Sliders(np.empty(0), np.empty(0))
        F_k = float(np.mean(values[self._places(FRICTION)]))
        kappa = values[self.start.places["rho"]] ** -2 * bool(F_k > 0.0)
        return Sliders(np.array([F_k / kappa if kappa else math.inf]), np.array([kappa]))

    # --- the model ----------------------------------------------------------------------------

    def _value(self, values: Array, name: str) -> float:
        return float(values[self.start.places[name]]) if name in self.start else 0.0

    def mode(self, values: Array) -> StiffnessLines:
        """Return the lines as the mode has them, without what the channels do."""
        R, delay = self._value(values, "R"), self._value(values, "delay")
        return self.lines.of_mode(R, delay) if R or delay else self.lines

    @cached_property
    def _as_read(self) -> Complexes:
        return self._columns(self.lines)

    def columns(self, mode: StiffnessLines) -> Complexes:
        """Return the parts of Z by linear unknowns of unit size, N/m, (n, p)."""
        return self._as_read if mode is self.lines else self._columns(mode)

    def _columns(self, mode: StiffnessLines) -> Complexes:
        out = np.zeros((mode.X.size, len(self.start)), dtype=np.complex128)
        for i, (key, name) in enumerate(zip(self.start.keys, self.start.names, strict=True)):
            if name in _LINEAR:
                out[:, i] = stiffness_part(name, mode, self.k) * self.of.get(key, 1.0)
        if self.contact == "gradual":
            out[:, self._places("kappa")] = secant(mode.X, self.r)
        return out

    def law(self, values: Array, mode: StiffnessLines | None = None) -> Complexes:
        """Return Z of the mode by the model, N/m, (n,)."""
        mode = mode or self.mode(values)
        Z = self.columns(mode) @ values + self.added
        if "k" not in self.start:
            Z = Z + self.k
        if self.contact == "one slider":
            rho = self._value(values, "rho")
            D = secant(mode.X, values[self._places(FRICTION)] * rho**2)
            for i, at in enumerate(self._places(FRICTION)):
                Z = Z + D[:, i] * self.of.get(self.start.keys[at], 1.0) * rho**-2
        return np.asarray(Z)

    def weighted(self, Z: Complexes, values: Array) -> Array:
        """Return changes of the mode's Z, (n, …), as rows of the measured in standard errors, (2n, …)."""
        R, delay = self._value(values, "R"), self._value(values, "delay")
        if R or delay:
            turn = np.exp(1j * self.lines.omega * delay)
            Z = ((1.0 - R * self.lines.Z) ** 2 * turn * Z.T).T
        return np.concatenate([(Z.real.T / self.sigma[0]).T, (Z.imag.T / self.sigma[1]).T])

    def residual(self, values: Array) -> Array:
        """Return (model − data)/σ, (2n,)."""
        mode = self.mode(values)
        return self.weighted(self.law(values, mode) - mode.Z, values)

    @cached_property
    def roughness(self) -> Array:
        """Second derivatives of κ r^{−1/2} by ln r by the unknowns, in units of the median column of a node."""
        if self.contact != "gradual" or not self.smoothing:
            return np.zeros((0, len(self.start)))
        n = self.nodes.size
        nodes = self._places("kappa")[:n]
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
        p = _nnls(A, y)
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

    def ends(self, starts: list[Parameters], **options: Any) -> Parameters:
        """Return where the lowest of the climbs from some starts ends."""
        if not self.climbed.free.any():
            return self.start.at(self.solve(self.start.values))
        each = [climb_on(self, start, **options) for start in starts]
        best = min(filter(None, each), key=lambda end: end.chi_square)
        return self.start.at(self.solve(best.point))

    # --- where it starts, and what it leaves --------------------------------------------------

    def with_sliders(self, values: Array) -> Array:
        """Return the unknowns with the best of the sliders that are tried."""
        mode = self.mode(values)
        nothing = np.where(self.solved, 0.0, values)
        nothing[self._places(FRICTION)] = 0.0
        A, y = self.rows(nothing), -self.residual(nothing)
        r = np.geomspace(_RIGID * mode.X.min(), mode.X.max(), _TRIED + 1)[:-1]
        best, least = 0, math.inf
        columns = self.weighted(secant(mode.X, r), values)
        whole = np.column_stack([A, columns[:, 0]])
        for i in range(_TRIED):
            whole[:, -1] = columns[:, i]
            p = _nnls(whole, y)
            if (chi_square := float(np.sum((whole @ p - y) ** 2))) < least:
                best, least, kappa = i, chi_square, float(p[-1])
        kappa = max(kappa, _SOFTEST * float(np.abs(mode.Z).max()))
        nothing[self._places(FRICTION)] = kappa * r[best]
        nothing[self.start.places["rho"]] = kappa**-0.5
        return nothing

    def misfit(self, values: Array) -> Misfit:
        """Return the distance of the lines from a law."""
        mode = self.mode(values)
        Z, law = mode.Z, self.law(values, mode)
        both = law.imag / Z.imag - 1.0, law.real - Z.real
        loss, stiffness = (math.sqrt(np.mean(one**2)) for one in both)
        return Misfit(loss, stiffness, float(np.mean(self.weighted(law - Z, values) ** 2)))

    def used(self, values: Array) -> Mask:
        """Return the unknowns that a fit has, without κ that are zero, (p,)."""
        nodes = np.zeros(values.size, dtype=np.bool_)
        nodes[self._places("kappa")] = True
        return np.asarray(self.start.free & ~(nodes & (values <= 0.0)))

    def by_rows(self, values: Array) -> Array:
        """Return derivatives of the unknowns by the rows of the data in standard errors, and by those of the smoothing,
        (p, 2n + s)."""
        used = self.used(values)
        J = np.vstack([self.derivatives(values, used), self.roughness])[:, used]
        size = np.linalg.norm(J, axis=0)
        size[size == 0.0] = 1.0
        out = np.zeros((values.size, len(J)))
        out[used] = np.linalg.pinv(J / size) / size[:, None]
        return out

    def covariance(self, values: Array) -> Array:
        """Return the covariance of the unknowns, (p, p): a κ of zero may be that of a slider that hides."""
        free = self.start.free
        nodes = np.array(self.start.names) == "kappa"
        J = [self.derivatives(values, free), self.roughness]
        if nodes.any():
            slips = np.flatnonzero(nodes)[: self.nodes.size]
            kappa = values[slips]
            # between equal κ and equal forces; next to a slider, as the r of that is known no closer
            size = _HIDDEN * float(np.sum(kappa)) * np.sqrt(self.lines.X.min() / self.nodes)
            size = np.maximum(size, np.convolve(kappa, [1.0, 0.0, 1.0], "same")) + _SOFTEST
            J.append((np.eye(values.size)[slips] / size[:, None])[kappa <= 0.0])
        whole = np.vstack(J)[:, free]
        size = np.linalg.norm(whole, axis=0)
        size[size == 0.0] = 1.0
        by = np.linalg.pinv(whole / size) / size[:, None]
        covariance = np.zeros((values.size, values.size))
        covariance[np.ix_(free, free)] = by @ by.T
        return covariance

    def unknowns(self, values: Array) -> float:
        """Return the effective number of unknowns, tr ∂(model)/∂(data)."""
        used = self.used(values)
        if not self.smoothing:
            return float(np.count_nonzero(used))
        J = self.derivatives(values, used)
        return float(np.sum(J.T * self.by_rows(values)[:, : self.samples]))

    def scatter(self, values: Array, freedom: Array | None = None) -> Array:
        """Return standard errors of the real and the imaginary part of each Z, (2, n), from what the law leaves of
        them.

        Where lines state their errors, these count, or the errors of the fit times what each kind scatters by: the
        larger of the two. Else Var Re = α + β|Z|², Var Im = γ(Im Z)² + δ|Z|²: an error of the law in N/m or as a part
        of the loss, and one of the measurement; by largest likelihood (multiplicative updates).

        freedom : degrees of freedom of each kind; default, all lines less half of the unknowns.
        """
        n = self.lines.X.size
        left = self.residual(values).reshape(2, n) * self.sigma
        if freedom is None:
            freedom = np.full(2, max(n - 0.5 * self.unknowns(values), 0.5))
        share = n / freedom[:, None]
        if self.lines.error is not None:
            stated = np.broadcast_to(np.abs(self.lines.Z) * self.lines.error, (2, n))
            scattered = self.sigma * np.sqrt(
                np.mean((left / self.sigma) ** 2, axis=1, keepdims=True) * share
            )
            return np.asarray(np.maximum(scattered, stated))
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
