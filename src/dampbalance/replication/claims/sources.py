"""The data that claims are judged from: printed numbers, the case of the configuration, results of the routes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import pandas as pd

from ...project.case import Case
from ..claim_verdicts import ROUTE_NAMES
from ..route_tables import RouteTables
from . import allowed, checksums
from .from_print import from_print, printed_estimates
from .judging import Range
from .published import FREQUENCIES, LEVELS, Published, Row
from .reading_rules import rules_at_work

SIMULATING = ("exact", "as_published")
"""The routes that simulate."""


def require_paper(case: Case) -> None:
    """Raise ValueError when the case lacks a frequency or a level of the paper."""
    missing = [name for name in FREQUENCIES if name not in case.frequencies_hz]
    if missing:
        raise ValueError(
            f"claims need the frequencies {', '.join(FREQUENCIES)}; missing: {', '.join(missing)}"
        )
    if len(case.levels_m) != LEVELS:
        raise ValueError(f"claims need the five levels of the paper, got {len(case.levels_m)}")


@dataclass(frozen=True)
class Sources:
    """All that claims are judged from, and what is computed from it once for many of them.

    published : the printed numbers.   case : as configured.
    exact, as_published : the result tables of the routes that simulate.
    unrounded : the as-published simulation at ω1 in full digits, `ReadFeatures.to_frame()`.
    """

    published: Published
    case: Case
    exact: RouteTables
    as_published: RouteTables
    unrounded: pd.DataFrame

    @cached_property
    def from_print(self) -> RouteTables:
        """The route from the printed numbers."""
        return from_print(self.published, self.case)

    @cached_property
    def routes(self) -> dict[str, RouteTables]:
        """The routes by their names in claims.csv."""
        return {name: getattr(self, name) for name in ROUTE_NAMES}

    @cached_property
    def pairs(self) -> dict[str, RouteTables]:
        """The routes as in Tables 2 and 3, which print the pairs themselves."""
        return self.routes | {"from_print": printed_estimates(self.published)}

    @cached_property
    def unread(self) -> RouteTables:
        """The as-published simulation at ω1 before it was read off."""
        return RouteTables({"omega1": self.unrounded}, {})

    @cached_property
    def refuted(self) -> dict[str, str]:
        """The cells of Tables 1 and 2 that the printed least squares refute: id → a sentence."""
        return checksums.refuted(self.published, self.case)

    @cached_property
    def allowed(self) -> dict[str, Range | None]:
        """`allowed.ranges`."""
        return allowed.ranges(self.published, self.case)

    @cached_property
    def misfits(self) -> dict[str, float]:
        """`allowed.misfits`."""
        return allowed.misfits(self.published, self.case)

    @cached_property
    def rules_at_work(self) -> Callable[[Row], str]:
        """A function of a row that says what moves that number of Table 3."""
        return rules_at_work(self.case, self.exact, self.unrounded)

    def features(self, column: str, level: int) -> dict[str, float]:
        """A feature by the routes that simulate; arguments as in `RouteTables.feature`."""
        return {name: self.routes[name].feature(column, level) for name in SIMULATING}

    def estimates(self, column: str, approach: str, **which: str) -> dict[str, float]:
        """One number of the estimates by every route; arguments as in `RouteTables.estimate`."""
        return {
            name: route.estimate(column, approach, **which) for name, route in self.routes.items()
        }
