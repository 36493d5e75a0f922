"""The data that claims are judged from: printed numbers, the case of the configuration, results of the routes."""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

from ...project.case import Case
from ..claim_verdicts import ROUTE_NAMES
from ..route_tables import RouteTables
from .published import FREQUENCIES, LEVELS, Published

# Of as_published.APPROACHES_OF_TABLE_3: the V_s pairs as (19) states them; "V_s" there has the print's slip of sign.
CORRECTED = "V_s with minus"


def require_paper(case: Case) -> None:
    """Raise ValueError when the case lacks a frequency or a level of the paper."""
    missing = [name for name in FREQUENCIES if name not in case.frequencies_hz]
    if missing:
        raise ValueError(
            f"claims need the frequencies {', '.join(FREQUENCIES)}; missing: {', '.join(missing)}"
        )
    if len(case.levels_m) != LEVELS:
        raise ValueError(f"claims need the five levels of the paper, got {len(case.levels_m)}")


@dataclass(frozen=True, slots=True)
class Sources:
    """All that claims are judged from: the printed numbers, the case and the three routes.

    unrounded : the as-published simulation at ω1 in full digits, `ReadFeatures.to_frame()`.
    """

    published: Published
    case: Case
    exact: RouteTables
    as_published: RouteTables
    from_print: RouteTables
    unrounded: pd.DataFrame

    @property
    def routes(self) -> dict[str, RouteTables]:
        """The routes by their names in claims.csv."""
        return {name: getattr(self, name) for name in ROUTE_NAMES}

    def features(self, column: str, level: int) -> dict[str, float]:
        """A feature by the routes that simulate; arguments as in `RouteTables.feature`."""
        simulating = {"exact": self.exact, "as_published": self.as_published}
        return {name: route.feature(column, level) for name, route in simulating.items()}

    def unread(self, column: str, level: int) -> float:
        """A feature of the as-published simulation before it was read off, of the level counted from 1."""
        return RouteTables({"omega1": self.unrounded}, {}).feature(column, level)

    def estimates(self, column: str, approach: str, **which: str) -> dict[str, float]:
        """One number of the estimates by every route; arguments as in `RouteTables.estimate`."""
        return {
            name: route.estimate(column, approach, **which) for name, route in self.routes.items()
        }
