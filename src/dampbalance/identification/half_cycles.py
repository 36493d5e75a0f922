"""Rows of the energy balance from the half cycles of free decays, read from the samples without the fitted motion.

Between two turns a and b of a free motion that slips, the energy of the spring goes into friction and damper,

    ½k (x_a² − x_b²) = F_k (D − 2Z_m) + c ∫ ẋ² dt,    D = |x_a − x_b|

with x measured from the position at which the spring is slack, which no sample shows: the mass may stick anywhere
within F_k/k of it. Since x_a² − x_b² = ±D (x_a + x_b), that position cancels in the sum of two neighbouring half cycles
if each is multiplied by the swing of the other; divided by the sum of both swings, it is a row of the balance:

    ½k D₀D₁ (D₀ − D₁)/(D₀ + D₁) = F_k [D₁(D₀ − 2Z_m) + D₀(D₁ − 2Z_m)]/(D₀ + D₁) + c (D₁b₀ + D₀b₁)/(D₀ + D₁)

D and b = ∫ ẋ² dt are integrals of the velocity between its zeros: of the smoothed derivative of a displacement, of the
smoothed velocity, or of the integral of an acceleration. An error in the time of a turn acts on them in second order
only. An offset or a drift of the velocity lengthens swings to one side and shortens those to the other: the one that
makes D run smoothly is subtracted, and the rows leave it free. All these are sums over samples, so that the covariance
of the rows follows from the noise; rows that share a swing or a turn are correlated.

For a pendulum, (x_a² − x_b²)/2 is replaced by cos x_b − cos x_a = ±2 sin(D/2) sin((x_a + x_b)/2): S = 2 sin(D/2) takes
the place of D as a weight, and the sine of a decrement that of the decrement itself.

From the fit come only the stick distance Z_m = F_k/K_z, which matters little if the contact is stiff, and the motion
where samples are missing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag
from scipy.ndimage import uniform_filter1d
from scipy.signal import savgol_filter

from ..arrays import Array, Integers
from ..balance import Rows
from ..fit.decay import Decay, DecayFit
from ..law.terms import FRICTION
from ..signals.bursts import Signal, least_noise
from ..signals.simpson import integrals
from ..signals.thresholds import SIGNIFICANT

# More samples are averaged to as many: a mean over dt makes a swing smaller by (ωdt)²/24, 2e-4.
_SAMPLES_A_CYCLE = 100
_WINDOW = 12  # samples are smoothed over a twelfth of a cycle on either side
_DEGREE = 4  # of the smoothing polynomial, whose error in a sine over that window is 2e-4
_MOST_HALVES = 200  # their covariance takes a tenth of a second, and few decays show more
_SLIPS = 1.5  # sticks 2Z_m that a swing must have: the mass then slips in every half cycle
_PASSES = 4  # corrections of the baseline: each leaves the square of the one before
# half cycles for each parameter of the baseline: with fewer, it would follow the decay
_HALVES_A_BEND = 6
_AT_REST = 2.0  # times the noise: the scatter of the last cycle where the mass is at rest
# standard errors of the baseline by which the rows leave it free: more would change nothing
_FREE = 10.0
_APART = 0.4  # part of half a cycle by which turns may be early or late


class Swings(NamedTuple):
    """The swings of a decay in one channel.

    turns : rows (t, x) with x from the rest position, s and m, (n + 1, 2).   errors : of x, m, (n + 1,).
    D, b : |x_a − x_b|, m, and ∫ ẋ² dt, m²/s, of each half cycle, (n,).   covariance : of D and b, (2n, 2n).
    free : number of parameters of the baseline of the velocity, which the covariance leaves free.
    """

    turns: Array
    errors: Array
    D: Array
    b: Array
    covariance: Array
    free: int


@dataclass(frozen=True, eq=False)
class DecayRows:
    """Rows of all decays.

    rows : a of F_k and b of c, one friction force for all.   covariance : of W − a F_k − b c, J², (n, n).   decay,
    friction : number of the decay and of the friction force of each row, (n,).
    free : number of parameters of baselines, which the covariance leaves free.
    turns : of each decay, rows (t, x), s and m, and their standard errors, m; empty where none could be read.
    """

    rows: Rows
    covariance: Array
    decay: Integers
    friction: Integers
    free: int
    turns: tuple[tuple[Array, Array], ...]

    @property
    def halves(self) -> int:
        """Number of half cycles that were read."""
        return sum(max(0, len(turns) - 1) for turns, _ in self.turns)


def rows_of(fit: DecayFit) -> DecayRows:
    """Return the rows of all decays of a fit, from which they take only k, Z_m, the period and the missing samples."""
    forces = [fit.value(one.key("F_k")) for one in fit.decays]
    numbers = {F_k: number for number, F_k in enumerate(dict.fromkeys(forces))}
    columns, decays, halves = [np.empty((0, 3))], [], []
    for i, (one, F_k) in enumerate(zip(_without_gaps(fit), forces, strict=True)):
        stick = 2.0 * F_k / fit.at_once
        moves = one.cut(one.start, fit.at_rest(i))  # from there on it rings on the contact
        channels = [swings_of(signal, one.period, _SLIPS * stick) for signal in moves.signals]
        read = max(channels, key=lambda of: (of.D.size, -of.errors.sum()))
        (differ, pair, scale), (S, slope) = _pairs(read.D), _weights(read.D, fit)
        halves.append((read, stick, differ, pair, scale, S, slope))
        parts = 0.5 * fit.k * differ @ read.D, pair @ ((read.D - stick) / S), pair @ (read.b / S)
        columns.append(scale * np.stack(parts, axis=1))
        decays += [i] * len(scale)
    which = np.array(decays, dtype=np.intp)
    friction = np.array([numbers[F_k] for F_k in forces], dtype=np.intp)[which]
    W, a, b = np.vstack(columns).T
    travels = [np.where(friction == number, a, 0.0) for number in numbers.values()]
    *F, c = np.linalg.lstsq(np.column_stack([*travels, b]), W)[0]
    blocks = []
    for (read, stick, differ, pair, scale, S, slope), F_k in zip(halves, forces, strict=True):
        F_i = F[numbers[F_k]]
        loss = (F_i - (F_i * (read.D - stick) + c * read.b) * slope / S) / S
        by = scale * np.hstack([0.5 * fit.k * differ - pair * loss, -c * pair / S])
        blocks.append(by @ read.covariance @ by.T)
    swings = [read for read, *_ in halves]
    turns, free = [(one.turns, one.errors) for one in swings], sum(one.free for one in swings)
    rows = Rows({FRICTION: a, "c": b}, W)
    return DecayRows(rows, block_diag(*blocks), which, friction, free, tuple(turns))


def _weights(D: Array, fit: DecayFit) -> tuple[Array, Array]:
    """Return S of each half cycle, D unless it is of a pendulum, and its derivative."""
    if fit.problem.pendulum:
        return 2.0 * np.sin(0.5 * D), np.cos(0.5 * D)
    return D, np.ones(D.size)


def _without_gaps(fit: DecayFit) -> list[Decay]:
    """Return the decays of a fit with its motion in place of missing samples."""
    gaps = [signal.missing for one in fit.decays for signal in one.signals]
    if not any(gap is not None and gap.any() for gap in gaps):
        return [*fit.decays]
    decays = [
        replace(one, signals=tuple(replace(signal, missing=None) for signal in one.signals))
        for one in fit.decays
    ]
    problem = replace(fit.problem, decays=tuple(decays), band=None)
    filled: list[list[Signal]] = [[] for _ in decays]
    for gap, (i, signal, off) in zip(gaps, replace(fit, problem=problem).residuals(), strict=True):
        values = signal.values + (0.0 if gap is None else gap * off * signal.noise)
        filled[i].append(replace(signal, values=values))
    return [replace(one, signals=tuple(of)) for one, of in zip(decays, filled, strict=True)]


def _pairs(D: Array) -> tuple[Array, Array, Array]:
    """Return the difference and the sum of each two neighbours as matrices, (n − 1, n), and D₀D₁/(D₀ + D₁), (n − 1,
    1)."""
    one, other = np.eye(D.size)[:-1], np.eye(D.size)[1:]
    return one - other, one + other, 1.0 / ((one + other) @ (1.0 / D))[:, None]


_NO_SWINGS = Swings(np.empty((0, 2)), np.empty(0), np.empty(0), np.empty(0), np.empty((0, 0)), 0)


def swings_of(signal: Signal, period: float, least: float) -> Swings:
    """Return the swings of a free decay in a channel, up to the first that does not exceed `least`, m.

    The first half cycle, which begins before the first turn, and the last, which may end in sticking, are left out.
    There are none where fewer than two stand out of the noise.

    period : of the motion, s.
    """
    if signal.t.size < 2:
        return _NO_SWINGS
    many = max(1, int(period / signal.dt / _SAMPLES_A_CYCLE))
    count, dt = signal.values.size // many, many * signal.dt
    y = signal.values[: count * many].reshape(count, many).mean(axis=1)
    cycle = round(period / dt)
    width = 2 * max(2, round(cycle / _WINDOW)) + 1
    if count <= 2 * cycle + 4 * width:
        return _NO_SWINGS

    def smoothed(values: Array, derivative: int) -> Array:
        of: Array = savgol_filter(values, width, _DEGREE, derivative, dt, mode="constant")
        return of

    def velocity(values: Array) -> Array:
        if signal.order == 2:
            of: Array = dt * (np.cumsum(values, axis=-1) - 0.5 * values)
            return of
        return smoothed(values, 1 - signal.order)

    impulse = np.eye(1, 2 * width + 1, width)[0]
    # two measures of the noise: the second, for which few samples do not suffice, includes a hum
    noises = [np.diff(y, 3) / math.sqrt(20.0)]
    if width > _DEGREE + 1:
        share = math.sqrt(1.0 - smoothed(impulse, 0)[width])
        noises.append((y - smoothed(y, 0))[width:-width] / share)
    sigma = max(1.4826 * float(np.median(np.abs(one))) for one in noises)
    sigma = max(sigma, least_noise(y))
    rests = float(np.std(y[-cycle:])) < _AT_REST * sigma
    y = y - y[-cycle if rests else 0 :].mean()
    inside = slice(width, count - width)  # the filter reaches no end
    t = float(signal.t[0]) + 0.5 * (dt - signal.dt) + dt * np.arange(count)[inside]
    v, cells = velocity(y)[inside], np.arange(t.size)
    bias = sigma**2 * float(np.sum(velocity(impulse) ** 2))
    if signal.order == 2:  # what has been added up drifts
        bias = 0.0
        slow = uniform_filter1d(uniform_filter1d(v, cycle), cycle)[cycle:-cycle]
        v = v - np.polyval(np.polyfit(t[cycle:-cycle], slow, 1), t)
    above_rest = v
    swing = np.pad(np.ones(cycle // 2), width)  # as a sum over the velocity
    # the smallest swing whose turns are no noise
    least = max(least, SIGNIFICANT * sigma * dt * float(np.linalg.norm(velocity(swing))))
    fewest = _HALVES_A_BEND if signal.order == 2 or (signal.order and not rests) else 3
    for _ in range(_PASSES):
        places = _turns(v, 0.5 * cycle)[: _MOST_HALVES + 1]
        signed, b = integrals(np.stack([v, v**2]), dt, places)
        n = int(np.argmin(np.append(np.abs(signed) > least, False)))
        if n < fewest:
            return _NO_SWINGS
        places, side, D = places[: n + 1], np.sign(signed[:n]), np.abs(signed[:n])
        b = b[:n] - bias * dt * np.diff(places)
        ends = places[:, None]
        parts = np.minimum(cells + 0.5, ends[1:]) - np.maximum(cells - 0.5, ends[:-1])
        weights = np.zeros((2 * n, count))  # D and b are sums of samples of the velocity
        weights[:n, inside] = side[:, None] * dt * np.clip(parts, 0.0, 1.0)
        weights[n:, inside] = 2.0 * v * dt * np.clip(parts, 0.0, 1.0)
        # backwards in time, a filter is its own transpose
        by_noise = sigma * velocity(weights[:, ::-1])
        covariance = by_noise @ by_noise.T
        bends = n // _HALVES_A_BEND + (signal.order == 2)  # one more for its start
        knots = np.linspace(places[0], places[-1], max(1, bends))
        hats = np.stack([np.interp(cells, knots, one) for one in np.eye(knots.size)])
        by_baseline = weights[:, inside] @ hats.T
        if bends:  # the baseline that leaves swings to one side as long as those to the other
            second = np.diff(np.eye(n, 2 * n), 2, axis=0)
            read = np.linalg.pinv(second @ by_baseline) @ second
            v = v - (read[:, :n] @ D) @ hats
        else:  # that at rest
            read, v = np.zeros((1, 2 * n)), above_rest
            covariance += (signal.order * sigma**2 / cycle) * (by_baseline @ by_baseline.T)
    settled = np.eye(2 * n) - by_baseline @ read
    errors = (settled @ covariance @ settled.T)[:n, :n]
    free = by_baseline @ read
    covariance = covariance + _FREE**2 * free @ covariance @ free.T
    last = n - 1
    # two turns to one side, and that between twice, have their mean at rest, in pairs
    by_D = np.vstack([np.zeros(last), np.tril(np.ones((last, last))) * side[:last]])
    by_D -= np.convolve(np.full(last - 1, 0.25 / (last - 1)), [1.0, 2.0, 1.0]) @ by_D
    turns = np.column_stack([np.interp(places[: last + 1], cells, t), by_D @ D[:last]])
    of_turns = np.sqrt(np.diag(by_D @ errors[:last, :last] @ by_D.T))
    kept = np.r_[:last, n : n + last]
    return Swings(turns, of_turns, D[:last], b[:last], covariance[np.ix_(kept, kept)], bends)


def _turns(v: Array, half: float) -> Array:
    """Return the zeros of a velocity, in samples, for as long as they are half a cycle apart.   half : samples."""
    i = np.flatnonzero(v[:-1] * v[1:] < 0.0)
    zeros = i + v[i] / (v[i] - v[i + 1])
    # noise turns one zero into three
    groups = np.split(zeros, np.flatnonzero(np.diff(zeros) > 0.5 * half) + 1)
    places = np.array([of.mean() for of in groups if of.size % 2])
    regular = np.abs(np.diff(places) / half - 1.0) < _APART
    first = int(np.argmax(np.append(regular, True)))
    last = first + int(np.argmin(np.append(regular[first:], False)))
    return places[first : last + 1]
