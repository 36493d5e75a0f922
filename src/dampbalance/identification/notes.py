"""Notes on the estimates, and on how they agree: what a reader must know before using a number.

A sentence on the oscillator is said only where the fit of the whole oscillator says it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..balance import Rows
from ..law.terms import term
from ..project.wording import listed, times
from ..reading.checks import is_clipped

if TYPE_CHECKING:
    from ..reading.noisy import Reading
    from .oscillator import Whole
    from .result import ApproachResult, Microstick, ParameterEstimate

YARDSTICK = "direct"
"""The approach that assumes no shape of x(t): the one that is held against the fit of the whole oscillator."""

_APART = 4.0  # standard errors
_SHAPE_SHOWS = 0.5  # standard errors: an interval of 95 % holds the truth in 92 % of all cases then
_SHAPE_LEAST = 1e-6  # of a value: what the harmonics that a waveform leaves out are worth
_FOLDED = 2.0  # of the noise
_FAR = 3.0  # standard deviations of the rows
_ALIKE = 0.02  # sine of the angle between the columns of A below which the levels hardly tell F_k and c apart


def with_notes(
    estimates: Mapping[str, ApproachResult], readings: Sequence[Reading], whole: Whole
) -> dict[str, ApproachResult]:
    """Add to each estimate what a reader must know of it."""
    return {
        name: replace(e, notes=(*e.notes, *_notes(e, readings, whole)))
        for name, e in estimates.items()
    }


def _notes(estimated: ApproachResult, readings: Sequence[Reading], whole: Whole) -> list[str]:
    clipped = [
        f"{quantity} of {reading.steady.source}"
        for reading in readings
        for quantity, harmonics in reading.steady.channels.items()
        if is_clipped(harmonics)
    ]
    notes = forbidden(estimated.coefficients, clipped, "a sign, a gain, a channel or the stiffness")
    shape = _shape(estimated)
    if shape:
        notes.append(shape)
    if whole.linear:
        notes.append("F_k and K_z leave no trace in the records: c comes from W = b c")
    elif not whole.waveforms_hold and not estimated.notes:
        notes.append(
            "the onset of slip is not known: what sticking takes from 4X is that of the oscillator that comes nearest"
            if whole.fit is not None
            else "the onset of slip is not known: the contact is taken as rigid, and F_k is too small"
        )
        if estimated.misfit > _FAR**2:
            notes.append(
                f"its rows lie {times(math.sqrt(estimated.misfit))} farther from the balance than noise explains, and "
                "the intervals do not tell"
            )
    if whole.late:
        notes.append(
            "the response is out of time with the drive (see below): F_k and c carry that error"
        )
    return notes


def forbidden(
    coefficients: Mapping[str, ParameterEstimate], clipped: Sequence[str], suspects: str
) -> list[str]:
    """A sentence on each coefficient whose whole interval is negative, with the likely cause.

    clipped : signals that are.   suspects : what else may be wrong, "a gain or the stiffness".
    """
    cause = f"{suspects} may be wrong"
    if clipped:
        cause = f"clipping is the likely cause ({listed(clipped)}); raise the measuring range"
    return [
        f"{symbol} = {found.value:.3g} {term(symbol).unit} is negative, which physics forbids: {cause}"
        for symbol, found in coefficients.items()
        if found.interval.high < 0.0
    ]


def notes_of(whole: Whole) -> tuple[str, ...]:
    """What a reader must know of the fit of the whole oscillator itself."""
    fit, notes = whole.fit, []
    if fit is None or whole.linear:
        return ()
    if not fit.adequate:
        notes.append(
            "the records are not those of such an oscillator: it is only the one that comes nearest"
        )
    notes += [
        f"the best {key} is at its limit, zero: its standard error is not that of a normal distribution"
        for key in fit.undamped
    ]
    return tuple(notes)


def _shape(estimated: ApproachResult) -> str:
    """A sentence where the shape of x(t) that an approach assumes costs more than its interval tells."""
    parts = []
    for symbol, bias in estimated.shape_bias.items():
        found = estimated.coefficients[symbol]
        least = max(_SHAPE_SHOWS * found.standard_error, _SHAPE_LEAST * abs(found.value))
        if not abs(bias * found.value) <= least:  # nor is NaN
            sense = "small" if bias < 0.0 else "large"
            size = f"{100.0 * abs(bias):.2g} % too {sense}"
            parts.append(f"{symbol} {size if math.isfinite(bias) else 'impossible to find'}")
    if not parts:
        return ""
    return (
        f"the shape of x(t) that this approach assumes makes {listed(parts)} for the oscillator found, and its "
        "intervals do not tell"
    )


def agreement(
    readings: Sequence[Reading],
    microstick: Microstick,
    whole: Whole,
    estimates: Mapping[str, ApproachResult],
) -> list[str]:
    """Warnings on all records together."""
    warnings = _on_the_oscillator(readings, whole)
    still = [str(i + 1) for i, reading in enumerate(readings) if reading.slips is False]
    if still:
        warnings.append(
            f"the contact only sticks in record {', '.join(still)}: it takes no energy there, and the record stays out "
            "of the balance"
        )
    if whole.waveforms_hold and not microstick.resolved:
        warnings.append(
            "the records together do not resolve the onset of slip: K_z has a lower limit only; sample faster, measure "
            "acceleration, or reduce the noise"
        )
    folded = [str(i + 1) for i, r in enumerate(readings) if r.lines.aliased > _FOLDED]
    if folded and not whole.linear:
        warnings.append(
            f"the sampling rate of record {', '.join(folded)} folds back harmonics that are larger than the noise: K_z "
            "may be off by more than its interval tells; sample faster, or through an anti-alias filter that the "
            "mapping names"
        )
    fit = whole.fit
    if fit is not None and {"c", "c_r"} <= set(fit.law.unknowns):
        warnings.append(
            f"c and c_r together cannot be told from a skew of the channels: if the response lags by 1 µs, c_r is "
            f"{1e-6 * fit.k:.2g} N s/m too small and c as much too large"
        )
    apart = _apart(estimates.get(YARDSTICK), whole)
    if apart:
        warnings.append(apart)
    first = next((e for e in estimates.values() if e.rows.usable.sum() >= 2), None)
    if first is not None and _sine(first.rows) < _ALIKE:
        warnings.append(
            f"the levels are so alike that {listed(list(first.coefficients))} can hardly be told apart: add a record "
            "at a much higher or lower amplitude"
        )
    return warnings


def _on_the_oscillator(readings: Sequence[Reading], whole: Whole) -> list[str]:
    """What the fit of the whole oscillator says."""
    if whole.linear:
        return [
            "the records are those of a linear oscillator within their noise: the contact only sticks, or there is no "
            "friction, and F_k and K_z cannot be told; raise the excitation"
        ]
    if whole.fit is None:
        return [
            "no oscillator with this stiffness and a friction contact slips and responds like the records: check the "
            "stiffness, the signs, the units and the order of the channels"
        ]
    said = []
    fit, delayed = whole.fit, whole.delayed
    if not whole.mass_fits:
        said.append(
            f"the mass given, {whole.mass:.6g} kg, is not that of the records, {fit.m:.6g} ± {fit.error('m'):.2g} kg: "
            "nothing here uses it; check the mass, the stiffness, the gains and the units"
        )
    if not fit.adequate:
        worst = int(np.argmax(fit.misfits))
        said.append(
            "the records are not those of one mass on a spring, a damper and one friction contact: the best one that "
            f"{fit.evaluations} trials found leaves {times(math.sqrt(fit.misfit))} their noise, most in "
            f"{readings[worst].steady.source}; K_z and the onset of slip cannot be told; a channel may be skewed, "
            "coupled (AC) or filtered, a gain or a sign may be wrong, the levels may differ in more than their "
            "amplitude, the damping may follow another law (compare the laws), or the oscillator is of another kind"
        )
    if whole.late and delayed is not None:
        without = [f"{key} = {delayed.value(key):.4g} {term(key).unit}" for key in fit.law.unknowns]
        said.append(
            f"the harmonics say that the response lags the drive by {1e6 * delayed.delay:.4g} ± "
            f"{1e6 * delayed.error('delay'):.2g} µs beside the motion; without that, {listed(without)}: "
            "give the delay in the mapping, or sample all channels at once"
        )
    return said


def _apart(estimated: ApproachResult | None, whole: Whole) -> str:
    """A sentence where the balance contradicts the fit of the whole oscillator beyond what their errors allow."""
    if estimated is None or whole.fit is None or not whole.waveforms_hold:
        return ""
    parts = []
    for symbol, own in estimated.coefficients.items():
        of_fit = whole.fit.value(symbol)
        # the fit uses all that the balance uses: the variance of their difference is that of their variances
        error = math.sqrt(max(own.standard_error**2 - whole.fit.error(symbol) ** 2, 0.0))
        error = max(error, 0.5 * own.standard_error, 1e-7 * abs(of_fit))
        if abs(own.value - of_fit) > _APART * error and of_fit:
            parts.append(f"{symbol} by {100.0 * (own.value / of_fit - 1.0):+.2g} %")
    if not parts:
        return ""
    return (
        f"the balance of energy and the fit of the whole oscillator differ, {' and '.join(parts)}, by more than their "
        "errors allow: trust neither interval"
    )


def _sine(rows: Rows) -> float:
    """The smallest sine of the angle that a column of the balance makes with those before it."""
    columns = [
        g[rows.usable] / np.linalg.norm(g[rows.usable])
        for symbol, g in rows.terms.items()
        if symbol not in rows.given
    ]
    return float(np.min(np.abs(np.diag(np.linalg.qr(np.column_stack(columns))[1]))))
