"""Tests whether a misprint would be noticed: every digit of Tables 1 to 3 one up and one down.

The claims are judged by the same rules as those of the paper, on a print with one other number. `misprints` gives
every change with its verdicts; `packed` writes them down for the page that lets readers change a digit. That takes a
minute for all tables, so what it gives is kept on record with the print, and shown where it is of the run.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

from .judging import Claim, explanation, verdict
from .print import Printed
from .rules import Sources, claims
from .verdicts import VERDICTS, part_of

_JUDGED = {
    "table1": ("table1", "table3", "text"),
    "table2": ("table2", "text"),
    "table3": ("table3",),
}
"""Part of the paper → the parts with computed numbers whose verdicts follow from what is printed there."""

_FOLLOWS = {
    "from_print": ("table1", "table2", "text"),
    "pairs": ("table2", "table3"),
    "refuted": ("table1", "table2", "text"),
    "by_table_2": ("table2",),
    "by_table_3": ("table1", "table3", "text"),
    "misfits": (),  # depends on Tables 1 and 3, and serves causes only
    "unread": (),
}
"""Cached property of `Sources` → parts of the paper whose printed numbers it depends on."""


class Misprint(NamedTuple):
    """A printed number with another digit.   claims : those whose verdict is another one then, by id."""

    id: str
    printed: str
    claims: Mapping[str, Claim]


def other_digits(number: Printed) -> list[str]:
    """Return the number with each of its significant digits one up and one down in turn, the last digit first."""
    return [
        number.moved(step * 10**place) for place in range(number.significant) for step in (+1, -1)
    ]


def judged(sources: Sources, name: str, text: str) -> dict[str, Claim]:
    """Return the claims on all computed numbers that another text for one printed number can affect, by id.

    Their causes are not looked into: they say why a number is what it is, and no verdict depends on them.
    """
    part = part_of(name)
    changed = replace(sources, published=sources.published.changed({name: text}))
    kept = {name: getattr(sources, name) for name in _FOLLOWS if part not in _FOLLOWS[name]}
    vars(changed).update(kept, rules_at_work=lambda row: "")
    parts = _JUDGED.get(part, (part,))
    rows = changed.published.rows.values()
    affected = [row for row in rows if row.kind == "computed" and part_of(row.id) in parts]
    return {claim.row.id: claim for claim in claims(changed, affected)}


def misprints(sources: Sources, names: Iterable[str]) -> Iterator[Misprint]:
    """Judge some computed numbers anew with `other_digits`."""
    was = verdicts_of_changes(sources)
    for name in names:
        for text in other_digits(sources.published[name]):
            now = judged(sources, name, text)
            yield Misprint(name, text, {i: c for i, c in now.items() if verdict(c).name != was[i]})


def verdicts_of_changes(sources: Sources) -> dict[str, str]:
    """Return the names of the verdicts on all computed numbers, by id."""
    rows = [row for row in sources.published.rows.values() if row.kind == "computed"]
    return {claim.row.id: verdict(claim).name for claim in claims(sources, rows)}


_NUMBER = re.compile(r"[-+]?\d(?:[\d.]|[eE][-+]?)*\d|\d")


def cells(sources: Sources) -> list[str]:
    """Return the ids of the computed numbers of Tables 1 to 3."""
    rows = sources.published.rows.values()
    return [row.id for row in rows if row.kind == "computed" and part_of(row.id) in _JUDGED]


def packed(sources: Sources, names: Iterable[str]) -> dict[str, Any]:
    """Return the misprints of some numbers, of `cells` as a rule, in short, to be written as JSON.

    verdicts : their names, best first.   was : id → verdict on the number as printed.
    reasons : sentences, with # for every number.   because : sentences on other numbers.
    sets : lists of [id, verdict, because]: the other numbers whose verdicts change.
    numbers : id → [printed, changes]; a change is [printed, verdict, reason, numbers in the reason, set].
    Verdicts, reasons, because and sets are given by their places in these lists.
    """
    ranks, was = list(VERDICTS), verdicts_of_changes(sources)
    pools: dict[str, dict[Any, int]] = {"reasons": {}, "because": {}, "sets": {}}

    def place(pool: str, thing: Any) -> int:
        return pools[pool].setdefault(thing, len(pools[pool]))

    def rank(claim: Claim) -> int:
        return ranks.index(verdict(claim).name)

    numbers: dict[str, Any] = {}
    for name, printed, changed in misprints(sources, names):
        own = changed.get(name)
        others = tuple(
            (other, rank(claim), place("because", _because(claim)))
            for other, claim in changed.items()
            if other != name
        )
        reason = explanation(replace(own, cause="")) if own else ""
        _, changes = numbers.setdefault(name, [sources.published[name].text, []])
        change = [printed, rank(own) if own else ranks.index(was[name])]
        change += [place("reasons", _NUMBER.sub("#", reason)), " ".join(_NUMBER.findall(reason))]
        changes.append([*change, place("sets", others)])
    return {
        "verdicts": ranks,
        "was": {name: ranks.index(earlier) for name, earlier in was.items()},
        **{name: list(pool) for name, pool in pools.items()},
        "numbers": numbers,
    }


def _because(claim: Claim) -> str:
    """Return why a changed number gives another one another verdict, without numbers."""
    if claim.contradiction:
        return "it now disagrees with the paper’s own numbers"
    if claim.strays:
        return "the printed inputs now give a number too far from it"
    return "the rest of its table now allows another range for it"
