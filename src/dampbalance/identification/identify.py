"""F_k, c and K_z from measured responses at several levels, by every approach, with standard errors and intervals.

Each response gives one row a F_k + b c = W of the energy balance (6); rows of different frequencies go together, since
neither F_k nor c knows the frequency. A row weighs as much as its misfit is sure; Eq. (9) as published, where all weigh
alike, stands beside.

What a row needs of the onset of slip comes from the waveforms of one oscillator fitted to all records. Where the
records are not those of such an oscillator, nothing is known of the onset, and K_z is not identified: direct
integration then takes a = 4X − λ with the λ of the oscillator that comes nearest, a small part of 4X where the contact
is stiff. A level that does not slip leaves the balance; where none slips, F_k is unknown, and W = b c gives c.

The effect of noise on the estimates is computed twice: by bootstrap (cycles of every record drawn with replacement, the
balance solved for each drawing) and by propagation (the jackknife: one cycle of one record left out after the other).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import number, whole
from ..arrays import Array, Mask
from ..balance import APPROACHES, Approach, Rows
from ..features import Features, Phase, stack
from ..law.law import Law
from ..law.terms import FRICTION, parted
from ..reading.noisy import Reading
from ..reading.one_thread import one_thread
from ..solver import Estimate, least_squares, solve
from .microstick import Sample, Samples, microstick, read_samples
from .notes import YARDSTICK, agreement, with_notes
from .oscillator import Whole, joined, whole_oscillator
from .result import (
    CONFIDENCE,
    ApproachResult,
    Identification,
    Interval,
    Microstick,
    ParameterEstimate,
)

REPLICATES = 1000
SEED = 2010

_COPIED = 1e-9  # of the largest harmonic: what writing a record in another format may change


@one_thread
def identify_readings(
    readings: Sequence[Reading],
    k: float,
    *,
    law: Law | None = None,
    approaches: Mapping[str, Approach] = APPROACHES,
    phase: Phase = "reversal",
    mass: float | None = None,
    replicates: int = REPLICATES,
    seed: int = SEED,
) -> Identification:
    """The coefficients of a damping law and K_z from the features of n measured responses, by each approach, with
    intervals.

    readings : of `read_features`, one per level; levels that differ, as many as there are unknowns.   k : stiffness,
    N/m, that of the readings.   law : default, F_k and c.
    approaches : by name.   phase : that the harmonic approaches take.   mass : kg, if it is known.
    replicates : of the bootstrap.   seed : of its drawings.

    Raises ValueError for fewer readings than unknowns, terms that act alike in all of them, two of the same signals, a
    stiffness or a mass that is not positive, a stiffness that is not that of the readings, and too few or too many
    replicates. An approach whose rows cannot be solved stays in the result with NaN and its reason.
    """
    law = law or Law()
    _require(readings, k, law, approaches, replicates)
    if mass is not None:
        number("mass", mass)
    whole = whole_oscillator([reading.lines for reading in readings], k, mass, law)
    readings = joined(readings, whole, law)
    samples = read_samples(readings, replicates, np.random.default_rng(seed))
    line = microstick(samples)
    estimates = {
        name: _result(name, RowsOf(way, law, whole, k, phase), readings, samples, line)
        for name, way in approaches.items()
    }
    estimates = with_notes(estimates, readings, whole)
    of_records = [f"{r.steady.source}: {words}" for r in readings for words in r.warnings]
    return Identification(
        k=k,
        law=law,
        phase=phase,
        readings=tuple(readings),
        whole=whole,
        features=samples.point.features.with_phase(phase),
        microstick=line,
        estimates=estimates,
        replicates=replicates,
        seed=seed,
        warnings=(*of_records, *agreement(readings, line, whole, estimates)),
    )


def _require(
    readings: Sequence[Reading],
    k: float,
    law: Law,
    approaches: Mapping[str, Approach],
    replicates: int,
) -> None:
    number("stiffness", k)
    whole("replicates", replicates)
    law.require([reading.steady.frequency_hz for reading in readings])
    for reading in readings:
        if reading.steady.k != k:
            raise ValueError(
                f"{reading.steady.source} was read with k = {reading.steady.k:g} N/m, not with {k:g} N/m"
            )
    for reading, other in itertools.combinations(readings, 2):
        if _same(reading, other):
            raise ValueError(
                f"{reading.steady.source} and {other.steady.source} hold the same signals: each record is one level"
            )
    if not approaches:
        raise ValueError(f"no approach is asked for; known are {', '.join(APPROACHES)}")


def _same(one: Reading, other: Reading) -> bool:
    """Whether two records are copies of one, in whatever format: their cycles have the same harmonics."""
    rows, others = one.steady.X, other.steady.X
    bound = _COPIED * abs(rows[0, 1])
    if rows.shape != others.shape or not abs(rows[0, 1] - others[0, 1]) < bound:
        return False
    return bool(np.abs(rows - others).max() < bound)


_NO_FORM = "this approach has no form of a term of the law"
_UNTOLD = "this approach needs the onset of slip, which these records do not tell"
_NOTHING = ParameterEstimate(math.nan, math.nan, math.nan, Interval(math.nan, math.nan))


@dataclass(frozen=True, eq=False)
class RowsOf:
    """How one approach makes rows of the balance of a law.

    whole : the oscillator behind the records.   k : N/m.   phase : that the harmonic approaches take.
    """

    approach: Approach
    law: Law
    whole: Whole
    k: float
    phase: Phase

    def __call__(self, features: Features, k: ArrayLike | None = None) -> Rows:
        """The rows of features, with a column for each coefficient. Where nothing slips, friction has none; nor has a
        coefficient whose records all lack rows.   k : N/m; default, that of the records."""
        stiffness = self.k if k is None else k
        rows = self.approach(features.with_phase(self.phase), stiffness, self.law.terms)
        if self.whole.linear:
            rows = replace(rows, terms={**rows.terms, FRICTION: np.zeros(rows.W.shape)})
        rows = rows.of_law(self.law)
        kept = rows.usable
        empty = [key for key, g in rows.terms.items() if not np.where(kept, g, 0.0).any()]
        return replace(rows, given={**rows.given, **dict.fromkeys(empty, 0.0)})


def _result(
    name: str, rows_of: RowsOf, readings: Sequence[Reading], samples: Samples, line: Microstick
) -> ApproachResult:
    """The estimates of one approach, with standard errors and intervals."""
    whole, unknowns = rows_of.whole, rows_of.law.unknowns
    rows = rows_of(samples.point.features)
    drawn = rows_of(samples.drawn.features)
    left = [rows_of(sample.features) for sample in samples.left]
    covariance = drawn.scatter()
    try:
        estimate = least_squares(replace(rows, covariance=covariance))
    except ValueError as error:
        untold = not whole.waveforms_hold and not whole.linear and name != YARDSTICK
        unshaped = any(
            np.isnan(g).all() and parted(key)[0] not in rows_of.approach.terms
            for key, g in rows.terms.items()
        )
        reason = _NO_FORM if unshaped else _UNTOLD if untold else str(error)
        nothing = dict.fromkeys(unknowns, _NOTHING)
        return ApproachResult(
            approach=name,
            coefficients=nothing,
            equal=nothing,
            K_z=_NOTHING,
            shape_bias={},
            correlations={},
            residual=math.nan,
            misfit=math.nan,
            rows=rows,
            row_errors=np.full(len(rows.W), math.nan),
            notes=(reason,),
        )
    weights = replace(rows, covariance=covariance).weighted(estimate.values).weights
    assert weights is not None
    known = weights if np.isfinite(weights[rows.usable]).all() else np.ones(len(weights))
    of_drawn, of_left = solve(_weighing(drawn, known)), [solve(_weighing(r, known)) for r in left]
    plain, plain_drawn, plain_left = solve(rows), solve(drawn), [solve(r) for r in left]
    values = {symbol: float(value) for symbol, value in estimate.values.items()}
    freedom = int(estimate.n) - len(values)
    symbols = [symbol for symbol in unknowns if symbol in values]
    W = rows.W[rows.usable]
    off = rows.misfit({**rows.given, **values})[rows.usable]
    K_z, roots = _stiffness(samples, line, rows_of.law, estimate, of_drawn, of_left)
    errors = {symbol: of_drawn[symbol] for symbol in symbols}
    if roots is not None:
        errors["K_z"] = -roots  # K_z falls as its inverse root grows
    return ApproachResult(
        approach=name,
        coefficients=dict.fromkeys(unknowns, _NOTHING)
        | _parameters(symbols, estimate, of_drawn, of_left),
        equal=dict.fromkeys(unknowns, _NOTHING)
        | _parameters(symbols, plain, plain_drawn, plain_left),
        K_z=K_z,
        shape_bias=_shape_bias(rows_of, readings, known, rows.usable)
        if whole.waveforms_hold and whole.fit is not None
        else {},
        correlations={
            (one, other): float(np.corrcoef(errors[one], errors[other])[0, 1])
            for one, other in itertools.combinations(errors, 2)
        },
        residual=float(np.linalg.norm(off) / np.linalg.norm(W)) if freedom else math.nan,
        misfit=float(known[rows.usable] @ off**2) / freedom
        if freedom and known is weights
        else math.nan,
        rows=rows,
        row_errors=1.0 / np.sqrt(weights),
    )


def _weighing(rows: Rows, weights: Array) -> Rows:
    """Rows of replicates, (n, r), with the weights of the records, (n,)."""
    return replace(rows, weights=np.broadcast_to(weights[:, None], rows.W.shape))


def _parameters(
    symbols: Sequence[str], estimate: Estimate, drawn: Estimate, left: Sequence[Estimate]
) -> dict[str, ParameterEstimate]:
    return {
        symbol: _parameter(float(estimate[symbol]), drawn[symbol], [e[symbol] for e in left])
        for symbol in symbols
    }


def _shape_bias(
    rows_of: RowsOf, readings: Sequence[Reading], weights: Array, used: Mask
) -> dict[str, float]:
    """What the approach makes of the exact responses of the oscillator found, relative to its coefficients."""
    fit = rows_of.whole.fit
    assert fit is not None
    exact = stack([reading.exact_features for reading in readings])
    found = solve(replace(rows_of(exact), weights=weights)[used])
    return {
        key: float(found[key]) / fit.value(key) - 1.0
        for key in found.values
        if fit.value(key) > 0.0
    }


def _stiffness(
    samples: Samples,
    line: Microstick,
    law: Law,
    estimate: Estimate,
    drawn: Estimate,
    left: Sequence[Estimate],
) -> tuple[ParameterEstimate, Array | None]:
    """K_z = 2F_k/L (10), from the root of its inverse, whose errors are nearly normal, and that root of each drawing; a
    lower limit where the line is not resolved, without."""

    def friction(found: Estimate) -> Array:
        known = [
            found[key] if key in found.values else np.asarray(law.given.get(key, math.nan))
            for key in law.keys_of(FRICTION)
        ]
        mean: Array = np.mean(np.broadcast_arrays(*known), axis=0)
        return mean

    if not float(friction(estimate)) > 0.0 or not math.isfinite(line.length):
        return _NOTHING, None

    def root(sample: Sample, found: Estimate) -> Array:
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.maximum(sample.F_k / friction(found), 0.0)
            return np.asarray(sample.rho * np.sqrt(ratio))

    here = float(root(samples.point, estimate)[0])
    parts = [root(sample, e) for sample, e in zip(samples.left, left, strict=True)]
    roots = root(samples.drawn, drawn)
    found = _parameter(here, roots, parts)
    low, high = found.interval
    if not line.resolved:
        unbounded = Interval(high**-2, math.inf)
        return ParameterEstimate(math.inf, math.nan, math.nan, unbounded), None
    slope = 2.0 * here**-3
    K_z = ParameterEstimate(
        here**-2,
        slope * found.standard_error,
        slope * found.propagated_error,
        Interval(high**-2, low**-2 if low > 0.0 else math.inf),
    )
    return K_z, roots


def _parameter(value: float, drawn: Array, left: Sequence[Array]) -> ParameterEstimate:
    """Standard errors and interval of one number.

    drawn : of the bootstrap.   left : without groups of cycles of each record.
    The variances that the records contribute, v_i of g_i groups, give the degrees of freedom of their sum,
    (Σ v_i)²/Σ v_i²/(g_i − 1) (Welch–Satterthwaite), and those the quantile of Student's t.
    """
    from scipy import special  # slow to import, as scipy.stats with the same functions is

    error = float(drawn.std(ddof=1))
    parts = np.array([(len(p) - 1) / len(p) * np.sum((p - p.mean()) ** 2) for p in left])
    groups = np.array([len(p) for p in left])
    total = float(parts.sum())
    freedom = total**2 / float(np.sum(parts**2 / (groups - 1))) if total > 0.0 else math.inf
    reach = float(special.stdtrit(freedom, 0.5 + 0.5 * CONFIDENCE)) * error
    return ParameterEstimate(value, error, math.sqrt(total), Interval(value - reach, value + reach))
