"""From a printed number and what the routes give for it to the best verdict of `verdicts.VERDICTS` that it earns.

A route gives the printed digits when it lies within half a unit of the last of them; an input or a statement ("less
than 1.5 %") is given when it holds. Nothing here is typed in: the verdict follows from the row, and so does its reason.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from ..printed import Printed
from ..verdicts import (
    DIFFERS,
    LAST_DIGIT,
    READING,
    RECONSTRUCTED,
    REPRODUCED,
    ROUTE_NAMES,
    Kind,
    Verdict,
)

# A printed number and a computed one meet at half a unit only up to the rounding of binary fractions.
HALF = 0.5 * (1.0 + 1e-9)


@dataclass(frozen=True, slots=True)
class Tolerance:
    """A range that the printed number may lie in, from `low` to `high`, why, and the verdict that this earns it."""

    low: float
    high: float
    reason: str
    verdict: Verdict = READING

    def holds(self, printed: float) -> bool:
        """Whether the printed number lies in the range."""
        return self.low <= printed <= self.high


@dataclass(frozen=True, slots=True)
class Claim:
    """One printed number, what the routes give for it, and why they differ.

    values : a number per route of ROUTE_NAMES, NaN or absent where the route has nothing to say.
    kind : of verdicts.KINDS.
    holds : for an input or a statement, whether it holds by each route; None for a number, compared by its digits.
    compared : the routes that can give the printed digits; the others are shown only.
    tolerances : ranges that a number may lie in, the best verdict first.
    cause : the deviation behind the digits, one sentence computed from the same run; "" without one.
    contradiction : which of the paper's own numbers refute this one, whatever any route gives; "" if none does.
    evidence : what in the paper's own numbers contradicts the printed one, should it differ.
    """

    id: str
    where: str
    quantity: str
    unit: str
    printed: str
    values: Mapping[str, float]
    kind: Kind = "computed"
    holds: Mapping[str, bool] | None = None
    compared: tuple[str, ...] = tuple(ROUTE_NAMES)
    tolerances: tuple[Tolerance, ...] = ()
    cause: str = ""
    contradiction: str = ""
    evidence: str = ""

    @property
    def routes(self) -> list[str]:
        """The routes that give a number, in the order of ROUTE_NAMES."""
        return [route for route in ROUTE_NAMES if not math.isnan(self.values.get(route, math.nan))]

    def show(self, route: str) -> str:
        """The value of a route, written like the printed number with a few more digits; "" if there is none."""
        value = self.values.get(route, math.nan)
        if math.isnan(value):
            return ""
        printed = Printed(self.printed)
        return printed.show(value) if printed.is_number else f"{value:.3f}"

    def off(self, route: str) -> float:
        """Distance of a route from the printed number, in units of its last digit, signed."""
        printed = Printed(self.printed)
        return (self.values[route] - printed.value) / printed.unit

    @property
    def giving(self) -> list[str]:
        """The routes that give the printed digits, or by which an input or a statement holds."""
        compared = [route for route in self.routes if route in self.compared]
        if self.holds is not None:
            return [route for route in compared if self.holds[route]]
        return [route for route in compared if abs(self.off(route)) <= HALF]

    @property
    def tolerance(self) -> Tolerance | None:
        """The best tolerance that holds the printed number."""
        printed = Printed(self.printed).value
        return next((one for one in self.tolerances if one.holds(printed)), None)


def verdict(claim: Claim) -> Verdict:
    """The best verdict that the claim earns."""
    if claim.contradiction:
        return DIFFERS
    if claim.giving:
        return REPRODUCED if "exact" in claim.giving else RECONSTRUCTED
    if claim.holds is not None:
        return DIFFERS
    compared = [route for route in claim.routes if route in claim.compared]
    if any(abs(claim.off(route)) <= 1.0 + HALF for route in compared):
        return LAST_DIGIT
    return claim.tolerance.verdict if claim.tolerance else DIFFERS


def explanation(claim: Claim) -> str:
    """Why the claim has its verdict, in a sentence or two, from the numbers of its row."""
    if claim.holds is not None:
        return claim.cause
    decided = verdict(claim)
    if decided is REPRODUCED:
        return f"Exactly {claim.show('exact')}, which rounds to {claim.printed}."
    if decided is RECONSTRUCTED:
        giving = " and ".join(ROUTE_NAMES[route] for route in claim.giving)
        exact = f" (exact: {_distance(claim, 'exact')})" if "exact" in claim.routes else ""
        return f"Obtained {giving}{exact}. {claim.cause}".strip()
    if not claim.routes:
        return "No route gives a value."
    nearest = min(claim.routes, key=lambda route: abs(claim.off(route)))
    distance = f"{ROUTE_NAMES[nearest].capitalize()}: {_distance(claim, nearest)}"
    if decided is DIFFERS:
        evidence = claim.contradiction or claim.evidence
        return (
            f"{distance}. {evidence or 'Unexplained: no other number of the paper contradicts it.'}"
        )
    if decided is not LAST_DIGIT and claim.tolerance:
        return f"{distance}; {claim.tolerance.reason}. {claim.cause}".strip()
    return f"{distance}. {claim.cause}".strip()


def _distance(claim: Claim, route: str) -> str:
    """How far a route lies from the printed number, in words: units of the last digit if few, else per cent."""
    units = claim.off(route)
    side = "above" if units > 0 else "below"
    if abs(units) < 20.0:
        return f"{abs(units):.2g} units of the last digit {side} print"
    percent = 100.0 * abs(claim.values[route] / Printed(claim.printed).value - 1.0)
    return f"{percent:.0f} % {side} print" if percent >= 10.0 else f"{percent:.2g} % {side} print"
