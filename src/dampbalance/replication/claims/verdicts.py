"""The verdicts on printed numbers, best first, and how many numbers earn each.

The names of the routes by which a printed number is computed are here, too, as the reasons for a verdict cite them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple

if TYPE_CHECKING:
    import pandas as pd

PARTS_OF_THE_PAPER = {
    "parameter": "Parameters",
    "table1": "Table 1",
    "table2": "Table 2",
    "table3": "Table 3",
    "text": "Text",
}
"""The parts of the paper: how their ids begin → in words."""

ROUTE_NAMES = {"exact": "exact", "as_published": "as published", "from_print": "from print"}
"""Column of the table of claims → the route in words."""


@dataclass(frozen=True, slots=True)
class ClaimVerdict:
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


_MEANING_OF_VERDICTS = {
    "reproduced": ("✓", "The equations, solved exactly, give the printed digits."),
    "simulated": (
        "≈",
        "The simulation as published, with its read-outs, gives the printed digits, by a named deviation.",
    ),
    "from print": ("≡", "The paper’s own printed inputs in its own equations give the digits."),
    "last digit": ("±1", "One unit off in the last printed digit."),
    "reading": ("r", "Within the resolution with which the number was read off a plot."),
    "propagated": ("u", "The rebuild’s own number lies in the range that unprinted digits leave."),
    "unexplained": (
        "?",
        "Near, within a bound fixed beforehand; the cause of the deviation is unknown.",
    ),
    "undecided": ("≷", "A statement that the print neither confirms nor refutes."),
    "differs": (
        "✗",
        "None of these, or contradicted by the paper’s own numbers; see the evidence.",
    ),
}
VERDICTS = {name: ClaimVerdict(name, *texts) for name, texts in _MEANING_OF_VERDICTS.items()}
"""Every verdict by its name, best first."""
REPRODUCED, SIMULATED, FROM_PRINT, LAST_DIGIT, READING, *_WORSE = VERDICTS.values()
PROPAGATED, UNEXPLAINED, UNDECIDED, DIFFERS = _WORSE

VERDICT_BY = dict(zip(ROUTE_NAMES, (REPRODUCED, SIMULATED, FROM_PRINT), strict=True))
"""Route, as a column of the table of claims → the verdict on a number of which it gives the digits, the best first."""
HOLDING = tuple(verdict.name for verdict in VERDICT_BY.values())
"""The verdicts with which an input or a statement holds."""

ClaimKind = Literal["given", "computed", "statement"]
KINDS: dict[ClaimKind, str] = {
    "given": "An input of the configuration. It is listed and checked, but not counted.",
    "computed": "A number that follows from the inputs: these are counted.",
    "statement": "A bound or a word, judged by a separate rule.",
}
"""The kinds of claims and what they are."""


class Count(NamedTuple):
    """Numbers of claims of each kind in a part of the paper, and of verdicts on its computed numbers.

    key : of the part, as the ids of its claims begin, or "all".
    of_verdict : name of the verdict → how many computed numbers earn it.
    given, given_held : inputs, and those that the configuration holds.
    statements, statements_held, statements_undecided : bounds and words, those that hold, and those left open.
    """

    key: str
    of_verdict: Mapping[str, int]
    given: int
    given_held: int
    statements: int
    statements_held: int
    statements_undecided: int

    @property
    def part(self) -> str:
        """The part in words."""
        return PARTS_OF_THE_PAPER.get(self.key, self.key)

    @property
    def computed(self) -> int:
        """The number of computed numbers in the part."""
        return sum(self.of_verdict.values())


def counts(claims: pd.DataFrame) -> list[Count]:
    """Return a count per part, in the paper's order, and one of all. claims : columns id, kind and verdict.

    Raises KeyError for an id that belongs to no part.
    """
    keys = claims["id"].map(part_of)
    counted = []
    for key, rows in (*((key, claims[keys == key]) for key in keys.unique()), ("all", claims)):
        given, computed, statements = (
            list(rows["verdict"][rows["kind"] == kind]) for kind in KINDS
        )
        of_verdict = {name: computed.count(name) for name in VERDICTS}
        held = [sum(map(verdicts.count, HOLDING)) for verdicts in (given, statements)]
        undecided = statements.count(UNDECIDED.name)
        numbers = len(given), held[0], len(statements), held[1], undecided
        counted.append(Count(key, of_verdict, *numbers))
    return counted


def part_of(claim: str) -> str:
    """Return the part of the paper that a claim belongs to, a key of PARTS; raises KeyError where there is none."""
    part = claim.partition(".")[0]
    if part not in PARTS_OF_THE_PAPER:
        raise KeyError(
            f"{claim!r} belongs to no part of the paper; known are {', '.join(PARTS_OF_THE_PAPER)}"
        )
    return part
