"""F_k, c and K_z from measured responses at several levels, by every approach, with standard errors and intervals.

Each response gives one row a F_k + b c = W of the energy balance (6); rows of different frequencies go together, since
neither F_k nor c knows the frequency. The microstick line has one length for all of them, X + X_s = 2F_k/K_z (10): the
weighted mean over the records serves each of them, also those that do not resolve it alone. Where the mean does not
stand out of its noise either, the contact is taken as rigid, and what that may cost is stated.

What noise does to the estimates is told twice: by bootstrap (cycles of every record drawn with replacement, the balance
solved for each drawing) and by propagation (the jackknife: one cycle of one record left out after the other).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import special  # scipy.stats has the same functions, and takes seconds to import

from ..balance import APPROACHES, Approach, Rows
from ..features import Features, Phase
from ..fitting import least_squares_of_cases
from ..reading.noisy import Reading
from ..reading.one_thread import one_thread
from ..solver import contact_stiffness, least_squares
from .microstick import Lengths, microstick_of, weights_of, with_length
from .notes import agreement, judged
from .result import CONFIDENCE, Estimated, Identification, Interval, Microstick, Parameter

Array = NDArray[np.float64]

__all__ = ["REPLICATES", "SEED", "Identification", "identify"]

REPLICATES = 1000
SEED = 2010


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

    readings : of `read_features`, one per level; levels that differ.   k : stiffness, N/m, as the readings were told.
    approaches : by name.   phase : that the harmonic approaches take.
    replicates : of the bootstrap.   seed : of its drawings.

    Raises ValueError for fewer than two readings, a stiffness that is not positive or not that of the readings, and
    fewer than two replicates. An approach whose rows cannot be solved stays in the result with NaN and its reason.
    """
    _require(readings, k, approaches, replicates)
    random = np.random.default_rng(seed)
    drawn = [reading.resampled(replicates, random, onset=True) for reading in readings]
    left = [reading.left_out(onset=True) for reading in readings]
    points = [reading.with_onset(True) for reading in readings]
    known = [reading.waveform is not None for reading in readings]
    weights = weights_of(readings)
    lengths = Lengths.of(points, drawn, left, weights)
    microstick = microstick_of(readings, lengths)
    if not microstick.resolved:
        rigid = Lengths.rigid(lengths)
        microstick = replace(microstick, rigid_bias=_rigid_bias(points, known, microstick.bound, k))
        lengths = rigid

    shared = [
        with_length(f, lengths.point, known[i]).with_phase(phase) for i, f in enumerate(points)
    ]
    resampled = [
        with_length(f, lengths.drawn, known[i]).with_phase(phase) for i, f in enumerate(drawn)
    ]
    without = [
        [
            with_length(f, lengths.left[j], known[i]).with_phase(phase)
            for i, f in enumerate([*points[:j], left[j], *points[j + 1 :]])
        ]
        for j in range(len(readings))
    ]
    estimates = {}
    for name, approach in approaches.items():
        sets = _Sets(
            _rows(approach, shared, k),
            _rows(approach, resampled, k),
            tuple(_rows(approach, responses, k) for responses in without),
        )
        estimates[name] = _estimated(name, sets, lengths, microstick)
    estimates = judged(estimates)
    return Identification(
        k=k,
        phase=phase,
        readings=tuple(readings),
        features=tuple(shared),
        microstick=microstick,
        estimates=estimates,
        replicates=replicates,
        seed=seed,
        warnings=(
            *(
                f"{r.steady.source}: {words}"
                for r in readings
                for words in r.warnings
                if words != r.onset_note  # the shared length speaks for all
            ),
            *agreement(microstick, estimates),
        ),
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
    if replicates < 2:
        raise ValueError(f"replicates must be at least 2, got {replicates}")
    if not approaches:
        raise ValueError(f"no approach is asked for; known are {', '.join(APPROACHES)}")


def _rows(approach: Approach, responses: Sequence[Features], k: float) -> Rows:
    """Rows of n records and their r replicates: a, b, W each (n, r)."""
    parts = [approach(features, k) for features in responses]
    return Rows(*(np.stack(arrays) for arrays in zip(*parts, strict=True)))


def _rigid_bias(points: Sequence[Features], known: Sequence[bool], bound: float, k: float) -> float:
    """Relative error of F_k by direct integration when a contact with the microstick length `bound` is taken as rigid;
    NaN where no bound is known."""
    found = []
    for length in (0.0, bound):
        shared = [with_length(f, np.array([length]), known[i]) for i, f in enumerate(points)]
        found.append(float(least_squares_of_cases(_rows(APPROACHES["direct"], shared, k)).F_k[0]))
    return found[0] / found[1] - 1.0


class _Sets(NamedTuple):
    """Rows of one approach: as read, (n, 1); of the bootstrap, (n, r); n times without cycles of a record, (n, g)."""

    point: Rows
    drawn: Rows
    left: tuple[Rows, ...]


def _estimated(name: str, sets: _Sets, lengths: Lengths, microstick: Microstick) -> Estimated:
    point = Rows(*(array[:, 0] for array in sets.point))
    nothing = Parameter(math.nan, math.nan, math.nan, Interval(math.nan, math.nan))
    try:
        estimate = least_squares(point)
    except ValueError as error:
        unknown = np.full(len(point.a), math.nan)
        return Estimated(
            name, nothing, nothing, nothing, math.nan, math.nan, math.nan, point, unknown, (str(error),)
        )  # fmt: skip
    notes = []
    left_out = np.flatnonzero(~point.usable)
    if left_out.size:
        numbers = ", ".join(str(i + 1) for i in left_out)
        notes.append(f"without record {numbers}, which lacks a feature that this approach needs")
    drawn = least_squares_of_cases(sets.drawn)
    left = [least_squares_of_cases(rows) for rows in sets.left]
    F_k, c = (
        _parameter(value, getattr(drawn, key), [getattr(e, key) for e in left])
        for key, value in (("F_k", estimate.F_k), ("c", estimate.c))
    )
    K_z = nothing
    if microstick.resolved:
        with np.errstate(divide="ignore", invalid="ignore"):
            compliance = _parameter(
                float(lengths.point[0]) / (2.0 * estimate.F_k),
                lengths.drawn / (2.0 * drawn.F_k),
                [at / (2.0 * e.F_k) for at, e in zip(lengths.left, left, strict=True)],
            )
        K_z = _inverse(compliance)
    elif microstick.bound > 0.0 and estimate.F_k > 0.0:
        low = float(contact_stiffness(estimate.F_k, microstick.bound, 0.0))
        K_z = Parameter(math.inf, math.nan, math.nan, Interval(low, math.inf))
    rest = estimate.F_k * sets.drawn.a + estimate.c * sets.drawn.b - sets.drawn.W
    row_errors = rest.std(axis=1, ddof=1)
    freedom = int(point.usable.sum()) - 2
    return Estimated(
        approach=name,
        F_k=F_k,
        c=c,
        K_z=K_z,
        correlation=float(np.corrcoef(drawn.F_k, drawn.c)[0, 1]),
        residual=estimate.residual if freedom else math.nan,
        misfit=_misfit(point, row_errors, freedom),
        rows=point,
        row_errors=row_errors,
        notes=tuple(notes),
    )


def _misfit(rows: Rows, errors: Array, freedom: int) -> float:
    """Least χ² of the rows, each weighted with its own standard deviation, per degree of freedom; NaN without any.

    The estimate itself weights all rows alike, as (9): what its residuals leave is not χ².
    """
    usable = rows.usable
    if freedom < 1 or not np.all(errors[usable] > 0.0):
        return math.nan
    a, b, W = (array[usable] / errors[usable] for array in rows)
    Q, _ = np.linalg.qr(np.column_stack([a, b / np.linalg.norm(b) * np.linalg.norm(a)]))
    left = W - Q @ (Q.T @ W)
    return float(left @ left) / freedom


def _parameter(value: float, drawn: Array, left: Sequence[Array]) -> Parameter:
    """Standard errors and interval of one number.

    drawn : of the bootstrap.   left : without groups of cycles of each record.
    The variances that the records contribute, v_i of g_i groups, give the degrees of freedom of their sum,
    (Σ v_i)²/Σ v_i²/(g_i − 1) (Welch–Satterthwaite), and those the quantile of Student's t.
    """
    error = float(drawn.std(ddof=1))
    parts = np.array([(len(p) - 1) / len(p) * np.sum((p - p.mean()) ** 2) for p in left])
    groups = np.array([len(p) for p in left])
    total = float(parts.sum())
    freedom = total**2 / float(np.sum(parts**2 / (groups - 1))) if total > 0.0 else math.inf
    reach = float(special.stdtrit(freedom, 0.5 + 0.5 * CONFIDENCE)) * error
    return Parameter(value, error, math.sqrt(total), Interval(value - reach, value + reach))


def _inverse(compliance: Parameter) -> Parameter:
    """The stiffness of a compliance; without an upper limit where the interval of the compliance holds zero."""
    low, high = compliance.interval
    K_z = 1.0 / compliance.value
    return Parameter(
        K_z,
        K_z**2 * compliance.standard_error,
        K_z**2 * compliance.propagated_error,
        Interval(1.0 / high, 1.0 / low if low > 0.0 else math.inf),
    )
