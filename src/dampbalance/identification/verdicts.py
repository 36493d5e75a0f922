"""What each identified number is worth: usable, doubtful or none, and why. The only place that decides it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from .result import ApproachResult, ParameterEstimate, unit_of

USABLE, DOUBTFUL, NONE = "usable", "doubtful", "none"


class Verdict(NamedTuple):
    """usable: value and interval hold.   doubtful: a value with a reason not to trust it.   none: no value."""

    verdict: str
    reason: str = ""


def verdicts_of(estimated: ApproachResult) -> dict[str, Verdict]:
    """The verdict on each parameter of an approach, by symbol."""
    return judged_by_notes(estimated.parameters, estimated.notes)


def judged_by_notes(
    parameters: Mapping[str, ParameterEstimate], notes: Sequence[str]
) -> dict[str, Verdict]:
    """The verdict on each of several parameters by its own numbers, and by what is noted on all of them."""
    return {symbol: _judged(symbol, p, notes) for symbol, p in parameters.items()}


def in_one(verdicts: Mapping[str, Verdict]) -> str:
    """The verdicts on several parameters for a line of a table: "usable", or "usable: F_k, c; none: K_z"."""
    by_word: dict[str, list[str]] = {}
    for symbol, (word, _) in verdicts.items():
        by_word.setdefault(word, []).append(symbol)
    if len(by_word) == 1:
        return next(iter(by_word))
    return "; ".join(f"{word}: {', '.join(symbols)}" for word, symbols in by_word.items())


def _judged(symbol: str, parameter: ParameterEstimate, notes: Sequence[str]) -> Verdict:
    if math.isnan(parameter.value):
        return Verdict(NONE, "; ".join(notes) or f"these records do not tell {symbol}")
    reasons = "; ".join([*notes, *_reasons(symbol, parameter)])
    return Verdict(DOUBTFUL, reasons) if reasons else Verdict(USABLE)


def _reasons(symbol: str, parameter: ParameterEstimate) -> Iterator[str]:
    """Why a number is doubtful by itself."""
    low, high = parameter.interval
    if math.isinf(parameter.value) or math.isinf(high):
        yield f"a lower limit only: {symbol} is above {low:.4g} {unit_of(symbol)}"
    elif not high - low <= abs(parameter.value):
        yield "its interval is wider than its value"
