"""Slip onset by fitting the exact steady waveform, with its microstick line, to the harmonics of one record.

The waveform has two branches: from the reversal at −X the contact sticks over a length L = X + X_s = 2F_k/K_z, on a
line of slope −(k + K_z)/m of the acceleration against x; then it slips. In harmonics,

    (k − n²ω²m + inωc) x_n = k Y δ_n1 − f_n,     f_n: of the contact force, which jumps by 2F_k over the length L

so that m, c, F_k and L follow from two complex harmonics, and from the sharpest channels best. m, c and F_k serve only
to find L: the balance of energy does not use them. The fit weighs each harmonic by its noise. It is parametrised by
u = √(2L/X₁) ≈ ω t_s, in which the waveform is linear where L is small.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Complexes, Integers
from ..model import BaseMotion, Oscillator
from ..motion.orbit import NoSteadyOrbit, Orbit, steady_orbit
from ..motion.regime import Regime
from .climb import Evaluation, NoConvergence, NoStart, climb

_HARMONICS = 128  # odd ones of the waveform: beyond them lies less than 1e-6 of its velocity
_SMALLEST_U, _LARGEST_U = 1e-3, 1.9
_STARTS = (0.06, 0.18, 0.5)
_GAIN = 5e-8  # of half the sum of squares, where the climb ends
_STEP = 1e-6  # of the finite differences: orbits are exact to 1e-13


@dataclass(frozen=True, eq=False)
class Waveform:
    """The exact waveform that fits the harmonics of one record best.

    orbit : the motion; its oscillator holds k as given and the fitted m, c, F_k, K_z of this one record.
    length, length_error : L, freed of its bias of second order, and its standard error, m.
    length_bound : L is below it with 97.5 % confidence, m.
    sensitivity : d(L, V_s, t_s)/d(|Y|, Re x_n …, Im x_n …), shape (3, 1 + 2 · harmonics).
    misfit : χ² over degrees of freedom.   freedom : their number.
    tail : harmonics x_n, n = 1, 3, 5 … of the waveform, the phase counted from the peak of y, m.
    """

    orbit: Orbit
    length: float
    length_error: float
    length_bound: float
    sensitivity: Array
    misfit: float
    freedom: int
    tail: Complexes


def fit_waveform(
    omega: float, k: float, Y: float, Y_error: float, n: Integers, x: Complexes, x_error: Array
) -> Waveform | None:
    """The waveform that fits harmonics of one record; None where they show no slip that could be fitted.

    omega : rad/s.   k : N/m.   Y : amplitude of the base, m.   n : odd, (h,), h ≥ 2.   x : x_n, y being Y cos ωt, m.
    Y_error, x_error : standard deviations of the real and of the imaginary part of each harmonic, m.
    """
    start = _rigid(omega, k, Y, n, x, x_error)
    if start is None:
        return None
    fit = _Fit(omega, k, Y, Y_error, n, x, x_error)
    starts = [np.array([*np.log(start), u, math.log(Y), 0.0]) for u in _STARTS]
    sizes = [math.inf if (r := fit.residual(p)) is None else float(r @ r) for p in starts]
    reached = fit.minimised(starts[int(np.argmin(sizes))]) if min(sizes) < math.inf else None
    if reached is None:
        return None
    p, residual, jacobian = reached
    solution = np.linalg.pinv(jacobian)  # p from residuals, to first order
    covariance = solution @ solution.T
    u, u_error = float(p[3]), math.sqrt(covariance[3, 3])
    here, orbit = fit.onset(p)
    gradient = np.column_stack(
        [(fit.onset(p + step)[0] - here) / _STEP for step in _STEP * np.eye(p.size)]
    )
    # residuals are (model − data)/σ; the datum of the phase of y is zero by definition
    sigma = np.concatenate([[Y_error], x_error, x_error])
    sensitivity = gradient @ np.delete(solution, 1, axis=1) / sigma
    X_1 = abs(x[0])
    freedom = residual.size - p.size
    return Waveform(
        orbit=orbit,
        length=float(here[0]) - 0.5 * X_1 * u_error**2,
        length_error=X_1 * u * u_error,
        length_bound=0.5 * X_1 * (u + 1.96 * u_error) ** 2,
        sensitivity=sensitivity,
        misfit=float(residual @ residual) / max(1, freedom),
        freedom=freedom,
        tail=orbit.harmonics(_HARMONICS),
    )


def _rigid(
    omega: float, k: float, Y: float, n: Integers, x: Complexes, x_error: Array
) -> tuple[float, float, float] | None:
    """(m, c, F_k) by linear least squares, the contact force being a square wave with the sign of the velocity."""
    theta = np.arange(720) * (2.0 * math.pi / 720)
    wave = (x[None, :] * np.exp(1j * np.outer(theta, n))).real.sum(axis=1)
    reversal = theta[int(np.argmax(wave))]
    # sgn of the velocity: −(4/π) sin n(θ − θ_r)/n, summed over odd n
    square = 4j / (math.pi * n) * np.exp(-1j * n * reversal)
    columns = np.column_stack([-(n**2) * omega**2 * x, 1j * n * omega * x, square])
    right = np.where(n == 1, k * Y, 0.0) - k * x
    weight = 1.0 / np.maximum(x_error * (n * omega) ** 2, 1e-9 * np.abs(k * x[0]))
    A = np.concatenate([(columns * weight[:, None]).real, (columns * weight[:, None]).imag])
    r = np.concatenate([(right * weight).real, (right * weight).imag])
    scale = np.linalg.norm(A, axis=0)
    if not np.all(scale > 0.0):
        return None
    m, c, F_k = np.linalg.lstsq(A / scale, r, rcond=None)[0] / scale
    if not (m > 0.0 and F_k > 0.0):
        return None
    return float(m), float(max(c, 1e-3 * m * omega)), float(F_k)


@dataclass(frozen=True, eq=False)
class _Fit:
    """Data of a fit and its residuals as functions of p = (log m, log c, log F_k, u, log Y, phase of y)."""

    omega: float
    k: float
    Y: float
    Y_error: float
    n: Integers
    x: Complexes
    x_error: Array

    def orbit(self, p: Array) -> Orbit | None:
        """The orbit of the parameters; None where it does not slip."""
        m, c, F_k, Y = (math.exp(p[i]) for i in (0, 1, 2, 4))
        K_z = 4.0 * F_k / (p[3] ** 2 * abs(self.x[0]))
        try:
            orbit = steady_orbit(
                Oscillator(m=m, c=c, k=self.k, K_z=K_z, F_k=F_k), BaseMotion(Y=Y, omega=self.omega)
            )
        except (NoSteadyOrbit, ValueError):
            return None
        return orbit if orbit.regime in (Regime.ONE_SLIP, Regime.SEVERAL_SLIPS) else None

    def residual(self, p: Array) -> Array | None:
        """(model − data)/σ of |Y|, the phase of y, Re x_n, Im x_n; None where nothing slips."""
        within = _SMALLEST_U <= p[3] <= _LARGEST_U and abs(p[:3]).max() < 50
        orbit = self.orbit(p) if within else None
        if orbit is None:
            return None
        model = orbit.harmonics(self.n.size) * np.exp(1j * self.n * p[5])
        off = (model - self.x) / self.x_error
        Y_off = (math.exp(p[4]) - self.Y) / self.Y_error
        return np.concatenate([[Y_off, p[5] * self.Y / self.Y_error], off.real, off.imag])

    def onset(self, p: Array) -> tuple[Array, Orbit]:
        """(L, V_s, t_s) and the orbit."""
        orbit = self.orbit(p)
        if orbit is None:
            raise AssertionError("the fitted waveform slips")
        return np.array([orbit.X + orbit.X_s, orbit.V_s, orbit.t_s]), orbit

    def minimised(self, p: Array) -> tuple[Array, Array, Array] | None:
        """(p, residual, Jacobian) at the least sum of squares, or as far as it falls; None where there is no start."""
        lower, scale = np.array([-math.inf] * 3 + [_SMALLEST_U] + [-math.inf] * 2), np.ones(p.size)
        try:
            climbed = climb(self.evaluate, p, lower, scale, longest=0.7, gain=_GAIN)
        except NoStart:
            return None
        except NoConvergence as stuck:
            climbed = stuck.best
        end, here = climbed.point, climbed.evaluation
        # the step that the climb did not take any more leaves far less than the gain it stopped at
        last = self.evaluate(end + climbed.step)
        if last is not None and last.value <= here.value:
            end, here = end + climbed.step, last
        assert here.residual is not None
        assert here.jacobian is not None
        return end, here.residual, here.jacobian

    def evaluate(self, p: Array) -> Evaluation | None:
        """Half the sum of squares with its information and gradient; None where nothing slips."""
        residual = self.residual(p)
        if residual is None:
            return None
        step = _STEP if p[3] + _STEP <= _LARGEST_U else -_STEP
        moved = [self.residual(p + one) for one in step * np.eye(p.size)]
        slopes = [(there - residual) / step for there in moved if there is not None]
        if len(slopes) < p.size:
            return None
        return Evaluation.of_residuals(residual, np.column_stack(slopes))
