"""From free decays to rows of the energy balance, one for each half cycle between turns, with their covariance.

Between two turns a and b of a free motion that slips the energy of spring and contact goes into friction and damper,

    ½k (x_a² − x_b²) = F_k (|x_a − x_b| − 2Z_m) + c ∫ ẋ² dt + k x_0 (x_a − x_b)

where x_0, by which the channel's zero is off the rest position of the spring, is one unknown of a record. The first row
begins at the start state, with ½mẋ² and with Z_m (1 ∓ z/Z_m)²/2 in the place of 2Z_m.

The turns are read off all samples: between two turns the motion is that of the fit, stretched to x_a and x_b, and these
are found by least squares. The shape of the motion between its turns (how it fades, how long it sticks, how a mass that
sticks for good rings on the contact) tells F_k and c, too: what it tells is found beside the turns, and makes two more
rows of a stretch, F_k times the way it moves and c ∫ ẋ² dt. Neighbouring rows share a turn, and all share what the fit
tells of m, K_z and the instants of the turns; the covariance holds both.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Integers, Mask
from ..model import Parameters
from ..motion.events import PHASE_S, PHASE_T, PHASE_V, PHASE_X, PHASE_Z
from ..motion.states import states_in_phases
from .ringdown_fit import COMMON, STATE, RingFit, Stretch, numbers_of, phases_of, stuck_from

W, A, B, D = range(4)
"""Columns of a row: W (J), a (m), b (m²/s), and x_a − x_b (m), the factor of k x_0."""

_SHAPED = ("F_k", "c")
"""What the shape of the motion between its turns tells, too."""

_STEP = 1e-6
_PART = 1e-3  # of a standard error, for differences of what is read
_SEEN = 0.5  # of a last half cycle that the record must hold
_SLIDES = 0.1  # of a half cycle's travel that must be in slip
_RINGS = 1.0  # cycles of ringing that are read
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)
_PANEL = 4.0  # rad: the rule is then exact to rounding


class Half(NamedTuple):
    """A half cycle of the fit's motion: from the turn at time t_a, s after the start, to that at t_b.

    x_a, x_b : m.   v_a : m/s, zero but at a start.   lost : of |x_b − x_a| for the friction travel, m.
    viscous : ∫ ẋ² dt, m²/s.
    """

    t_a: float
    t_b: float
    x_a: float
    x_b: float
    v_a: float
    lost: float
    viscous: float


class Ringing(NamedTuple):
    """The mass at rest, ringing: from its last turn at t_a, with amplitude q about `rest`, m.

    share : of the contact in the stiffness, K_z/(k + K_z).
    """

    t_a: float
    q: float
    rest: float
    share: float


@dataclass(frozen=True, eq=False)
class Course:
    """The motion of the fit in one stretch as rows see it.

    halves : that slip.   ringing : of the mass at rest; None where it cannot be seen.   phases : of the motion.
    viscous : ∫ ẋ² dt to the end, m²/s.
    """

    halves: tuple[Half, ...]
    ringing: Ringing | None
    phases: Array
    viscous: float


@dataclass(frozen=True, eq=False)
class RingRows:
    """Rows of all stretches.

    columns : (n, 4), see W, A, B, D, as read.   smooth : the same of the fit's motion.   covariance : of
    W − a F_k − b c with the F_k and c of the fit, J², (n, n).
    stretch : number of the stretch that each is of, (n,).   shape : which rows are of the shape.
    turns : of each stretch, its turns read off the record, rows (t, x), s and m, and their standard errors, m.
    """

    columns: Array
    smooth: Array
    covariance: Array
    stretch: Integers
    shape: Mask
    turns: tuple[tuple[Array, Array], ...]


def rows_of(fit: RingFit) -> RingRows:
    """The rows of all stretches of a fit."""
    p = fit.point.size
    parts, smooth, slopes, direct, crossed, which, shape, turns = [], [], [], [], [], [], [], []
    at = 0
    for i, one in enumerate(fit.stretches):
        own = slice(p - STATE * (len(fit.stretches) - i), p - STATE * (len(fit.stretches) - i - 1))
        here = slice(at, at + one.samples)
        at += one.samples
        read = _read(fit.point, own, fit.k, one)
        if read is None:
            turns.append((np.empty((0, 2)), np.empty(0)))
            continue
        course, theta, pulls, rows = read
        n = len(rows)
        by_theta = np.empty((n, theta.size))
        for j in range(theta.size):
            turns_span = float(np.ptp(theta[:-2]))
            scale = turns_span if j < theta.size - 2 else fit.F_k if j < theta.size - 1 else fit.c
            step = _STEP * max(scale, 1e-300)
            moved = theta.copy()
            moved[j] += step
            by_theta[:, j] = _misfit(fit, _columns(fit.point, fit.k, course, moved) - rows) / step
        by_point = np.zeros((n, p))
        for j in _unknowns(fit, i):
            moved, step = _beside(fit, j)
            again = _read(moved, own, fit.k, one)
            if again is not None and len(again[3]) == n:
                by_point[:, j] = _misfit(fit, again[3] - rows) / step
        parts.append(rows)
        smooth.append(_columns(fit.point, fit.k, course, _fitted(course, fit.point)))
        slopes.append(by_point)
        direct.append(by_theta @ pulls)
        crossed.append(direct[-1] @ fit.response[:, here].T)
        which += [i] * n
        shape += [False] * len(course.halves) + [True] * len(_SHAPED)
        times = (
            [course.halves[0].t_a, *(half.t_b for half in course.halves)] if course.halves else []
        )
        sure = np.sqrt(
            np.sum(
                (pulls + _turns_by_point(fit, i, own, one, theta) @ fit.response[:, here]) ** 2,
                axis=1,
            )
        )
        count = len(times)
        turns.append((np.column_stack([one.start + np.array(times), theta[:count]]), sure[:count]))
    if not parts:
        empty = np.empty((0, 4))
        return RingRows(
            empty, empty, np.empty((0, 0)), np.empty(0, int), np.empty(0, bool), tuple(turns)
        )
    slope, cross = np.vstack(slopes), np.vstack(crossed)
    covariance = slope @ fit.covariance @ slope.T + cross @ slope.T + slope @ cross.T
    place = 0
    for some in direct:
        block = slice(place, place + len(some))
        covariance[block, block] += some @ some.T
        place += len(some)
    return RingRows(
        np.vstack(parts),
        np.vstack(smooth),
        covariance,
        np.array(which),
        np.array(shape),
        tuple(turns),
    )


def _unknowns(fit: RingFit, i: int) -> list[int]:
    """Numbers of the unknowns of a fit that stretch i depends on."""
    first = fit.point.size - STATE * (len(fit.stretches) - i)
    offsets = [len(COMMON) + number for number in fit.stretches[i].offsets]
    return [*range(len(COMMON)), *offsets, *range(first, first + STATE)]


def _misfit(fit: RingFit, change: Array) -> Array:
    """Change of W − a F_k − b c, J, with the change of the columns."""
    changed: Array = change[:, W] - change[:, A] * fit.F_k - change[:, B] * fit.c
    return changed


def _beside(fit: RingFit, j: int) -> tuple[Array, float]:
    """A point with unknown j moved, and by how much."""
    point = fit.point.copy()
    error = math.sqrt(fit.covariance[j, j])
    step = _PART * error if error > 0.0 else _STEP * max(abs(point[j]), 1e-300)
    if j >= point.size - STATE * len(fit.stretches) and (point.size - j) % STATE == 1:
        step = -_PART if point[j] > 1.0 else _PART  # w, within its limits
    point[j] += step
    return point, step


def _turns_by_point(fit: RingFit, i: int, own: slice, one: Stretch, theta: Array) -> Array:
    """Derivatives of what `_read` finds by the unknowns of the fit, (theta, p)."""
    slope = np.zeros((theta.size, fit.point.size))
    for j in _unknowns(fit, i):
        moved, step = _beside(fit, j)
        again = _read(moved, own, fit.k, one)
        if again is not None and again[1].size == theta.size:
            slope[:, j] = (again[1] - theta) / step
    return slope


def _read(
    point: Array, own: slice, k: float, one: Stretch
) -> tuple[Course, Array, Array, Array] | None:
    """(course, θ, its derivatives by the samples in units of their noise, rows) of a stretch; None without a row.

    θ : x at the start and the turns, m, and the F_k and c of the shape, N and N s/m.
    """
    course = _course(point, point[own], k, one)
    if course is None:
        return None
    basis, rest = _basis(point, own, k, one, course)
    # without a displacement nothing tells the level, which then stays that of the fit
    length = np.linalg.norm(basis, axis=0)
    length[length == 0.0] = 1.0
    pulls = np.linalg.pinv(basis / length, rcond=1e-9) / length[:, None]
    theta = _fitted(course, point) + pulls @ rest
    return course, theta, pulls, _columns(point, k, course, theta)


def _fitted(course: Course, point: Array) -> Array:
    """θ of the fit itself."""
    return np.append(_turns(course), [point[COMMON.index(symbol)] for symbol in _SHAPED])


def _turns(course: Course) -> Array:
    """x at the start and the turns, m."""
    if course.halves:
        return np.array([course.halves[0].x_a, *(half.x_b for half in course.halves)])
    assert course.ringing is not None
    return np.array([course.ringing.rest + course.ringing.q])


def _course(point: Array, state: Array, k: float, one: Stretch) -> Course | None:
    """The half cycles and the ringing of a motion; None where there is neither."""
    par = numbers_of(point, k)
    Z_m, span = par.F_k / par.K_z, one.end - one.start
    phases = phases_of(point, state, k, span + one.period)
    turns = [i for i in range(1, len(phases)) if phases[i, PHASE_V] == 0.0]
    total = _viscous(phases[phases[:, PHASE_T] < span], span, par)
    halves: list[Half] = []
    begin = 0
    for i in turns:
        t_a, t_b = float(phases[begin, PHASE_T]), float(phases[i, PHASE_T])
        if t_b > span and span - t_a < _SEEN * (t_b - t_a):
            break
        x_a, x_b = float(phases[begin, PHASE_X]), float(phases[i, PHASE_X])
        u = (state[2] - 1.0) if begin == 0 else math.copysign(1.0, phases[begin, PHASE_Z])
        if begin == 0:
            u = min(max(u, -1.0), 1.0)
        towards = math.copysign(1.0, phases[i, PHASE_Z])
        viscous = _viscous(phases[begin:i], t_b, par)
        lost = 0.5 * Z_m * (1.0 - towards * u) ** 2
        if abs(x_b - x_a) - lost < _SLIDES * abs(x_b - x_a):
            return Course(tuple(halves), None, phases, total) if halves else None
        halves.append(Half(t_a, t_b, x_a, x_b, float(phases[begin, PHASE_V]), lost, viscous))
        begin = i
    ringing = _ringing(phases[begin:], span, par) if begin == len(phases) - 1 else None
    if not halves and ringing is None:
        return None
    return Course(tuple(halves), ringing, phases, total)


def _ringing(phases: Array, end: float, par: Parameters) -> Ringing | None:
    """The ringing from the last phase of a motion on, if it is one."""
    t_a, s, x, v, z = phases[0]
    Omega = math.sqrt((par.k + par.K_z) / par.m)
    if s != 0.0 or v != 0.0 or (end - t_a) * Omega < 2.0 * math.pi * _RINGS:
        return None
    q = (par.k * x + par.K_z * z) / (par.k + par.K_z)
    return Ringing(t_a, q, x - q, par.K_z / (par.k + par.K_z))


def _viscous(phases: Array, end: float, par: Parameters) -> float:
    """∫ ẋ² dt over phases, up to `end`."""
    total = 0.0
    for i in range(len(phases)):
        start = float(phases[i, PHASE_T])
        stop = float(phases[i + 1, PHASE_T]) if i + 1 < len(phases) else end
        if stop <= start:
            continue
        stiff = par.k + (par.K_z if phases[i, PHASE_S] == 0.0 else 0.0)
        times, weights = _quadrature(start, stop, math.sqrt(stiff / par.m))
        # a time on the border may belong to the next phase: taken from this one alone
        speed = states_in_phases(times, phases[i : i + 1], 0.0, par)[1]
        total += float(weights @ speed**2)
    return total


def _quadrature(start: float, stop: float, omega: float) -> tuple[Array, Array]:
    """Times and weights of Gauss's rule, in panels of a part of a cycle."""
    panels = 1 + int((stop - start) * omega / _PANEL)
    h = (stop - start) / panels
    middles = start + h * (np.arange(panels) + 0.5)
    times = (middles[:, None] + 0.5 * h * _NODES).ravel()
    return times, np.tile(0.5 * h * _WEIGHTS, panels)


def _basis(point: Array, own: slice, k: float, one: Stretch, course: Course) -> tuple[Array, Array]:
    """Derivatives of the samples by θ, and what the fit leaves of them, in units of their noise."""
    par = numbers_of(point, k)
    size = _turns(course).size
    blocks, rests = [], []
    beside = []
    for symbol, step in zip(
        _SHAPED, (par.F_k, max(par.c, 2e-2 * math.sqrt(k * par.m))), strict=True
    ):
        moved = point.copy()
        moved[COMMON.index(symbol)] += _STEP * step
        beside.append((numbers_of(moved, k), _STEP * step, _course(moved, moved[own], k, one)))
    for signal, number in zip(one.signals, one.offsets, strict=True):
        times = signal.t - one.start
        motion = states_in_phases(times, course.phases, 0.0, par)[:3]
        block = np.zeros((times.size, size))
        seen = np.zeros(times.size, dtype=np.bool_)
        for j, half in enumerate(course.halves):
            inside = slice(*np.searchsorted(times, [half.t_a, half.t_b]))
            travel = half.x_b - half.x_a
            along = motion[signal.order, inside] / travel
            if signal.order == 0:
                along = along - half.x_a / travel
            block[inside, j + 1] = along
            block[inside, j] = (1.0 if signal.order == 0 else 0.0) - along
            seen[inside] = True
        if course.ringing is not None:
            ring = course.ringing
            inside = slice(int(np.searchsorted(times, ring.t_a)), times.size)
            x = (motion[0, inside] - ring.rest, motion[1, inside], motion[2, inside])
            last = len(course.halves)
            block[inside, last] = (1.0 - ring.share) * x[signal.order] / ring.q
            if signal.order == 0:
                block[inside, last] += ring.share
            seen[inside] = True
        shapes = []
        for other_par, step, other in beside:
            shapes.append(np.zeros(times.size))
            if other is not None and len(other.halves) == len(course.halves):
                moved_motion = states_in_phases(times, other.phases, 0.0, other_par)
                shapes[-1] = (moved_motion[signal.order] - motion[signal.order]) / step
                shapes[-1] -= block @ ((_turns(other) - _turns(course)) / step)
        block = np.column_stack([block, *shapes])
        left = signal.values - motion[signal.order] - point[len(COMMON) + number]
        blocks.append(np.where(seen[:, None], block, 0.0) / signal.noise)
        rests.append(np.where(seen, left, 0.0) / signal.noise)
    return np.vstack(blocks), np.concatenate(rests)


def _columns(point: Array, k: float, course: Course, theta: Array) -> Array:
    """The rows (W, a, b, x_a − x_b) with these turns and these coefficients of the shape, (n, 4)."""
    rows = []
    for j, half in enumerate(course.halves):
        x_a, x_b = float(theta[j]), float(theta[j + 1])
        stretched = ((x_b - x_a) / (half.x_b - half.x_a)) ** 2
        m = point[COMMON.index("m")]
        work = 0.5 * k * (x_a - x_b) * (x_a + x_b) + 0.5 * m * half.v_a**2 * stretched
        rows.append((work, abs(x_a - x_b) - half.lost, half.viscous * stretched, x_a - x_b))
    travel = max(float(np.ptp(_turns(course))), math.ulp(1.0))
    rows.append((float(theta[-2]) * travel, travel, 0.0, 0.0))
    rows.append((float(theta[-1]) * course.viscous, 0.0, course.viscous, 0.0))
    return np.array(rows)


def at_rest(fit: RingFit, i: int) -> float | None:
    """The time from which on the mass of a stretch sticks, s after its start; None where the record ends before."""
    span = fit.stretches[i].end - fit.stretches[i].start
    still = stuck_from(fit.phases(i), span)
    return still if still < span else None
