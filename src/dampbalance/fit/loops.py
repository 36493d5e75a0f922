"""Fit of a contact to measured loops: a problem with residuals and slopes, and a jackknife over blocks of cycles.

    f = Σ κ_j z_j + k x + c ẋ + c_2 ẋ|ẋ| + m ẍ + drift t + offsets,      ż_j = ẋ while |z_j| < r_j, else z_j = ±r_j

One slider, that of the paper, has κ = K_z and r = Z_m = F_k/K_z; a gradual contact has many, whose forces are linear
and not negative. One slider may be extended by a gap in series, by a friction force that falls with the speed, or by a
rounded knee (`law/contact.py`), by a quadratic damper and by a mass.

Each record has a drift, and each cycle an offset of its own. The search starts at the best of a grid of the r, g,
n, rise and w in which the force is not linear, by the least squares of all others. An extension is kept where it
predicts blocks of cycles that are left out clearly better. Stick-slip noise and ripple are no white noise: errors come
from the scatter between blocks.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np

from ..arrays import Array, Mask
from ..law.contact import Sliders
from ..signals.loops import Loop
from ..signals.one_thread import one_thread
from .climb import Climb
from .errors import jackknifed
from .fit import Fit
from .loop_design import (
    FEW,
    ZERO,
    Design,
    force_of,
    forces_of,
    lost,
    motions_of,
    share_of,
    without_each_block,
)
from .multistart import Trail, multistart
from .parameters import Parameter, Parameters

_CERTAIN = 4.0  # standard errors of F_k that is there
# of the samples of a cycle: fewer do not show the force at which the contact slips
_SLIPPING = 0.02
_WIDER = 1e-4  # part of the deflections at which sliders slip, of a difference quotient
_STEP = 1e-4  # of a parameter of the shape, likewise
_KNEE = 0.98  # of F_k: a rounded knee counts as slip from here on
SLIDERS = 40  # of a gradual contact, in geometric steps: finer ones are not told apart
WITHIN = 0.01, 0.7  # r/X of them: softer sliders are hardly told from a spring
# of a scatter between blocks alone, below which another contact predicts them better
_P_SIMPLER = 0.01
_P_EXTENDED = 0.002  # for five extensions, each of which may win by chance
_LESS = 0.05  # of the sum of squares: an extension that takes less does not matter, however certain it is
_P_CONSTANT = 0.001  # for three laws of speed of a contact of many sliders
_APART = 100  # part of a cycle, from which on samples of noise are independent
_STRIBECK = (0.1, 0.3, 0.7)  # speeds at which friction has fallen, over the largest one
_EXACT = 1e-7  # of the force: what rounding leaves of a residual
_ROUNDS, _STAYS = 3, 0.01  # of climbs, each in units of what is left, until one gains less in χ²
_LEAST = 0.02  # F_k over F, of a friction that falls to nothing
_TINY = 1e-6  # of a parameter, of a difference quotient of a closed form

EXTENSIONS: dict[str, dict[str, tuple[float, ...]]] = {
    "gap": {"g": (0.03, 0.1, 0.2, 0.3)},
    "fall": {"rise": (-2.0, -1.0), "w": (2.0, 11.0, 100.0)},
    "knee": {"n": (1.0, 3.0)},
    "c_2": {},
    "m": {},
}
"""Extensions of one slider by name: the parameters of its shape that become free, and where their search starts, g over
X and see `SliderProblem`."""

_FIRST = tuple(np.geomspace(0.004, 1.0, 20).tolist())  # r/X, where the search begins
_AROUND = 0.4, 0.6, 0.75, 0.9, 1.0, 1.15  # of r before, where the search of an extension begins


@dataclass(frozen=True, eq=False)
class LoopProblem:
    """A contact in loops: residuals (model − data)/σ, less their mean in each cycle, and how they change.

    design : of the loops.   linear : terms beyond contact, spring and drifts.   sigma : σ, N, a unit.
    """

    design: Design
    linear: tuple[str, ...]
    sigma: float = field(default=1.0, kw_only=True)

    @cached_property
    def rows(self) -> Array:
        """The rows of spring, drifts and linear terms, (p, n)."""
        return self.design.linear(self.linear)

    @property
    def samples(self) -> int:
        """Number of samples."""
        return self.design.f.size

    def thinned(self) -> LoopProblem:
        """Return the problem itself: it is cheap."""
        return self

    def contact(self, values: Array) -> Sliders:
        """Return the contact with these values of the parameters."""
        raise NotImplementedError

    def linear_at(self, values: Array) -> dict[str, float]:
        """Return the coefficients of spring and linear terms, by symbol."""
        k, *others = values[len(values) - len(self.rows) :].tolist()
        return {"k": k} | dict(zip(self.linear, others[len(self.design.loops) :], strict=True))

    def slopes(self, values: Array) -> Array:
        """Return the derivatives of the model, N, (p, n)."""
        raise NotImplementedError

    def left(self, values: Array, slopes: Array) -> Array:
        """Return data less model, N, (n,)."""
        raise NotImplementedError

    def without(self, values: Array, slopes: Array) -> Array:
        """Return the values without each block, (blocks, p)."""
        raise NotImplementedError

    def fit(self, end: Climb) -> LoopFit:
        """Return the fit where a climb ended."""
        without = self.without(end.point, self.slopes(end.point))
        return LoopFit(
            parameters=end.parameters,
            covariance=jackknifed([without.T]),
            chi_square=end.chi_square,
            freedom=self.design.blocks - 1,
            problem=self,
            evaluations=end.evaluations,
            promise=end.promise,
        )


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
        X, design = self.design.X, self.design
        shape = {
            "r": Parameter("r", X, 1e-3 * X, 3.0 * X, scale=1e-3 * X),
            "g": Parameter("g", 0.0, 0.0, scale=X),
            "rise": Parameter("rise", 0.0, -7.0, 5.0),
            "w": Parameter("w", 1.0, 0.44, 1e3),
            "n": Parameter("n", 3.0, 0.5, 30.0),
        }
        free = ["r", *(name for of in self.extensions for name in EXTENSIONS[of])]
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
        r, fallen = np.array([of.pop("r")]), 1.0  # F_k/F
        if "rise" in of:
            w = of.pop("w")
            rise = math.exp(min(of.pop("rise"), w - _LEAST))
            fallen = 1.0 - rise * math.exp(-w)
            of |= {"fall": rise / fallen, "v_S": self.design.fastest / math.sqrt(w)}
        return Sliders(r * fallen, values[0] / r, **of)

    def share(self, values: Array) -> Array:
        """Return the force of the contact over F, less its means, (n,)."""
        contact, design = self.contact(np.append(1.0, values[1:])), self.design
        return design.centred(design.stacked([force_of(contact, loop) for loop in design.loops]))

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
        """Set JᵀJ bordered by Jᵀr and χ²."""
        slopes = self.slopes(values)
        both = np.vstack([slopes, -self.left(values, slopes)]) / self.sigma
        out[:] = both @ both.T
        return True

    def without(self, values: Array, slopes: Array) -> Array:
        """Return the values without each block, (blocks, p): one step of Gauss and Newton leaves a block out."""
        changes = without_each_block(self.design, slopes, self.left(values, slopes))
        limits = self.parameters.limits
        return np.asarray(np.clip(values + changes, limits.low, limits.high))

    def start(self, near: Parameters | None = None) -> tuple[Parameters, float]:
        """Return the parameters of the smallest sum of squares on a grid of shapes, and that sum, N².   near : the best
        ones without the last extension."""
        design, all_of = self.design, self.parameters
        found = all_of.moved(**{of.key: of.value for of in near or () if of.key in all_of})
        units = {"g": design.X}
        grids = {
            name: [units.get(name, 1.0) * one for one in some]
            for name, some in (EXTENSIONS[self.extensions[-1]] if near else {}).items()
        }
        part = _AROUND if near else _FIRST
        grids = {"r": [found["r"].value * one for one in part]} | grids
        Q = np.linalg.qr(self.rows.T)[0]
        f = design.f - Q @ (Q.T @ design.f)

        def cost(values: Array) -> float:
            s = self.share(values)
            s = s - Q @ (Q.T @ s)
            return float(f @ f - (s @ f) ** 2 / max(float(s @ s), ZERO))

        grid = [
            found.moved(**dict(zip(grids, of, strict=True))).values
            for of in itertools.product(*grids.values())
        ]
        best = min(grid, key=cost)
        rows = np.array([self.share(best), *self.rows])
        linear = np.linalg.lstsq(rows.T, design.f)[0]
        values = np.concatenate([linear[:1], best[self.shape], linear[1:]])
        return all_of.at(values), cost(best)

    def fitted(self, start: Parameters, total: float) -> LoopFit:
        """Return the fit that a climb from a start finds.   total : sum of squares there, N²."""
        least = _EXACT**2 * float(self.design.f @ self.design.f)
        for _ in range(_ROUNDS):
            sigma = math.sqrt(max(total, least) / self.samples)
            fit: LoopFit = multistart(replace(self, sigma=sigma), [start])[0]
            if fit.total > total - _STAYS * sigma**2:
                break
            start, total = fit.parameters, fit.total
        return fit


@dataclass(frozen=True, eq=False)
class GradualProblem(LoopProblem):
    """Sliders in parallel, whose forces F_j = κ_j r_j are not negative.

    r : deflections at which they slip, m, (j,).
    """

    r: Array

    @cached_property
    def columns(self) -> Array:
        """The derivatives of the model by F_j and the linear terms, (p, n)."""
        design = self.design
        unit = Sliders(self.r, 1.0 / self.r)
        forces = design.stacked([forces_of(unit, loop) for loop in design.loops])
        return np.array([*design.centred(forces), *self.rows])

    @cached_property
    def solved(self) -> tuple[Array, Array]:
        """The values of least squares, and those without each block, (p,) and (blocks, p); neither spring nor damper
        push."""
        from scipy.optimize import nnls  # slow to import

        drifts = self.r.size + 1 + np.arange(len(self.design.loops))
        others = np.setdiff1d(np.arange(len(self.columns)), drifts)
        a, b = np.ix_(others, others), np.ix_(drifts, drifts)
        scale = np.sqrt(np.mean(self.columns**2, axis=1)) + ZERO
        A = self.columns / scale[:, None]
        grams = np.array([A[:, own] @ A[:, own].T for own in self.design.own])
        sides = np.array([A[:, own] @ self.design.f[own] for own in self.design.own])

        def solution(G: Array, y: Array) -> Array:
            inverse = np.linalg.pinv(G[b], rcond=1e-12, hermitian=True)
            turned = G[np.ix_(others, drifts)] @ inverse
            S = G[a] - turned @ G[np.ix_(drifts, others)]
            size, basis = np.linalg.eigh(S)
            root = np.sqrt(np.maximum(size, 1e-12 * size[-1]))
            p = np.empty(len(scale))
            p[others] = nnls((basis * root).T, basis.T @ (y[others] - turned @ y[drifts]) / root)[0]
            p[drifts] = inverse @ (y[drifts] - G[np.ix_(drifts, others)] @ p[others])
            return p / scale

        G, y = grams.sum(axis=0), sides.sum(axis=0)
        left_out = [solution(G - g, y - s) for g, s in zip(grams, sides, strict=True)]
        return solution(G, y), np.array(left_out)

    def contact(self, values: Array) -> Sliders:
        """Return the contact with these values of the parameters."""
        return Sliders(self.r, values[: self.r.size] / self.r)

    def slopes(self, values: Array) -> Array:
        """Return the derivatives of the model, N, (p, n)."""
        return self.columns

    def left(self, values: Array, slopes: Array) -> Array:
        """Return data less model, N, (n,)."""
        return np.asarray(self.design.f - values @ slopes)

    def without(self, values: Array, slopes: Array) -> Array:
        """Return the values without each block, (blocks, p)."""
        return self.solved[1]


class LoopFit(Fit):
    """A contact fitted to loops; its problem has their design."""

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
    def linear(self) -> dict[str, float]:
        """Coefficients of the terms beyond friction, by symbol."""
        return self.problem.linear_at(self.point)

    @property
    def drifts(self) -> Array:
        """Drifts of the loops, N/s."""
        return self.point[np.array(self.parameters.names) == "drift"]

    @cached_property
    def _apart(self) -> tuple[Array, Array]:
        """Data less model, N, (n,), and its changes without each block where it is left out, likewise."""
        slopes = self.problem.slopes(self.point)
        changes = self.problem.without(self.point, slopes) - self.point
        parts = [of @ slopes[:, own] for of, own in zip(changes, self.design.own, strict=True)]
        return self.problem.left(self.point, slopes), np.concatenate(parts)

    @cached_property
    def without(self) -> list[tuple[Sliders, dict[str, float]]]:
        """Contact and linear coefficients without each block."""
        values = self.problem.without(self.point, self.problem.slopes(self.point))
        return [(self.problem.contact(of), self.problem.linear_at(of)) for of in values]

    def numbers_at(self, values: Array) -> dict[str, float]:
        """Return the numbers of a contact by symbol, F_k (N), K_z (N/m), k (N/m), and what is free of c (N s/m), c_2
        (N s²/m²), m (kg), g (m), F_S (N), v_S (m/s) and n, with these values of the parameters."""
        contact, linear = self.problem.contact(values), self.problem.linear_at(values)
        more = {"g": ("g", contact.g), "rise": ("F_S", contact.fall * contact.F_k)}
        more |= {"w": ("v_S", contact.v_S), "n": ("n", contact.n)}
        free = dict(of for name, of in more.items() if name in self.parameters)
        return {"F_k": contact.F_k, "K_z": contact.K_z, **linear, **free}

    @cached_property
    def values(self) -> dict[str, float]:
        """The numbers of the contact of all blocks."""
        return self.numbers_at(self.point)

    def covariance_of_values(self, *symbols: str) -> Array:
        """Return the covariance of some of these numbers, to first order."""
        steps = _TINY * np.maximum(np.abs(self.point), self.parameters.scale)
        ends = [self.point + turn * np.diag(steps) for turn in (1.0, -1.0)]
        up, down = ([self.numbers_at(of) for of in some] for some in ends)
        pairs = [*zip(up, down, strict=True)]
        slopes = np.array([[one[s] - other[s] for one, other in pairs] for s in symbols])
        slopes = slopes.reshape(-1, steps.size) / (2.0 * steps)
        return np.asarray(slopes @ self.covariance @ slopes.T)

    @cached_property
    def errors(self) -> dict[str, float]:
        """Standard errors of the values."""
        errors = np.sqrt(np.diag(self.covariance_of_values(*self.values)))
        return dict(zip(self.values, errors.tolist(), strict=True))

    @cached_property
    def models(self) -> tuple[Array, ...]:
        """Force of each loop in its cycles, N."""
        ends = np.cumsum([own.sum() for own in self.design.inside])[:-1]
        return tuple(np.split(self.design.force - self._apart[0], ends))

    @property
    def total(self) -> float:
        """RSS, N²."""
        return self.chi_square * float(self.problem.sigma) ** 2

    @cached_property
    def slipping(self) -> float:
        """Share of the samples in slip, of the largest slider that there is."""
        contact = self.contact
        i = int(np.flatnonzero(contact.kappa).max(initial=0))
        r = contact.r[i : i + 1]
        share = self.design.share(replace(contact, r=r, kappa=1.0 / r))
        knee = 1.0 - 1e-9 if math.isinf(contact.n) else _KNEE
        return float(np.mean(np.abs(share) > knee * self.design.load))

    @cached_property
    def predicted(self) -> Array:
        """Sum of squares of each block by the fit to the others, N²."""
        left, moved = self._apart
        return self.design.by_block(left - moved)

    @property
    def rms(self) -> float:
        """Root mean square of the residual, N."""
        return math.sqrt(self.total / self.design.f.size)

    @property
    def beyond_noise(self) -> float:
        """Root mean square of what of the residual is certainly no white noise, N: samples a hundredth of a cycle apart
        share it."""
        cycle, left = self.design.cycle, self._apart[0]
        apart = max(1, left.size // (int(cycle.max()) + 1) // _APART)
        same = cycle[apart:] == cycle[:-apart]
        shared = float(np.mean((left[apart:] * left[:-apart])[same]))
        return math.sqrt(max(0.0, shared - 2.0 * self.rms**2 / math.sqrt(left.size)))

    @property
    def wrong_loss(self) -> float:
        """Root mean square of the difference of the energy that the fit loses in a cycle from that of the loop, over
        the latter, without what white noise makes of it."""
        noise, loops = self.rms**2 - self.beyond_noise**2, self.design.loops
        off = [lost(loop, self.contact, self.linear) - loop.lost for loop in loops]
        chance = noise * math.fsum(np.sum(np.gradient(of.x)[of.own] ** 2) for of in loops)
        measured = np.concatenate([loop.lost for loop in loops])
        wrong = float(np.sum(np.concatenate(off) ** 2)) - chance
        return math.sqrt(max(0.0, wrong) / float(np.sum(measured**2)))

    def residual(self, loop: Loop, drift: float) -> Array:
        """Return the residual of any cycles of the record that a loop of the fit is from, to an offset of each, N.

        drift : of that loop, N/s.
        """
        of = {"k": loop.x, **motions_of(loop)}
        linear = sum(p * of[name] for name, p in self.linear.items())
        friction = self.contact.F_k * share_of(self.contact, loop)
        return np.asarray(loop.f - drift * loop.t - friction - linear)

    def loss(self, loop: Loop, X: Array) -> tuple[Array, Array]:
        """Return the energy lost per cycle at amplitudes X, m, of a motion like that of a loop, and its standard error,
        J, each (n,)."""
        motions = [loop.scaled(of) for of in X.tolist()]
        found = [(self.contact, self.linear), *self.without]
        W = np.array([[lost(of, *one).item() for one in found] for of in motions])
        return W[:, 0], np.sqrt(np.diag(jackknifed([W[:, 1:]])))


def slider(
    design: Design, extensions: tuple[str, ...] = (), near: LoopFit | None = None
) -> LoopFit:
    """Fit one slider with the extensions named.   near : the fit without the last of them."""
    linear = ["c"] * design.with_c + [of for of in extensions if of in design.motions]
    problem = SliderProblem(design, tuple(linear), extensions)
    return problem.fitted(*problem.start(near.parameters if near else None))


@one_thread
def fit_slider(design: Design, *, backlash: bool = True) -> LoopFit:
    """Fit one slider, and extend it as long as an extension predicts cycles that are left out clearly better."""
    fit, open_to = slider(design), [of for of in design.extensions if backlash or of != "gap"]
    while open_to:
        fits = [slider(design, (*fit.problem.extensions, of), fit) for of in open_to]
        better = [
            i
            for i, of in enumerate(fits)
            if min(of.values[s] for s in ("F_k", "F_S", "c_2", "m") if s in of.values) > 0.0
            and slips(of) >= slips(fit)
            and of.total < (1.0 - _LESS) * fit.total
            and predicts_better(of, fit, _P_EXTENDED)
        ]
        if not better:
            break
        first = min(better, key=lambda i: float(fits[i].predicted.sum()))
        fit = fits[first]
        open_to.pop(first)
    return fit


@one_thread
def fit_gradual(
    design: Design, count: int = SLIDERS, within: tuple[float, float] = WITHIN
) -> LoopFit:
    """Fit many sliders in parallel by least squares, refitted without each block; neither they nor spring and damper
    push.   within : the smallest and the largest r/X of them."""
    r, linear = design.X * np.geomspace(*within, count), ("c",) * design.with_c
    problem = GradualProblem(design, linear, r)
    values = problem.solved[0]
    left = problem.left(values, problem.columns)
    forces = [Parameter("F", low=0.0, value=0.0, group=str(j + 1)) for j in range(count)]
    parameters = Parameters.of([*forces, *design.parameters(linear)]).at(values)
    products = np.full((1, 1), left @ left)
    return problem.fit(Climb(parameters, products, 1, 0.0))


def _with_columns(fit: LoopFit, columns: Sequence[Array]) -> tuple[Array, Array]:
    """Return the coefficients of further columns, with the linear ones left free, and the sum of squares of each block
    by the fit to the others."""
    design, left = fit.design, fit.design.force - np.concatenate(fit.models)
    A = np.array([*design.centred(np.array(columns)), *fit.problem.rows])
    p = np.linalg.lstsq(A.T, left)[0]
    out = p + without_each_block(design, A, left - p @ A)
    ahead = [left[own] - of @ A[:, own] for of, own in zip(out, design.own, strict=True)]
    return p, design.by_block(np.concatenate(ahead))


@one_thread
def fall_with_speed(fit: LoopFit) -> tuple[float, float]:
    """Return by which part of F_k the friction is larger at rest than at speed, negative for a rise, where a term
    F_k e^{−(ẋ/v_S)²} predicts blocks that are left out clearly better (Stribeck), and by which part F_k changes then;
    else zeros."""
    design, share = fit.design, fit.design.share(fit.contact)
    changes, best = (0.0, 0.0), fit.predicted
    for part in _STRIBECK:
        at_rest = share * np.exp(-((design.v / (part * design.fastest)) ** 2))
        p, of = _with_columns(fit, [at_rest, share])
        if _less(of, fit.predicted, _P_CONSTANT) and of.sum() < best.sum():
            changes, best = (float(p[0]) / fit.values["F_k"], float(p[1]) / fit.values["F_k"]), of
    return changes


@one_thread
def different_forces(fit: LoopFit) -> Array:
    """Return the friction force of each record over their mean where one of its own predicts blocks that are left out
    clearly better, (loops,); else ones."""
    design, contact, same = fit.design, fit.contact, np.ones(len(fit.design.loops))
    if same.size == 1 or not slips(fit):
        return same
    wider = replace(contact, r=contact.r * (1.0 + _WIDER))
    share = design.share(contact)
    number = np.repeat(np.arange(same.size), [loop.own.size for loop in design.loops])
    slope = (wider.F_k * design.share(wider) - contact.F_k * share) / _WIDER
    slopes = [np.where(number == i, slope, 0.0) for i in range(same.size)]
    p, ahead = _with_columns(fit, [*slopes, share])
    forces = 1.0 + p[: same.size]
    clear = _less(ahead, fit.predicted, _P_CONSTANT) and forces.min() > 0.0
    return np.asarray(forces / forces.mean()) if clear else same


@lru_cache(maxsize=4)  # asked for by the intervals, the report and the document
def with_late_motion(fit: LoopFit, late: float) -> LoopFit:
    """Return the fit with its displacement later by some time, s, as a fit to the force that much earlier."""
    loops = [replace(of, f=np.interp(of.t + late, of.t, of.f)) for of in fit.design.loops]
    if isinstance(fit.problem, GradualProblem):
        return fit_gradual(Design(loops))
    return replace(fit.problem, design=Design(loops)).fitted(fit.parameters, fit.total)


def _less(one: Array, other: Array, p: float) -> bool:
    """Return whether sums of squares of blocks are smaller than others, by the scatter of their differences."""
    from scipy.stats import t as student  # slow to import

    less = other - one
    error = float(np.std(less, ddof=1)) / math.sqrt(less.size)
    return bool(student.sf(less.mean() / max(error, 1e-300), less.size - 1) < p)


def predicts_better(one: LoopFit, other: LoopFit, p: float = _P_SIMPLER) -> bool:
    """Return whether a fit predicts blocks of cycles that are left out better than another one does, by the scatter of
    the differences between blocks.   p : probability of a scatter alone."""
    return _less(one.predicted, other.predicted, p)


def slips(fit: LoopFit) -> bool:
    """Return whether the contact slips for certain, and long enough for F_k to be determined."""
    return fit.slipping > _SLIPPING and fit.values["F_k"] > _CERTAIN * fit.errors["F_k"]
