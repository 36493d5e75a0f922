"""Fit of a contact to measured loops: variable projection, and a jackknife over blocks of cycles.

    f = Σ κ_j z_j + k x + c ẋ + offset + drift t,      ż_j = ẋ while |z_j| < r_j, else z_j = ±r_j

One slider, that of the paper, has κ = K_z and r = Z_m = F_k/K_z; a gradual contact has many. With a dead band of half
width g in series, as the backlash of a fixture makes it, deflection of spring and gap is a play operator of half width
Z_m + g, and the force K_z times what lies beyond the gap. All is linear except Z_m and g, over which the sum of squares
is profiled. Stick-slip noise and ripple are no white noise: errors come from the scatter between blocks of cycles.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import Array, Integers, Mask

MOST_BLOCKS = 24
"""Blocks of cycles of a jackknife: Student's t of so many is close to the normal distribution."""

FEWEST_CYCLES = 4
"""Complete cycles, the first left out: of fewer the scatter between them says nothing."""

# of the range of x: a reversal is a return by more, so that levels of 1 : 20 are read
_SWING = 0.04
_CLOSED = 0.05  # of the range of a cycle, between its ends
# noise of x over its range from which on it is smoothed: else z reverses with it
_SMOOTHED = 1e-3
_OF_PERIOD, _OF_PERIOD_V = 40, 16  # windows of x and ẋ are these parts of a period
# part of X between reversals, and quartiles of the speed there, which of a sine are 21 % apart
_BETWEEN, _STEADY = 0.8, 0.1
_CERTAIN = 4.0  # standard errors by which friction loses energy, or a sign is wrong
# of the samples of a cycle: fewer do not show the force at which the contact slips
_SLIPPING = 0.02
SLIDERS = 40  # of a gradual contact, in geometric steps: finer ones are not told apart
WITHIN = 0.01, 0.7  # r/X of them: softer sliders are hardly told from a spring
# of a scatter between blocks alone, below which another contact predicts them better
_P_SIMPLER = 0.01
_P_CONSTANT = 0.001  # for three laws of speed, each of which may win by chance
_STRIBECK = (0.1, 0.3, 0.7)  # speeds at which friction has fallen, over the largest one


def turning_points(x: Array, least: float) -> Integers:
    """Return the indices of the reversals of x that are followed by a return of more than `least`."""
    found, at, way = list[int](), 0, 0
    for i, value in enumerate(x.tolist()):
        ahead = (value - x[at]) * (way or 1.0)
        if way == 0 and abs(value - x[at]) > least:
            way, at = (1 if value > x[at] else -1), i
        elif way and ahead >= 0.0:
            at = i
        elif way and ahead < -least:
            found.append(at)
            way, at = -way, i
    return np.array(found, dtype=int)


def play(x: Array, r: Array) -> Array:
    """Return the deflections of sliders that start relaxed, exact for a motion that is monotone between samples.

    x : displacement, m, (n,).   r : deflections at which they slip, m, (j,).   Returns z, m, (j, n).
    """
    steps = np.diff(x)
    (moving,) = np.nonzero(steps)
    turns = moving[1:][np.diff(np.sign(steps[moving])) != 0.0]
    z, now = np.zeros((r.size, x.size)), np.zeros(r.size)
    ends = [0, *turns.tolist(), x.size - 1]
    for start, end in itertools.pairwise(ends):
        z[:, start : end + 1] = now[:, None] + (x[start : end + 1] - x[start])
        np.clip(z[:, start : end + 1], -r[:, None], r[:, None], z[:, start : end + 1])
        now = z[:, end]
    return z


def slack(z: Array, g: float) -> Array:
    """Return the part of a deflection beyond a gap of half width g, m."""
    return np.asarray(np.sign(z) * np.maximum(np.abs(z) - g, 0.0))


@dataclass(frozen=True, eq=False)
class Loop:
    """A record of force and displacement, ready for the fit.

    t : s.   x : displacement, smoothed where it is noisy, m.   v : velocity, m/s.   f : force, N, its sign such that
    energy is lost.   cycle : number of the cycle of each sample; −1 outside of those that are fitted.
    """

    name: str
    t: Array
    x: Array
    v: Array
    f: Array
    cycle: Integers
    flipped: bool

    @classmethod
    def of(cls, name: str, t: Array, x: Array, f: Array) -> Loop:
        """Return the loop of samples in equal steps.   Raises ValueError for too few cycles."""
        from scipy.signal import savgol_filter  # slow to import

        third = np.diff(x, 3)  # σ√20 of white noise
        noise = 1.4826 * float(np.median(np.abs(third - np.median(third)))) / math.sqrt(20.0)
        least = _SWING * float(np.ptp(x))
        turns = turning_points(x, least)
        minima = turns[int(x[turns[0]] > x[turns[1]]) :: 2] if turns.size > 2 else turns[:0]
        if minima.size < FEWEST_CYCLES + 2:
            raise ValueError(
                f"{name}: the displacement makes {max(minima.size - 1, 0)} cycles between reversals, and "
                f"{FEWEST_CYCLES + 1} are needed at least: a contact shows its stiffness after a reversal, and its "
                "scatter from cycle to cycle"
            )
        period = float(np.median(np.diff(minima)))
        smooth, smooth_v = (2 * int(period / of / 2) + 1 for of in (_OF_PERIOD, _OF_PERIOD_V))
        v = np.gradient(x, t)
        if smooth_v > 3:
            v = savgol_filter(x, smooth_v, 3, deriv=1, delta=(t[-1] - t[0]) / (t.size - 1))
        if noise > _SMOOTHED * np.ptp(x) and smooth > 3:
            x = savgol_filter(x, smooth, 3)
        cycle = np.searchsorted(minima[1:], np.arange(x.size), side="right") - 1
        cycle[minima[-1] :] = -1
        loop = cls(name, t, x, np.asarray(v), f, cycle, False)
        lost = loop.lost
        gains = lost.mean() < -_CERTAIN * lost.std(ddof=1) / math.sqrt(lost.size)
        return replace(loop, f=-f, flipped=True) if gains else loop

    @property
    def cycles(self) -> int:
        """Number of cycles that are fitted."""
        return int(self.cycle.max()) + 1

    def by_cycle(self, values: Array) -> Array:
        """Return ∮ values dx of each cycle, (cycles,)."""
        pieces = np.append(0.5 * (values[1:] + values[:-1]) * np.diff(self.x), 0.0)
        return np.array([np.sum(pieces[self.cycle == i]) for i in range(self.cycles)])

    @property
    def lost(self) -> Array:
        """Energy lost in each cycle, ∮ f dx without the drift of the force, J."""
        own = self.cycle >= 0
        return self.by_cycle(self.f - np.polyval(np.polyfit(self.t[own], self.f[own], 1), self.t))

    @property
    def step(self) -> float:
        """Typical distance of samples next to a reversal, by which a sharp one may be missed, m."""
        turns = turning_points(self.x, _SWING * float(np.ptp(self.x)))
        return float(np.median(np.abs(np.diff(self.x))[turns[1:-1]]))

    @property
    def closed(self) -> Mask:
        """Which cycles end where they began, by a part of their amplitude."""
        own = [self.x[self.cycle == i] for i in range(self.cycles)]
        return np.array([abs(x[-1] - x[0]) < _CLOSED * np.ptp(x) for x in own])

    @property
    def amplitudes(self) -> Array:
        """X of each cycle, m."""
        own = [self.x[self.cycle == i] for i in range(self.cycles)]
        return np.array([0.5 * np.ptp(x) for x in own])


@dataclass(frozen=True, eq=False)
class LoopFit:
    """A contact fitted to loops.

    values, errors : by symbol: F_k (N), K_z (N/m), k (N/m), c (N s/m; only where it is determined), g (m).
    covariance : of F_k, c and K_z as far as determined.   freedom : blocks less one, of Student's t.
    r, kappa : of the sliders, m and N/m.   residual : N, of the samples fitted, a part each loop.   total : RSS, N².
    slipping : share of the samples in slip.   predicted : sum of squares of each block by the fit to the others, N².
    """

    values: dict[str, float]
    errors: dict[str, float]
    covariance: Array
    freedom: int
    r: Array
    kappa: Array
    models: tuple[Array, ...]
    total: float
    slipping: float
    predicted: Array
    samples: int
    share: Array

    @property
    def rms(self) -> float:
        """Root mean square of the residual, N."""
        return math.sqrt(self.total / self.samples)


class Design:
    """Columns that are linear in the unknowns, and the blocks of cycles, of some loops."""

    def __init__(self, loops: Sequence[Loop]) -> None:
        """Stack the cycles of the loops."""
        self.loops = loops
        self.inside = [loop.cycle >= 0 for loop in loops]
        self.f = self.stacked([loop.f for loop in loops])
        self.X = max(float(loop.amplitudes.max()) for loop in loops)
        common = [self.stacked([getattr(loop, n) for loop in loops]) for n in ("x", "v")]
        own = list[Array]()
        for i, loop in enumerate(loops):
            for column in (np.ones(loop.t.size), (loop.t - loop.t.mean()) / np.ptp(loop.t)):
                own.append(
                    self.stacked([column if i == j else 0.0 * of.t for j, of in enumerate(loops)])
                )
        self.base = [common[0], *own]
        self.v = common[1]
        first = np.cumsum([0, *(loop.cycles for loop in loops)])
        cycle = self.stacked([loop.cycle + n for loop, n in zip(loops, first, strict=False)])
        self.blocks = min(MOST_BLOCKS, int(first[-1]))
        self.block = (cycle * self.blocks // int(first[-1])).astype(int)

    def stacked(self, of_loops: Sequence[Array]) -> Array:
        """Return the samples inside cycles of values of each loop."""
        return np.concatenate(
            [np.asarray(of)[own] for of, own in zip(of_loops, self.inside, strict=True)]
        )

    def sliders(self, r: Array) -> Array:
        """Return the deflections of sliders in all loops, m, (j, n)."""
        return np.hstack(
            [play(of.x, r)[:, own] for of, own in zip(self.loops, self.inside, strict=True)]
        )

    @cached_property
    def with_c(self) -> bool:
        """Whether the speed between reversals varies so much, within or between loops, that c is told from friction."""
        speeds = []
        for loop, own in zip(self.loops, self.inside, strict=True):
            x = loop.x[own] - loop.x[own].mean()
            speeds.append(np.abs(loop.v[own][np.abs(x) < _BETWEEN * loop.amplitudes.max()]))
        low, middle, high = np.percentile(np.concatenate(speeds), (25.0, 50.0, 75.0))
        return bool(high - low > _STEADY * middle)

    @property
    def linear(self) -> list[Array]:
        """The columns other than friction: x, offsets, drifts, and ẋ where it is determined."""
        return [*self.base, *([self.v] if self.with_c else [])]

    def solved(self, s: Array) -> tuple[Array, float]:
        """Return the coefficients with a column s of friction, and the sum of squares."""
        A = np.array([s, *self.linear]).T
        p = np.linalg.lstsq(A, self.f)[0]
        left = self.f - A @ p
        return p, float(left @ left)


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
    """Return the covariance of the jackknife, (n − 1)/n Σ δ δᵀ."""
    delta = out - out.mean(axis=0)
    return np.asarray((len(out) - 1.0) / len(out) * delta.T @ delta)


def fit_slider(design: Design, *, backlash: bool) -> LoopFit:
    """Fit one slider, with a dead band in series where asked for and where the sum of squares falls clearly by it."""
    from scipy.optimize import minimize  # slow to import

    X = design.X

    def column(at: Array) -> Array:
        Z, g = X * math.exp(min(at[0], 1.0)), X * abs(at[1])
        return slack(design.sliders(np.array([Z + g]))[0], g) / Z

    def cost(at: Array) -> float:
        return math.log(design.solved(column(at))[1] + 1e-300)

    def searched(gaps: Sequence[float]) -> Array:
        grid = [np.array([z, g]) for z in np.linspace(math.log(0.004), 0.0, 20) for g in gaps]
        best = min(grid, key=cost)
        free = 2 if gaps[-1] else 1
        simplex = np.vstack([best, best + np.diag([0.2, 0.03])])[: free + 1, :free]
        options = {"initial_simplex": simplex, "xatol": 1e-6, "fatol": 1e-10}
        search: Any = minimize  # its stubs know no function of an array of any shape
        way = {"method": "Nelder-Mead", "options": options}
        at = search(lambda p: cost(np.append(p, 0.0)), best[:free], **way).x
        return np.array([at[0], abs(at[1]) if free == 2 else 0.0])

    simple = _of_slider(design, column, searched([0.0]), gap=False)
    if not backlash:
        return simple
    other = _of_slider(design, column, searched([0.03, 0.1, 0.2, 0.3]), gap=True)
    return other if other.values["F_k"] > 0.0 and predicts_better(other, simple) else simple


def _of_slider(
    design: Design, column: Callable[[Array], Array], at: Array, *, gap: bool
) -> LoopFit:
    """Return the fit at ln Z_m/X and g/X; one step of Gauss and Newton leaves a block out, with the columns
    F_k ∂s/∂ln Z_m and F_k ∂s/∂(g/X)."""
    (p, _), s, step = design.solved(column(at)), column(at), 1e-4
    slopes = [
        p[0] * (column(at + step * e) - column(at - step * e)) / (2.0 * step)
        for e in np.eye(2)[: 1 + gap]
    ]
    A, model = np.array([s, *slopes, *design.linear]).T, np.array([s, *design.linear]).T @ p
    out = _without_each_block(A, design.f - model, design.block, design.blocks)
    n, F_k, Z = 1 + len(slopes), float(p[0]), design.X * math.exp(at[0])
    K_z = F_k / Z
    changes = {
        "F_k": out[:, 0],
        "K_z": K_z * (out[:, 0] / F_k - out[:, 1]),
        "k": out[:, n],
        **({"c": out[:, -1]} if design.with_c else {}),
        **({"g": design.X * out[:, 2]} if gap else {}),
    }
    values = {"F_k": F_k, "K_z": K_z, "k": float(p[1])}
    values |= {"c": float(p[-1])} if design.with_c else {}
    values |= {"g": design.X * float(at[1])} if gap else {}
    slipping = float(np.mean(np.abs(s) > 1.0 - 1e-9))
    contact = np.array([Z]), np.array([K_z])
    return _made(design, values, changes, contact, A @ out.T, model, slipping, s)


def fit_gradual(
    design: Design, count: int = SLIDERS, within: tuple[float, float] = WITHIN
) -> LoopFit:
    """Fit many sliders in parallel by least squares, refitted without each block; neither they nor spring and damper
    push.   within : the smallest and the largest r/X of them."""
    from scipy.optimize import nnls  # slow to import

    r = design.X * np.geomspace(*within, count)
    x, *offsets = design.base
    damper = [design.v] if design.with_c else []
    A = np.array([*(design.sliders(r) / r[:, None]), x, *damper, *offsets]).T
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
    out = np.array([solved(G - g, y - s) - p for g, s in zip(grams, sides, strict=True)])
    model, moved = A @ p, A @ out.T
    p, out = p / scale, out / scale
    forces = slice(None, count)

    def numbers(of: Array) -> dict[str, Array]:
        found = {"F_k": of[..., forces].sum(axis=-1), "K_z": (of[..., forces] / r).sum(axis=-1)}
        found["k"] = of[..., count]
        return found | ({"c": of[..., count + 1]} if damper else {})

    values = {name: float(of) for name, of in numbers(p).items()}
    largest = r[p[forces] > 0.0].max(initial=0.0)
    slipping = float(np.mean(np.abs(design.sliders(np.array([largest]))[0]) > largest * (1 - 1e-9)))
    share = (A[:, forces] * scale[forces]) @ p[forces] / (values["F_k"] or 1.0)
    return _made(design, values, numbers(out), (r, p[forces] / r), moved, model, slipping, share)


def _made(
    design: Design,
    values: dict[str, float],
    changes: dict[str, Array],
    contact: tuple[Array, Array],
    moved: Array,
    model: Array,
    slipping: float,
    share: Array,
) -> LoopFit:
    """Return a fit with the errors that its changes without each block make.   moved : changes of the model, (n, b)."""
    covariance = _covariance(np.array([*changes.values()]).T)
    errors = dict(zip(changes, np.sqrt(np.diag(covariance)).tolist(), strict=True))
    names = [n for n in ("F_k", "c", "K_z") if n in changes]
    at = [[*changes].index(n) for n in names]
    left = design.f - model
    without = left - moved[np.arange(left.size), design.block]
    predicted = np.array([np.sum(without[design.block == b] ** 2) for b in range(design.blocks)])
    ends = np.cumsum([own.sum() for own in design.inside])[:-1]
    models, covariance = tuple(np.split(model, ends)), covariance[np.ix_(at, at)]
    return LoopFit(
        values=values,
        errors=errors,
        covariance=covariance,
        freedom=design.blocks - 1,
        r=contact[0],
        kappa=contact[1],
        models=models,
        total=float(left @ left),
        slipping=slipping,
        predicted=predicted,
        samples=left.size,
        share=share,
    )


def fall_with_speed(design: Design, fit: LoopFit) -> tuple[float, float]:
    """Return by which part of F_k the friction is larger at rest than at speed, negative for a rise, where a term
    F_k e^{−(ẋ/v_S)²} predicts blocks that are left out clearly better (Stribeck), and by which part F_k changes then;
    else zeros."""
    from scipy.stats import ttest_rel  # slow to import

    left = design.f - np.concatenate(fit.models)
    changes, best = (0.0, 0.0), fit.predicted
    for part in _STRIBECK:
        at_rest = fit.share * np.exp(-((design.v / (part * np.abs(design.v).max())) ** 2))
        A = np.array([at_rest, fit.share, *design.linear]).T
        p = np.linalg.lstsq(A, left)[0]
        out = _without_each_block(A, left - A @ p, design.block, design.blocks)
        without = left - np.sum(A * (p + out[design.block]), axis=1)
        of = np.array([np.sum(without[design.block == b] ** 2) for b in range(design.blocks)])
        test = ttest_rel(fit.predicted, of, alternative="greater")
        if test.pvalue < _P_CONSTANT and of.sum() < best.sum():
            changes, best = (float(p[0]) / fit.values["F_k"], float(p[1]) / fit.values["F_k"]), of
    return changes


def predicts_better(one: LoopFit, other: LoopFit) -> bool:
    """Return whether a fit predicts blocks of cycles that are left out better than another one does, by the scatter of
    the differences between blocks."""
    from scipy.stats import ttest_rel  # slow to import

    test = ttest_rel(other.predicted, one.predicted, alternative="greater")
    return bool(test.pvalue < _P_SIMPLER)


def slips(fit: LoopFit) -> bool:
    """Return whether the contact slips for certain, and long enough for F_k to be determined."""
    return fit.slipping > _SLIPPING and fit.values["F_k"] > _CERTAIN * fit.errors["F_k"]
