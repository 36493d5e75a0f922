"""What limits an answer, each thing once: the same words on several records or approaches become one sentence."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import PurePath

from ..project.wording import listed
from .notes import notes_of
from .result import Identification

REFERENCE = "maximum likelihood"

_MOST_NAMES = 6  # of records in a sentence
_NUMBER = re.compile(r"(?:more than )?(?<![\w.])[-+−]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


@dataclass(frozen=True, slots=True)
class Limit:
    """One thing that limits the answer.

    kind : "records", "approaches" or "all": what it concerns.   of : their names; () for all records together.
    words : what it is, how much it is, and what helps; a number that differs among them as "low to high".
    """

    kind: str
    of: tuple[str, ...]
    words: str


def limits(result: Identification) -> list[Limit]:
    """What limits an identification: notes on approaches, then warnings on records and on all of them."""
    notes = [(name, note) for name, e in result.estimates.items() for note in e.notes]
    notes += [(REFERENCE, words) for words in notes_of(result.whole)]
    sources = dict.fromkeys(reading.steady.source for reading in result.readings)
    of_records, of_all = [], []
    for words in result.warnings:
        source = next((s for s in sources if words.startswith(f"{s}: ")), None)
        if source is None:
            of_all.append(Limit("all", (), words))
        else:
            of_records.append((source, words.removeprefix(f"{source}: ")))
    return [*_gathered("approaches", notes), *_gathered("records", of_records), *of_all]


def shown(limit: Limit, sources: Sequence[str]) -> str:
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


def _gathered(kind: str, said: Iterable[tuple[str, str]]) -> list[Limit]:
    """What is said of each, (name, words), with those that differ in nothing but numbers put together."""
    alike: dict[str, list[tuple[str, str]]] = {}
    for name, words in said:
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
