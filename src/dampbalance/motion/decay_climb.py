"""The climb to the oscillator whose free decays fit given samples best, compiled as a whole.

A point holds F_k, c, ρ = K_z^{−1/2}, m, the offsets of the channels, and the start state x, ẋ, w of each decay. In a
phase the residual (model − sample) and its derivatives are linear in six functions of time: the responses to ẋ(0) and
f₀, the derivatives by δ and Ω², 1, and the residual. Their products are summed over the samples of the phase, e^{−δt}
cos and sin advanced from sample to sample by a rotation, and taken to the unknowns once per phase. The sum over all
phases is the information JᵀJ with Jᵀr and rᵀr, from which Levenberg–Marquardt steps follow.

Normal equations hold half of the digits of a factorisation of J. That suffices: the gradient Jᵀr, which says where the
climb ends, is exact, and only the steps towards there are approximate.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Mask
from ..model import Parameters
from .decays import COMMON_UNKNOWNS, STATE_UNKNOWNS, phase_slopes, phase_start_of, responses
from .events import read_phase, run
from .jit import jit
from .states import states_in_phases

MOST_PHASES = 4096
"""Of a decay: a motion that slips more often than that is none."""

DECAY, ORDER, OFFSET, FIRST, STEP, NOISE, BEGIN, END = range(8)
"""Columns of the table of channels: number of the decay, order of the derivative, number of the offset, time of the
first sample after the start of the decay, s, interval, s, standard deviation of the noise, and the samples' places."""

_F_K, _C, _RHO, _M = range(COMMON_UNKNOWNS)
_OWN = (
    COMMON_UNKNOWNS + STATE_UNKNOWNS
)  # unknowns of one decay without its offset, which follows, and the residual
_UNDER = 0.999  # of the critical damping: below it the responses are advanced by a rotation
_CHORD = 3e-2  # of ρ√k, K_z = 1100 k
# A motion with more phases than that for its samples is none that they show.
_FEW_PHASES, _PER_PHASE = 64, 4
_RIDGE = 1e-13  # of the diagonal of the information, in which rounding is as large
_RELATIVE = 1e-11
_STALLED = 1e-7  # of an unknown: rounding may refuse a step below this
_STEEPEST = 1e10  # damping at which no step has helped
_SHRINK = 0.2  # no positive unknown falls below this part of itself in one step


class Bounds(NamedTuple):
    """Which unknowns move, (p,), their least and greatest values, and sizes below which they count as zero."""

    free: Mask
    lower: Array
    upper: Array
    scale: Array


@jit
def contact_chord(rho: float, k: float) -> float:
    """The step in ρ over which its derivative is taken; 0 where that is the derivative itself.

    Close to a rigid contact the motion depends on K_z^{−1} = ρ², and a chord replaces the slope, which vanishes.
    """
    chord = _CHORD / math.sqrt(k)
    return chord if rho < 0.3 * chord else 0.0


@jit
def _add_phase(
    sums: Array,
    values: Array,
    times: tuple[float, float],
    order: int,
    level: float,
    start: tuple[float, float, float, float, float],
) -> None:
    """Add to sums (6, 6) the products of the six functions over the samples of a phase, lower triangle.

    times : of the first sample, s from the start of the phase, and interval.   level : offset of the channel.
    start : of the phase: x, ẋ, f₀, δ, Ω².
    """
    x0, v0, f0, delta, Omega2 = start
    t, step = times
    under = delta < _UNDER * math.sqrt(Omega2)
    w = math.sqrt(Omega2 - delta * delta) if under else 1.0
    decay = math.exp(-delta * t)
    cosine, sine = decay * math.cos(w * t), decay * math.sin(w * t)
    decay = math.exp(-delta * step)
    turn_c, turn_s = decay * math.cos(w * step), decay * math.sin(w * step)
    half_q, over = 0.5 / (w * w), 1.0 / Omega2
    f = np.empty(6)
    for n in range(values.size):
        if under:
            S = sine / w
            R, J = cosine - delta * S, (1.0 - cosine - delta * S) * over
            S_O = (t * cosine - S) * half_q
            S_d = -t * S - 2.0 * delta * S_O
            J_O = (0.5 * t * S - delta * S_O - J) * over
            J_d = (t * (cosine - delta * S) - S - delta * S_d) * over
            cosine, sine = cosine * turn_c - sine * turn_s, cosine * turn_s + sine * turn_c
        else:
            J, S, R, J_d, S_d, _, J_O, S_O, _ = responses(t, delta, Omega2)
        t += step
        f[4] = 1.0
        if order == 0:
            f[0], f[1], f[2], f[3] = S, J, v0 * S_d + f0 * J_d, v0 * S_O + f0 * J_O
            f[5] = x0 + v0 * S + f0 * J + level - values[n]
        else:
            R_O = -2.0 * delta * S_O - J - Omega2 * J_O
            R_d = -2.0 * (S + delta * S_d) - Omega2 * J_d
            v, v_d, v_O = v0 * R + f0 * S, v0 * R_d + f0 * S_d, v0 * R_O + f0 * S_O
            if order == 1:
                f[0], f[1], f[2], f[3] = R, S, v_d, v_O
                f[5] = v + level - values[n]
            else:
                u = v0 * S + f0 * J
                f[0], f[1] = -2.0 * delta * R - Omega2 * S, R
                f[2] = -2.0 * (v + delta * v_d) - Omega2 * (v0 * S_d + f0 * J_d)
                f[3] = -u - 2.0 * delta * v_O - Omega2 * (v0 * S_O + f0 * J_O)
                f[5] = f0 - 2.0 * delta * v - Omega2 * u + level - values[n]
        for i in range(6):
            for j in range(i + 1):
                sums[i, j] += f[i] * f[j]


@jit
def _add_channel(
    own: Array,
    values: Array,
    channel: Array,
    level: float,
    phases: Array,
    slopes: Array,
    par: Parameters,
) -> None:
    """Add to own (9, 9) the products over the samples of a channel, by the unknowns of its decay, its offset and the
    residual, lower triangle."""
    order, first, step = int(channel[ORDER]), channel[FIRST], channel[STEP]
    weight = channel[NOISE] ** -2
    sums, to = np.empty((6, 6)), np.zeros((6, _OWN + 2))
    to[4, _OWN] = to[5, _OWN + 1] = 1.0
    half = np.empty((6, _OWN + 2))
    n = 0
    for i in range(phases.shape[0]):
        begin, s, x0, v0, z0 = read_phase(phases, i)
        stop = values.size
        if i + 1 < phases.shape[0]:
            stop = min(max(math.ceil((phases[i + 1, 0] - first) / step), n), stop)
        if stop == n:
            continue
        f0, delta, Omega2 = phase_start_of(s, x0, z0, par)
        sums[:] = 0.0
        times = (first + n * step - begin, step)
        _add_phase(sums, values[n:stop], times, order, level, (x0, v0, f0, delta, Omega2))
        n = stop
        to[:4, :_OWN] = slopes[i, 1:]
        if order == 0:
            to[4, :_OWN] = slopes[i, 0]
        for a in range(6):
            for b in range(_OWN + 2):
                total = 0.0
                for j in range(6):
                    total += (sums[a, j] if j <= a else sums[j, a]) * to[j, b]
                half[a, b] = total
        for a in range(_OWN + 2):
            for b in range(a + 1):
                total = 0.0
                for j in range(6):
                    total += to[j, a] * half[j, b]
                own[a, b] += weight * total


@jit
def _phases_of(
    point: Array, k: float, offsets: int, channels: Array, i: int, rows: Array
) -> tuple[int, Parameters]:
    """Number of phases, written to rows, up to the last sample of the decay whose first channel is i, −1 where its
    contact rattles on; and the oscillator."""
    par = Parameters(point[_M], point[_C], k, point[_RHO] ** -2, point[_F_K], 0.0, 0.0)
    Z_m = par.F_k / par.K_z
    decay = channels[i, DECAY]
    state = COMMON_UNKNOWNS + offsets + STATE_UNKNOWNS * int(decay)
    until, samples = channels[i, STEP], 0
    for j in range(i, channels.shape[0]):
        if channels[j, DECAY] != decay:
            break
        size = int(channels[j, END] - channels[j, BEGIN])
        until = max(until, channels[j, FIRST] + (size - 1) * channels[j, STEP])
        samples += size
    x, v, w = point[state], point[state + 1], point[state + 2]
    z = min(max((w - 1.0) * Z_m, -Z_m), Z_m)
    count, reached, _, _, _ = run(
        x, v, z, 0.0, until, 0.0, par, rows[: _FEW_PHASES + samples // _PER_PHASE]
    )
    return (count if reached >= until else -1), par


@jit
def products(
    point: Array, k: float, offsets: int, channels: Array, values: Array, rows: Array, out: Array
) -> bool:
    """Set out (p + 1, p + 1) to the products of the derivatives of all residuals (model − sample)/σ by unknowns and
    of the residuals: JᵀJ, Jᵀr and, in the last corner, χ². False where the contact rattles on.

    offsets : number of offsets.   channels : table, decay by decay.   values : samples of all of them.
    rows : room for phases.
    """
    out[:] = 0.0
    p = point.size
    own, places = np.empty((_OWN + 2, _OWN + 2)), np.empty(_OWN + 2, dtype=np.int64)
    places[:COMMON_UNKNOWNS] = np.arange(COMMON_UNKNOWNS)
    places[_OWN + 1] = p
    slopes = np.empty((0, 5, _OWN))
    for i in range(channels.shape[0]):
        channel = channels[i]
        if i == 0 or channel[DECAY] != channels[i - 1, DECAY]:
            count, par = _phases_of(point, k, offsets, channels, i, rows)
            if count < 0:
                return False
            state = COMMON_UNKNOWNS + offsets + STATE_UNKNOWNS * int(channel[DECAY])
            slopes = phase_slopes(rows[:count], point[state + 2], par)
            places[COMMON_UNKNOWNS:_OWN] = np.arange(state, state + STATE_UNKNOWNS)
        own[:] = 0.0
        here = values[int(channel[BEGIN]) : int(channel[END])]
        offset = COMMON_UNKNOWNS + int(channel[OFFSET])
        _add_channel(own, here, channel, point[offset], rows[:count], slopes, par)
        places[_OWN] = offset
        for a in range(_OWN + 2):
            for b in range(a + 1):
                out[max(places[a], places[b]), min(places[a], places[b])] += own[a, b]
    chord = contact_chord(point[_RHO], k)
    if chord > 0.0:
        stretch = 1.0 + 0.5 * chord / point[_RHO]
        out[_RHO, :_RHO] *= stretch
        out[_RHO:, _RHO] *= stretch
        out[_RHO, _RHO] *= stretch
    for a in range(p + 1):
        for b in range(a):
            out[b, a] = out[a, b]
    return math.isfinite(out.sum())


@jit
def decay_residuals(point: Array, k: float, offsets: int, channels: Array, values: Array) -> Array:
    """Residuals (model − sample)/σ at a point, in the order of the samples, NaN where the contact rattles on."""
    out = np.full(values.size, np.nan)
    rows = np.empty((min(MOST_PHASES, _FEW_PHASES + values.size), 5))
    for i in range(channels.shape[0]):
        channel = channels[i]
        if i == 0 or channel[DECAY] != channels[i - 1, DECAY]:
            count, par = _phases_of(point, k, offsets, channels, i, rows)
        if count < 0:
            continue
        order, begin = int(channel[ORDER]), int(channel[BEGIN])
        size = int(channel[END]) - begin
        times = channel[FIRST] + channel[STEP] * np.arange(size)
        model = states_in_phases(times, rows[:count], 0.0, par)[order]
        level = point[COMMON_UNKNOWNS + int(channel[OFFSET])]
        out[begin : begin + size] = (model + level - values[begin : begin + size]) / channel[NOISE]
    return out


@jit
def _damped(information: Array, active: Mask, damping: float) -> Array:
    """The step (p,) of the damped equations in the unknowns that are not active, by Cholesky's factorisation of the
    information scaled to unit diagonal; `information` is that of `products`."""
    p = information.shape[0] - 1
    step, chosen = np.zeros(p), np.empty(p, dtype=np.int64)
    n = 0
    for j in range(p):
        if not active[j] and information[j, j] > 0.0:
            chosen[n] = j
            n += 1
    length = np.empty(n)
    for i in range(n):
        length[i] = math.sqrt(information[chosen[i], chosen[i]])
    ridge = max(damping, _RIDGE)
    root, solution = np.zeros((n, n)), np.empty(n)
    for i in range(n):
        for j in range(i + 1):
            entry = information[chosen[i], chosen[j]] / length[i] / length[j]
            if i == j:
                entry += ridge
            for l in range(j):
                entry -= root[i, l] * root[j, l]
            if i == j:
                root[i, i] = math.sqrt(max(entry, _RIDGE))
            else:
                root[i, j] = entry / root[j, j]
    for i in range(n):
        entry = -information[chosen[i], p] / length[i]
        for l in range(i):
            entry -= root[i, l] * solution[l]
        solution[i] = entry / root[i, i]
    for i in range(n - 1, -1, -1):
        entry = solution[i]
        for l in range(i + 1, n):
            entry -= root[l, i] * solution[l]
        solution[i] = entry / root[i, i]
    for i in range(n):
        step[chosen[i]] = solution[i] / length[i]
    return step


@jit
def climb_decays(
    start: Array,
    k: float,
    offsets: int,
    channels: Array,
    values: Array,
    bounds: Bounds,
    gain: float,
    most: int,
) -> tuple[Array, Array, int]:
    """The point that a climb from `start` reaches, (p,), the `products` there, and the number of evaluations, 0 where
    the model has no motion at the start.

    The rules are those of `reading/climb.py`: λ falls after a step that helps and rises after one that does not; the
    climb ends when a full step would gain less than `gain` in χ²/2, would move no unknown by more than 10⁻¹¹ of itself,
    where no step helps, and after `most` evaluations.
    """
    p = start.size
    longest = 0
    for i in range(channels.shape[0]):
        longest += int(channels[i, END] - channels[i, BEGIN])
    rows = np.empty((min(MOST_PHASES, _FEW_PHASES + longest), 5))
    lower, upper = bounds.lower, bounds.upper
    point = start.copy()
    for j in range(p):
        if bounds.free[j]:
            point[j] = min(max(start[j], lower[j]), upper[j])
    here, there = np.empty((p + 1, p + 1)), np.empty((p + 1, p + 1))
    if not products(point, k, offsets, channels, values, rows, here):
        return point, here, 0
    active, trial = np.empty(p, dtype=np.bool_), np.empty(p)
    damping, count = 1e-3, 1
    while count < most:
        for j in range(p):
            falls, rises = here[j, p] >= 0.0, here[j, p] <= 0.0
            held = (point[j] <= lower[j] and falls) or (point[j] >= upper[j] and rises)
            active[j] = held or not bounds.free[j]
        full = _damped(here, active, 0.0)
        size = promise = 0.0
        for j in range(p):
            size = max(size, abs(full[j]) / max(abs(point[j]), bounds.scale[j]))
            promise -= full[j] * here[j, p]
        if not promise >= 2.0 * gain or size < _RELATIVE:
            break
        step = _damped(here, active, damping)
        for j in range(p):
            least = lower[j] if lower[j] <= 0.0 else max(lower[j], _SHRINK * point[j])
            trial[j] = min(max(point[j] + step[j], least), upper[j]) if bounds.free[j] else point[j]
        count += 1
        if products(trial, k, offsets, channels, values, rows, there) and there[p, p] < here[p, p]:
            point, trial = trial, point
            here, there = there, here
            damping = max(0.1 * damping, 1e-12)
        elif size < _STALLED:
            break
        else:
            damping = max(10.0 * damping, 1e-6)
        if damping > _STEEPEST:
            break
    return point, here, count


@jit
def climb_from_all(
    starts: Array,
    k: float,
    offsets: int,
    channels: Array,
    values: Array,
    bounds: Bounds,
    gain: float,
    most: int,
    following: bool,
) -> Array:
    """Where climbs from many starts (n, p) end, and χ² there, (n, p + 1); infinite χ² where the model has no motion.

    following : whether each climb starts from the end of the one before, with its own values of the unknowns that are
    not free.
    """
    n, p = starts.shape
    ends = np.empty((n, p + 1))
    for i in range(n):
        start = starts[i].copy()
        if following and i > 0 and math.isfinite(ends[i - 1, p]):
            for j in range(p):
                if bounds.free[j]:
                    start[j] = ends[i - 1, j]
        point, reached, count = climb_decays(
            start, k, offsets, channels, values, bounds, gain, most
        )
        ends[i, :p] = point
        ends[i, p] = reached[p, p] if count > 0 else math.inf
    return ends
