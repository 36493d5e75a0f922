"""The verdicts on the printed numbers: what they mean, and how many of each kind every part of the paper has."""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

from ...replication.tables import MARKS

PARTS = {
    "parameter": "Parameters",
    "table1": "Table 1",
    "table2": "Table 2",
    "table3": "Table 3",
    "text": "Text",
}
MEANINGS = {
    "reproduced": "The equations, solved exactly, give the printed digits.",
    "reconstructed": "The paper’s own numerics or printed inputs give the printed digits, by a named deviation.",
    "last digit": "One unit off in the last printed digit.",
    "reading": "Within the resolution with which the number can have been read off.",
    "differs": "None of these; the evidence stands beside it.",
}


@dataclass(frozen=True, slots=True)
class Verdict:
    """One of the five verdicts: name, what stands for it beside colour, meaning, and name in the style sheet."""

    name: str
    symbol: str
    meaning: str

    @property
    def css(self) -> str:
        """Name of its colours."""
        return self.name.replace(" ", "-")


VERDICTS = tuple(Verdict(name, symbol, MEANINGS[name]) for name, symbol in MARKS.items())
BY_NAME = {verdict.name: verdict for verdict in VERDICTS}


@dataclass(frozen=True, slots=True)
class Count:
    """How many printed numbers a part of the paper has, and how many of them earn each verdict (in their order)."""

    part: str
    printed: int
    of_verdict: tuple[int, ...]


def part_of(claim: str) -> str:
    """The part of the paper that a claim belongs to, by its id: table1.X_s.3 → Table 1."""
    return PARTS[claim.split(".", 1)[0]]


def counts(claims: pd.DataFrame) -> list[Count]:
    """A count per part, in the paper's order, and one of all. claims : columns id and verdict.

    Raises KeyError for an id that belongs to no part.
    """
    parts = claims["id"].map(part_of)
    groups = [(part, claims[parts == part]) for part in parts.unique()]
    return [
        Count(part, len(rows), tuple(int((rows["verdict"] == v.name).sum()) for v in VERDICTS))
        for part, rows in [*groups, ("all", claims)]
    ]
