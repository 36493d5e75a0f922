"""From a printed number and what the routes give for it to the best verdict of `verdicts.VERDICTS` that it earns.

A route gives the printed digits when it lies within half a unit of the last of them; statements ("less than 1.5 %")
are given when they hold. Nothing here is typed in: the verdict follows from the row, and so does the sentence for it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from ..printed import Printed
from ..verdicts import DIFFERS, LAST_DIGIT, READING, RECONSTRUCTED, REPRODUCED, ROUTE_NAMES, Verdict

# A printed number and a computed one meet at half a unit only up to the rounding of binary fractions.
HALF = 0.5 * (1.0 + 1e-9)


@dataclass(frozen=True, slots=True)
class Resolution:
    """How finely a quantity can have been read: numbers from `low` to `high` are one reading, for `reason`."""

    low: float
    high: float
    reason: str


@dataclass(frozen=True, slots=True)
class Claim:
    """One printed number, what the routes give for it, and why they differ.

    values : a number per route of ROUTE_NAMES, NaN or absent where the route has nothing to say.
    holds : for a statement, whether it holds by each route; None for a number, which is compared by its digits.
    cause : the deviation behind the digits, one sentence computed from the same run; "" without one.
    evidence : what in the paper's own numbers contradicts the printed one, should it differ.
    """

    id: str
    where: str
    quantity: str
    unit: str
    printed: str
    values: Mapping[str, float]
    holds: Mapping[str, bool] | None = None
    resolution: Resolution | None = None
    cause: str = ""
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


def verdict(claim: Claim) -> Verdict:
    """The best verdict that the claim earns."""
    if claim.holds is not None:
        agreeing = [route for route in claim.routes if claim.holds[route]]
        within_one = False
    else:
        agreeing = [route for route in claim.routes if abs(claim.off(route)) <= HALF]
        within_one = any(abs(claim.off(route)) <= 1.0 + HALF for route in claim.routes)
    if "exact" in agreeing:
        return REPRODUCED
    if agreeing:
        return RECONSTRUCTED
    if within_one:
        return LAST_DIGIT
    if (
        claim.resolution
        and claim.resolution.low <= Printed(claim.printed).value <= claim.resolution.high
    ):
        return READING
    return DIFFERS


def explanation(claim: Claim) -> str:
    """Why the claim has its verdict, in a sentence or two, from the numbers of its row."""
    if claim.holds is not None:
        return claim.cause
    decided = verdict(claim)
    if decided is REPRODUCED:
        return f"Exactly {claim.show('exact')}, which rounds to {claim.printed}."
    if decided is RECONSTRUCTED:
        giving = " and ".join(
            ROUTE_NAMES[route] for route in claim.routes if abs(claim.off(route)) <= HALF
        )
        exact = f" (exact: {_distance(claim, 'exact')})" if "exact" in claim.routes else ""
        return f"Obtained {giving}{exact}. {claim.cause}".strip()
    if not claim.routes:
        return "No route gives a value."
    nearest = min(claim.routes, key=lambda route: abs(claim.off(route)))
    distance = f"{ROUTE_NAMES[nearest].capitalize()}: {_distance(claim, nearest)}"
    if decided is READING and claim.resolution:
        printed = Printed(claim.printed)
        low, high = printed.show(claim.resolution.low, 0), printed.show(claim.resolution.high, 0)
        return f"{distance}; {low} to {high} is one reading: {claim.resolution.reason}. {claim.cause}".strip()
    if decided is DIFFERS:
        return f"{distance}. {claim.evidence or 'Unexplained: no other number of the paper contradicts it.'}"
    return f"{distance}. {claim.cause}".strip()


def _distance(claim: Claim, route: str) -> str:
    """How far a route lies from the printed number, in words: units of the last digit if few, else per cent."""
    units = claim.off(route)
    side = "above" if units > 0 else "below"
    if abs(units) < 20.0:
        return f"{abs(units):.2g} units of the last digit {side} print"
    percent = 100.0 * abs(claim.values[route] / Printed(claim.printed).value - 1.0)
    return f"{percent:.0f} % {side} print" if percent >= 10.0 else f"{percent:.2g} % {side} print"
