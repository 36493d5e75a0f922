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
from dataclasses import replace

import numpy as np

from ..arrays import Array, Mask
from ..balance import APPROACHES, Approach, Rows
from ..features import Features, Phase, of_orbit, stack
from ..reading.noisy import Reading
from ..reading.one_thread import one_thread
from ..reading.waveforms import Fit
from ..solver import Estimate, least_squares, solve
from .microstick import Sample, Samples, microstick, read_samples
from .notes import agreement, with_notes
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
MOST_REPLICATES = 10_000
"""More tell nothing new: the standard error of a standard error is 0.7 % of it then."""

SEED = 2010

_COPIED = 1e-9  # of the largest harmonic: what writing a record in another format may change


@one_thread
def identify(
    readings: Sequence[Reading],
    k: float,
    *,
    approaches: Mapping[str, Approach] = APPROACHES,
    phase: Phase = "reversal",
    mass: float | None = None,
    replicates: int = REPLICATES,
    seed: int = SEED,
) -> Identification:
    """F_k, c and K_z from the features of n ≥ 2 measured responses, by each approach, with intervals.

    readings : of `read_features`, one per level; levels that differ.   k : stiffness, N/m, that of the readings.
    approaches : by name.   phase : that the harmonic approaches take.   mass : kg, if it is known.
    replicates : of the bootstrap.   seed : of its drawings.

    Raises ValueError for fewer than two readings, two of the same signals, a stiffness or a mass that is not positive,
    a stiffness that is not that of the readings, and too few or too many replicates. An approach whose rows cannot be
    solved stays in the result with NaN and its reason.
    """
    _require(readings, k, approaches, replicates)
    if mass is not None and not (math.isfinite(mass) and mass > 0.0):
        raise ValueError(f"the mass must be a positive number of kg, got {mass}")
    whole = whole_oscillator([reading.lines for reading in readings], k, mass)
    readings = joined(readings, whole)
    samples = read_samples(readings, replicates, np.random.default_rng(seed))
    line = microstick(samples)
    estimates = {
        name: _result(name, way, samples, line, whole, k, phase) for name, way in approaches.items()
    }
    estimates = with_notes(estimates, readings, whole)
    of_records = [f"{r.steady.source}: {words}" for r in readings for words in r.warnings]
    return Identification(
        k=k,
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
    readings: Sequence[Reading], k: float, approaches: Mapping[str, Approach], replicates: int
) -> None:
    if not (math.isfinite(k) and k > 0.0):
        raise ValueError(f"the stiffness k must be a positive number of N/m, got {k}")
    if len(readings) < 2:
        raise ValueError(
            f"F_k and c need responses at two levels or more, got {len(readings)}: add records at other amplitudes"
        )
    for reading in readings:
        if reading.steady.k != k:
            raise ValueError(
                f"{reading.steady.source} was read with k = {reading.steady.k:g} N/m, not with {k:g} N/m"
            )
    if not 2 <= replicates <= MOST_REPLICATES:
        raise ValueError(f"replicates must be 2 to {MOST_REPLICATES}, got {replicates}")
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


_UNTOLD = "this approach needs the onset of slip, which these records do not tell"
_NOTHING = ParameterEstimate(math.nan, math.nan, math.nan, Interval(math.nan, math.nan))


def _result(
    name: str,
    approach: Approach,
    samples: Samples,
    line: Microstick,
    whole: Whole,
    k: float,
    phase: Phase,
) -> ApproachResult:
    """The estimates of one approach, with standard errors and intervals."""

    def rows_of(sample: Sample) -> Rows:
        return rows_with_onset(approach(sample.features.with_phase(phase), k), whole)

    rows = rows_of(samples.point)
    try:
        least_squares(rows)
    except ValueError as error:
        nothing = dict.fromkeys(approach.terms, _NOTHING)
        unknown = np.full(len(rows.W), math.nan)
        untold = not (whole.waveforms_hold or whole.linear)
        reason = (_UNTOLD if untold and not rows.usable.any() else str(error),)
        return ApproachResult(
            name, nothing, nothing, _NOTHING, {}, {}, math.nan, math.nan, rows, unknown, reason
        )
    drawn = rows_of(samples.drawn)
    left = [rows_of(sample) for sample in samples.left]
    covariance = drawn.scatter()
    estimate = solve(replace(rows, covariance=covariance))
    weights = replace(rows, covariance=covariance).weighted(estimate.values).weights
    assert weights is not None
    known = weights if np.isfinite(weights[rows.usable]).all() else np.ones(len(weights))
    of_drawn, of_left = solve(_weighing(drawn, known)), [solve(_weighing(r, known)) for r in left]
    plain, plain_drawn, plain_left = solve(rows), solve(drawn), [solve(r) for r in left]
    values = {symbol: float(value) for symbol, value in estimate.values.items()}
    freedom = int(estimate.n) - len(values)
    symbols = [symbol for symbol in approach.terms if symbol in values]
    W = rows.W[rows.usable]
    off = rows.misfit({**rows.given, **values})[rows.usable]
    return ApproachResult(
        approach=name,
        coefficients=dict.fromkeys(approach.terms, _NOTHING)
        | _parameters(symbols, estimate, of_drawn, of_left),
        equal=dict.fromkeys(approach.terms, _NOTHING)
        | _parameters(symbols, plain, plain_drawn, plain_left),
        K_z=_stiffness(samples, line, estimate, of_drawn, of_left),
        shape_bias=_shape_bias(approach, whole.fit, k, phase, known, rows.usable)
        if whole.waveforms_hold and whole.fit is not None
        else {},
        correlations={
            (one, other): float(np.corrcoef(of_drawn[one], of_drawn[other])[0, 1])
            for one, other in itertools.combinations(symbols, 2)
        },
        residual=float(np.linalg.norm(off) / np.linalg.norm(W)) if freedom else math.nan,
        misfit=float(known[rows.usable] @ off**2) / freedom
        if freedom and known is weights
        else math.nan,
        rows=rows,
        row_errors=1.0 / np.sqrt(weights),
    )


def rows_with_onset(rows: Rows, whole: Whole) -> Rows:
    """The rows; where nothing slips, those of W = b c."""
    if whole.linear:
        none = {"F_k": np.zeros(rows.W.shape)}
        return replace(rows, terms={**rows.terms, **none}, given={"F_k": 0.0})
    return rows


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
    approach: Approach, fit: Fit, k: float, phase: Phase, weights: Array, used: Mask
) -> dict[str, float]:
    """What the approach makes of the exact responses of the oscillator found, relative to its coefficients."""
    exact: Features = stack([of_orbit(orbit) for orbit in fit.orbits]).with_phase(phase)
    found = solve(replace(approach(exact, k), weights=weights)[used])
    return {
        symbol: float(found[symbol]) / getattr(fit, symbol) - 1.0
        for symbol in found.values
        if getattr(fit, symbol, 0.0) > 0.0
    }


def _stiffness(
    samples: Samples,
    line: Microstick,
    estimate: Estimate,
    drawn: Estimate,
    left: Sequence[Estimate],
) -> ParameterEstimate:
    """K_z = 2F_k/L (10), from the root of its inverse, whose errors are nearly normal; a lower limit where the line is
    not resolved."""
    if "F_k" not in estimate.values or not float(estimate["F_k"]) > 0.0:
        return _NOTHING
    if not math.isfinite(line.length):
        return _NOTHING

    def root(sample: Sample, F_k: Array) -> Array:
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(sample.rho * np.sqrt(np.maximum(sample.F_k / F_k, 0.0)))

    here = float(root(samples.point, estimate["F_k"])[0])
    parts = [root(sample, e["F_k"]) for sample, e in zip(samples.left, left, strict=True)]
    found = _parameter(here, root(samples.drawn, drawn["F_k"]), parts)
    low, high = found.interval
    if not line.resolved:
        return ParameterEstimate(math.inf, math.nan, math.nan, Interval(high**-2, math.inf))
    slope = 2.0 * here**-3
    return ParameterEstimate(
        here**-2,
        slope * found.standard_error,
        slope * found.propagated_error,
        Interval(high**-2, low**-2 if low > 0.0 else math.inf),
    )


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
