"""Features of one noisy record, with standard errors and bootstrap replicates.

All features are functions of the mean harmonics of base and response, relative to the phase of the base:

    X_n² = |x_n|² − var x_n              freed of the bias that noise gives a square
    W = π k Y X₁ sin φ₁,  b = πω Σ n²X_n²     exact by orthogonality; n odd; beyond the bandwidth, the waveform
    X                                    largest value of Σ x_n e^{inωt}; beyond the bandwidth, the waveform
    X_s, V_s, t_s                        from the length of the microstick line (`onset.py`);   a = 2(X − X_s)

Standard errors are those of the jackknife over cycles; replicates draw cycles with replacement. Both evaluate the same
functions on many means at once, the slip onset to first order.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array, Complexes
from ..features import COLUMNS, Features, of_numbers, wrapped
from ..motion.regime import Regime
from ..records.measurement import Measurement
from .conditioning import SteadyRecord, condition
from .one_thread import one_thread
from .onset import Waveform, fit_waveform

RESOLVED = 2.0
"""Standard errors that the length of the microstick line must exceed to count as resolved."""

RIGID = "slip onset not resolved: rigid limit"
ONE_SLIP = str(Regime.ONE_SLIP)

_EXTRA = 4  # odd harmonics beyond the bandwidth that the waveform is fitted to: they bound it
_JACKKNIFE_GROUPS = 400
_OF_ONSET = ("V_s", "t_s", "V_r", "t_r")
_MISFIT = 5.0  # standard deviations of χ²
_REACHED = 1e-9  # rad: the next of Newton's steps would be about its square


@dataclass(frozen=True, eq=False)
class Reading:
    """Features of one response read off a record, and how sure they are.

    features : of the one response; where the onset is not resolved, X_s = −X and a = 4X (the rigid limit).
    standard_errors : by feature name, of the jackknife over cycles; NaN for what is not read.
    steady : the conditioned record.   waveform : the fitted exact waveform, or None.
    onset_resolved : whether X_s, V_s, t_s were read.   length_bound : X + X_s is below it with 97.5 % confidence, m.
    warnings : what is wrong with the record, one sentence each; the last is `onset_note`, if there is one.
    onset_note : why the slip onset is not resolved, and what that costs.
    """

    features: Features
    steady: SteadyRecord
    waveform: Waveform | None
    onset_resolved: bool
    length_bound: float
    warnings: tuple[str, ...]
    onset_note: str = ""

    @cached_property
    def standard_errors(self) -> Mapping[str, float]:
        """Standard errors by leaving out one group of rows after the other; NaN for what is not read."""
        left, errors = self.left_out(), {}
        for name in COLUMNS:
            values = getattr(left, name)
            if name.startswith("phi"):  # phases near the ends of the interval
                values = np.unwrap(values)
            spread = float(np.sum((values - values.mean()) ** 2))
            errors[name] = math.sqrt((len(left) - 1) / len(left) * spread)
        return errors if self.onset_resolved else errors | dict.fromkeys(_OF_ONSET, math.nan)

    @one_thread
    def with_onset(self, onset: bool) -> Features:
        """The features with the slip onset of the waveform, resolved or not, or without: the rigid limit."""
        if onset == self.onset_resolved:
            return self.features
        return _features(self.steady, self.waveform, onset)

    @one_thread
    def resampled(
        self, count: int, rng: np.random.Generator, *, onset: bool | None = None
    ) -> Features:
        """`count` bootstrap replicates of the features: of means over cycles drawn with replacement.

        Their deviations from the mean are stretched by √(n/(n − 1)), n rows, for the bootstrap falls short of the
        scatter by that much.   onset : whether they have a slip onset; default, where it is resolved.
        """
        weights, onset = self.steady.weights, self.onset_resolved if onset is None else onset
        rows = len(weights)
        drawn = rng.multinomial(rows, np.full(rows, 1.0 / rows), size=count) * weights
        stretch = math.sqrt(rows / max(1, rows - 1))
        return _features(self.steady, self.waveform, onset, drawn, stretch)

    @one_thread
    def left_out(self, *, onset: bool | None = None) -> Features:
        """Jackknife replicates of the features: of means without one group of cycles after the other.

        g groups (all cycles, or 400): (g − 1)/g Σ (p_j − p̄)² over the replicates is the variance of any p.
        """
        weights, onset = self.steady.weights, self.onset_resolved if onset is None else onset
        rows = len(weights)
        groups = min(rows, _JACKKNIFE_GROUPS)
        member = np.arange(rows) * groups // rows
        drawn = np.where(member[None, :] == np.arange(groups)[:, None], 0.0, weights)
        return _features(self.steady, self.waveform, onset, drawn, bias=1.0)

    @one_thread
    def averaged_cycle(self, points: int = 720) -> dict[str, Array]:
        """One cycle as the harmonics within the bandwidth and the waveform beyond give it, for plots.

        phase : ωt, the peak of the base at 0, rad.   x, v, acceleration : m, m/s, m/s².
        """
        parts = _Parts.of(self.steady, self.waveform)
        theta = np.linspace(0.0, 2.0 * math.pi, points, endpoint=False)
        turn, rate = np.exp(1j * np.outer(theta, parts.n)), 1j * parts.n * self.steady.omega
        moved = {
            name: (turn @ (rate**order * parts.x[0])).real
            for order, name in enumerate(("x", "v", "acceleration"))
        }
        return {"phase": theta, **moved}


def read_features(
    measurement: Measurement,
    k: float,
    *,
    frequency_hz: float | None = None,
    skip_cycles: int = 0,
) -> Reading:
    """Features of the response of one measurement.

    k : stiffness, N/m.   frequency_hz : the nominal drive frequency, to compare with that of the excitation.
    skip_cycles : cycles left out at the start.   Raises ValueError naming the source when the record cannot be used.
    """
    return read_steady(
        condition(measurement, k, frequency_hz=frequency_hz, skip_cycles=skip_cycles)
    )


@one_thread
def read_steady(steady: SteadyRecord) -> Reading:
    """Features of a conditioned record."""
    waveform = _waveform(steady)
    warnings = list(steady.warnings)
    resolved, bound, note = False, math.nan, ""
    if waveform is None:
        note = (
            f"the harmonics show no slip onset (bandwidth: harmonic {steady.bandwidth}); the rigid limit a = 4X stands "
            "for the friction travel"
        )
    else:
        bound = waveform.length_bound
        resolved = waveform.length > RESOLVED * waveform.length_error
        if waveform.misfit > 1.0 + _MISFIT * math.sqrt(2.0 / max(1, waveform.freedom)):
            warnings.append(
                f"the waveform of one mass on a compliant contact fits the harmonics {waveform.misfit:.1f} times worse "
                "than their noise (χ² per degree of freedom): the slip onset is that of the nearest such waveform"
            )
    features = _features(steady, waveform, resolved)
    if waveform is not None and not resolved:
        note = (
            f"the slip onset is not resolved: the microstick line is {1e6 * waveform.length:.2g} ± "
            f"{1e6 * waveform.length_error:.2g} µm long; the rigid limit a = 4X is used, too large by less than "
            f"{50.0 * bound / features.X[0]:.2g} % (97.5 % confidence)"
        )
    return Reading(
        features=features,
        steady=steady,
        waveform=waveform,
        onset_resolved=resolved,
        length_bound=bound,
        warnings=(*warnings, note) if note else tuple(warnings),
        onset_note=note,
    )


def _waveform(steady: SteadyRecord) -> Waveform | None:
    """The exact waveform fitted to the odd harmonics up to a little beyond the bandwidth."""
    if steady.bandwidth < 3:
        return None
    highest = min(steady.bandwidth + 2 * _EXTRA, len(steady.X_error) - 1)
    n = np.arange(1, highest + 1, 2)
    base = steady.mean(steady.Y[:, 1:2])[0]
    x = steady.mean(steady.X)[n] * np.exp(-1j * n * np.angle(base))
    Y, Y_error = float(np.abs(base)), float(steady.Y_error[1])
    return fit_waveform(steady.omega, steady.k, Y, Y_error, n, x, steady.X_error[n])


@dataclass(frozen=True, eq=False)
class _Parts:
    """Means of r drawings of cycles: amplitude of the base, odd harmonics of x relative to its phase.

    Y : (r,).   x : x_n, (r, h), m: those read up to the bandwidth, those of the waveform beyond.   n : orders.
    read : how many of them are read.   variance : of x_n as a complex number, to be taken from |x_n|²; zero beyond, m².
    """

    Y: Array
    x: Complexes
    variance: Array
    n: Array
    read: int

    @classmethod
    def of(
        cls,
        steady: SteadyRecord,
        waveform: Waveform | None,
        drawn: Array | None = None,
        stretch: float = 1.0,
        bias: float = 1.0,
    ) -> _Parts:
        """drawn : weights of the rows, (r, rows); default, all once.   stretch : of the deviations from the mean.
        bias : how many variances |x_n|² holds too much."""
        # without a waveform to stand for them, the third and fifth are taken as they are
        least = 1 if waveform is not None else min(5, steady.X.shape[1] - 1)
        n = np.arange(1, max(steady.bandwidth, least) + 1, 2)
        Y, x = steady.mean(steady.Y[:, 1:2]), steady.mean(steady.X[:, n])[None]
        if drawn is not None:
            total = drawn.sum(axis=1)
            Y = Y + stretch * (drawn @ steady.Y[:, 1] / total - Y)
            x = x + stretch * (drawn @ steady.X[:, n] / total[:, None] - x)
        x = x * np.exp(-1j * np.outer(np.angle(Y), n))
        tail = np.zeros(0) if waveform is None else waveform.tail[n.size :]
        return cls(
            Y=np.abs(Y),
            x=np.hstack([x, np.tile(tail, (len(x), 1))]),
            variance=np.append(bias * 2.0 * steady.X_error[n] ** 2, np.zeros(tail.size)),
            n=np.arange(1.0, 2.0 * (n.size + tail.size), 2.0),
            read=n.size,
        )


def _features(
    steady: SteadyRecord,
    waveform: Waveform | None,
    onset: bool,
    drawn: Array | None = None,
    stretch: float = 1.0,
    bias: float = 2.0,
) -> Features:
    """Features of the means over the rows drawn, or over all, with the slip onset of the waveform or without.

    The onset follows the waveform to first order in the deviations from the means that it was fitted to. A replicate's
    |x_n|² holds the variance twice: the mean's own, and that of the drawing. Taking off both centres the replicates on
    the estimate.
    """
    parts = at = _Parts.of(steady, waveform)
    if drawn is not None:
        parts = _Parts.of(steady, waveform, drawn, stretch, bias)
    # may fall below zero: cutting that off would be a bias in b
    squares = np.abs(parts.x) ** 2 - parts.variance
    amplitudes = np.zeros((len(squares), 3))  # of the first three, as far as the sampling reaches
    amplitudes[:, : squares.shape[1]] = np.sqrt(np.maximum(squares[:, :3], 0.0))
    lag, read = -np.angle(parts.x[:, 0]), parts.read
    beyond = float(np.sum((parts.n * np.abs(parts.x[0]))[read:] ** 2))
    theta_peak, X = _peak(parts)
    reversal = wrapped(theta_peak)
    if onset and waveform is not None:
        regime, (length, V_s, t_s) = ONE_SLIP, _onset(parts, waveform, at)
    else:
        regime, (length, V_s, t_s) = RIGID, np.zeros((3, len(X)))
    return of_numbers(
        steady.omega,
        regime,
        Y=parts.Y,
        X=X,
        X_s=length - X,
        V_s=V_s,
        t_s=t_s,
        phi=reversal,
        phi_reversal=reversal,
        phi_zero_crossing=wrapped(_upward_zero(parts, lag) + 0.5 * math.pi),
        phi_fundamental=wrapped(lag),
        X_r=X - length,
        V_r=-V_s,
        t_r=t_s,
        X_1=amplitudes[:, 0],
        X_3=amplitudes[:, 1],
        X_5=amplitudes[:, 2],
        a=4.0 * X - 2.0 * length,
        b=math.pi * steady.omega * (squares[:, :read] @ parts.n[:read] ** 2 + beyond),
        W=math.pi * steady.k * parts.Y * amplitudes[:, 0] * np.sin(lag),
    )


def _onset(parts: _Parts, waveform: Waveform, at: _Parts) -> Array:
    """(L, V_s, t_s) of each mean, (3, r); at : the means that the waveform was fitted to."""
    here = np.array([[waveform.length], [waveform.orbit.V_s], [waveform.orbit.t_s]])
    fitted = waveform.sensitivity.shape[1] // 2
    used = np.arange(min(fitted, parts.read))
    off = (parts.x - at.x)[:, used]
    deviations = np.column_stack([parts.Y - at.Y, off.real, off.imag])
    return here + waveform.sensitivity[:, np.r_[0, 1 + used, 1 + fitted + used]] @ deviations.T


def _peak(parts: _Parts) -> tuple[Array, Array]:
    """(ωt, x) at the largest value of x, (r,): by Newton's method on the velocity, from the largest of 360 points."""
    mean = parts.x[:, :8].mean(axis=0)
    theta = np.linspace(0.0, 2.0 * math.pi, 360, endpoint=False)
    values = (np.exp(1j * np.outer(theta, parts.n[:8])) @ mean).real
    start = float(theta[int(np.argmax(values))])
    at = np.full(len(parts.Y), start)
    limit = 2.0 * math.pi / 360
    for _ in range(4):
        _, rate, bend = _motion(parts, at)
        step = np.where(bend < 0.0, -rate / np.where(bend < 0.0, bend, -1.0), 0.0)
        at = at + np.clip(step, -limit, limit)
        if np.all(np.abs(step) < _REACHED):
            break
    return at, _motion(parts, at)[0]


def _upward_zero(parts: _Parts, lag: Array) -> Array:
    """ωt of the upward zero of x, (r,)."""
    at = lag - 0.5 * math.pi
    for _ in range(5):
        x, rate, _ = _motion(parts, at)
        step = x / np.where(rate > 0.0, rate, np.inf)
        at = at - np.clip(step, -0.5, 0.5)
        if np.all(np.abs(step) < _REACHED):
            break
    return at


def _motion(parts: _Parts, theta: Array) -> tuple[Array, Array, Array]:
    """x, dx/dωt, d²x/dωt² at one phase for each mean, (r,)."""
    n = parts.n
    turn = np.empty(
        parts.x.shape, dtype=np.complex128
    )  # e^{inθ}: products cost less than exponentials
    turn[:, 0], turn[:, 1:] = np.exp(1j * theta), np.exp(2j * theta)[:, None]
    turn = np.multiply.accumulate(turn, axis=1) * parts.x
    return turn.real.sum(axis=1), -(turn.imag @ n), -(turn.real @ n**2)
