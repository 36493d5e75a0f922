"""Fit of a contact to measured loops: variable projection, and a jackknife over blocks of cycles.

    f = Σ κ_j z_j + k x + c ẋ + c_2 ẋ|ẋ| + m ẍ + drift t + offsets,      ż_j = ẋ while |z_j| < r_j, else z_j = ±r_j

One slider, that of the paper, has κ = K_z and r = Z_m = F_k/K_z; a gradual contact has many. One slider may be
extended:

- a dead band of half width g in series, as the backlash of a fixture makes it: the deflection of spring and gap is a
  play of half width Z_m + g, and the force K_z times the part beyond the gap;
- a friction force F_k + F_S e^{−(ẋ/v_S)²}, which falls with the speed (Stribeck);
- a rounded knee (Bouc and Wen, `law/contact.py`) of sharpness n.

Each record has a drift, and each cycle an offset of its own. All is linear except Z_m, g, F_S/F_k, v_S and n, over
which the sum of squares is profiled. An extension is kept where it predicts blocks of cycles that are left out clearly
better. Stick-slip noise and ripple are no white noise: errors come from the scatter between blocks.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from ..arrays import Array, Integers
from ..law.contact import Sliders
from ..signals.one_thread import one_thread
from .cycles import Loop

MOST_BLOCKS = 24
"""Blocks of cycles of a jackknife: Student's t of so many is close to the normal distribution."""

# part of X between reversals, and quartiles of the speed there, which of a sine are 21 % apart
_BETWEEN, _STEADY = 0.8, 0.1
_INDEPENDENT = 0.1  # of a column, which no combination of those before it makes
_CERTAIN = 4.0  # standard errors of F_k that is there
# of the samples of a cycle: fewer do not show the force at which the contact slips
_SLIPPING = 0.02
_WIDER = 1e-4  # part of the deflections at which sliders slip, of a difference quotient
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

_UNEXTENDED = {"g": 0.0, "fall": 0.0, "v_S": 0.3, "n": math.inf}
"""The shape of one slider that is not extended: g over X, F_S over F_k, v_S over the largest speed, sharpness n."""

EXTENSIONS: dict[str, dict[str, tuple[float, ...]]] = {
    "gap": {"g": (0.03, 0.1, 0.2, 0.3)},
    "fall": {"fall": (0.1, 0.4), "v_S": _STRIBECK},
    "knee": {"n": (1.0, 3.0)},
    "c_2": {},
    "m": {},
}
"""Extensions of one slider by name: the parameters of its shape that become free, and where their search starts."""

_AROUND = 0.4, 0.6, 0.75, 0.9, 1.0, 1.15  # of Z_m before, where the search of an extension starts
_LOGARITHMIC = {"Z": (1e-3, 3.0), "v_S": (0.03, 1.5), "n": (0.5, 30.0)}
"""Parameters whose logarithm is searched, and their limits; Z is Z_m over X."""


def forces(contact: Sliders, loop: Loop) -> Array:
    """Return the force of each element of a contact in the motion of a loop, N, (j, n)."""
    z = contact.deflections(loop.x, loop.v, loop.through, loop.load)
    return np.asarray(contact.kappa[:, None] * z)


def share_of(contact: Sliders, loop: Loop) -> Array:
    """Return the force of all elements of a contact in the motion of a loop over F_k, (n,)."""
    z = contact.deflections(loop.x, loop.v, loop.through, loop.load)
    return np.asarray(contact.kappa @ z / (contact.F_k or 1.0))


@dataclass(frozen=True, eq=False)
class LoopFit:
    """A contact fitted to loops.

    design : what it was fitted to.   extensions, shape : of one slider; None and empty of many.
    contact : of all blocks.   linear : coefficients of the terms beyond friction, by symbol.   drifts : of the loops,
    N/s.
    values, errors : by symbol: F_k (N), K_z (N/m), k (N/m), and what is free of c (N s/m), c_2 (N s²/m²), m (kg), g
    (m), F_S (N), v_S (m/s) and n.
    covariance : of F_k, c and K_z as far as determined.   freedom : blocks less one, of Student's t.
    without : contact and linear coefficients without each block.   models : force of each loop in its cycles, N.
    total : RSS, N².   slipping : share of the samples in slip.   predicted : sum of squares of each block by the fit to
    the others, N².
    """

    design: Design = field(repr=False)
    extensions: Sequence[str] | None
    shape: Mapping[str, float]
    contact: Sliders
    linear: Mapping[str, float]
    drifts: Array
    values: dict[str, float]
    errors: dict[str, float]
    covariance: Array
    freedom: int
    without: Sequence[tuple[Sliders, Mapping[str, float]]] = field(repr=False)
    models: tuple[Array, ...]
    total: float
    slipping: float
    predicted: Array

    @property
    def rms(self) -> float:
        """Root mean square of the residual, N."""
        return math.sqrt(self.total / sum(model.size for model in self.models))

    @property
    def beyond_noise(self) -> float:
        """Root mean square of what of the residual is certainly no white noise, N: samples a hundredth of a cycle apart
        share it."""
        design = self.design
        left = design.force - np.concatenate(self.models)
        apart = max(1, left.size // (int(design.cycle.max()) + 1) // _APART)
        same = design.cycle[apart:] == design.cycle[:-apart]
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
        return np.asarray(
            loop.f - drift * loop.t - self.contact.F_k * share_of(self.contact, loop) - linear
        )

    def loss(self, loop: Loop, X: Array) -> tuple[Array, Array]:
        """Return the energy lost per cycle at amplitudes X, m, of a motion like that of a loop, and its standard error,
        J, each (n,)."""
        motions = [loop.scaled(of) for of in X.tolist()]
        found = [(self.contact, self.linear), *self.without]
        W = np.array([[lost(of, *one).item() for of in motions] for one in found])
        return W[0], np.sqrt(np.diag(_covariance(W[1:])))


def lost(loop: Loop, contact: Sliders, linear: Mapping[str, float]) -> Array:
    """Return the energy that a contact and dampers take in each cycle of a motion, J, (cycles,)."""
    damped = linear.get("c", 0.0) + linear.get("c_2", 0.0) * np.abs(loop.v)
    return loop.by_cycle(contact.F_k * share_of(contact, loop) + damped * loop.v)


def motions_of(loop: Loop) -> dict[str, Array]:
    """Return the columns of the terms that a motion has beyond friction and spring, by symbol, (n,)."""
    return {"c": loop.v, "c_2": loop.v * np.abs(loop.v), "m": np.gradient(loop.v, loop.t)}


class Design:
    """Columns that are linear in the unknowns, and the blocks of cycles, of some loops."""

    def __init__(self, loops: Sequence[Loop]) -> None:
        """Stack the cycles of the loops."""
        self.loops, self.timed = loops, all(loop.timed for loop in loops)
        self.inside = [loop.cycle >= 0 for loop in loops]
        first = np.cumsum([0, *(loop.cycles for loop in loops)])
        pairs = zip(loops, first, strict=False)
        self.cycle = self.stacked([loop.cycle + n for loop, n in pairs]).astype(int)
        self.blocks = min(MOST_BLOCKS, int(first[-1]))
        self.block = self.cycle * self.blocks // int(first[-1])
        self.force = self.stacked([loop.f for loop in loops])
        self.f = self.centred(self.force)
        self.X = max(float(loop.amplitudes.max()) for loop in loops)
        self.fastest = max(float(np.abs(loop.v).max()) for loop in loops)
        drifts = [
            self.stacked([of.t / np.ptp(of.t) if of is loop else 0.0 * of.t for of in loops])
            for loop in loops
        ]
        x = self.stacked([loop.x for loop in loops])
        self.base = [self.centred(column) for column in (x, *drifts)]
        self.v = self.stacked([loop.v for loop in loops])
        motions = [motions_of(loop) for loop in loops]
        self.motions = {
            name: self.centred(self.stacked([of[name] for of in motions])) for name in motions[0]
        }
        self.load = self.stacked([np.full(loop.x.size, loop.load) for loop in loops])

    def stacked(self, of_loops: Sequence[Array]) -> Array:
        """Return the samples inside cycles of values of each loop, (…, n)."""
        pairs = zip(of_loops, self.inside, strict=True)
        return np.concatenate([np.asarray(of)[..., own] for of, own in pairs], axis=-1)

    def centred(self, values: Array) -> Array:
        """Return values less their mean in each cycle, as an offset of each cycle of its own leaves them, (…, n)."""
        rows = np.atleast_2d(values)
        count = np.bincount(self.cycle)
        means = [(np.bincount(self.cycle, row) / count)[self.cycle] for row in rows]
        return np.asarray((rows - means).reshape(np.shape(values)))

    def share(self, contact: Sliders) -> Array:
        """Return the force of a contact over its F_k in all loops, (n,)."""
        return self.stacked([share_of(contact, loop) for loop in self.loops])

    def by_block(self, left: Array) -> Array:
        """Return the sum of squares of each block, (blocks,)."""
        return np.array([np.sum(left[self.block == b] ** 2) for b in range(self.blocks)])

    @cached_property
    def with_c(self) -> bool:
        """Whether the speed between reversals is known, and varies so much that c is told from friction."""
        speeds = []
        for loop, own in zip(self.loops, self.inside, strict=True):
            x = loop.x[own] - loop.x[own].mean()
            speeds.append(np.abs(loop.v[own][np.abs(x) < _BETWEEN * loop.amplitudes.max()]))
        low, middle, high = np.percentile(np.concatenate(speeds), (25.0, 50.0, 75.0))
        return self.timed and bool(high - low > _STEADY * middle)

    @cached_property
    def extensions(self) -> tuple[str, ...]:
        """Names of the extensions that these motions determine: at one frequency m ẍ is a spring, and of two speeds no
        curve is told from a line."""

        def independent(y: Array, columns: Sequence[Array]) -> bool:
            A = np.array(columns).T
            rest = y - A @ np.linalg.lstsq(A, y)[0]
            return float(rest @ rest) > _INDEPENDENT**2 * float(y @ y)

        curved = self.with_c and independent(self.motions["c_2"], [self.v, np.sign(self.v)])
        inertia = self.timed and independent(self.motions["m"], self.base)
        open_to = {"gap": True, "fall": curved, "knee": True, "c_2": curved, "m": inertia}
        return tuple(name for name in EXTENSIONS if open_to[name])

    def linear(self, names: Sequence[str]) -> list[Array]:
        """Return the columns other than friction: x, drifts, and the terms named."""
        return [*self.base, *(self.motions[name] for name in names)]


def _without_each_block(A: Array, left: Array, block: Integers, blocks: int) -> Array:
    """Return by how much coefficients of least squares change without each block, (blocks, p).   left : residual of the
    best fit."""
    scale = np.sqrt(np.mean(A**2, axis=0)) + 1e-300
    A = A / scale
    own = [block == b for b in range(blocks)]
    G = A.T @ A
    out = [
        -np.linalg.pinv(G - A[of].T @ A[of], rcond=1e-12, hermitian=True) @ (A[of].T @ left[of])
        for of in own
    ]
    return np.array(out) / scale


def _covariance(out: Array) -> Array:
    """Return the covariance of the jackknife, (n − 1)/n Σ δ δᵀ.   out : numbers without each block, (n, p)."""
    delta = out - out.mean(axis=0)
    return np.asarray((len(out) - 1.0) / len(out) * delta.T @ delta)


class Slider:
    """One slider with the extensions named, whose shape is searched.   linear : names of its linear terms."""

    def __init__(
        self,
        design: Design,
        extensions: Sequence[str] = (),
        shape: Mapping[str, float] = _UNEXTENDED,
    ) -> None:
        self.design, self.extensions = design, extensions
        self.free = ["Z", *(name for of in extensions for name in EXTENSIONS[of])]
        self.linear = ["c"] * design.with_c + [of for of in extensions if of in design.motions]
        Q = np.linalg.qr(np.array(design.linear(self.linear)).T)[0]
        f = design.f - Q @ (Q.T @ design.f)

        def cost(at: Array) -> float:
            s = design.centred(design.share(self.contact(self.shape_at(at, shape))))
            s = s - Q @ (Q.T @ s)
            left = float(f @ f - (s @ f) ** 2 / max(float(s @ s), 1e-300))
            return math.log(max(left, 1e-14 * float(f @ f)))

        self.shape = self._searched(cost, shape)

    def contact(self, shape: Mapping[str, float], F_k: float = 1.0) -> Sliders:
        """Return the contact of a shape."""
        X, Z = self.design.X, self.design.X * shape["Z"]
        speed = self.design.fastest * shape["v_S"]
        r, kappa = np.array([Z]), np.array([F_k / Z])
        return Sliders(r, kappa, X * shape["g"], shape["fall"], speed, shape["n"])

    def shape_at(self, at: Array, shape: Mapping[str, float]) -> dict[str, float]:
        """Return a shape whose free parameters are at these values, logarithms of some."""
        moved = dict(shape)
        for name, value in zip(self.free, at.tolist(), strict=True):
            if name in _LOGARITHMIC:
                low, high = _LOGARITHMIC[name]
                value = min(max(math.exp(min(value, 10.0)), low), high)
            moved[name] = abs(value) if name == "g" else value
        return moved

    def at(self, shape: Mapping[str, float]) -> Array:
        """Return the free parameters of a shape, the inverse of `shape_at`."""
        pairs = [(name, shape[name]) for name in self.free]
        return np.array([math.log(v) if name in _LOGARITHMIC else v for name, v in pairs])

    def _searched(self, cost: Any, shape: Mapping[str, float]) -> dict[str, float]:
        from scipy.optimize import minimize  # slow to import

        newest = EXTENSIONS[self.extensions[-1]] if self.extensions else {}
        around = shape["Z"] * np.array(_AROUND) if self.extensions else np.geomspace(0.004, 1.0, 20)
        grid = [
            self.at({**shape, "Z": Z, **dict(zip(newest, of, strict=True))})
            for Z in around.tolist()
            for of in itertools.product(*newest.values())
        ]
        best = min(grid, key=cost)
        steps = np.diag([0.03 if name == "g" else 0.2 for name in self.free])
        search: Any = minimize  # its stubs know no function of an array of any shape
        simplex = np.vstack([best, best + steps])
        options = {"initial_simplex": simplex, "xatol": 1e-6, "fatol": 1e-10}
        return self.shape_at(search(cost, best, method="Nelder-Mead", options=options).x, shape)

    def fit(self) -> LoopFit:
        """Return the fit; one step of Gauss and Newton leaves a block out."""
        design, at, step = self.design, self.at(self.shape), 1e-4
        s = design.share(self.contact(self.shape))
        A = np.array([design.centred(s), *design.linear(self.linear)]).T
        p = np.linalg.lstsq(A, design.f)[0]
        ends = [(at + step * e, at - step * e) for e in np.eye(at.size)]
        shares = [
            [design.share(self.contact(self.shape_at(p, self.shape))) for p in of] for of in ends
        ]
        slopes = [p[0] * design.centred(up - down) / (2.0 * step) for up, down in shares]
        J, model = np.column_stack([A, *slopes]), A @ p
        out = _without_each_block(J, design.f - model, design.block, design.blocks)
        names, n = ["k", *self.linear], p.size - len(self.linear)
        places = [1, *range(n, p.size)]

        def found(change: Array) -> tuple[Sliders, dict[str, float]]:
            shape = self.shape_at(at + change[p.size :], self.shape)
            linear = dict(zip(names, (p + change[: p.size])[places].tolist(), strict=True))
            return self.contact(shape, float(p[0] + change[0])), linear

        contact, linear = found(np.zeros(at.size + p.size))
        without = [found(change) for change in out]
        knee = 1.0 - 1e-9 if math.isinf(contact.n) else _KNEE
        slipping = float(np.mean(np.abs(s) > knee * design.load))
        own = self.extensions, self.shape, p[2 : 1 + len(design.base)]
        return _made(design, own, (contact, linear), without, model, J @ out.T, slipping)


@one_thread
def fit_slider(design: Design, *, backlash: bool = True) -> LoopFit:
    """Fit one slider, and extend it as long as an extension predicts cycles that are left out clearly better."""
    best = Slider(design)
    fit, open_to = best.fit(), [of for of in design.extensions if backlash or of != "gap"]
    while open_to:
        tried = [Slider(design, (*best.extensions, of), best.shape) for of in open_to]
        fits = [one.fit() for one in tried]
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
        best, fit = tried[first], fits[first]
        open_to.pop(first)
    return fit


@one_thread
def fit_gradual(
    design: Design, count: int = SLIDERS, within: tuple[float, float] = WITHIN
) -> LoopFit:
    """Fit many sliders in parallel by least squares, refitted without each block; neither they nor spring and damper
    push.   within : the smallest and the largest r/X of them."""
    from scipy.optimize import nnls  # slow to import

    r = design.X * np.geomspace(*within, count)
    x, *drifts = design.base
    linear = ["c"] * design.with_c
    damper = [design.motions[name] for name in linear]
    unit = Sliders(r, 1.0 / r)
    z = design.stacked([forces(unit, loop) for loop in design.loops])
    A = np.array([*design.centred(z), x, *damper, *drifts]).T
    positive = count + 1 + len(damper)
    scale = np.sqrt(np.mean(A**2, axis=0)) + 1e-300
    A = A / scale
    own = [design.block == b for b in range(design.blocks)]
    grams = np.array([A[of].T @ A[of] for of in own])
    sides = np.array([A[of].T @ design.f[of] for of in own])

    def solved(G: Array, y: Array) -> Array:
        a, b = slice(None, positive), slice(positive, None)
        inverse = np.linalg.pinv(G[b, b], rcond=1e-12, hermitian=True)
        S = G[a, a] - G[a, b] @ inverse @ G[b, a]
        size, basis = np.linalg.eigh(S)
        root = np.sqrt(np.maximum(size, 1e-12 * size[-1]))
        part = nnls((basis * root).T, basis.T @ (y[a] - G[a, b] @ inverse @ y[b]) / root)[0]
        return np.append(part, inverse @ (y[b] - G[b, a] @ part))

    G, y = grams.sum(axis=0), sides.sum(axis=0)
    p = solved(G, y)
    out = np.array([solved(G - g, y - s) for g, s in zip(grams, sides, strict=True)])

    def found(p: Array) -> tuple[Sliders, dict[str, float]]:
        return Sliders(r, p[:count] / r), dict(
            zip(["k", *linear], p[count:positive].tolist(), strict=True)
        )

    contact, k = found(p / scale)
    largest = int(np.flatnonzero(contact.kappa).max(initial=0))
    slipping = float(np.mean(np.abs(z[largest]) > (1.0 - 1e-9) * design.load))
    without = [found(of) for of in out / scale]
    return _made(
        design,
        (None, {}, (p / scale)[positive:]),
        (contact, k),
        without,
        A @ p,
        A @ (out - p).T,
        slipping,
    )


def _numbers(contact: Sliders, linear: Mapping[str, float]) -> dict[str, float]:
    """Return the numbers of a contact by symbol."""
    extra = {"g": contact.g, "F_S": contact.fall * contact.F_k, "v_S": contact.v_S, "n": contact.n}
    free = {"g": contact.g != 0.0, "n": math.isfinite(contact.n)}
    known = {name: of for name, of in extra.items() if free.get(name, contact.fall != 0.0)}
    return {"F_k": contact.F_k, "K_z": contact.K_z, **linear, **known}


def _made(
    design: Design,
    own: tuple[Sequence[str] | None, Mapping[str, float], Array],
    found: tuple[Sliders, Mapping[str, float]],
    without: Sequence[tuple[Sliders, Mapping[str, float]]],
    model: Array,
    moved: Array,
    slipping: float,
) -> LoopFit:
    """Return a fit with the errors that its changes without each block make.

    own : extensions, shape, and coefficients of the columns of drift.   moved : changes of the model, (n, b).
    """
    values = _numbers(*found)
    names = [*values]
    out = np.array([[_numbers(*of).get(name, math.nan) for name in names] for of in without])
    covariance = _covariance(out)
    at = [names.index(name) for name in ("F_k", "c", "K_z") if name in names]
    left = design.f - model
    ahead = left - moved[np.arange(left.size), design.block]
    ends = np.cumsum([own.sum() for own in design.inside])[:-1]
    return LoopFit(
        design=design,
        extensions=own[0],
        shape=own[1],
        contact=found[0],
        linear=found[1],
        drifts=own[2] / [np.ptp(loop.t) for loop in design.loops],
        values=values,
        errors=dict(zip(names, np.sqrt(np.diag(covariance)).tolist(), strict=True)),
        covariance=covariance[np.ix_(at, at)],
        freedom=design.blocks - 1,
        without=without,
        models=tuple(np.split(design.force - left, ends)),
        total=float(left @ left),
        slipping=slipping,
        predicted=design.by_block(ahead),
    )


def _with_columns(fit: LoopFit, columns: Sequence[Array]) -> tuple[Array, Array]:
    """Return the coefficients of further columns, with the linear ones left free, and the sum of squares of each block
    by the fit to the others."""
    design, left = fit.design, fit.design.force - np.concatenate(fit.models)
    A = np.array([*design.centred(np.array(columns)), *design.linear([*fit.linear][1:])]).T
    p = np.linalg.lstsq(A, left)[0]
    out = _without_each_block(A, left - A @ p, design.block, design.blocks)
    return p, design.by_block(left - np.sum(A * (p + out[design.block]), axis=1))


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
    if fit.extensions is None:
        return fit_gradual(Design(loops))
    return Slider(Design(loops), fit.extensions, fit.shape).fit()


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
