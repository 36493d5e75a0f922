"""F_k, c and K_z from measured responses at several levels, by every approach, with standard errors and intervals.

Each response gives one row a F_k + b c = W of the energy balance (6); rows of different frequencies go together, since
neither F_k nor c knows the frequency. The microstick line has one length for all of them, X + X_s = 2F_k/K_z (10): the
weighted mean over the records serves each of them, also those that do not resolve it alone. Where the mean does not
stand out of its noise either, the contact is taken as rigid, and what that may cost is stated.

The effect of noise on the estimates is computed twice: by bootstrap (cycles of every record drawn with replacement, the
balance solved for each drawing) and by propagation (the jackknife: one cycle of one record left out after the other).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..arrays import Array
from ..balance import APPROACHES, Approach, Rows
from ..features import Phase
from ..reading.noisy import Reading
from ..reading.one_thread import one_thread
from ..solver import Estimate, contact_stiffness, least_squares, solve
from .microstick import SharedLine, share_line, with_length
from .notes import agreement, with_notes
from .result import CONFIDENCE, ApproachResult, Identification, Interval, ParameterEstimate

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
    replicates: int = REPLICATES,
    seed: int = SEED,
) -> Identification:
    """F_k, c and K_z from the features of n ≥ 2 measured responses, by each approach, with intervals.

    readings : of `read_features`, one per level; levels that differ.   k : stiffness, N/m, that of the readings.
    approaches : by name.   phase : that the harmonic approaches take.
    replicates : of the bootstrap.   seed : of its drawings.

    Raises ValueError for fewer than two readings, two of the same signals, a stiffness that is not positive or not that
    of the readings, and too few or too many replicates. An approach whose rows cannot be solved stays in the result
    with NaN and its reason.
    """
    _require(readings, k, approaches, replicates)
    random = np.random.default_rng(seed)
    drawn = [reading.resampled(replicates, random, onset=True) for reading in readings]
    line = share_line(readings, drawn, [reading.left_out(onset=True) for reading in readings])
    if not line.microstick.resolved:
        bias = _rigid_bias(line, k)
        line = replace(line, microstick=replace(line.microstick, rigid_bias=bias))
    line = replace(
        line,
        point=line.point.with_phase(phase),
        drawn=line.drawn.with_phase(phase),
        left=tuple(features.with_phase(phase) for features in line.left),
    )
    estimates = with_notes({name: _result(name, way, line, k) for name, way in approaches.items()})
    of_records = [
        f"{reading.steady.source}: {words}"
        for reading in readings
        for words in reading.warnings
        if words != reading.onset_note  # the shared length speaks for all
    ]
    return Identification(
        k=k,
        phase=phase,
        readings=tuple(readings),
        features=line.point,
        microstick=line.microstick,
        estimates=estimates,
        replicates=replicates,
        seed=seed,
        warnings=(*of_records, *agreement(line.microstick, estimates)),
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


def _rigid_bias(line: SharedLine, k: float) -> float:
    """Relative error of F_k by direct integration when a contact whose microstick line is as long as the bound is taken
    as rigid; NaN where no bound is known."""
    F_k = [
        float(solve(APPROACHES["direct"](with_length(line.point, length, line.fitted), k))["F_k"])
        for length in (0.0, line.microstick.bound)
    ]
    return F_k[0] / F_k[1] - 1.0


_NOTHING = ParameterEstimate(math.nan, math.nan, math.nan, Interval(math.nan, math.nan))


def _result(name: str, approach: Approach, line: SharedLine, k: float) -> ApproachResult:
    """The estimates of one approach, with standard errors and intervals."""
    rows = approach(line.point, k)
    try:
        estimate = least_squares(rows)
    except ValueError as error:
        nothing = dict.fromkeys(rows.terms, _NOTHING)
        unknown = np.full(len(rows.W), math.nan)
        return ApproachResult(
            name, nothing, _NOTHING, {}, math.nan, math.nan, rows, unknown, (str(error),)
        )
    drawn_rows = approach(line.drawn, k)
    drawn = solve(drawn_rows)
    left = [solve(approach(features, k)) for features in line.left]
    values = {symbol: float(value) for symbol, value in estimate.values.items()}
    row_errors = drawn_rows.misfit(values).std(axis=1, ddof=1)
    freedom = int(estimate.n) - len(values)
    missing = ", ".join(str(i + 1) for i in np.flatnonzero(~rows.usable))
    note = f"without record {missing}, which lacks a feature that this approach needs"
    return ApproachResult(
        approach=name,
        coefficients={
            symbol: _parameter(value, drawn[symbol], [e[symbol] for e in left])
            for symbol, value in values.items()
        },
        K_z=_stiffness(line, estimate, drawn, left),
        correlations={
            (one, other): float(np.corrcoef(drawn[one], drawn[other])[0, 1])
            for one, other in itertools.combinations(values, 2)
        },
        residual=float(estimate.residual) if freedom else math.nan,
        misfit=_misfit(rows, row_errors, freedom),
        rows=rows,
        row_errors=row_errors,
        notes=(note,) if missing else (),
    )


def _stiffness(
    line: SharedLine, estimate: Estimate, drawn: Estimate, left: Sequence[Estimate]
) -> ParameterEstimate:
    """K_z from F_k and the shared microstick line; a lower limit where the line is not resolved."""
    if "F_k" not in estimate.values:
        return _NOTHING
    F_k = float(estimate["F_k"])
    if line.microstick.resolved:
        with np.errstate(divide="ignore", invalid="ignore"):
            left_out = zip(line.left_lengths, left, strict=True)
            compliance = _parameter(
                line.length / (2.0 * F_k),
                line.drawn_length / (2.0 * drawn["F_k"]),
                [lengths / (2.0 * e["F_k"]) for lengths, e in left_out],
            )
        return _inverse(compliance)
    if line.microstick.bound > 0.0 and F_k > 0.0:
        low = float(contact_stiffness(F_k, line.microstick.bound, 0.0))
        return ParameterEstimate(math.inf, math.nan, math.nan, Interval(low, math.inf))
    return _NOTHING


def _misfit(rows: Rows, errors: Array, freedom: int) -> float:
    """Least χ² of the rows, each weighted with its own standard deviation, per degree of freedom; NaN without any.

    The estimate itself weights all rows alike, as (9): what its residuals leave is not χ².
    """
    if freedom < 1 or not np.all(errors[rows.usable] > 0.0):
        return math.nan
    weights = errors**-2.0
    fit = solve(replace(rows, weights=weights))
    total = float(np.sum((weights * rows.W**2)[rows.usable]))
    return float(fit.residual) ** 2 * total / freedom


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


def _inverse(compliance: ParameterEstimate) -> ParameterEstimate:
    """The stiffness of a compliance; without an upper limit where the interval of the compliance holds zero."""
    low, high = compliance.interval
    K_z = 1.0 / compliance.value
    return ParameterEstimate(
        K_z,
        K_z**2 * compliance.standard_error,
        K_z**2 * compliance.propagated_error,
        Interval(1.0 / high, 1.0 / low if low > 0.0 else math.inf),
    )
