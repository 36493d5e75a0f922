"""Numbers made wrong, one at a time: a digit of print, or what a route of the rebuild gives; and their verdicts."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from typing import NamedTuple

from dampbalance.replication.claim_verdicts import VERDICTS
from dampbalance.replication.claims import of_tables, of_text, read_published
from dampbalance.replication.claims.from_print import from_print
from dampbalance.replication.claims.inputs import Sources
from dampbalance.replication.claims.judging import Claim, verdict
from dampbalance.replication.printed import Printed
from paper.routes import CASE, PUBLISHED, as_published, exact, unrounded

PRINT = read_published(PUBLISHED)
PARTS = {
    "parameters": [of_text.parameters],
    "table1": [of_tables.table1],
    "table2_integrals": [of_tables.table2_integrals],
    "table2_pairs": [of_tables.table2_pairs],
    "table3": [of_tables.table3],
    "text_values": [of_text.least_squares, of_text.means],
}
"""Printed numbers by file → what makes the claims on them."""


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


def judged(published, file) -> dict[str, Claim]:
    """The claims on the computed numbers of a file, by id."""
    routes = exact(), as_published(), from_print(published, CASE)
    sources = Sources(published, CASE, *routes, unrounded())
    claims = [claim for part in PARTS[file] for claim in part(sources)]
    return {claim.id: claim for claim in claims if claim.kind == "computed"}


@cache
def originals() -> list[Claim]:
    """The claims on all computed numbers, as they are."""
    return [claim for file in PARTS for claim in judged(PRINT, file).values()]


def of_print(*steps: int) -> Iterator[Mutant]:
    """Every computed number, its last printed digit moved by each of some steps."""
    for file in PARTS:
        frame, before = getattr(PRINT, file), judged(PRINT, file)
        columns = ["printed"] if "printed" in frame else frame.columns.drop("Y_m", errors="ignore")
        for line, column, step in itertools.product(frame.index, columns, steps):
            if not Printed(frame[column][line]).is_number:
                continue
            changed = frame.copy()
            changed.loc[line, column] = Printed(frame[column][line]).moved(step)
            after = judged(replace(PRINT, **{file: changed}), file)
            for name, claim in after.items():
                if claim.printed != before[name].printed:
                    yield Mutant(before[name], claim, step)


def of_rebuild(*, units: float = 0.0, share: float = 0.0) -> Iterator[Mutant]:
    """Every number that any route gives for a computed one, made wrong by so many units or by a share of itself."""
    for claim in originals():
        for route in claim.routes:
            wrong = claim.values[route] * (1.0 + share) + units * Printed(claim.printed).unit
            after = replace(claim, values={**claim.values, route: wrong})
            yield Mutant(claim, after, units, route)
