"""Numbers made wrong, one at a time: a digit of print, or what a route of the rebuild gives; and their verdicts."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from typing import NamedTuple

from dampbalance.replication.claims.judging import Claim, verdict
from dampbalance.replication.claims.rules import claims
from dampbalance.replication.claims.verdicts import VERDICTS, part_of
from replication.routes import PRINT, reprinted, sources_of


class Mutant(NamedTuple):
    """A claim as it is, and with one number wrong: of print ("") or of a route.   step : in units of the last digit."""

    before: Claim
    after: Claim
    step: float
    route: str = ""

    @property
    def verdicts(self) -> tuple[str, str]:
        """The names of the verdicts before and after."""
        return verdict(self.before).name, verdict(self.after).name

    @property
    def worse(self) -> int:
        """By how many ranks the verdict is worse."""
        was, now = map(list(VERDICTS).index, self.verdicts)
        return now - was


_FOLLOWS = {
    "refuted": ("table1", "table2", "text"),
    "by_table_2": ("table2",),
    "by_table_3": ("table1", "table3", "text"),
    "misfits": (),  # depends on Tables 1 and 3, and serves causes only
}
"""Cached property of `Sources` → parts of the paper whose printed numbers it depends on."""


def printed_as(name: str, text: str) -> Claim:
    """The claim on a number with another text in print, without causes: no verdict depends on them."""
    sources, part = sources_of(), part_of(name)
    changed = reprinted(sources, PRINT.changed({name: text}))
    kept = {of: getattr(sources, of) for of, parts in _FOLLOWS.items() if part not in parts}
    vars(changed).update(kept, rules_at_work=lambda row: "")
    return claims(changed, [changed.published.rows[name]])[0]


@cache
def originals() -> list[Claim]:
    """The claims on all computed numbers, as they are."""
    return claims(sources_of(), [row for row in PRINT.rows.values() if row.claim == "computed"])


def of_print(*steps: int) -> Iterator[Mutant]:
    """Every computed number, its last printed digit moved by each of some steps."""
    for before, step in itertools.product(originals(), steps):
        name = before.row.id
        yield Mutant(before, printed_as(name, PRINT[name].moved(step)), step)


def of_rebuild(*, units: float = 0.0, share: float = 0.0) -> Iterator[Mutant]:
    """Every number that any route gives for a computed one, made wrong by so many units or by a share of itself."""
    for claim in originals():
        for route in claim.routes:
            wrong = claim.values[route] * (1.0 + share) + units * claim.row.number.unit
            after = replace(claim, values={**claim.values, route: wrong})
            yield Mutant(claim, after, units, route)
