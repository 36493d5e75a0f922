"""Fit of a contact to measured loops: a problem with residuals and slopes, and a jackknife over blocks of cycles.

    f = Σ κ_j z_j + k x + c ẋ + c_2 ẋ|ẋ| + m ẍ + drift t + offsets,      ż_j = ẋ while |z_j| < r_j, else z_j = ±r_j

One slider, that of the paper, has κ = K_z and r = Z_m = F_k/K_z; a gradual contact has many, whose forces are linear
and not negative. One slider may be extended by a gap in series, a friction force that falls with the speed, a rounded
knee, Dahl's, or a force of the speed alone (`law/contact.py`), by a quadratic damper and by a mass. A contact that
slips at other forces one way and the other is one slider with another offset.

Each record has a drift, and each cycle a separate offset. The search starts at the best of a grid of the r, g,
n, rise and w in which the force is not linear, by the least squares of all others. Contacts are weighed by how they
predict blocks of cycles that are left out. Stick-slip noise and ripple are no white noise: errors come
from the scatter between blocks.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache, partial

import numpy as np

from ..arrays import Array, Mask
from ..law.contact import Sliders
from ..signals.loops import Loop
from ..signals.one_thread import one_thread
from .climb import GAIN
from .errors import jackknifed
from .fit import Fit
from .loop_design import (
    FEW,
    ZERO,
    Design,
    deflections_of,
    force_of,
    lost,
    motions_of,
    slope_of,
    without_each_block,
)
from .multistart import Trail, climb_on
from .parameters import Parameter, Parameters
from .select import PRIORS, Candidate, Selection, select

_CERTAIN = 4.0  # standard errors of F_k that is there
# of the samples of a cycle: fewer do not show the force at which the contact slips
_SLIPPING = 0.02
_STEP = 1e-4  # of a parameter of the shape, of a difference quotient
_KNEE, _ROUNDED = 0.98, 0.8  # of F_k: a rounded knee, or speed, counts as slip from here on
SLIDERS = 40  # of a gradual contact, in geometric steps: finer ones cannot be distinguished
WITHIN = 0.01, 0.7  # r/X of them: sliders that slip later hardly differ from a spring
_INDEPENDENT = 10  # values in what is left beyond the noise of a cycle of a record
DIFFER = 0.002
"""Part of F_k between records that matters."""
_REFITS = 3  # of records whose friction differs: each leaves the square of the difference before
_EXACT = 1e-7  # of the force: what rounding leaves of a residual
_ROUNDS, _STAYS = 4, 0.01  # of climbs, each to within what is left, until one gains less of it
_LEAST = 0.02  # F_k over F, of a friction that falls to nothing

EXTENSIONS: dict[str, dict[str, tuple[float, ...]]] = {
    "gap": {"g": (0.03, 0.1, 0.2, 0.3)},
    "fall": {"rise": (-2.0, -1.0), "w": (2.0, 11.0, 100.0)},
    "knee": {"n": (1.0, 3.0)},
    "dahl": {},
    "rounded": {"v_0": (0.01, 0.1, 0.3, 1.0)},
    "c_2": {},
    "m": {},
    "k_3": {},
}
"""Extensions of one slider by name: the parameters of its shape that become free, and where their search starts, g over
X, v_0 over the largest speed, and see `SliderProblem`."""

_KNEES = {"knee", "dahl", "rounded"}  # of which there is one
_KEYS = ("F_k", "c", "rho")

_FIRST = tuple(np.geomspace(0.004, 1.0, 20).tolist())  # r/X, where the search begins
_AROUND = 0.4, 0.6, 0.75, 0.9, 1.0, 1.15  # of r before, where the search of an extension begins


@dataclass(frozen=True, eq=False)
class LoopProblem:
    """A contact in loops: residuals model − data, N, less their mean in each cycle, and how they change.

    design : of the loops.   linear : terms beyond contact, spring and drifts.
    """

    design: Design
    linear: tuple[str, ...]

    def contact(self, values: Array) -> Sliders:
        """Return the contact with these values of the parameters."""
        raise NotImplementedError

    @cached_property
    def rows(self) -> Array:
        """The rows of spring, drifts and linear terms, (p, n)."""
        return self.design.linear(self.linear)

    def drawn(self, values: Array, left: Array) -> Array:
        """Return by how much data less model change with other drawings of what is wrong with both, N, (draws, n): the
        noise of the displacement, and what is left in all cycles beyond it, of which few values are independent."""
        contact, k, design = self.contact(values), values[-len(self.rows)], self.design
        drawn = [
            design.stacked([force_of(contact, one) + k * one.x for one in loops])
            for loops in (design.loops, *zip(*(one.drawn for one in design.loops), strict=True))
        ]
        of_x = design.centred(np.array(drawn[1:]) - drawn[0])
        size = math.sqrt(max(0.0, design.shared(left) - float(np.mean(of_x**2))))
        return of_x + size * design.patterns(len(of_x) // 2, _INDEPENDENT)


@dataclass(frozen=True, eq=False)
class SliderProblem(LoopProblem):
    """One slider with the extensions named. Its parameters are F, the friction force at the largest speed v, which is
    F_k where it does not fall, r = F/K_z, those of its shape that are free, and the coefficients of the linear terms.

    rise, w : ln F_S/F and (v/v_S)². At rest the contact sticks, so that F_S is extrapolated: over orders of magnitude.
    """

    extensions: tuple[str, ...] = ()

    @cached_property
    def parameters(self) -> Parameters:
        """The parameters before anything is known of them."""
        X, v, design = self.design.X, self.design.fastest, self.design
        shape = {
            "r": Parameter("r", X, 1e-3 * X, 3.0 * X, scale=1e-3 * X),
            "g": Parameter("g", 0.0, 0.0, scale=X),
            "rise": Parameter("rise", 0.0, -7.0, 5.0),
            "w": Parameter("w", 1.0, 0.44, 1e3),
            "n": Parameter("n", 3.0, 0.5, 30.0),
            "v_0": Parameter("v_0", v, 1e-3 * v, 10.0 * v, scale=1e-3 * v),
        }
        # a force of the speed alone has no deflection
        free = ["r"] * ("rounded" not in self.extensions)
        free += [name for of in self.extensions for name in EXTENSIONS[of]]
        friction = Parameter("F", 0.0, scale=FEW * float(np.std(design.f)))
        own = [friction, *(shape[name] for name in free), *design.parameters(self.linear)]
        return Parameters.of(own)

    @cached_property
    def shape(self) -> slice:
        """Places of the parameters in which the force is not linear."""
        return slice(1, len(self.parameters) - len(self.rows))

    def contact(self, values: Array) -> Sliders:
        """Return the contact with these values of the parameters."""
        of = dict(zip(self.parameters.names[self.shape], values[self.shape].tolist(), strict=True))
        r, fallen = np.array([of.pop("r", self.design.X)]), 1.0  # F_k/F
        of |= {"n": 0.0} if "dahl" in self.extensions else {}
        if "rise" in of:
            w = of.pop("w")
            rise = math.exp(min(of.pop("rise"), w - _LEAST))
            fallen = 1.0 - rise * math.exp(-w)
            of |= {"fall": rise / fallen, "v_S": self.design.fastest / math.sqrt(w)}
        return Sliders(r * fallen, values[0] / r, **of)

    def share(self, values: Array) -> Array:
        """Return the force of the contact over F, less its means, (n,)."""
        contact, design = self.contact(np.append(1.0, values[1:])), self.design
        return design.centred(design.forces(contact))

    def slopes(self, values: Array) -> Array:
        """Return the derivatives of the model, N, (p, n)."""
        limits, slopes = self.parameters.limits, [self.share(values)]
        for i in range(self.shape.start, self.shape.stop):
            ends = np.tile(values, (2, 1))
            ends[:, i] += _STEP * max(abs(values[i]), limits.scale[i]) * np.array([1.0, -1.0])
            ends[:, i] = np.clip(ends[:, i], limits.low[i], limits.high[i])
            up, down = (self.share(end) for end in ends)
            slopes.append(values[0] * (up - down) / (ends[0, i] - ends[1, i]))
        return np.array([*slopes, *self.rows])

    def left(self, values: Array, slopes: Array) -> Array:
        """Return data less model, N, (n,)."""
        linear = np.delete(values, self.shape) @ np.delete(slopes, self.shape, axis=0)
        return np.asarray(self.design.f - linear)

    def products(self, values: Array, free: Mask, trail: Trail, out: Array) -> bool:
        """Set JᵀJ bordered by Jᵀr and χ², of residuals in N."""
        slopes = self.slopes(values)
        both = np.vstack([slopes, -self.left(values, slopes)])
        out[:] = both @ both.T
        return True

    def start(self, near: Parameters | None = None) -> Parameters:
        """Return the parameters of the smallest sum of squares on a grid of shapes.   near : the best ones without the
        last extension."""
        design, all_of = self.design, self.parameters
        found = all_of.moved(**{of.key: of.value for of in near or () if of.key in all_of})
        around = _AROUND if near else _FIRST
        grids = {of: [found[of].value * one for one in around] for of in ("r",) if of in found}
        for name, some in (EXTENSIONS[self.extensions[-1]] if near else {}).items():
            unit = {"g": design.X, "v_0": design.fastest}.get(name, 1.0)
            grids[name] = [one * unit for one in some]
        Q = np.linalg.qr(self.rows.T)[0]
        f = design.f - Q @ (Q.T @ design.f)

        def cost(values: Array) -> float:
            s = self.share(values)
            s = s - Q @ (Q.T @ s)
            return -(float(s @ f) ** 2) / max(float(s @ s), ZERO)

        grid = itertools.product(*grids.values())
        best = min(
            (found.moved(**dict(zip(grids, of, strict=True))).values for of in grid), key=cost
        )
        rows = np.array([self.share(best), *self.rows])
        linear = np.linalg.lstsq(rows.T, design.f)[0]
        return all_of.at(np.concatenate([linear[:1], best[self.shape], linear[1:]]))

    def fitted(self, start: Parameters) -> LoopFit:
        """Return the fit that a climb from a start finds; one step of Gauss and Newton leaves a block out."""
        design, limits, many = self.design, self.parameters.limits, len(self.parameters)
        start = self.parameters.at(start.values[:many])
        total = float(design.f @ design.f)
        least = _EXACT**2 * total
        for _ in range(_ROUNDS):
            noise, before = max(total, least) / design.f.size, total
            end = climb_on(self, start, gain=GAIN * noise)
            assert end is not None
            start, total = end.parameters, end.chi_square
            if total > before - _STAYS * noise:
                break
        values, slopes = start.values, self.slopes(start.values)
        left = self.left(values, slopes)
        without = values + without_each_block(design, slopes, left)
        drawn = np.array(np.linalg.lstsq(slopes.T, self.drawn(values, left).T)[0].T, np.float64)
        without, drawn = (np.clip(of, limits.low, limits.high) for of in (without, values - drawn))
        return LoopFit.of(self, start, slopes, left, without, drawn)


@dataclass(frozen=True, eq=False)
class GradualProblem(LoopProblem):
    """Sliders in parallel, whose forces F_j = κ_j r_j are not negative.

    r : deflections at which they slip, m, (j,).
    """

    r: Array

    @cached_property
    def parameters(self) -> Parameters:
        """The parameters before anything is known of them."""
        forces = [Parameter("F", 0.0, low=0.0, group=str(j + 1)) for j in range(self.r.size)]
        return Parameters.of([*forces, *self.design.parameters(self.linear)])

    def contact(self, values: Array) -> Sliders:
        """Return the contact with these values of the parameters."""
        return Sliders(self.r, values[: self.r.size] / self.r)

    def fitted(self, start: Parameters | None = None) -> LoopFit:
        """Return the fit of least squares, refitted without each block; neither sliders nor spring and damper push.

        start : it needs none.
        """
        from scipy.optimize import nnls  # slow to import

        design = self.design
        unit = Sliders(self.r, 1.0 / self.r)
        z = design.stacked([deflections_of(unit, loop) for loop in design.loops])
        columns = np.array([*design.centred(z / self.r[:, None]), *self.rows])
        p, drifts = len(columns), self.r.size + 1 + np.arange(len(design.loops))
        scale = np.sqrt(np.mean(columns**2, axis=1)) + ZERO
        A = columns / scale[:, None]
        A = np.vstack([A, -A[drifts]])  # a drift has either sign
        grams = np.array([A[:, own] @ A[:, own].T for own in design.own])
        sides = np.array([A[:, own] @ design.f[own] for own in design.own])

        def solution(G: Array, y: Array) -> Array:
            size, basis = np.linalg.eigh(G)
            root = np.sqrt(np.maximum(size, 1e-12 * size[-1]))
            found = nnls((basis * root).T, basis.T @ y / root)[0]
            found[drifts] -= found[p:]
            return found[:p] / scale

        G, y = grams.sum(axis=0), sides.sum(axis=0)
        values = solution(G, y)
        left_out = [solution(G - g, y - s) for g, s in zip(grams, sides, strict=True)]
        left = design.f - values @ columns
        drawn = [solution(G, y - A @ of) for of in self.drawn(values, left)]
        others = np.array(left_out), np.array(drawn)
        return LoopFit.of(self, self.parameters.at(values), columns, left, *others)


@dataclass(frozen=True, eq=False)
class LoopFit(Fit):
    """A contact fitted to loops. In addition to the parameters of its problem it has F_k (N), K_z (N/m) and, for a
    friction that falls with the speed, F_S (N) and v_S (m/s).

    left : data less model, N, (n,).   ahead : the same, each block by the fit to the others.   without : contact and
    values by key of the fit without each block.
    """

    left: Array = field(kw_only=True)
    ahead: Array = field(kw_only=True)
    without: Sequence[tuple[Sliders, Mapping[str, float]]] = field(kw_only=True)

    @classmethod
    def of(
        cls,
        problem: SliderProblem | GradualProblem,
        parameters: Parameters,
        slopes: Array,
        left: Array,
        without: Array,
        drawn: Array,
    ) -> LoopFit:
        """Return the fit at parameters with the slopes of the model there.

        without : values without each block, (blocks, p).   drawn : with other noise of the displacement, (draws, p).
        """

        def extended(values: Array) -> Parameters:
            contact = problem.contact(values)
            K_z = 0.0 if contact.v_0 else contact.K_z
            more = {"F_k": contact.F_k, "K_z": K_z, "rho": K_z**-0.5 if K_z > 0.0 else 0.0}
            more |= {} if "c" in parameters else {"c": 0.0}
            if "rise" in parameters:
                more |= {"F_S": contact.fall * contact.F_k, "v_S": contact.v_S}
            derived = [Parameter(name, value) for name, value in more.items()]
            return Parameters.of([*parameters.at(values), *derived])

        others = [extended(values) for values in without]
        blocks = problem.design.blocks
        pairs = zip(without - parameters.values, problem.design.own, strict=True)
        # a drawing moves the numbers as the noise that was there did: by its mean, and by its scatter
        of_x = np.array([extended(values).values for values in drawn])
        off, limits = of_x - of_x.mean(axis=0), parameters.limits
        moved = np.clip(2.0 * parameters.values - drawn.mean(axis=0), limits.low, limits.high)
        covariance = jackknifed([np.array([of.values for of in others]).T]) + off.T @ off / len(off)
        # by the scatter between blocks
        own = extended(moved), covariance, blocks - 1, blocks - 1, problem
        ahead = left - np.concatenate([of @ slopes[:, own] for of, own in pairs])
        contacts = map(problem.contact, without)
        each = [*zip(contacts, (of.by_key for of in others), strict=True)]
        return cls(*own, left=left, ahead=ahead, without=each)

    @property
    def design(self) -> Design:
        """The loops that it is fitted to."""
        design: Design = self.problem.design
        return design

    @cached_property
    def contact(self) -> Sliders:
        """The contact of all blocks."""
        contact: Sliders = self.problem.contact(self.point)
        return contact

    @cached_property
    def slips(self) -> bool:
        """Whether the contact slips for certain, and long enough for F_k to be determined."""
        contact = self.contact  # the largest slider that there is
        i = int(np.flatnonzero(contact.kappa).max(initial=0))
        r = contact.r[i : i + 1]
        share = self.design.forces(replace(contact, r=r, kappa=1.0 / r))
        knee = 1.0 - 1e-9 if contact.plain else _KNEE if not contact.v_0 else _ROUNDED
        slipping = float(np.mean(np.abs(share) > knee * self.design.load))
        return slipping > _SLIPPING and self.value("F_k") > _CERTAIN * self.error("F_k")

    @cached_property
    def predicted(self) -> Array:
        """Sum of squares of each block by the fit to the others, N²."""
        return self.design.by_block(self.ahead)

    @property
    def rms(self) -> float:
        """Root mean square of the residual, N."""
        return float(np.sqrt(np.mean(self.left**2)))

    @property
    def noise(self) -> float:
        """Mean square of the noise of a sample, N², with what is left in all cycles as one of few values."""
        few = _INDEPENDENT * len(self.design.loops)
        return self.rms**2 + self.beyond_noise**2 * self.left.size / few

    @property
    def beyond_noise(self) -> float:
        """Root mean square of what of the residual is certainly no white noise, N."""
        return math.sqrt(self.design.shared(self.left))

    @property
    def wrong_loss(self) -> float:
        """Root mean square of the difference of the energy that the fit loses in a cycle from that of the loop, over
        the latter, without what white noise makes of it."""
        noise, loops = self.rms**2 - self.beyond_noise**2, self.design.loops
        values, measured = self.parameters.by_key, np.concatenate([loop.lost for loop in loops])
        off = np.concatenate([lost(loop, self.contact, values) for loop in loops]) - measured
        chance = noise * math.fsum(np.sum(np.gradient(of.x)[of.own] ** 2) for of in loops)
        return math.sqrt(max(0.0, float(off @ off) - chance) / float(measured @ measured))

    def residual(self, loop: Loop, number: int) -> Array:
        """Return the residual of any cycles of the record that a loop of the fit is from, to an offset of each, N.

        number : of that loop.
        """
        values = self.parameters.by_key
        linear = {"k": loop.x, **motions_of(loop)}
        model = sum(values.get(name, 0.0) * of for name, of in linear.items())
        drift = values[f"drift[{number + 1}]"] * loop.t
        return np.asarray(loop.f - drift - force_of(self.contact, loop) - model)

    def loss(self, loop: Loop, X: Array) -> tuple[Array, Array]:
        """Return the energy lost per cycle at amplitudes X, m, of a motion like that of a loop, and its standard error,
        J, each (n,)."""
        motions = [loop.scaled(of) for of in X.tolist()]
        found = [(self.contact, self.parameters.by_key), *self.without]
        W = np.array([[lost(of, *one).item() for one in found] for of in motions])
        return W[:, 0], np.sqrt(np.diag(jackknifed([W[:, 1:]])))


def slider(
    design: Design, extensions: tuple[str, ...] = (), near: LoopFit | None = None
) -> LoopFit:
    """Fit one slider with the extensions named.   near : the fit without the last of them."""
    linear = ["c"] * design.with_c + [of for of in extensions if of in design.motions]
    problem = SliderProblem(design, tuple(linear), extensions)
    return problem.fitted(problem.start(near.parameters if near else None))


@one_thread
def weigh(design: Design, *, backlash: bool = True) -> Selection:
    """Weigh one slider against its extensions, against many sliders, and against a separate friction force for each
    record; the evidence comes from blocks of cycles that are left out, see `_evidence`."""
    gradual = fit_gradual(design)

    def extended(fit: LoopFit, names: tuple[str, ...]) -> list[Candidate]:
        others = {"each": None if "each" in names else _with_own_forces(fit)}
        others |= {} if names else {"gradual": gradual}
        if not {"gradual", "each"} & {*names}:
            closed = {*names, *(_KNEES if _KNEES & {*names} else ())}
            closed |= set() if backlash else {"gap"}
            closed |= {"gap", "fall"} if "rounded" in names else set()
            own, more = fit.problem.extensions, (of for of in design.extensions if of not in closed)
            others |= {of: slider(design, (*own, of), fit) for of in more}
        ends = {of: end for of, end in others.items() if end is not None and _possible(end, fit)}
        best = min([fit, *ends.values()], key=lambda one: float(one.predicted.sum()))

        def evidence(end: LoopFit) -> float:
            return _evidence(end, best) - _evidence(fit, best)

        return [Candidate(of, PRIORS[of], partial(ends.get, of), None, evidence) for of in ends]

    fit = slider(design)
    return select(fit, extended(fit, ()), _KEYS, further=extended)


def _possible(end: LoopFit, fit: LoopFit) -> bool:
    """Return whether an extended fit has positive forces and masses, and slips where the one before does."""
    sizes = [end.value(s) for s in ("F_k", "F_S", "c_2", "m") if s in end.parameters]
    return min(sizes) > 0.0 and end.slips >= fit.slips


def _evidence(fit: LoopFit, best: LoopFit) -> float:
    """Return ln of the likelihood of the sums of squares of blocks that are left out, over that of the best fit:

        −½ B ln(1 + t²/(B − 1)),      t = d̄ √B/s

    of the differences d of B blocks, whose scatter s knows that a residual is no white noise; but no more than −½ Σ d
    over the noise, where what the best fit leaves in all cycles counts as one of few values.
    """
    worse, blocks = fit.predicted - best.predicted, fit.design.blocks
    total = float(worse.sum())
    if fit is best or total <= 0.0:
        return 0.0
    t2 = total**2 / blocks / max(float(np.var(worse, ddof=1)), ZERO)
    by_blocks = 0.5 * blocks * math.log1p(t2 / (blocks - 1.0))
    return -min(by_blocks, 0.5 * total / best.noise)


@one_thread
def fit_gradual(
    design: Design, count: int = SLIDERS, within: tuple[float, float] = WITHIN
) -> LoopFit:
    """Fit many sliders in parallel.   within : the smallest and the largest r/X of them."""
    linear = ("c",) * design.with_c
    return GradualProblem(design, linear, design.X * np.geomspace(*within, count)).fitted()


def _with_own_forces(fit: LoopFit) -> LoopFit | None:
    """Return the fit with a separate friction force for each record; None if there is only one record."""
    if len(fit.design.loops) < 2 or not fit.slips:
        return None
    given = fit.design.loops
    for _ in range(_REFITS):
        design, contact, loops = fit.design, fit.contact, fit.design.loops
        slope = design.stacked([slope_of(contact, loop) for loop in loops])
        number = np.repeat(np.arange(len(loops)), [loop.own.size for loop in loops])
        slopes = [np.where(number == i, slope, 0.0) for i in range(len(loops))]
        columns = np.array([*slopes, design.forces(contact), *fit.problem.rows])
        columns[: len(loops) + 1] = design.centred(columns[: len(loops) + 1])
        loads = 1.0 + np.linalg.lstsq(columns.T, fit.left)[0][: len(loops)]
        if loads.min() <= 0.0:
            return None
        pairs = zip(loops, loads / loads.mean(), strict=True)
        design = Design([replace(loop, load=loop.load * float(of)) for loop, of in pairs])
        fit = replace(fit.problem, design=design).fitted(fit.parameters)
    pairs = zip(fit.design.loops, given, strict=True)
    return fit if np.ptp([loop.load / of.load for loop, of in pairs]) > DIFFER else None


@lru_cache(maxsize=4)  # asked for by the intervals, the report and the document
def with_late_motion(fit: LoopFit, late: float) -> LoopFit:
    """Return the fit with its displacement later by some time, s, as a fit to the force that much earlier."""
    design = Design([replace(of, f=np.interp(of.t + late, of.t, of.f)) for of in fit.design.loops])
    late_fit: LoopFit = replace(fit.problem, design=design).fitted(fit.parameters)
    return late_fit
