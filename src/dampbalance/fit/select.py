"""Models weighed by their evidence, where one would otherwise be chosen: the only place that compares models.

The plain model M_0 may lack something: a candidate M_j has one unknown v more (a delay, a spring that hardens, a term
of the damping), which M_0 holds at zero. How large such an unknown is in rigs is known beforehand: a share π_j has it,
with sizes N(0, τ_j²), or the positive half of it (`PRIORS`). With its estimate v̂ ± e, and χ² measured in the noise,

    ln B_j = ½ ln(e²/(e² + τ²)) + ½ (χ²_0 − χ²_j) − ½ v̂²/(e² + τ²)      (+ ln 2Φ(μ/σ) for the positive half)

is the logarithm of its Bayes factor (Laplace), μ = v̂ τ²/(e² + τ²) and σ² = e² τ²/(e² + τ²) the moments of v that are
left. To first order χ²_0 − χ²_j = v̂²/e², so that the score test (`score.py`) gives all of it without another fit; a
candidate whose weight exceeds `REFITTED` is fitted. The weights are w_j ∝ π_j B_j, and the numbers θ those of all
models,

    θ = Σ w_j θ_j,      C = Σ w_j (C_j + Δ_j Δ_jᵀ),      Δ_j = θ_j − θ

(Hoeting, Madigan, Raftery & Volinsky, Stat. Sci. 14, 1999). A departure that passed a test is on average too large, and
the interval of the model that has it does not know of the test: averaged, it does.

What even the best model leaves beyond the noise is taken for noise of as many values as are independent in it, and
scales all errors. The departure that it comes from is then none of the candidates, and the plain model has no better a
claim than all of them together.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy import optimize, special

from ..arrays import Array
from .score import Departure

REFITTED = 0.1
"""Weight above which a candidate that is known to first order is fitted."""

CLEAR = 0.9
"""Weight above which a model stands for all others: further candidates are tested from it, and a sentence names it."""

NOISE_ALONE = 1e-4
"""Probability of a χ² below which the best model leaves more than noise."""

_MOST, _MOST_FAR = 3, 4
"""Most departures of a model, as data do not determine more; most candidates that are fitted where no model explains
the data."""


class Prior(NamedTuple):
    """Prior knowledge of a departure.

    share : π, the share of rigs that have it.   size : τ, its standard deviation among them, in multiples of `unit`.
    positive : whether it cannot be negative.
    """

    share: float
    size: float
    unit: str
    positive: bool = False


PRIORS: Mapping[str, Prior] = {
    # channels
    "delay": Prior(0.01, 2.0, "sample interval"),
    "gain": Prior(0.01, 0.02, "gain"),
    "corner": Prior(0.01, 0.03, "frequency of the slowest record", positive=True),
    "frame": Prior(0.005, 1.0, "none: the response is relative or absolute"),
    # friction
    "friction_level": Prior(0.02, 0.1, "F_k"),
    "friction_speed": Prior(0.02, 0.15, "F_k", positive=True),
    "falling": Prior(0.03, 0.5, "F_k"),
    "fading": Prior(0.05, 0.15, "F_k"),
    "frictions": Prior(0.1, 0.05, "F_k"),
    # contact
    "gradual": Prior(0.1, 0.5, "contact of Iwan", positive=True),
    "gradual in decays": Prior(0.2, 0.5, "contact of Iwan", positive=True),
    # stepped sine: models that are no extensions of each other, without a size
    "gradual contact": Prior(0.4, math.inf, "none"),
    "none contact": Prior(0.03, math.inf, "none"),
    "further damping": Prior(0.03, math.inf, "none"),
    "smoothness": Prior(0.25, math.inf, "none"),
    "gap": Prior(0.03, 0.1, "X", positive=True),
    "knee": Prior(0.03, 0.5, "1/n of a rounded knee", positive=True),
    "dahl": Prior(0.02, 1.0, "none: the knee is Dahl's or not"),
    "fall": Prior(0.03, 0.15, "F_k, at rest", positive=True),
    "rounded": Prior(0.02, 0.3, "largest speed", positive=True),
    "each": Prior(0.03, 0.1, "F_k, of each record"),
    # forces at steady speeds: laws beyond the line, without a size, too
    "steady F_S": Prior(0.06, math.inf, "none"),
    "steady exponential": Prior(0.06, math.inf, "none"),
    "steady v_0": Prior(0.1, math.inf, "none"),
    "steady c_2": Prior(0.08, math.inf, "none"),
    # spring and damper
    "m": Prior(0.03, 0.1, "k over ω²", positive=True),
    "k_3": Prior(0.02, 0.02, "k over X²"),
    "pendulum": Prior(0.1, 0.0, "none: the spring of a rotation is gravity"),
    "c_2": Prior(0.02, 0.2, "c over ωX", positive=True),
    "c_2 in decays": Prior(0.12, 0.3, "c over ωX", positive=True),
    # laws of damping: each term, friction among them
    "law": Prior(0.2, 0.5, "coefficient that takes all of the work", positive=True),
}
"""The one table of departures: how many rigs have each, and of what size."""


@dataclass(frozen=True, eq=False)
class Model:
    """A model, and what it says of the numbers.

    name : of what it has beyond the plain one, empty for that.   share : a priori.   evidence : ln of its Bayes factor
    against the plain one.   values, covariance : of the numbers, (p,), (p, p).   fit : None where it is known to first
    order only.   size : of the departure, with its standard error.
    """

    name: str
    share: float
    evidence: float
    values: Array
    covariance: Array
    fit: Any = None
    size: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Candidate:
    """A model to be weighed against the plain one.

    name : of its departure, the key of that unknown in its fit.   prior : with the size in the unit of the unknown.
    tested : what the score test says of it; None where it has to be fitted.   fitted : returns its fit; None where it
    has none.   evidence : ln of its Bayes factor, of a fit; default, that of the equation above.
    """

    name: str
    prior: Prior
    fitted: Callable[[], Any]
    tested: Departure | None = None
    evidence: Callable[[Any], float] | None = None


@dataclass(frozen=True, eq=False)
class Selection:
    """Models with their weights, the numbers averaged over them, and the fit of the heaviest model.

    keys : of the numbers.   models, weights : the plain one first.   departures : names of those that the plain model
    of this selection has, in the order in which they became clear.   noise : factor on the variance of the noise.
    plain : the fit without any departure.
    """

    keys: tuple[str, ...]
    models: tuple[Model, ...]
    weights: tuple[float, ...]
    departures: tuple[str, ...] = ()
    noise: float = 1.0
    plain: Any = field(default=None)

    @property
    def best(self) -> Model:
        """The heaviest model that is fitted."""
        fitted = (i for i, model in enumerate(self.models) if model.fit is not None)
        return self.models[max(fitted, key=self.weights.__getitem__)]

    @property
    def fit(self) -> Any:
        """The fit of the heaviest model."""
        return self.best.fit

    @property
    def names(self) -> tuple[str, ...]:
        """The departures of the heaviest model."""
        return (*self.departures, *filter(None, [self.best.name]))

    def weight(self, name: str) -> float:
        """Return the weight of a model by name; 1 for a departure that all models have, 0 for one that was not
        weighed."""
        own = [w for model, w in zip(self.models, self.weights, strict=True) if model.name == name]
        return 1.0 if name in self.departures else math.fsum(own)

    def evidence(self, name: str) -> float:
        """Return ln of the Bayes factor of a model by name."""
        return next(one.evidence for one in self.models if one.name == name)

    @property
    def values(self) -> Array:
        """The numbers, means over all models, (p,)."""
        return np.asarray(np.average([one.values for one in self.models], 0, self.weights))

    @property
    def covariance(self) -> Array:
        """Covariance of the numbers, (p, p)."""
        off = [one.values - self.values for one in self.models]
        each = [m.covariance + np.outer(of, of) for m, of in zip(self.models, off, strict=True)]
        return np.asarray(np.average(each, 0, self.weights))

    def interval(self, key: str, probability: float = 0.95) -> tuple[float, float]:
        """Return the interval that contains a number with some probability, by the mixture of the normal distributions
        of all models: a model of little weight widens it little, however far it is from the others."""
        at, weights = self.keys.index(key), np.array(self.weights)
        centres = np.array([one.values[at] for one in self.models])
        errors = np.sqrt(np.array([one.covariance[at, at] for one in self.models]))
        if not errors.any():
            return float(self.values[at]), float(self.values[at])
        # a model without the number says that it is zero
        errors = np.maximum(errors, 1e-9 * float(errors.max()))

        def beyond(x: float, p: float) -> float:
            return float(weights @ special.ndtr((x - centres) / errors)) - p

        far = 10.0 * errors
        whole = float(np.min(centres - far)), float(np.max(centres + far))
        low, high = (
            optimize.brentq(
                beyond, *whole, args=(0.5 + by * probability,), xtol=1e-6 * float(errors.min())
            )
            for by in (-0.5, 0.5)
        )
        return low, high

    def moved_by(self, name: str) -> dict[str, float]:
        """Return the change of each number that comes with the share of a model, w_j Δ_j, relative to the number or,
        where that is larger, to its error."""
        at = next(i for i, model in enumerate(self.models) if model.name == name)
        plain = self.models[0]
        sizes = np.maximum(np.abs(plain.values), np.sqrt(np.diag(plain.covariance)))
        by = self.weights[at] * (self.models[at].values - plain.values)
        pairs = zip(self.keys, by.tolist(), sizes.tolist(), strict=True)
        return {key: part / size for key, part, size in pairs if size}


def select(
    fit: Any,
    candidates: Sequence[Candidate],
    keys: Sequence[str],
    *,
    noise: float | None = None,
    further: Callable[[Any, tuple[str, ...]], Sequence[Candidate]] | None = None,
    departures: tuple[str, ...] = (),
) -> Selection:
    """Weigh the candidates and the plain model.

    Use it instead of choosing a model by a test: the numbers are averages over the models that the data cannot
    distinguish.

    fit : of the plain model, with `chi_square` and `freedom` in units of the noise.   keys : of the numbers, as
    `value` and `covariance_of` of the fits take them; a candidate known to first order has them in its slopes.
    noise : factor on the variance of the noise, where it is known; default, from the residual of the best model.
    further : returns the candidates for a second departure, from a fit and the names of those it has; default, none.
    departures : that the plain model has.
    """
    keys = tuple(keys)
    fits: dict[str, Any] = {
        one.name: end
        for one in candidates
        if one.tested is None and (end := one.fitted()) is not None
    }
    known = [one for one in candidates if one.tested is not None or one.name in fits]
    failed: set[str] = set()
    while True:
        found = _weighed(fit, known, fits, keys, noise, departures)
        left = [one for one in known if one.name not in fits and one.name not in failed]
        # those for which the records speak by a factor of e
        likely = [one for one in left if found.evidence(one.name) > 1.0]
        asked = [one for one in likely if found.weight(one.name) > REFITTED]
        # far from the data the first order is no guide to which of the likeliest explains them
        far = noise_of(found.fit.chi_square, found.fit.freedom) > 1.0
        if not asked and far and len(fits) < _MOST_FAR:
            asked = likely
        if not asked:
            break
        one = max(asked, key=lambda one: found.evidence(one.name))
        end = one.fitted()
        if end is None:
            failed.add(one.name)
        else:
            fits[one.name] = end
    best = found.best
    clear = best.name and found.weight(best.name) > CLEAR and len(departures) + 1 < _MOST
    if not clear or further is None:
        return found
    names = (*departures, best.name)
    more = select(
        *(best.fit, further(best.fit, names), keys),
        noise=noise,
        further=further,
        departures=names,
    )
    return replace(more, plain=found.plain)


def noise_of(chi_square: float, freedom: float, independent: float = math.inf) -> float:
    """Return the factor on the variance of the noise that explains χ²; 1 where the stated noise explains it.

    chi_square, freedom : χ² and its degrees of freedom.   independent : number of independent values in a residual
    beyond the noise, which is smooth; default, the degrees of freedom.
    """
    beyond = chi_square / max(freedom, 1.0) - 1.0
    if beyond <= 0.0 or special.chdtrc(max(freedom, 1.0), chi_square) > NOISE_ALONE:
        return 1.0
    return 1.0 + beyond * max(1.0, freedom / independent)


def bayes_factor(
    value: float, error: float, prior: Prior, fall: float | None = None
) -> tuple[float, float, float]:
    """Return ln of the Bayes factor for one more unknown, and the mean and variance of its posterior distribution.

    value, error : its estimate v̂ and standard error e.   prior : its size before any record, in the same unit.
    fall : by how much the unknown lowers χ²; default, v̂²/e².
    """
    e2, tau2 = error**2, prior.size**2
    mean, variance = value * tau2 / (e2 + tau2), e2 * tau2 / (e2 + tau2)
    fall = value**2 / e2 if fall is None else fall
    factor = 0.5 * (math.log(e2 / (e2 + tau2)) + fall - value**2 / (e2 + tau2))
    if not prior.positive:
        return factor, mean, variance
    sigma = math.sqrt(variance)
    z = mean / sigma
    of_half = float(special.log_ndtr(z))
    # mean and variance of the positive half of a normal distribution
    ratio = math.exp(-0.5 * z * z - 0.5 * math.log(2.0 * math.pi) - of_half)
    return (
        factor + math.log(2.0) + of_half,
        mean + sigma * ratio,
        variance * max(1.0 - ratio * (ratio + z), 0.0),
    )


def evidence_of(
    fall: float, values: Array, covariance: Array, sizes: ArrayLike, *, positive: bool
) -> float:
    """Return ln of the Bayes factor of several unknowns with prior standard deviations τ:

        ½ Δχ² + ½ ln |C|/|C + T| − ½ v̂ᵀ (C + T)⁻¹ v̂      (+ Σ ln 2Φ(μ_j/σ_j) where none is negative),   T = diag τ²

    Use it for models with several unknowns more; for one it is `bayes_factor`.

    fall : Δχ², by which the unknowns lower χ² in the noise; of models none of which contains all others, −χ² itself.
    values, covariance : v̂ and C.   sizes : τ, of each or of all.   positive : whether none of them is negative.
    """
    sizes = np.broadcast_to(sizes, values.shape)
    v, C = values / sizes, covariance / np.outer(sizes, sizes)
    S = C + np.eye(v.size)
    mean, ratio = np.linalg.solve(S, v), np.linalg.slogdet(C)[1] - np.linalg.slogdet(S)[1]
    evidence = float(0.5 * (fall + ratio - v @ mean))
    if not positive:
        return evidence
    variance = np.maximum(np.diag(C - C @ np.linalg.solve(S, C)), 1e-300)
    return evidence + float(np.sum(special.log_ndtr(mean / np.sqrt(variance)) + math.log(2.0)))


def _weighed(
    fit: Any,
    candidates: Sequence[Candidate],
    fits: Mapping[str, Any],
    keys: tuple[str, ...],
    noise: float | None,
    departures: tuple[str, ...],
) -> Selection:
    """Return the plain model and the candidates, some of which are fitted, with their weights."""
    # what the best of them leaves; to first order of those that are not fitted
    left = [(fit.chi_square, fit.freedom), *((e.chi_square, e.freedom) for e in fits.values())]
    left += [
        (fit.chi_square - one.tested.size**2, fit.freedom - 1.0)
        for one in candidates
        if one.tested is not None and one.name not in fits
    ]
    noise = noise or min(noise_of(*of) for of in left)
    values = np.array([fit.value(key) for key in keys])
    covariance = noise * fit.covariance_of(*keys)
    shares = math.fsum(one.prior.share for one in candidates)
    own = (shares or 1.0) if noise > 1.0 else max(1.0 - shares, shares)
    models = [Model("", own, 0.0, values, covariance, fit)]
    for one in candidates:
        if one.name in fits:
            models.append(_fitted(one, fit, fits[one.name], keys, noise))
        elif one.tested is not None:
            models.append(_to_first_order(one, one.tested, models[0], keys, noise))
    logs = np.array([math.log(one.share) + one.evidence for one in models])
    weights = np.exp(logs - logs.max())
    weights /= weights.sum()
    return Selection(keys, tuple(models), tuple(weights.tolist()), departures, noise, fit)


def _fitted(one: Candidate, plain: Any, end: Any, keys: tuple[str, ...], noise: float) -> Model:
    """Return a candidate that is fitted."""
    size = (0.0, 0.0)
    values = np.array([end.value(key) for key in keys])
    covariance = noise * end.covariance_of(*keys)
    with suppress(KeyError):  # one without an unknown of its name
        size = end.value(one.name), end.error(one.name) * math.sqrt(noise)
    (value, error), evidence = size, -math.inf
    if error > 0.0 and 0.0 < one.prior.size < math.inf:
        fall = (plain.chi_square - end.chi_square) / noise
        evidence, mean, variance = bayes_factor(value, error, one.prior, fall)
        # the numbers follow the unknown from its estimate to what the prior leaves of it
        by = noise * end.covariance_of(*keys, one.name)[:-1, -1] / error**2
        values = values + by * (mean - value)
        covariance = covariance - np.outer(by, by) * (error**2 - variance)
    if one.evidence is not None:
        evidence = one.evidence(end)
    return Model(one.name, one.prior.share, evidence, values, covariance, end, size)


def _to_first_order(
    one: Candidate, tested: Departure, plain: Model, keys: tuple[str, ...], noise: float
) -> Model:
    """Return a candidate by the score test: the numbers of the plain model, and their slopes times its unknown."""
    error = tested.error * math.sqrt(noise)
    evidence, mean, variance = bayes_factor(tested.value, error, one.prior)
    slopes = np.array([tested.slopes.get(key, 0.0) for key in keys])
    return Model(
        one.name,
        one.prior.share,
        evidence,
        plain.values + slopes * mean,
        plain.covariance + np.outer(slopes, slopes) * variance,
        size=(mean, math.sqrt(variance)),
    )
