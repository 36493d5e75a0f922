"""Fit of one oscillator to the fundamental of each record alone, where the higher harmonics are not those of the model.

A second mode, a sensor that is not linear, a spring that stiffens or a contact that yields gradually show in the higher
harmonics first, and hardly in the fundamental, which carries nearly all of the energy. Its dynamic stiffness

    Z = kY/x_1 = k − mω² + K + i(Σ p_j g_j/(πX²) + E/(πX²))

has in-phase and quadrature parts for each level, with the describing function of the slider for x = X cos ωt,

    K = (K_z/π)(ϑ − sin ϑ cos ϑ),   cos ϑ = 1 − 2Z_m/X,   E = 4F_k(X − Z_m),   Z_m = F_k/K_z

(Caughey, J. Appl. Mech. 27, 1960). What the describing function lacks of the exact orbit is added at the oscillator
found, and the fit repeated, so that the describing function only gives the derivatives. Rows are relative to |Z|,
which is the drive over the response.

No noise explains what the rows leave. Their errors come from their scatter, that of the in-phase and that of the
quadrature rows each, with Student's t of the rows less the unknowns that each kind determines, and are no less than
those of the noise. Use it where a fit of the waveforms is not adequate.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import special

from ..arrays import Array, Complexes, Mask
from ..law.law import Law
from ..law.terms import FRICTION, term
from ..motion.law_steady import Response
from ..signals.lines import Lines
from ..solver import NORMAL_95
from .climb import climb
from .oscillator_fit import OscillatorFit
from .starts import starts
from .waveforms import NO_MOTION, Unknowns

_STARTS = 4  # contact stiffnesses: a rigid one next to a soft one are two minima
_REPETITIONS = (
    8  # of the correction, which is a few per cent, and falls by a factor of ten each time
)
_SETTLED = 1e-3  # of the residual: a gain that does not matter
_STEP = 1e-6  # relative, of central differences of a closed form: errors of 1e-10


@dataclass(frozen=True, eq=False)
class FundamentalFit(OscillatorFit):
    """The oscillator whose fundamentals are closest to those of n records.

    unknowns : names and places of the unknowns.   residual : (model − data)/|Z|, in phase and in quadrature, (2, n).
    by_rows : derivatives of the common unknowns by the relative error of each row, (p, 2n).
    reach : half of the 95 % interval of each common unknown, (p,).
    """

    unknowns: Unknowns
    residual: Array
    by_rows: Array
    reach: Array
    freedom: int

    @property
    def names(self) -> tuple[str, ...]:
        """Keys of the law's coefficients, then the other common unknowns."""
        return self.unknowns.names

    @property
    def law(self) -> Law:
        """The damping law whose coefficients are fitted."""
        return self.unknowns.law

    @cached_property
    def responses(self) -> tuple[Response, ...]:
        """The motion of each record."""
        return tuple(self.unknowns.response(self.point, i) for i in range(len(self.unknowns.lines)))

    @property
    def misfit(self) -> float:
        """χ² per degree of freedom, in units of the noise."""
        return self.chi_square / self.freedom

    @property
    def scatter(self) -> float:
        """Root mean square of the rows' residuals, relative to the drive."""
        return math.sqrt(float(np.sum(self.residual**2)) / self.freedom)

    def interval(self, name: str) -> tuple[float, float]:
        """95 % interval of a common unknown, in its unit, with Student's t for the scatter of the rows."""
        reach = float(self.reach[self.names.index(name)])
        return self.value(name) - reach, self.value(name) + reach

    def moved(self, relative: Complexes) -> Array:
        """Return the relative change of the common unknowns, (p, …), with that of the Z of each record, (n, …)."""
        Z = _data(self.unknowns)[0]
        part = (relative.T * Z / np.abs(Z)).T
        by = self.by_rows @ np.concatenate([part.real, part.imag])
        values = self.point[: len(self.names)]
        with np.errstate(divide="ignore", invalid="ignore"):
            changes: Array = (by.T / values).T
        return changes


def fit_fundamentals(
    lines: Sequence[Lines], k: float, law: Law | None = None, *, late: bool = False
) -> FundamentalFit | None:
    """The oscillator whose fundamentals are closest; None where the levels are too few to show how well they fit.

    lines : of n records, without what harmonics of the base add.   k : stiffness, N/m.   law : default, F_k and c.
    """
    unknowns = Unknowns(law or Law(), tuple(lines), k)
    damping = len(unknowns.law.unknowns)
    if len(lines) <= max(damping, 2 + late):
        return None
    ends = [
        end for start in _starts(unknowns) if (end := _fitted(unknowns, start, late)) is not None
    ]
    if not ends:
        return None
    point, off = min(ends, key=lambda end: float(np.sum(np.abs(end[1]) ** 2)))
    Z, error = _data(unknowns)
    at, rho = _free(unknowns, late), unknowns.names.index("rho")
    slopes = _slopes(unknowns, point, late) / np.abs(Z)
    inverse = np.linalg.pinv(np.concatenate([slopes.real, slopes.imag], axis=1).T)
    by_rows = np.zeros((len(unknowns.names), 2 * len(lines)))
    by_rows[at] = inverse
    residual = np.stack([off.real, off.imag])
    # stiffness and mass come from the in-phase rows, damping from those in quadrature
    freedom = np.array([len(lines) - 2 - late, len(lines) - damping])
    variance = np.sum(residual**2, axis=1) / freedom
    noise = np.tile((error / np.abs(Z)) ** 2, 2)
    t = special.stdtrit(freedom, 0.975)
    scattered = np.repeat(variance, len(lines))
    reach = np.maximum(
        np.sqrt(by_rows**2 @ (scattered * np.repeat(t, len(lines)) ** 2)),
        NORMAL_95 * np.sqrt(by_rows**2 @ noise),
    )
    larger = np.maximum(scattered, noise)
    covariance = np.zeros((unknowns.size, unknowns.size))
    covariance[: len(by_rows), : len(by_rows)] = (by_rows * larger) @ by_rows.T
    return FundamentalFit(
        k=k,
        point=point,
        covariance=covariance,
        chi_square=float(np.sum(residual.ravel() ** 2 / noise)),
        rigid=bool(point[rho] <= unknowns.bounds(point, _every(point)).lower[rho]),
        unknowns=unknowns,
        residual=residual,
        by_rows=by_rows,
        reach=reach,
        freedom=int(freedom.sum()),
    )


def _free(unknowns: Unknowns, late: bool) -> list[int]:
    """Places of the unknowns that are fitted.   late : whether the delay is one."""
    names = (*unknowns.law.unknowns, "rho", "m", *["delay"] * late)
    return [unknowns.names.index(name) for name in names]


def _data(unknowns: Unknowns) -> tuple[Complexes, Array]:
    """Z of each record, N/m, and the standard error of its real and of its imaginary part, (n,)."""
    Z = np.array([unknowns.k * one.Y / one.x[0] for one in unknowns.lines])
    parts = [(one.x_error[0] / abs(one.x[0]), one.Y_error / one.Y) for one in unknowns.lines]
    return Z, np.abs(Z) * np.hypot(*np.transpose(parts))


def _describing(unknowns: Unknowns, point: Array, motion: Sequence[complex]) -> Complexes:
    """Z of each record by the describing function, N/m, (n,).   motion : x_1 of each record, m."""
    values, k = np.empty(len(unknowns.lines), dtype=np.complex128), unknowns.k
    for i, (one, at, x) in enumerate(zip(unknowns.lines, unknowns.at, motion, strict=True)):
        X, phi, friction, rho = abs(x), -cmath.phase(x), point[at[FRICTION]], point[at["rho"]]
        Z_m = friction * rho**2
        stiffness, energy = rho**-2, 0.0
        if Z_m < X:
            theta = math.acos(1.0 - 2.0 * Z_m / X)
            stiffness *= (theta - math.sin(theta) * math.cos(theta)) / math.pi
            energy = 4.0 * friction * (X - Z_m)
        for symbol in unknowns.law.terms:
            if symbol != FRICTION:
                energy += point[at[symbol]] * term(symbol).harmonic(one.omega, X, one.Y, phi, k)
        in_phase = k - point[at["m"]] * one.omega**2 + stiffness
        values[i] = complex(in_phase, energy / (math.pi * X**2))
        values[i] *= cmath.exp(1j * one.omega * point[at["delay"]])
    return values


def _slopes(unknowns: Unknowns, point: Array, late: bool) -> Complexes:
    """Derivatives of Z by the unknowns that are fitted, (p, n)."""
    motion, scale = (
        [one.x[0] for one in unknowns.lines],
        unknowns.bounds(point, _every(point)).scale,
    )
    slopes = []
    for at in _free(unknowns, late):
        step = np.zeros(point.size)
        step[at] = _STEP * max(abs(point[at]), scale[at])
        more, less = (_describing(unknowns, point + by * step, motion) for by in (1.0, -1.0))
        slopes.append((more - less) / (2.0 * step[at]))
    return np.array(slopes)


def _starts(unknowns: Unknowns) -> list[Array]:
    """Points that balance the work of the fundamentals, the closest of some contact stiffnesses."""
    lines = [
        replace(one, n=one.n[:1], x=one.x[:1], x_error=one.x_error[:1]) for one in unknowns.lines
    ]
    candidates = starts(lines, unknowns.k)
    first = np.sort(np.unique(candidates[:, 2], return_index=True)[1])[:_STARTS]
    return [unknowns.start(candidate, np.ones(len(lines))) for candidate in candidates[first]]


def _fitted(unknowns: Unknowns, start: Array, late: bool) -> tuple[Array, Complexes] | None:
    """The point closest to the fundamentals, and (model − data)/|Z| there, (n,); None where there is no motion."""
    Z, error = _data(unknowns)
    free, best = _free(unknowns, late), None
    unit = np.abs(Z) * math.sqrt(float(np.mean((error / np.abs(Z)) ** 2)))
    motion = [one.x[0] for one in unknowns.lines]
    drive, omega = np.transpose([(unknowns.k * one.Y, one.omega) for one in unknowns.lines])
    bounds = unknowns.bounds(start, _every(start, free))
    correction, point = np.zeros_like(Z), start

    def products(at: Array, out: Array) -> bool:
        whole = np.zeros((at.size + 1, Z.size), dtype=np.complex128)
        whole[free] = _slopes(unknowns, at, late) / unit
        whole[-1] = (_describing(unknowns, at, motion) + correction - Z) / unit
        out[:] = (whole @ whole.conj().T).real
        return True

    for _ in range(_REPETITIONS):
        reached = climb(products, point, bounds)
        if reached is None:
            break
        point = reached.point
        try:
            responses = [unknowns.response(point, i).harmonics(1)[0] for i in range(Z.size)]
        except NO_MOTION:
            break
        turned = np.exp(1j * omega * point[unknowns.names.index("delay")])
        exact = drive / responses * turned
        correction = exact - _describing(unknowns, point, responses)
        off = (_describing(unknowns, point, motion) + correction - Z) / np.abs(Z)
        if best is not None and np.linalg.norm(off) > (1.0 - _SETTLED) * np.linalg.norm(best[1]):
            break
        best = point, off
    return best


def _every(point: Array, places: Sequence[int] | None = None) -> Mask:
    """Which unknowns move: those at these places, or all."""
    mask = np.zeros(point.size, dtype=np.bool_)
    mask[slice(None) if places is None else places] = True
    return mask
