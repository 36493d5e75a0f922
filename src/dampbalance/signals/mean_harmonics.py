"""Features of one noisy record, with standard errors and bootstrap replicates.

All features are functions of the mean harmonics of base and response, relative to the phase of the base:

    X_n² = |x_n|² − var x_n              freed of the bias that noise gives a square
    W = −πk Σ n Im(y_n* x_n)             exact by orthogonality, and free of bias as it is: linear in x_n
    b = πω Σ n²X_n²                      exact by orthogonality, too
    2X = x_max − x_min                   of Σ x_n e^{inωt}, or between the levels of rests (`turning.py`)
    X_s, V_s, t_s, a = 4X − λ            from the exact waveform that fits (`Waveform`)

If a waveform fits, it also gives the odd harmonics beyond the fifth, where those of the record are mostly noise.
Otherwise all harmonics up to the bandwidth are those of the record, and the onset of slip is unknown: a = 4X. Even
harmonics of the response and higher ones of the base are used if they are significant. Onset and zero crossing are
those of the symmetric part of the motion.

Standard errors follow from the jackknife over cycles; replicates draw cycles with replacement. Both evaluate the same
functions on many means at once, with the waveform to first order.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import Array, Complexes
from ..features import FEATURE_COLUMNS, Features, of_numbers, wrapped_phase
from ..findings.finding import Finding
from ..law.terms import FRICTION, of_harmonics
from ..motion.law_steady import Response
from ..records.record import Record
from .conditioning import SteadyRecord, condition
from .cycles import bootstrap, powers
from .one_thread import one_thread
from .record_harmonics import RecordHarmonics
from .turning import Series, turning_points, upward_zero

ONSET_UNKNOWN = "slip onset not known"

_HIGHEST_READ = 5  # the highest harmonic taken from a record that an exact waveform fits
_OF_ONSET = ("X_s", "V_s", "t_s", "X_r", "V_r", "t_r")


@dataclass(frozen=True, eq=False)
class Means:
    """Means of r drawings of the rows of a record, with phases relative to the base.

    Y : amplitude of the base, m, (r,).   x : x_n, m, (r, h), n as in `RecordHarmonics`.
    even : significant x_n, n = 2, 4 …, m.   base : significant y_n, n = 2, 3 …, m.
    bias : noise bias of |x_n|², in variances of x_n, (r,): 1 for the mean, 2 for bootstrap replicates.
    """

    Y: Array
    x: Complexes
    even: Complexes
    base: Complexes
    bias: Array

    def __getitem__(self, kept: Any) -> Means:
        """Return the means of some drawings, selected by a list or a mask."""
        return Means(*(getattr(self, part.name)[kept] for part in fields(self)))

    def followed_by(self, other: Means) -> Means:
        """Return these means followed by others of the same record."""
        names = [part.name for part in fields(self)]
        return Means(*(np.concatenate([getattr(of, n) for of in (self, other)]) for n in names))

    def delayed(self, turn: float, of_base: float = 0.0) -> Means:
        """Return the means of a response that is late by `turn`, rad at the drive frequency, n times that at harmonic
        n.

        of_base : as for `changed`.
        """
        added = np.zeros_like(self.x)
        added[:, 0] = self.Y * of_base
        odd, even = (np.arange(of.shape[1]) for of in (self.x, self.even))
        x = (self.x - added) * np.exp(-1j * turn * (2 * odd + 1)) + added
        return replace(self, x=x, even=self.even * np.exp(-1j * turn * (2 * even + 2)))

    def changed(
        self, drive: float, response: float, turn: float, lever: float, of_base: float = 0.0
    ) -> Means:
        """Return the means of base and response multiplied by `drive` and `response`, the response late by `turn`, rad
        at the drive frequency, n times that at harmonic n, to first order.

        lever : factor of the effect of the drive that leaves the motion of the base unchanged.
        of_base : multiple of the fundamental of the base that was added to the measured response.
        """
        added = np.zeros_like(self.x)
        added[:, 0] = self.Y * of_base

        def turned(x: Complexes, lowest: int) -> Complexes:
            n = lowest + 2 * np.arange(x.shape[1])
            return np.asarray(x * response * (1.0 - 1j * turn * n))

        x, driven = turned(self.x - added, 1) + added * drive, drive * lever
        return Means(self.Y * driven, x, turned(self.even, 2), self.base * driven, self.bias)


@dataclass(frozen=True, eq=False)
class Waveform:
    """The fitted waveform of one record, with derivatives by the p unknowns of the fit.

    response : the motion.
    onset : (V_s, t_s, λ), SI, λ = 4X − a the travel that sticking takes from 4X: 2L for one slip onset per half cycle.
    onset_slope : (3, p).
    tail : harmonics x_n, n = 1, 3, 5 …, as the record shows them, phases counted from the peak of y, m.
    tail_slope : (harmonics, p).
    at : indices of the record's unknowns among the p, by name.
    F_k : friction force of the record, N.
    rho, rho_error : K_z^{−1/2} with its standard error.
    folded : aliases in the harmonics of the record, m.
    by_data : derivatives of the unknowns by |Y|, its phase, Re x_n and Im x_n, in units of their errors, (p, data).
    """

    response: Response
    onset: Array
    onset_slope: Array
    tail: Complexes
    tail_slope: Complexes
    at: Mapping[str, int]
    F_k: float
    rho: float
    rho_error: float
    folded: Complexes
    by_data: Array

    @property
    def length(self) -> float:
        """L = 2F_k/K_z, m, without its bias of second order."""
        return 2.0 * self.F_k * (self.rho**2 - self.rho_error**2)

    @property
    def length_slope(self) -> Array:
        """Derivatives of L by the unknowns, (p,)."""
        slope = np.zeros(len(self.by_data))
        slope[self.at[FRICTION]] = 2.0 * self.rho**2
        slope[self.at["rho"]] = 4.0 * self.F_k * self.rho
        return slope


@dataclass(frozen=True, eq=False)
class Reading:
    """Features of one response read off a record, with their standard errors.

    steady : the conditioned record.
    waveform : the exact waveform that fits; None if none does or none was fitted.
    stick_travel : λ = 4X − a, m, by which sticking reduces the travel 4X, used if there is no waveform.
    terms : of a damping law, other than friction and a linear damper, whose integrals are wanted.
    """

    steady: SteadyRecord
    waveform: Waveform | None = None
    stick_travel: float = 0.0
    terms: tuple[str, ...] = ()

    @cached_property
    def lines(self) -> RecordHarmonics:
        """The harmonics to which waveforms are fitted, without the aliases of a waveform that fits."""
        lines = RecordHarmonics.of(self.steady)
        if self.waveform is None:
            return lines
        return replace(lines, x=lines.x - self.waveform.folded, folds=None)

    @property
    def slips(self) -> bool | None:
        """Whether the contact slips; None if no waveform fits."""
        return None if self.waveform is None else self.waveform.response.slips

    @cached_property
    def features(self) -> Features:
        """Features of the response; if no waveform fits, X_s = −X (the rigid limit) and a = 4X − λ."""
        return self.features_of(self.mean)

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """Findings on the record."""
        return self.steady.warnings

    @cached_property
    def standard_errors(self) -> Mapping[str, float]:
        """Standard errors of the features by a jackknife over groups of rows; NaN for features that are not read."""
        left, errors = self.features_of(self.left_out()), {}
        for name in FEATURE_COLUMNS:
            values = getattr(left, name)
            if name.startswith("phi"):  # phases near the ends of the interval
                values = np.unwrap(values)
            errors[name] = math.sqrt((len(left) - 1) * float(np.var(values)))
        return errors if self.slips else errors | dict.fromkeys(_OF_ONSET, math.nan)

    @cached_property
    def mean(self) -> Means:
        """The means over all rows."""
        means = self._drawn(self.steady.weights[None], 0.0, 1.0)
        return replace(means, Y=np.array([self.lines.Y]), x=self.lines.x[None])

    def resampled(self, count: int, rng: np.random.Generator) -> Means:
        """Return `count` bootstrap replicates of the means, of rows drawn with replacement, with additional random
        errors for those that all rows of an unsteady record share."""
        drawn, stretch = bootstrap(len(self.steady.weights), count, rng)
        means = self._drawn(drawn * self.steady.weights, stretch, 2.0)
        hidden = self._hidden
        if not hidden.any():
            return means
        of_base = rng.standard_normal((count, 1))
        sizes = (part.shape[1] for part in (means.x, means.even, means.base))
        pairs = [rng.standard_normal((2, count, size)) for size in sizes]
        off = np.hstack([of_base, *(one + 1j * other for one, other in pairs)])
        return self._with(means, off * hidden)

    def with_hidden_errors(self) -> list[Means]:
        """Return the mean with each hidden error, up and down, as an additional set of groups of a jackknife; empty if
        there are no hidden errors."""
        errors = np.diag(self._hidden)[self._hidden > 0.0]
        if not len(errors):
            return []
        groups = 4 * len(errors)
        # (g − 1)/g of the squares of both, up and down, is the variance
        errors = errors * math.sqrt(groups / (2.0 * (groups - 1)))
        ways = np.array([1.0, -1.0, 1j, -1j])[:, None, None]
        return [self._with(self.mean[[0] * groups], (ways * errors).reshape(groups, -1))]

    @property
    def _hidden(self) -> Array:
        """Errors that all rows share, m: of the amplitude of the base and of `x`, `even` and `base` of `Means`."""
        of, even = self.steady, slice(2, self.steady.even_bandwidth + 1, 2)
        base = of.Y_hidden[2 : of.base_bandwidth + 1]
        return np.concatenate(
            [of.Y_hidden[1:2], of.X_hidden[self.lines.n], of.X_hidden[even], base]
        )

    def _with(self, means: Means, off: Array | Complexes) -> Means:
        """Return means with errors added in the order of `_hidden`, (r, e); the phase of the base has none."""
        Y, x, even, base = np.split(
            off, np.cumsum([1, means.x.shape[1], means.even.shape[1]]), axis=1
        )
        return Means(
            means.Y + Y[:, 0].real, means.x + x, means.even + even, means.base + base, means.bias
        )

    def left_out(self) -> Means:
        """Return jackknife replicates of the means, each without one group of rows.

        With g groups (all rows, or 400), (g − 1)/g Σ (p_j − p̄)² over the replicates is the variance of any p.
        """
        weights = self.steady.weights
        rows = len(weights)
        groups = min(rows, 400)
        member = np.arange(rows) * groups // rows
        return self._drawn(np.where(member == np.arange(groups)[:, None], 0.0, weights), 1.0, 1.0)

    def moved(self, means: Means) -> Array:
        """Return the changes of the unknowns of the fit for these means of the record, (p, r), to first order."""
        waveform = self.waveform
        if waveform is None:
            return np.zeros((0, len(means.Y)))
        lines, off = self.lines, (means.x - self.lines.x).T
        off[0] -= lines.of_base * (means.Y - lines.Y)
        error = lines.x_error[:, None]
        Y = (means.Y - lines.Y) / lines.Y_error
        data = np.vstack([Y, np.zeros(Y.size), off.real / error, off.imag / error])
        return waveform.by_data @ data

    @one_thread
    def features_of(self, means: Means, moved: Array | None = None) -> Features:
        """Return the features of means of the record.

        moved : changes of the unknowns of the fit, (p, r); default, those caused by this record alone.
        """
        moved = self.moved(means) if moved is None else moved
        steady, series = self.steady, self.series(means, moved)
        squares = series.squares
        amplitudes = np.zeros((3, len(means.Y)))  # zero where the sampling does not reach
        first = squares[:, series.n % 2.0 > 0.0][:, :3]
        amplitudes[: first.shape[1]] = np.sqrt(np.maximum(first, 0.0)).T
        lag = -np.angle(series.x[:, 0])
        theta_peak, X = turning_points(series, rests=self.waveform is None)
        reversal = wrapped_phase(theta_peak)
        regime, length, (V_s, t_s, stick_travel) = self._onset(means, moved)
        base = np.hstack([means.Y[:, None], means.base])
        orders = np.arange(1.0, base.shape[1] + 1.0)
        # Σ n Im(y_n* x_n) over the harmonics n = 2, 3 … of the base
        x = np.zeros((len(base), orders.size + 1), dtype=np.complex128)
        shared = series.n <= orders.size
        x[:, series.n[shared].astype(np.intp)] = series.x[:, shared]
        beyond = (means.base.conj() * x[:, 2:]).imag @ orders[1:]
        motion = series.n, series.x, orders, base, steady.omega, steady.k, series.variance
        return of_numbers(
            steady.omega,
            regime,
            Y=means.Y,
            X=X,
            X_s=length - X,
            V_s=V_s,
            t_s=t_s,
            phi=reversal,
            phi_reversal=reversal,
            phi_zero_crossing=wrapped_phase(upward_zero(series, lag) + 0.5 * math.pi),
            phi_fundamental=wrapped_phase(lag),
            X_r=X - length,
            V_r=-V_s,
            t_r=t_s,
            **dict(zip(("X_1", "X_3", "X_5"), amplitudes, strict=True)),
            a=4.0 * X - stick_travel,
            b=math.pi * steady.omega * (squares @ series.n**2),
            W=-math.pi * steady.k * (means.Y * series.x[:, 0].imag + beyond),
            integrals={symbol: of_harmonics(symbol, *motion) for symbol in self.terms},
        )

    @one_thread
    def averaged_cycle(self, points: int = 720) -> dict[str, Array]:
        """Return one cycle from the harmonics of the record and, beyond them, of the waveform, for plots.

        phase : ωt, the peak of the base at 0, rad.   x, v, acceleration : m, m/s, m/s².   y, w : of the base and its
        velocity, m, m/s.
        """
        series = self.series(self.mean)
        cycle = self._cycle(series.n, series.x[0], points)
        y = np.append(np.abs(self.steady.mean(self.steady.Y[:, 1:2])), self.lines.base)
        of_base = self._cycle(np.arange(1.0, y.size + 1.0), y, points)
        return cycle | {"y": of_base["x"], "w": of_base["v"]}

    def fitted_cycle(self, waveform: Waveform, points: int = 720) -> dict[str, Array]:
        """Return one cycle of a waveform fitted to this record, in the columns of `averaged_cycle` without the base."""
        x = waveform.tail
        return self._cycle(np.arange(1.0, 2.0 * x.size, 2.0), x, points)

    def _cycle(self, n: Array, x: Complexes, points: int) -> dict[str, Array]:
        """Return Re Σ x_n e^{inθ} with its first two time derivatives."""
        theta = np.linspace(0.0, 2.0 * math.pi, points, endpoint=False)
        rate, turned = 1j * n * self.steady.omega, np.exp(1j * np.outer(n, theta))
        cycle = {"phase": theta}
        for order, name in enumerate(("x", "v", "acceleration")):
            cycle[name] = ((rate**order * x) @ turned).real
        return cycle

    def series(self, means: Means, moved: Array | None = None) -> Series:
        """Return the harmonics of r means of the response: those of the record and, beyond them, odd ones of the
        waveform.

        moved : as for `features_of`.
        """
        moved = self.moved(means) if moved is None else moved
        waveform, lines = self.waveform, self.lines
        if waveform is None:
            # the third and the fifth are used even if they are not significant
            own = lines.n <= max(self.steady.bandwidth, _HIGHEST_READ)
            tail = np.zeros((len(means.Y), 0), dtype=np.complex128)
        else:
            own = lines.n <= min(max(self.steady.bandwidth, 1), _HIGHEST_READ)
            beyond = slice(np.count_nonzero(own), None)
            tail = waveform.tail[beyond] + (waveform.tail_slope[beyond] @ moved).T
        x = np.hstack([means.x[:, own], tail, means.even])
        odd, even = np.arange(x.shape[1] - means.even.shape[1]), np.arange(means.even.shape[1])
        n = np.concatenate([2.0 * odd + 1.0, 2.0 * even + 2.0])
        of_even = self.steady.X_error[2::2][: even.size]
        error = np.concatenate([lines.x_error[own], np.zeros(tail.shape[1]), of_even])
        return Series(n, x, np.outer(means.bias, 2.0 * error**2))

    @one_thread
    def _drawn(self, drawn: Array, stretch: float, bias: float) -> Means:
        """Return means with the weights `drawn` of the rows, (r, rows), and their deviations times `stretch`."""
        steady, lines = self.steady, self.lines
        drawn = drawn / drawn.sum(axis=1, keepdims=True)

        def stretched(rows: Complexes) -> Complexes:
            mean = steady.mean(rows)
            return mean + stretch * (drawn @ rows - mean)

        even = np.arange(2, steady.even_bandwidth + 1, 2)
        higher = np.arange(2, steady.base_bandwidth + 1)
        Y = stretched(steady.Y[:, 1:2])
        last = max(int(lines.n[-1]), steady.even_bandwidth, steady.base_bandwidth)
        turn = powers((np.abs(Y) / Y)[:, 0], 1 + last)
        parts = (steady.X, lines.n), (steady.X, even), (steady.Y, higher)
        x, even_x, base = (stretched(of[:, n]) * turn[:, n] for of, n in parts)
        if self.waveform is not None:
            x -= self.waveform.folded
        return Means(np.abs(Y[:, 0]), x, even_x, base, np.full(len(drawn), bias))

    def _onset(self, means: Means, moved: Array) -> tuple[str, Array, Array]:
        """Return the regime, L, (r,), and (V_s, t_s, λ), (3, r), of each mean; NaN if the contact sticks.

        L and λ are proportional to ρ², so that the square of its error is subtracted, twice for bootstrap replicates.
        """
        count, waveform = len(means.Y), self.waveform
        if waveform is None:
            onset = np.repeat([[0.0], [0.0], [self.stick_travel]], count, axis=1)
            return ONSET_UNKNOWN, np.zeros(count), onset
        regime = str(waveform.response.orbit.regime)
        if not self.slips:
            return regime, np.full(count, math.nan), np.full((3, count), math.nan)
        error = moved[waveform.at["rho"]]
        square = error**2 - means.bias * waveform.rho_error**2
        length = 2.0 * waveform.F_k * (waveform.rho**2 + square) + waveform.length_slope @ moved
        onset = waveform.onset[:, None] + waveform.onset_slope @ moved
        onset[2] += 4.0 * waveform.F_k * square
        return regime, length, onset


def read_features(
    measurement: Record, k: float, *, frequency_hz: float | None = None, skip_cycles: int = 0
) -> Reading:
    """Return the features of the response of one measurement.

    k : stiffness, N/m.   frequency_hz : nominal drive frequency, compared with that of the excitation.
    skip_cycles : cycles to leave out at the start.   Raises ValueError naming the source if the record cannot be used.
    """
    return Reading(condition(measurement, k, frequency_hz=frequency_hz, skip_cycles=skip_cycles))
