"""What the balance of energy shows by itself, and where it contradicts the fit of one oscillator, whose check it is."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..findings.finding import UNBOUNDED, Finding
from ..law.terms import FRICTION, term
from ..project.wording import listed
from ..signals.checks import is_clipped
from ..signals.mean_harmonics import Reading
from .answer import Answer, ParameterEstimate
from .balance_rows import solved_again
from .oscillator import CommonFit


def notes_on(answer: Answer, readings: Sequence[Reading], common: CommonFit) -> Iterator[Finding]:
    """Yield what one must know, in addition to its own notes, before using the answer of the balance."""
    clipped = [
        f"{quantity} of {reading.steady.source}"
        for reading in readings
        for quantity, harmonics in reading.steady.channels.items()
        if is_clipped(harmonics)
    ]
    yield from forbidden(answer.coefficients, clipped)
    if common.frictionless:
        yield Finding("no friction column")
    elif common.stuck is not None:
        unsure, of = common.stuck.sticks is None, answer.coefficients
        limits = tuple((s, *p.interval) for s, p in of.items() if term(s).symbol == FRICTION)
        effect = {s: math.inf for s in of if s == FRICTION and unsure}
        yield Finding("hardly any friction", {"limits": limits, "unsure": unsure}, effect)
    elif not common.waveforms_hold and not answer.notes:
        if common.fit is None:
            yield Finding("onset of a rigid one", effect=UNBOUNDED)
        else:
            # whatever the records have beyond an oscillator is in the rows, too
            fitted, of_stick = common.answer, _by_half_the_stick(answer, readings)
            assert fitted is not None
            effect = {s: max(by, fitted.parameters[s].within) for s, by in of_stick.items()}
            yield Finding("onset of the closest", effect=effect)
        if answer.misfit > 9.0:  # χ² per degree of freedom: three times the noise
            times = {"times": math.sqrt(answer.misfit)}
            yield Finding("rows scatter", times, by_scatter(answer.coefficients, answer.misfit))
    if common.in_rows and common.answer is not None:
        # the rows may be off by all that lies between them and either end
        ends = common.answer.intervals
        off = {
            s: max(abs(end / (p.value or math.inf) - 1.0) for end in ends[s])
            for s, p in answer.coefficients.items()
        }
        yield Finding("rows uncorrected", effect=off)


def by_scatter(coefficients: Mapping[str, ParameterEstimate], misfit: float) -> dict[str, float]:
    """Return by what part each coefficient may be off where the rows scatter as much as this χ² per degree of
    freedom says: its interval, as many times as wide."""
    return {symbol: math.sqrt(misfit) * p.within for symbol, p in coefficients.items()}


def _by_half_the_stick(answer: Answer, readings: Sequence[Reading]) -> dict[str, float]:
    """Return by what part each coefficient changes where the stick distance λ = 4X − a is off by half of it."""
    assert answer.balance is not None
    rows = answer.balance.rows
    stick = np.array([reading.stick_travel for reading in readings])
    terms = {
        key: g + 0.5 * stick if term(key).symbol == FRICTION else g for key, g in rows.terms.items()
    }
    shifted = solved_again(replace(rows, terms=terms), answer.balance.errors)
    return {s: abs(p / answer.values[s] - 1.0) for s, p in shifted.items() if answer.values.get(s)}


def forbidden(
    coefficients: Mapping[str, ParameterEstimate], clipped: Sequence[str], code: str = "negative"
) -> list[Finding]:
    """Return a finding for each coefficient whose whole interval is negative.   clipped : names of clipped signals."""
    names = listed([*clipped])
    return [
        Finding(code, {"value": ((symbol, p.value),), "clipped": names}, UNBOUNDED)
        for symbol, p in coefficients.items()
        if p.interval.high < 0.0
    ]


def contradiction(check: Answer, answer: Answer, least: float = 4e-7) -> Iterator[Finding]:
    """Yield a finding where the balance differs from the answer by more than both intervals together.

    least : relative difference that counts: by default that of rounding in integrals of exact waveforms.
    """
    changes, effect = [], {}
    for symbol, own in check.coefficients.items():
        value, ends = answer.values[symbol], answer.intervals[symbol]
        halves = own.within * abs(own.value) + 0.5 * (ends.high - ends.low)
        if value and abs(own.value - value) > max(halves, least * abs(value)):
            changes.append((symbol, value, own.value - value))
            effect[symbol] = abs(own.value / value - 1.0)
    if changes:
        yield Finding("contradicts", {"changes": tuple(changes)}, effect)


def alike(answer: Answer) -> Iterator[Finding]:
    """Yield a finding where the rows of the balance hardly distinguish its coefficients: by the smallest sine of the
    angle that a column makes with those before it, each row counted by the parts of its work: of the largest motion
    alone, all small ones would look alike."""
    rows = None if answer.balance is None else answer.balance.rows
    if rows is None or rows.usable.sum() < 2:
        return
    used = rows.usable & (rows.W != 0.0)
    columns = [g[used] / rows.W[used] for s, g in rows.terms.items() if s not in rows.given]
    unit = np.column_stack([g / np.linalg.norm(g) for g in columns])
    # errors are fifty times those of a single unknown
    if np.min(np.abs(np.diag(np.linalg.qr(unit)[1]))) < 0.02:
        symbols = tuple(answer.coefficients)
        yield Finding("alike", {"symbols": symbols}, dict.fromkeys([*symbols, "K_z"], math.inf))
