"""The verdicts on printed numbers: their names, marks and meanings, best first, and how many numbers earn each.

The routes by which a printed number is computed have their names here, too: the reasons for a verdict cite them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import pandas as pd

from .claim_ids import PARTS, part_of

ROUTE_NAMES = {"exact": "exact", "as_published": "as published", "from_print": "from print"}
"""Column of the table of claims → the route in words."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """A verdict on a printed number.

    name : in tables of results.   mark : a sign for it where room is short.   meaning : in a sentence.
    """

    name: str
    mark: str
    meaning: str

    @property
    def css(self) -> str:
        """Name of its colours and of its class in the style sheet."""
        return self.name.replace(" ", "-")


REPRODUCED, RECONSTRUCTED, LAST_DIGIT, READING, DIFFERS = (
    Verdict("reproduced", "✓", "The equations, solved exactly, give the printed digits."),
    Verdict(
        "reconstructed",
        "≈",
        "The paper’s own numerics or printed inputs give the printed digits, by a named deviation.",
    ),
    Verdict("last digit", "±1", "One unit off in the last printed digit."),
    Verdict("reading", "r", "Within the resolution with which the number can have been read off."),
    Verdict("differs", "✗", "None of these; the evidence stands beside it."),
)
VERDICTS = {v.name: v for v in (REPRODUCED, RECONSTRUCTED, LAST_DIGIT, READING, DIFFERS)}
"""Every verdict by its name, best first."""


@dataclass(frozen=True, slots=True)
class Count:
    """How many printed numbers a part of the paper has, and how many of them earn each verdict.

    key : of the part, as the ids of its claims begin, or "all".   of_verdict : name of the verdict → number.
    """

    key: str
    of_verdict: Mapping[str, int]

    @property
    def part(self) -> str:
        """The part in words."""
        return PARTS.get(self.key, self.key)

    @property
    def printed(self) -> int:
        """All printed numbers of the part."""
        return sum(self.of_verdict.values())


def counts(claims: pd.DataFrame) -> list[Count]:
    """A count per part, in the paper's order, and one of all. claims : columns id and verdict.

    Raises KeyError for an id that belongs to no part.
    """
    keys = claims["id"].map(part_of)
    groups = [*((key, claims[keys == key]) for key in keys.unique()), ("all", claims)]
    return [
        Count(key, {name: int((rows["verdict"] == name).sum()) for name in VERDICTS})
        for key, rows in groups
    ]
