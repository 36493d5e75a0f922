"""The best verdict of `verdicts.VERDICTS` that a printed number earns by what the routes give for it.

The rule is the same for every number: the best verdict that holds. A route gives the printed digits if it lies within
half a unit of the last of them, whether or not the column was obtained by this route; `evidence.chance` counts how many
may do so by chance. If no route gives the digits, the one by which the column was obtained judges. In either case
neither it nor any other may be far off. A number that the paper's own numbers refute differs, whatever the routes give.
No verdict is typed in: it follows from the row, and so does its reason.

How far off a rebuilt number may lie, and why, behind "reading", "propagated" and "unexplained":

    quantity      range                                   reason                                             verdict
    φ             ± 0.05 ms                               the difference of two instants, each read to       reading
                                                          the nearest 0.05 ms: of the round units, the
                                                          coarsest that suits all five printed φ/ω
    φ             ± 0.2 ms                                two tenths of a millisecond, a bound fixed before  unexplained
                                                          the unit of reading was looked for in print
    F_k, c of     what the rest of Table 2 allows         computed from inputs with digits that are          propagated
    a pair        (`cross_checks.py`)                 not printed
    Table 2       less than ten units of the last digit,  the last digit alone is wrong; two programs of     unexplained
                  and less than a step in a period        one scheme may differ by where a cycle begins

Everything else has no range: whole tenths, rounded read-outs and the arithmetic on printed numbers leave nothing open.
V_s, too, was read off a plot, but no mark coarser than its last digit suits all five printed values, so that they are
judged like rounded ones: the exact ones come closest.
The bounds of "unexplained" state what nearness means for a kind of quantity; no number that they judge enters them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from ...project.case import Case
from . import verdicts
from .printed import Printed, Row
from .verdicts import ROUTE_NAMES, ClaimVerdict

NumberRange = tuple[float, float]

HALF = 0.5 * (1.0 + 1e-9)
"""Units of the last digit within which a number gives the printed one, with the rounding of binary fractions."""

WRITTEN = 1e-6
"""Units of the last digit within which a number agrees that the route itself rounds to the printed digits."""


MAX_DEVIATION_OF_OTHER_ROUTES = 5e-3
"""Largest relative deviation of a route that does not judge: half of the 1 % that must always be seen."""


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
    route : the one by which the column came about.
    holds : for an input or a statement, whether it holds by that route; None for a number, compared by its digits.
    undecided : for a statement, whether it may hold or not within what the print leaves open.
    half_unit : distance from `route`, in units of the last digit, up to which the digits agree; NaN where it was
    read more coarsely than it is printed, so that its digits say nothing.
    allowed : the range that the paper's other numbers leave for the number before it was rounded, or None.
    tolerances : ranges that earn other verdicts, the best first.
    shown_only : routes that are shown but do not judge, because they leave out what makes the number.
    expected : the number that a route should give, where that is not the printed one.
    cause : the deviation behind the digits, one sentence computed from the same run; "" without one.
    contradiction : which of the paper's own numbers refute this one, whatever any route gives; "" if none does.
    """

    row: Row
    values: Mapping[str, float]
    route: str = "exact"
    holds: bool | None = None
    undecided: bool = False
    half_unit: float = HALF
    allowed: NumberRange | None = None
    tolerances: tuple[Tolerance, ...] = ()
    shown_only: tuple[str, ...] = ()
    expected: Mapping[str, float] = field(default_factory=dict)
    cause: str = ""
    contradiction: str = ""

    def value(self, route: str) -> float:
        """Return the number of a route, NaN if it gives none."""
        return self.values.get(route, math.nan)

    @property
    def routes(self) -> list[str]:
        """The routes that give a number, in the order of ROUTE_NAMES."""
        return [route for route in ROUTE_NAMES if not math.isnan(self.value(route))]

    def show(self, route: str) -> str:
        """Return the value of a route, written like the printed number with a few more digits; "" if there is none."""
        return self.row.number.show(self.value(route))

    def off(self, route: str) -> float:
        """Return the distance of a route from print, in units of the last digit, signed."""
        return (self.value(route) - self.row.number.value) / self.row.number.unit

    def off_relative(self, route: str) -> float:
        """Return the distance of a route from the printed number, relative to the latter, signed."""
        return self.value(route) / self.row.number.value - 1.0

    @property
    def agreeing(self) -> list[str]:
        """The routes that give the printed digits, the best first; none for a statement."""
        if self.holds is not None:
            return []
        reaches = {self.route: self.half_unit}
        return [r for r in self.routes if abs(self.off(r)) <= reaches.get(r, HALF)]

    @property
    def deciding(self) -> str:
        """The route that earns the verdict, none of `shown_only`.

        It is the best one that gives the digits; if none does, that of the column.
        """
        return next((r for r in self.agreeing if r not in self.shown_only), self.route)

    @property
    def strays(self) -> list[str]:
        """The routes that deviate by more than MAX_DEVIATION_OF_OTHER_ROUTES.

        That of the column is among them only where another one decides.
        """

        def far(route: str) -> float:
            return abs(self.value(route) / self.expected.get(route, self.row.number.value) - 1.0)

        exempt = (*self.shown_only, *([self.route] if self.deciding == self.route else []))
        return [
            route
            for route in self.routes
            if route not in exempt and not far(route) <= MAX_DEVIATION_OF_OTHER_ROUTES
        ]

    @property
    def tolerance(self) -> Tolerance | None:
        """The best tolerance that holds the number of the column's route."""
        value = self.value(self.route)
        return next((t for t in self.tolerances if t.low <= value <= t.high), None)

    @property
    def one_unit_off(self) -> bool:
        """Whether the column's route misses the print by one unit of the last digit, which rounding may explain.

        It cannot explain it if the paper's other numbers leave a range for the number before it was rounded, and the
        route lies more than half a unit outside this range.
        """
        number, value = self.row.number, self.value(self.route)
        low, high = self.allowed or (value, value)
        excluded = max(low - value, value - high) > 0.5 * number.unit
        near = abs(self.off(self.route)) <= 1.0 + self.half_unit
        # of two significant digits, the last one counts per cents
        return near and number.significant >= 3 and not excluded


def verdict(claim: Claim) -> ClaimVerdict:
    """Return the best verdict that the claim earns."""
    if claim.contradiction or claim.route not in claim.routes:
        return verdicts.DIFFERS
    if claim.undecided:
        return verdicts.UNDECIDED
    if claim.holds is not None:
        return verdicts.VERDICT_BY[claim.route] if claim.holds else verdicts.DIFFERS
    if claim.strays:
        return verdicts.DIFFERS
    if claim.deciding in claim.agreeing:
        return verdicts.VERDICT_BY[claim.deciding]
    if claim.one_unit_off:
        return verdicts.LAST_DIGIT
    return claim.tolerance.verdict if claim.tolerance else verdicts.DIFFERS


def explanation(claim: Claim) -> str:
    """Return why the claim has its verdict, in a sentence or two, from the numbers of its row."""
    if claim.holds is not None:
        return claim.cause
    decided = verdict(claim)
    if claim.route not in claim.routes:
        return f"The route “{ROUTE_NAMES[claim.route]}” gives no number."
    route = claim.route if decided is verdicts.DIFFERS else claim.deciding
    far, why = f"{ROUTE_NAMES[route].capitalize()}: {_distance(claim, route)}", claim.cause
    if decided in verdicts.VERDICT_BY.values():
        how = f"Exactly {claim.show('exact')}, which rounds to {claim.row.printed}."
        if decided is not verdicts.REPRODUCED:
            exact = f" (exact: {_distance(claim, 'exact')})" if "exact" in claim.routes else ""
            how = f"Obtained {ROUTE_NAMES[route]}{exact}."
        return " ".join(filter(None, [how, _column(claim), why]))
    if decided is verdicts.DIFFERS:
        strays = " and ".join(f"{ROUTE_NAMES[r]} {_distance(claim, r)}" for r in claim.strays)
        why = claim.contradiction or (
            f"More than the named deviation explains: {strays}."
            if strays
            else "It exceeds every bound, and no other number of the paper contradicts the print."
        )
    elif decided is not verdicts.LAST_DIGIT and claim.tolerance:
        far += f"; {claim.tolerance.reason}"
    return f"{far}. {why}".strip()


def _column(claim: Claim) -> str:
    """Return how the number lies by which the column came about, where another one decides; "" otherwise."""
    if claim.deciding == claim.route:
        return ""
    arose = f"its column came about {ROUTE_NAMES[claim.route]}"
    if claim.route in claim.agreeing:
        return f"{arose[0].upper()}{arose[1:]}, which gives the digits as well."
    return f"This may be chance: {arose}, {_distance(claim, claim.route)}."


def _distance(claim: Claim, route: str) -> str:
    """Return how far a route lies from the printed number, in words: units of the last digit if few, else per cent."""
    units = claim.off(route)
    side = "above" if units > 0 else "below"
    if abs(units) < 20.0:
        few = f"{abs(units):.2g}"
        return f"{few} unit{'' if few == '1' else 's'} of the last digit {side} print"
    percent = 100.0 * abs(claim.off_relative(route))
    return f"{percent:{'.0f' if percent >= 10.0 else '.2g'}} % {side} print"


TIME_UNIT_S = 1e-4
VELOCITY_MARK = 5e-5  # m/s; some printed V_s are whole multiples of it

PHASE_UNIT_S = 5e-5
"""The coarsest of the units 1, 2 and 5 times a power of ten of which all printed φ/ω are multiples, as rounded."""

NEAR_PHASE_S = 2e-4
"""Largest deviation of a phase that is near, s: a tenth of a millisecond misread at each of two instants."""

NEAR_UNITS = 10.0
"""Units of the last digit within which a simulated number is near: right in all digits except the last."""

UNKNOWN = "the cause is unknown"


def phase_read(number: Printed, omega: float) -> tuple[Tolerance, ...]:
    """Allow φ as the difference of two instants that were each read to the nearest unit of time.   omega : rad/s."""
    value, step, far = number.value, omega * PHASE_UNIT_S, omega * NEAR_PHASE_S
    how = f"two instants, each to the nearest {1e3 * PHASE_UNIT_S:g} ms, fix the phase to {step:.4f} rad"
    beyond = f"{how}; it is less than {1e3 * NEAR_PHASE_S:g} ms off, and {UNKNOWN}"
    return (
        Tolerance(value - step, value + step, how, verdicts.READING),
        Tolerance(value - far, value + far, beyond, verdicts.UNEXPLAINED),
    )


def propagated(allowed: NumberRange | None, number: Printed) -> tuple[Tolerance, ...]:
    """Allow F_k or c of a pair in the range that the rest of Table 2 allows, if any."""
    if allowed is None:
        return ()
    reason = f"unprinted digits allow {range_text(allowed, number)}"
    return (Tolerance(*allowed, reason, verdicts.PROPAGATED),)


def simulated(number: Printed, case: Case) -> tuple[Tolerance, ...]:
    """Allow a number of Table 2 close to print without a reason.   case : for ω1 and the step of the simulation."""
    value, share = number.value, case.numerics.step_s * case.omega("omega1") / (2.0 * math.pi)
    far = min(NEAR_UNITS * number.unit, share * abs(value))
    near = f"less than {NEAR_UNITS:g} units and a relative {share:.1e}, one step in a period"
    return (Tolerance(value - far, value + far, f"{near}; {UNKNOWN}", verdicts.UNEXPLAINED),)


def range_text(ends: NumberRange, number: Printed) -> str:
    """Return a range as text, with two digits more than are printed."""
    return " to ".join(number.show(end, 2) for end in ends)
