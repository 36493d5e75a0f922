"""The energy balance as the check of the fit of one oscillator: its own limits, and where the two contradict."""

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
    """Yield what limits the use of the answer of the balance, in addition to its own notes."""
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
            # what no oscillator explains acts on the rows, too
            fitted, of_stick = common.answer, _by_half_the_stick(answer, readings)
            assert fitted is not None
            effect = {s: max(by, fitted.parameters[s].within) for s, by in of_stick.items()}
            yield Finding("onset of the closest", effect=effect)
        if answer.misfit > 9.0:  # χ² per degree of freedom: three times the noise
            # the intervals, as many times as wide as the rows scatter
            times = math.sqrt(answer.misfit)
            effect = {s: times * p.within for s, p in answer.coefficients.items()}
            yield Finding("rows scatter", {"times": times}, effect)
    if common.in_rows and common.answer is not None:
        # the rows may be off by their distance to the far end of the interval
        ends = common.answer.intervals
        off = {
            s: max(abs(end / (p.value or math.inf) - 1.0) for end in ends[s])
            for s, p in answer.coefficients.items()
        }
        yield Finding("rows uncorrected", effect=off)


def _by_half_the_stick(answer: Answer, readings: Sequence[Reading]) -> dict[str, float]:
    """Return the relative change of each coefficient by an error of half the stick travel λ = 4X − a."""
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


def compared(
    check: Answer,
    answer: Answer | None,
    lacks: Sequence[str] = (),
    least: float = 4e-7,
    corrected: Sequence[str] = (),
) -> tuple[Finding, list[Finding]]:
    """Return the finding of the check, and a doubt if balance and answer differ by more than both intervals together.

    A larger difference is no contradiction if the balance lacks something that the answer allows for. The difference of
    a number that may be zero is not relative.

    lacks : what the answer allows for and the rows do not, by the names of models.
    least : error of the rows beyond their noise, as a part of the work; default, that of rounding in integrals of exact
    waveforms.
    corrected : what the rows were corrected for, by the same names.
    """
    shown, apart, effect, most = [], [], {}, _largest(check)
    for symbol, own in check.coefficients.items():
        if answer is None:
            break
        value, (low, high) = answer.values[symbol], answer.intervals[symbol]
        off, reach = own.value - value, own.within * abs(own.value) + 0.5 * (high - low)
        reach = max(reach, least * most.get(symbol, 0.0))
        if not math.isfinite(off + reach):
            continue
        shown.append((symbol, 0.0 if low <= 0.0 < high else value, off))
        if abs(off) > reach:
            apart.append((*shown[-1], abs(off) / reach if reach else math.inf))
            effect[symbol] = abs(off / value) if value else math.inf
    times = max((ratio for *_, ratio in apart), default=0.0)
    if not shown or (apart and lacks):
        return Finding("no check", {"lacks": tuple(lacks)}), []
    doubts = [Finding("contradicts", {"changes": tuple(one[:3] for one in apart)}, effect)]
    numbers = {"changes": tuple(shown), "times": times, "beyond": times - 1.0}
    numbers |= {"corrected": tuple(corrected)}
    return Finding("check", numbers), doubts if apart else []


def _largest(check: Answer) -> dict[str, float]:
    """Return, for each coefficient, the value at which it takes all of the work of the rows by itself."""
    rows = None if check.balance is None else check.balance.rows
    if rows is None:
        return {}
    used = rows.usable
    work = float(np.abs(rows.W[used]).sum())
    return {s: work / total for s, g in rows.terms.items() if (total := float(g[used].sum())) > 0.0}


def alike(answer: Answer) -> Iterator[Finding]:
    """Yield a finding where the rows of the balance hardly distinguish its coefficients.

    The measure is the smallest sine of the angle between a column and those before it. Rows are divided by their work,
    as the largest motion would otherwise decide alone.
    """
    rows = None if answer.balance is None else answer.balance.rows
    if rows is None or rows.usable.sum() < 2:
        return
    used = rows.usable & (rows.W != 0.0)
    columns = [g[used] / rows.W[used] for s, g in rows.terms.items() if s not in rows.given]
    unit = np.column_stack([g / np.linalg.norm(g) for g in columns])
    # errors are then fifty times those of a single unknown
    if np.min(np.abs(np.diag(np.linalg.qr(unit)[1]))) < 0.02:
        symbols = tuple(answer.coefficients)
        yield Finding("alike", {"symbols": symbols}, dict.fromkeys([*symbols, "K_z"], math.inf))
