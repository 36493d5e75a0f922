"""From free decays to rows of the energy balance, one for each half cycle between turns, with their covariance.

Between two turns a and b of a free motion that slips the energy of the spring goes into friction and damper,

    ½k (x_a² − x_b²) = F_k (|x_a − x_b| − 2Z_m) + c ∫ ẋ² dt

with x counted from the rest position of the spring. The first row begins at the start state, with ½mẋ² and with
Z_m (1 ∓ z/Z_m)²/2 in the place of 2Z_m.

The turns are estimated from all samples: between two turns the motion is that of the fit, stretched to x_a and x_b.
Least squares gives these together with corrections of the fit from the shape and the instants of the motion: of m, K_z,
the start, F_k and c (how the motion decays and sticks between its turns, how a mass that stays stuck rings on the
contact). The information of the shape on F_k and c makes two more rows, F_k times the way and c ∫ ẋ² dt. Neighbouring
rows share a turn, and all share m, K_z and the rest position, on which the rows hold nearly all the information; the
covariance of the estimates gives that of the rows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Integers, Mask
from ..fit.decay import (
    STATE,
    Decay,
    RingFit,
    contact_chord,
    linear_solution,
    numbers_of,
    phases_of,
)
from ..model import Parameters
from ..motion.events import PHASE_S, PHASE_T, PHASE_V, PHASE_X
from ..motion.states import states_in_phases
from ..motion.unknowns import OSCILLATOR_UNKNOWNS

W, A, B = range(3)
"""Columns of a row: W (J), a (m), b (m²/s)."""

_STEP = 1e-6  # relative step of finite differences: motions are exact to 1e-12
_PART = 1e-3  # of a standard error, for differences of what is read
_WEAK = 10.0  # times its error in the fit: what is known of a level before
_SEEN = 0.5  # of a last half cycle that the record must hold
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


@dataclass(frozen=True, eq=False)
class Course:
    """The motion of the fit in one decay as rows see it.

    halves : that slip.   rings_from : time from which on the mass at rest rings, s after the start; infinite where that
    cannot be seen.   phases : of the motion.   viscous : ∫ ẋ² dt to the end, m²/s.
    """

    halves: tuple[Half, ...]
    rings_from: float
    phases: Array
    viscous: float

    @property
    def turns(self) -> Array:
        """x at the start and the turns, m; of a mass that only rings, its start."""
        ends = [half.x_b for half in self.halves]
        return np.array([float(self.phases[0, PHASE_X]), *ends])


@dataclass(frozen=True, eq=False)
class RingRows:
    """Rows of all decays.

    columns : (n, 3), see W, A, B, as read.   covariance : of W − a F_k − b c with the F_k and c of the fit, J²,
    (n, n).   decay : number of the decay of each row, (n,), −1 for those of the shape, the last ones.   friction :
    number of the friction force of each row, (n,), −1 for the row that has none.
    turns : of each decay, its start and turns as read, rows (t, x), s and m, and their standard errors, m.
    """

    columns: Array
    covariance: Array
    decay: Integers
    friction: Integers
    turns: tuple[tuple[Array, Array], ...]

    @property
    def halves(self) -> int:
        """Number of rows of half cycles."""
        return int(np.count_nonzero(self.decay >= 0))


def rows_of(fit: RingFit) -> RingRows:
    """The rows of all decays of a fit."""
    p, fit = fit.point.size, replace(fit, problem=replace(fit.problem, band=None))
    points = [fit.point_of(i) for i in range(len(fit.decays))]
    courses = [
        _course(point, point[fit.places(i)], fit.k, one)
        for i, (one, point) in enumerate(zip(fit.decays, points, strict=True))
    ]
    nodes = [course.turns for course in courses]
    ends = np.cumsum([node.size for node in nodes]).tolist()
    places = [slice(end - node.size, end) for end, node in zip(ends, nodes, strict=True)]
    total = ends[-1]
    # estimates: the turns of all decays, then the unknowns of the fit
    design, rest = np.zeros((fit.samples, total + p)), -fit.residual
    errors = np.concatenate([np.full(total, math.inf), fit.problem.prior_errors])
    rows = []
    at = 0
    for i, (one, course, own) in enumerate(zip(fit.decays, courses, points, strict=True)):
        here = slice(at, at + one.samples)
        at = here.stop
        block, seen = _basis(own, fit.k, one, course)
        start, begin = fit.places(i).start, places[i].start
        by_unknowns = np.where(seen[:, None], fit.jacobian[here], 0.0)
        design[here, total:] = by_unknowns
        design[here, places[i]] = block
        # the start is the first of the turns, and moves the shape as well
        design[here, begin] += by_unknowns[:, start]
        design[here, total + start] = 0.0
        rest[here] = np.where(seen, rest[here], 0.0)
        columns = _columns(own, fit.k, course, nodes[i])
        slope = np.zeros((*columns.shape, total + p))
        span = _STEP * max(float(np.ptp(nodes[i])), 1e-300)
        for j in range(nodes[i].size if course.halves else 0):
            turns = nodes[i].copy()
            turns[j] += span
            slope[..., begin + j] = (_columns(own, fit.k, course, turns) - columns) / span
        for j in (*range(len(OSCILLATOR_UNKNOWNS)), *range(start, start + STATE)):
            place = j or fit.friction_places[i]
            seen_there = fit.jacobian[:, place].any()
            nearby = _nearby(fit, i, j, len(course.halves)) if seen_there else None
            if nearby is None:
                continue
            point, other, step = nearby
            column = begin if j == start else total + place
            design[here, column] -= block @ ((other.turns - nodes[i]) / step)
            slope[..., column] += (_columns(point, fit.k, other, nodes[i]) - columns) / step
        rows.append((columns, slope))
        # only the rows may determine the level of the turns: no prior must fix it
        level = fit.covariance[start, start]
        errors[begin] = _WEAK * math.sqrt(level) if level > 0.0 else math.inf
    shifts, covariance = linear_solution(design, rest, errors)

    # to first order about the fit: a poorly determined level would distort the squares in W
    columns_of = [columns + slope @ shifts for columns, slope in rows]
    slopes = [
        s[:, W] - s[:, A] * own[0] - s[:, B] * fit.c
        for (_, s), own in zip(rows, points, strict=True)
    ]
    which = [i for i, columns in enumerate(columns_of) for _ in columns]
    force_of = [one.friction for one in fit.decays]
    forces = [force_of[i] for i in which]
    # the shape: each friction force times the way, and c ∫ ẋ² dt
    travel: dict[int, list[float]] = {}
    for force, course in zip(force_of, courses, strict=True):
        travel.setdefault(force, []).extend(abs(half.x_b - half.x_a) for half in course.halves)
    shape = [
        (A, force, fit.friction_places[force_of.index(force)], math.fsum(ways))
        for force, ways in travel.items()
    ]
    shape.append((B, -1, 1, math.fsum(course.viscous for course in courses)))
    for column, force, j, size in shape:
        if covariance[total + j, total + j] > 0.0 and size > 0.0:
            row, slope = np.zeros((1, 3)), np.zeros((1, shifts.size))
            row[0, column], row[0, W] = size, size * (fit.point[j] + shifts[total + j])
            slope[0, total + j] = size
            columns_of.append(row)
            slopes.append(slope)
            which.append(-1)
            forces.append(force)
    all_turns = []
    for one, course, node, place in zip(fit.decays, courses, nodes, places, strict=True):
        times = one.start + np.array([0.0, *(half.t_b for half in course.halves)])
        theta, sure = node + shifts[place], np.sqrt(np.diag(covariance)[place])
        all_turns.append((np.column_stack([times, theta[: times.size]]), sure[: times.size]))
    by_all = np.vstack(slopes)
    covariance = by_all @ covariance @ by_all.T
    numbers = np.array(which), np.array(forces)
    return RingRows(np.vstack(columns_of), covariance, *numbers, tuple(all_turns))


def _nearby(fit: RingFit, i: int, j: int, halves: int) -> tuple[Array, Course, float] | None:
    """The point with unknown j moved, the motion of decay i there, as many half cycles of it, and by how much it is
    moved; None where there are fewer either way."""
    own, place = fit.places(i), j or fit.friction_places[i]
    step = _PART * math.sqrt(fit.covariance[place, place])
    if j == own.start + 2:
        step = _PART
    elif j == OSCILLATOR_UNKNOWNS.index("rho"):
        # close to a rigid contact the motion depends on ρ²: a chord replaces the slope
        step = contact_chord(float(fit.point[j]), fit.k) or _STEP * float(fit.point[j])
    for way in (-step, step) if j == own.start + 2 and fit.point[j] > 1.0 else (step, -step):
        point = fit.point_of(i)
        point[j] += way
        if (j < len(OSCILLATOR_UNKNOWNS) and point[j] <= 0.0) or step == 0.0:
            continue
        course = _course(point, point[own], fit.k, fit.decays[i], halves)
        if len(course.halves) == halves:
            return point, course, way
    return None


def _course(point: Array, state: Array, k: float, one: Decay, most: int | None = None) -> Course:
    """The half cycles, `most` of them at the most, and the ringing of a motion."""
    par = numbers_of(point, k)
    Z_m, span = par.F_k / par.K_z, one.end - one.start
    phases = phases_of(point, state, k, span + one.period)
    viscous = _viscous(phases, span + one.period, par)
    halves: list[Half] = []
    begin = 0
    for i in [i for i in range(1, len(phases)) if phases[i, PHASE_V] == 0.0][:most]:
        t_a, _, x_a, v_a, z_a = phases[begin].tolist()
        t_b, _, x_b, _, z_b = phases[i].tolist()
        if t_b > span and span - t_a < _SEEN * (t_b - t_a):
            break
        u = min(max(state[2] - 1.0, -1.0), 1.0) if begin == 0 else math.copysign(1.0, z_a)
        lost = 0.5 * Z_m * (1.0 - math.copysign(1.0, z_b) * u) ** 2
        halves.append(Half(t_a, t_b, x_a, x_b, v_a, lost, float(viscous[begin:i].sum())))
        begin = i
    t_a, s, _, v, _ = phases[begin].tolist()
    Omega = math.sqrt((k + par.K_z) / par.m)
    rings = begin == len(phases) - 1 and s == v == 0.0
    seen = rings and (span - t_a) * Omega >= 2.0 * math.pi * _RINGS
    before = phases[phases[:, PHASE_T] < span]
    total = float(_viscous(before, span, par).sum())
    return Course(tuple(halves), t_a if seen else math.inf, phases, total)


def _viscous(phases: Array, end: float, par: Parameters) -> Array:
    """∫ ẋ² dt of each phase, the last of which ends at `end`, by Gauss's rule in panels of a part of a cycle."""
    of_phases = np.zeros(len(phases))
    for i, stop in enumerate([*phases[1:, PHASE_T].tolist(), end]):
        start = float(phases[i, PHASE_T])
        stiff = par.k + (par.K_z if phases[i, PHASE_S] == 0.0 else 0.0)
        panels = 1 + int((stop - start) * math.sqrt(stiff / par.m) / _PANEL)
        h = (stop - start) / panels
        times = start + h * ((np.arange(panels) + 0.5)[:, None] + 0.5 * _NODES).ravel()
        # a time on the border may belong to the next phase: taken from this one alone
        speed = states_in_phases(times, phases[i : i + 1], 0.0, par)[1]
        of_phases[i] = np.tile(0.5 * h * _WEIGHTS, panels) @ speed**2
    return of_phases


def _basis(point: Array, k: float, one: Decay, course: Course) -> tuple[Array, Mask]:
    """Derivatives of the samples by the turns, in units of their noise, and which samples lie in what rows are of."""
    par = numbers_of(point, k)
    blocks, masks = [], []
    for signal in one.signals:
        times, still = signal.t - one.start, float(signal.order == 0)
        motion = states_in_phases(times, course.phases, 0.0, par)
        block = np.zeros((times.size, course.turns.size))
        seen = times >= course.rings_from
        for j, half in enumerate(course.halves):
            inside = slice(*np.searchsorted(times, [half.t_a, half.t_b]))
            along = (motion[signal.order, inside] - still * half.x_a) / (half.x_b - half.x_a)
            block[inside, j + 1] = along
            block[inside, j] = still - along
            seen[inside] = True
        if math.isfinite(course.rings_from):
            ringing = times >= course.rings_from
            _, _, x, _, z = course.phases[-1].tolist()
            q, share = (k * x + par.K_z * z) / (k + par.K_z), par.K_z / (k + par.K_z)
            wave = motion[signal.order, ringing] - still * (x - q)
            block[ringing, -1] = (1.0 - share) * wave / q + still * share
        blocks.append(block / signal.noise)
        masks.append(seen)
    return np.vstack(blocks), np.concatenate(masks)


def _columns(point: Array, k: float, course: Course, turns: Array) -> Array:
    """The rows (W, a, b) with these turns, (n, 3)."""
    m, rows = point[OSCILLATOR_UNKNOWNS.index("m")], []
    for half, x_a, x_b in zip(course.halves, turns[:-1], turns[1:], strict=True):
        stretched = ((x_b - x_a) / (half.x_b - half.x_a)) ** 2
        work = 0.5 * k * (x_a - x_b) * (x_a + x_b) + 0.5 * m * half.v_a**2 * stretched
        rows.append((work, abs(x_a - x_b) - half.lost, half.viscous * stretched))
    return np.array(rows).reshape(-1, 3)
