"""A finding: what was seen, with its numbers and what they may do to an answer, and no words.

The words are in `sentences.toml`, by code; `words.sentence` puts the numbers into them, in the units and nouns of
a coordinate. To add a finding is a line in that table.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from .sentences import SENTENCES

UNBOUNDED: Mapping[str, float] = {"": math.inf}
"""The effect of what may put every number off by nobody knows how much."""


@dataclass(frozen=True, slots=True)
class Finding:
    """What is odd about records or an answer.

    code : of its sentence, in `SENTENCES`.
    numbers : that the sentence shows, by name: plain numbers in SI units, names, (value, standard error), tuples of
    these, or other findings.
    effect : symbol → relative change of that number that it may mean, infinite where it is unknown; the symbol ""
    stands for every number. A verdict depends on this alone.
    of : the record or the answer that it is about; empty for all records.
    """

    code: str
    numbers: Mapping[str, Any] = field(default_factory=dict)
    effect: Mapping[str, float] = field(default_factory=dict)
    of: str = ""

    def __post_init__(self) -> None:
        if self.code not in SENTENCES:
            raise KeyError(f"no sentence for {self.code!r}")

    def about(self, of: str) -> Finding:
        """Return the same finding about a record or an answer."""
        return replace(self, of=of)

    def spares(self, answer: str) -> bool:
        """Return whether an answer is not concerned, by its name."""
        return answer in SENTENCES[self.code].spares

    def shift(self, symbol: str) -> float:
        """Return the relative change of a number that it may mean."""
        shift = self.effect.get(symbol, self.effect.get("", 0.0))
        return math.inf if math.isnan(shift) else shift

    @property
    def largest(self) -> float:
        """The largest change that it may mean."""
        return max(map(self.shift, self.effect), default=0.0)

    @property
    def kind(self) -> tuple[Any, ...]:
        """Code and all that is no plain number: equal for findings that one sentence may state, with ranges."""
        return self.code, *((key, _words_in(value)) for key, value in self.numbers.items())

    @property
    def pages(self) -> list[str]:
        """The sections of the site that explain it and the findings in it."""
        inner = [page for one in within(self.numbers.values()) for page in one.pages]
        return [*dict.fromkeys([*filter(None, [SENTENCES[self.code].page]), *inner])]

    def document(self) -> dict[str, Any]:
        """Return it by the keys of the document."""
        numbers = {key: _plain(value) for key, value in self.numbers.items()}
        return {"code": self.code, "numbers": numbers, "effect": dict(self.effect), "of": self.of}


def _words_in(value: Any) -> Any:
    """Return what two values must share for a range of both: all but plain numbers, and pairs of these."""
    if isinstance(value, Finding):
        return value.kind
    if isinstance(value, tuple):
        return ... if all(_words_in(one) is ... for one in value) else repr(value)
    return ... if isinstance(value, float | int) and not isinstance(value, bool) else value


def _plain(value: Any) -> Any:
    if isinstance(value, Finding):
        return value.document()
    return [*map(_plain, value)] if isinstance(value, list | tuple) else value


def within(values: Any) -> list[Finding]:
    """Return the findings in values and in tuples among them."""
    found = []
    for value in values:
        if isinstance(value, list | tuple):
            found += within(value)
        elif isinstance(value, Finding):
            found.append(value)
    return found


def grouped(findings: Sequence[Finding]) -> list[list[Finding]]:
    """Return findings that one sentence may state put together, in the order of the first of each."""
    alike: dict[tuple[Any, ...], list[Finding]] = {}
    for one in findings:
        alike.setdefault(one.kind, []).append(one)
    return list(alike.values())
