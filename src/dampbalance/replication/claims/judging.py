"""From a printed number and what the routes give for it to the best verdict of `claim_verdicts.VERDICTS` that it earns.

One route judges a claim: the one by which the numbers of its column came about. It gives the printed digits when it
lies within half a unit of the last of them. That another route rounds to the same digits is chance; it must not be far
off, though. Nothing here is typed in: the verdict follows from the row, and so does its reason.

How far off a rebuilt number may lie, and why, behind "reading", "propagated" and "unexplained":

    quantity      range                                   reason                                             verdict
    φ             ± 0.1 ms                                the difference of two instants, each read to       reading
                                                          the nearest tenth of a millisecond
    V_s           ± 0.025 mm/s about the first            read off an axis to the nearest 0.05 mm/s          reading
                  slipping sample
    φ, V_s        twice as far                            a whole mark misread where half of one is due      unexplained
    F_k, c of     what the rest of Table 2 allows         computed from inputs with digits that are          propagated
    a pair        (`cross_checks.py`)                 not printed
    Table 2       less than ten units of the last digit,  the last digit alone is wrong; two programs of     unexplained
                  and less than a step in a period        one scheme may differ by where a cycle begins

Everything else has no range: whole tenths, rounded read-outs and the arithmetic on printed numbers leave nothing open.
The bounds of "unexplained" state what nearness means for a kind of quantity; no number that they judge enters them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from ...project.case import Case
from ..claim_verdicts import (
    DIFFERS,
    LAST_DIGIT,
    PROPAGATED,
    READING,
    RECONSTRUCTED,
    REPRODUCED,
    ROUTE_NAMES,
    UNEXPLAINED,
    ClaimVerdict,
)
from .published import Printed, Row

Range = tuple[float, float]

HALF = 0.5 * (1.0 + 1e-9)
"""Units of the last digit within which a number gives the printed one, with the rounding of binary fractions."""

WRITTEN = 1e-6
"""Units of the last digit that a number may be off which the route itself writes with the digits of the print."""

FEWEST_DIGITS = 3
"""Significant digits below which one unit off is no near miss: of two digits, the last one counts per cents."""

LEASH = 5e-3
"""How far from print, of itself, a route may lie that does not judge: half of the 1 % that must always be seen."""


@dataclass(frozen=True, slots=True)
class Tolerance:
    """A range in which the judging route's number earns a verdict, from `low` to `high`, and why."""

    low: float
    high: float
    reason: str
    verdict: ClaimVerdict


@dataclass(frozen=True, slots=True)
class Claim:
    """One printed number, what the routes give for it, and why they differ.

    values : a number per route of ROUTE_NAMES, NaN or absent where the route has nothing to say.
    route : the one that judges.
    holds : for an input or a statement, whether it holds by that route; None for a number, compared by its digits.
    reach : how many units of the last digit the printed digits reach; NaN for a column that was read off a plot, whose
    digits agree by chance at best.
    allowed : the range that the paper's other numbers leave for the number before it was rounded, or None.
    tolerances : ranges that earn other verdicts, the best first.
    apart : routes that are shown only, because they leave out what made the number.
    nearby : where another route belongs if not at the printed number.
    cause : the deviation behind the digits, one sentence computed from the same run; "" without one.
    contradiction : which of the paper's own numbers refute this one, whatever any route gives; "" if none does.
    evidence : what in the paper's own numbers contradicts the printed one, should it differ.
    """

    row: Row
    values: Mapping[str, float]
    route: str = "exact"
    holds: bool | None = None
    reach: float = HALF
    allowed: Range | None = None
    tolerances: tuple[Tolerance, ...] = ()
    apart: tuple[str, ...] = ()
    nearby: Mapping[str, float] = field(default_factory=dict)
    cause: str = ""
    contradiction: str = ""
    evidence: str = ""

    def value(self, route: str) -> float:
        """The number of a route, NaN if it gives none."""
        return self.values.get(route, math.nan)

    @property
    def routes(self) -> list[str]:
        """The routes that give a number, in the order of ROUTE_NAMES."""
        return [route for route in ROUTE_NAMES if not math.isnan(self.value(route))]

    def show(self, route: str) -> str:
        """The value of a route, written like the printed number with a few more digits; "" if there is none."""
        return self.row.number.show(self.value(route))

    def off(self, route: str) -> float:
        """Distance of a route from print, in units of the last digit, signed."""
        return (self.value(route) - self.row.number.value) / self.row.number.unit

    def off_relative(self, route: str) -> float:
        """Distance of a route from the printed number, of the latter, signed."""
        return self.value(route) / self.row.number.value - 1.0

    @property
    def strays(self) -> list[str]:
        """The routes next to the judging one that lie further than LEASH from where they belong."""

        def far(route: str) -> float:
            return abs(self.value(route) / self.nearby.get(route, self.row.number.value) - 1.0)

        others = [route for route in self.routes if route not in (self.route, *self.apart)]
        return [route for route in others if not far(route) <= LEASH]

    @property
    def tolerance(self) -> Tolerance | None:
        """The best tolerance that holds the number of the judging route."""
        value = self.value(self.route)
        return next((t for t in self.tolerances if t.low <= value <= t.high), None)

    @property
    def one_unit_off(self) -> bool:
        """Whether the judging route misses by a digit that rounding may have moved.

        It may not where the paper's other numbers show what was rounded, and the route lies half a unit from that.
        """
        number, value = self.row.number, self.value(self.route)
        low, high = self.allowed or (value, value)
        excluded = max(low - value, value - high) > 0.5 * number.unit
        near = abs(self.off(self.route)) <= 1.0 + self.reach
        return near and number.significant >= FEWEST_DIGITS and not excluded


def verdict(claim: Claim) -> ClaimVerdict:
    """The best verdict that the claim earns."""
    if claim.contradiction or claim.route not in claim.routes:
        return DIFFERS
    given = REPRODUCED if claim.route == "exact" else RECONSTRUCTED
    if claim.holds is not None:
        return given if claim.holds else DIFFERS
    if claim.strays:
        return DIFFERS
    if abs(claim.off(claim.route)) <= claim.reach:
        return given
    if claim.one_unit_off:
        return LAST_DIGIT
    return claim.tolerance.verdict if claim.tolerance else DIFFERS


def explanation(claim: Claim) -> str:
    """Why the claim has its verdict, in a sentence or two, from the numbers of its row."""
    if claim.holds is not None:
        return claim.cause
    decided, route = verdict(claim), ROUTE_NAMES[claim.route]
    if decided is REPRODUCED:
        return f"Exactly {claim.show('exact')}, which rounds to {claim.row.printed}."
    if claim.route not in claim.routes:
        return f"No number {route}."
    if decided is RECONSTRUCTED:
        exact = f" (exact: {_distance(claim, 'exact')})" if "exact" in claim.routes else ""
        return f"Obtained {route}{exact}. {claim.cause}".strip()
    far, why = f"{route.capitalize()}: {_distance(claim, claim.route)}", claim.cause
    if decided is DIFFERS:
        strays = " and ".join(f"{ROUTE_NAMES[r]} {_distance(claim, r)}" for r in claim.strays)
        why = claim.contradiction or (
            f"Too far for the deviation that is named: {strays}."
            if strays
            else claim.evidence
            or "No bound reaches so far, and no other number of the paper contradicts it."
        )
    elif decided is not LAST_DIGIT and claim.tolerance:
        far += f"; {claim.tolerance.reason}"
    return f"{far}. {why}".strip()


def _distance(claim: Claim, route: str) -> str:
    """How far a route lies from the printed number, in words: units of the last digit if few, else per cent."""
    units = claim.off(route)
    if route != claim.route and abs(units) <= HALF:
        return "rounds to print as well, by chance"
    side = "above" if units > 0 else "below"
    if abs(units) < 20.0:
        few = f"{abs(units):.2g}"
        return f"{few} unit{'' if few == '1' else 's'} of the last digit {side} print"
    percent = 100.0 * abs(claim.off_relative(route))
    return f"{percent:{'.0f' if percent >= 10.0 else '.2g'}} % {side} print"


TIME_UNIT_S = 1e-4
VELOCITY_MARK = 5e-5  # m/s; the printed V_s of levels 2 to 5 are whole multiples of it

NEAR_READINGS = 2.0
"""A reading is near up to so many times what its resolution explains: a whole mark misread instead of half of one."""

NEAR_UNITS = 10.0
"""Units of the last digit: a simulated number that is less far off is right in all digits but the last."""

NOTHING = "nothing says why"


def phase_read(number: Printed, omega: float) -> tuple[Tolerance, ...]:
    """φ as the difference of two instants that were each read to the nearest unit of time.   omega : rad/s."""
    step = omega * TIME_UNIT_S
    how = f"a difference of two instants, each to the nearest {1e3 * TIME_UNIT_S:g} ms, is known to {step:.4f} rad"
    return _read(number.value, step, how)


def velocity_read(number: Printed, to_sample: float) -> tuple[Tolerance, ...]:
    """V_s as the velocity of the first slipping sample, read to the nearest mark.

    to_sample : by how much it exceeds that of the onset itself, which the route gives, m/s.
    """
    half = 0.5 * VELOCITY_MARK
    how = f"the first slipping sample, to the nearest {1e3 * VELOCITY_MARK:g} mm/s, is known to {1e3 * half:g} mm/s"
    return _read(number.value - to_sample, half, how)


def propagated(allowed: Range | None, number: Printed) -> tuple[Tolerance, ...]:
    """F_k or c of a pair in the range that the rest of Table 2 allows, if any."""
    if allowed is None:
        return ()
    reason = f"digits that are not printed leave {shown(allowed, number)}"
    return (Tolerance(*allowed, reason, PROPAGATED),)


def simulated(number: Printed, case: Case) -> tuple[Tolerance, ...]:
    """A number of Table 2 close to print without a reason.   case : for ω1 and the step of the simulation."""
    value, share = number.value, case.numerics.step_s * case.omega("omega1") / (2.0 * math.pi)
    far = min(NEAR_UNITS * number.unit, share * abs(value))
    near = f"less than {NEAR_UNITS:g} units and {share:.1e} of itself, a step in a period"
    return (Tolerance(value - far, value + far, f"{near}; {NOTHING}", UNEXPLAINED),)


def shown(ends: Range, number: Printed) -> str:
    """A range as text, with two digits more than are printed."""
    return " to ".join(number.show(end, 2) for end in ends)


def _read(value: float, step: float, how: str) -> tuple[Tolerance, ...]:
    far = NEAR_READINGS * step
    beyond = f"{how}; it is less than {NEAR_READINGS:g} times as far off, and {NOTHING}"
    return (
        Tolerance(value - step, value + step, how, READING),
        Tolerance(value - far, value + far, beyond, UNEXPLAINED),
    )
