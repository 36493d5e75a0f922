"""What a reader must know before using a number: notes on answers, warnings on records, and both as a list without
repetitions.

A sentence on the oscillator is given only where the fit of one oscillator to all records supports it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import PurePath

import numpy as np

from ..balance import Rows
from ..law.terms import term
from ..project.wording import listed, times
from ..reading.checks import is_clipped
from ..reading.mean_harmonics import Reading
from .answer import Answer, ParameterEstimate, Remark
from .microstick import Microstick
from .oscillator import CONTRADICTED, COUPLED, LATE, JointFit

DIRECT = "direct"
"""The approach that assumes no shape of x(t): the one that is compared with the fit to all records."""

_APART = 4.0  # standard errors
_SHAPE_SHOWS = 0.5  # standard errors: an interval of 95 % holds the truth in 92 % of all cases then
_SHAPE_LEAST = 1e-6  # of a value: the size of the harmonics that a waveform leaves out
_FOLDED = 2.0  # of the noise
_FAR = 3.0  # standard deviations of the rows
_ALIKE = 0.02  # sine of the angle between the columns of A below which the levels hardly distinguish F_k from c


def with_notes(
    answers: Mapping[str, Answer], readings: Sequence[Reading], joint: JointFit
) -> dict[str, Answer]:
    """The answers of the approaches, each with what a reader must know before using it."""
    return {
        name: replace(answer, notes=(*answer.notes, *_notes(answer, readings, joint)))
        for name, answer in answers.items()
    }


def doubts(readings: Sequence[Reading]) -> tuple[str, ...]:
    """Faults of records that leave no number to be trusted, each once, without the record's name."""
    return tuple(
        limit.words
        for limit in _gathered(
            "", ((r.steady.source, words) for r in readings for words in r.doubts)
        )
    )


def _notes(answer: Answer, readings: Sequence[Reading], joint: JointFit) -> Iterator[str]:
    yield from doubts(readings)
    clipped = [
        f"{quantity} of {reading.steady.source}"
        for reading in readings
        for quantity, harmonics in reading.steady.channels.items()
        if is_clipped(harmonics)
    ]
    suspects = "a sign, a gain, a channel or the stiffness"
    yield from forbidden(answer.coefficients, clipped, suspects)
    yield from _shape(answer)
    if not joint.mass_fits:
        yield CONTRADICTED
    if joint.linear:
        yield "F_k and K_z leave no trace in the records: c comes from W = b c"
    elif not joint.waveforms_hold and not answer.notes:
        yield (
            "the onset of slip is not known: what sticking takes from 4X is that of the oscillator that comes nearest"
            if joint.fit is not None
            else "the onset of slip is not known: the contact is taken as rigid, and F_k is too small"
        )
        if answer.misfit > _FAR**2:
            yield (
                f"its rows lie {times(math.sqrt(answer.misfit))} farther from the balance than noise explains, and "
                "the intervals do not show it"
            )
    if joint.coupling is not None:
        yield COUPLED
    if joint.late:
        yield LATE


def forbidden(
    coefficients: Mapping[str, ParameterEstimate], clipped: Sequence[str], suspects: str
) -> list[str]:
    """A sentence on each coefficient whose whole interval is negative, with the likely cause.

    clipped : names of clipped signals.   suspects : what else may be wrong, "a gain or the stiffness".
    """
    cause = f"{suspects} may be wrong"
    if clipped:
        cause = f"clipping is the likely cause ({listed(clipped)}); raise the measuring range"
    return [
        f"{symbol} = {p.value:.3g} {term(symbol).unit} is negative, which physics forbids: {cause}"
        for symbol, p in coefficients.items()
        if p.interval.high < 0.0
    ]


def _shape(answer: Answer) -> Iterator[str]:
    """A sentence where the shape of x(t) that an approach assumes costs more than its interval shows."""
    parts = []
    for symbol, bias in answer.shape_bias.items():
        own = answer.coefficients[symbol]
        least = max(_SHAPE_SHOWS * own.standard_error, _SHAPE_LEAST * abs(own.value))
        if not abs(bias * own.value) <= least:  # nor is NaN
            sense = "small" if bias < 0.0 else "large"
            size = f"{100.0 * abs(bias):.2g} % too {sense}"
            parts.append(f"{symbol} {size if math.isfinite(bias) else 'impossible to find'}")
    if parts:
        yield (
            f"the shape of x(t) that this approach assumes makes {listed(parts)} for the oscillator identified, and "
            "its intervals do not show it"
        )


def agreement(
    readings: Sequence[Reading],
    microstick: Microstick,
    joint: JointFit,
    answers: Mapping[str, Answer],
) -> Iterator[str]:
    """Warnings on all records together: what the joint fit shows, which levels fail, where answers contradict."""
    yield from _on_the_oscillator(readings, joint)
    still = [str(i + 1) for i, reading in enumerate(readings) if reading.slips is False]
    if still:
        yield (
            f"the contact only sticks in record {', '.join(still)}: it takes no energy there, and the record stays out "
            "of the balance"
        )
    if joint.waveforms_hold and not microstick.resolved:
        yield (
            "the records together do not resolve the onset of slip: K_z has a lower limit only; sample faster, measure "
            "acceleration, or reduce the noise"
        )
    remedies = (
        "K_z may be off by more than its interval shows; sample faster, or through an anti-alias filter that the "
        "mapping names",
        "those of the oscillator identified are taken off, as if there were no anti-alias filter but that which the "
        "mapping names; sample faster, or name it",
    )
    for unfolded, remedy in enumerate(remedies):
        folded = [
            str(i + 1)
            for i, r in enumerate(readings)
            if r.lines.aliased > _FOLDED and r.steady.unfolded == bool(unfolded)
        ]
        if folded and not joint.linear:
            yield (
                f"the sampling rate of record {', '.join(folded)} folds back harmonics that are larger than the noise: "
                + remedy
            )
    fit = joint.fit
    if fit is not None and {"c", "c_r"} <= set(fit.law.unknowns):
        yield (
            f"c and c_r together cannot be distinguished from a skew of the channels: if the response lags by 1 µs, "
            f"c_r is {1e-6 * fit.k:.2g} N s/m too small and c as much too large"
        )
    yield from _apart(answers.get(DIRECT), joint)
    solved = [(a, a.balance.rows) for a in answers.values() if a.balance is not None]
    first = next(((a, rows) for a, rows in solved if rows.usable.sum() >= 2), None)
    if first is not None and _sine(first[1]) < _ALIKE:
        yield (
            f"the levels are so alike that {listed(list(first[0].coefficients))} can hardly be distinguished: add "
            "a record at a much higher or lower amplitude"
        )


def _on_the_oscillator(readings: Sequence[Reading], joint: JointFit) -> Iterator[str]:
    """Warnings from the joint fit."""
    if joint.linear:
        yield (
            "the records are those of a linear oscillator within their noise: the contact only sticks, or there is no "
            "friction, and F_k and K_z cannot be determined; raise the excitation"
        )
        return
    if joint.fit is None:
        yield (
            "no oscillator with this stiffness and a friction contact slips and responds like the records: check the "
            "stiffness, the signs, the units and the order of the channels"
        )
        return
    fit, delayed = joint.fit, joint.delayed
    if not joint.mass_fits:
        yield (
            f"the mass given, {joint.mass:.6g} kg, is not that of the records, {fit.m:.6g} ± {fit.error('m'):.2g} kg: "
            "nothing here uses it; check the mass, the stiffness, the gains and the units"
        )
    if not fit.adequate:
        worst = int(np.argmax(fit.misfits))
        yield (
            "the records are not those of one mass on a spring, a damper and one friction contact: the best one that "
            f"{fit.evaluations} trials found leaves {times(math.sqrt(fit.misfit))} their noise, most in "
            f"{readings[worst].steady.source}; K_z and the onset of slip cannot be determined; "
            + (
                "the likeliest cause, which explains all of that, is named next"
                if joint.late or joint.coupling
                else "a channel may be skewed, coupled (AC) or filtered, a gain or a sign may be wrong, the levels may "
                "differ in more than their amplitude, the damping may follow another law (compare the laws), or the "
                "oscillator is of another kind"
            )
        )
    coupling = joint.coupling
    if coupling is not None:
        own = coupling.fit
        without = [f"{key} = {own.value(key):.4g} {term(key).unit}" for key in own.law.unknowns]
        yield (
            "the harmonics are those of a response that is coupled through a capacitor (AC), a high-pass filter with a "
            f"corner of {coupling.hz:.4g} ± {coupling.error_hz:.2g} Hz, which explains what the oscillator alone does "
            f"not; without that, {listed([*without, f'K_z = {own.K_z:.4g} N/m'])}: couple it directly (DC), or give "
            "the corner in the mapping"
        )
    if joint.late and delayed is not None:
        without = [f"{key} = {delayed.value(key):.4g} {term(key).unit}" for key in fit.law.unknowns]
        yield (
            f"the harmonics say that the response lags the drive by {1e6 * delayed.delay:.4g} ± "
            f"{1e6 * delayed.error('delay'):.2g} µs more than the motion explains; without that, {listed(without)}: "
            "give the delay in the mapping, or sample all channels at once"
        )


def _apart(answer: Answer | None, joint: JointFit) -> Iterator[str]:
    """A sentence where the balance contradicts the joint fit by more than their errors allow."""
    if answer is None or joint.fit is None or not joint.waveforms_hold:
        return
    parts = []
    for symbol, own in answer.coefficients.items():
        of_fit = joint.fit.value(symbol)
        # the fit uses all that the balance uses: the variance of their difference is that of their variances
        error = math.sqrt(max(own.standard_error**2 - joint.fit.error(symbol) ** 2, 0.0))
        error = max(error, 0.5 * own.standard_error, 1e-7 * abs(of_fit))
        if abs(own.value - of_fit) > _APART * error and of_fit:
            parts.append(f"{symbol} by {100.0 * (own.value / of_fit - 1.0):+.2g} %")
    if parts:
        yield (
            f"the energy balance and the fit of one oscillator to all records differ, {' and '.join(parts)}, by more "
            "than their errors allow: trust neither interval"
        )


def _sine(rows: Rows) -> float:
    """The smallest sine of the angle that a column of the balance makes with those before it."""
    columns = [
        g[rows.usable] / np.linalg.norm(g[rows.usable])
        for symbol, g in rows.terms.items()
        if symbol not in rows.given
    ]
    return float(np.min(np.abs(np.diag(np.linalg.qr(np.column_stack(columns))[1]))))


# --- both as a list without repetitions -----------------------------------------------------------

_MOST_NAMES = 6  # of records in a sentence
_NUMBER = re.compile(r"(?:more than )?(?<![\w.])[-+−]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


@dataclass(frozen=True, slots=True)
class Limit:
    """One thing that limits the answers.

    kind : "records", "approaches" or "all": what it concerns.   of : their names; () for all records together.
    words : what it is, how much it is, and what helps; a number that differs among them as "low to high".
    """

    kind: str
    of: tuple[str, ...]
    words: str


def limits(answers: Mapping[str, Answer], warnings: Sequence[Remark]) -> list[Limit]:
    """What limits the answers, each thing once: notes on answers, then warnings on records and on all of them.

    Sentences that differ only in their numbers become one, with the range of each number.
    """
    notes = [(name, note) for name, answer in answers.items() for note in answer.notes]
    of_records = [(remark.source, remark.words) for remark in warnings if remark.source]
    of_all = [Limit("all", (), remark.words) for remark in warnings if not remark.source]
    return [*_gathered("approaches", notes), *_gathered("records", of_records), *of_all]


def in_a_sentence(limit: Limit, sources: Sequence[str]) -> str:
    """A limit as one sentence that names what it concerns.   sources : of all records."""
    return f"{_named(limit, sources)}: {limit.words}" if limit.of else limit.words


def _named(limit: Limit, sources: Sequence[str]) -> str:
    if limit.kind != "records":
        return listed(limit.of)
    if len(limit.of) == len(sources) > 1:
        return f"all {len(sources)} records"
    names = [PurePath(source).name for source in sources]
    short = dict(zip(sources, names, strict=True)) if len(set(names)) == len(names) else {}
    own = [short.get(source, source) for source in limit.of]
    if len(own) <= _MOST_NAMES:
        return listed(own)
    return f"{len(own)} of {len(sources)} records ({', '.join(own[: _MOST_NAMES - 1])} …)"


def _gathered(kind: str, remarks: Iterable[tuple[str, str]]) -> list[Limit]:
    """Sentences on each, (name, words), with those that differ in nothing but numbers put together."""
    alike: dict[str, list[tuple[str, str]]] = {}
    for name, words in remarks:
        alike.setdefault(_NUMBER.sub("#", words), []).append((name, words))
    return [
        Limit(kind, tuple(dict.fromkeys(name for name, _ in group)), _merged([w for _, w in group]))
        for group in alike.values()
    ]


def _merged(variants: Sequence[str]) -> str:
    """Sentences that differ in nothing but numbers as one, each number that differs as its range."""
    numbers = zip(*(_NUMBER.findall(words) for words in variants), strict=True)
    ranges = iter([_range(of_all) for of_all in numbers])
    return _NUMBER.sub(lambda _: next(ranges), variants[0])


def _range(numbers: Sequence[str]) -> str:
    """The least and the greatest of numbers in words, "2 to 7"; one where all are equal."""
    low, high = (pick(numbers, key=_value) for pick in (min, max))
    return low if _value(low) == _value(high) else f"{low} to {high}"


def _value(number: str) -> float:
    return float(number.removeprefix("more than ").replace("−", "-"))
