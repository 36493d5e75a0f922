"""What the claims are judged from: the case of the configuration, and the result tables of a route."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd

from ...balance import TERMS
from ...model import Oscillator
from ...project.case import Case
from ..comparison import relative_errors
from .published import FREQUENCIES, HARMONIC, LEVELS, Published

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


@dataclass(frozen=True)
class RouteTables:
    """The result tables of one route, by frequency name.

    features : `Features.to_frame()`, one row per level.   estimates : `estimates.estimate_table`.
    What a route does not have is NaN.
    """

    features: Mapping[str, pd.DataFrame]
    estimates: Mapping[str, pd.DataFrame]

    def feature(self, column: str, level: int, frequency: str = "omega1") -> float:
        """A feature of the level counted from 1."""
        frame = self.features.get(frequency)
        if frame is None or level > len(frame):
            return math.nan
        return float(frame[column].iloc[level - 1])

    def mean_feature(self, column: str, frequency: str = "omega1") -> float:
        """Mean of a feature over the levels that have it."""
        frame = self.features.get(frequency)
        return math.nan if frame is None else float(frame[column].mean())

    def estimate(
        self,
        column: str,
        approach: str,
        *,
        kind: str = "pair",
        phase: str = "individual",
        pair: str = "all",
        frequency: str = "omega1",
    ) -> float:
        """One number of the estimates."""
        line = self._lines.get((frequency, approach, kind, phase, pair))
        return math.nan if line is None else float(line[column])

    @cached_property
    def _lines(self) -> dict[tuple[str, ...], dict[Hashable, Any]]:
        """The lines of the estimates by frequency, approach, kind, phase and pair."""
        return {
            (frequency, *(line[key] for key in ("approach", "kind", "phase", "pair"))): line
            for frequency, frame in self.estimates.items()
            for line in frame.to_dict("records")
        }

    def errors(
        self,
        oscillator: Oscillator,
        approaches: tuple[str, ...] = HARMONIC,
        frequency: str = "omega1",
    ) -> dict[str, pd.Series[float]]:
        """Errors of the pairs, per cent, signed, by term; harmonic approaches with common φ and t_s."""
        frame = self.estimates.get(frequency)
        if frame is None:
            return dict.fromkeys(TERMS, pd.Series(dtype=float))
        phase = np.where(frame["approach"] == "direct", "individual", "common")
        chosen = frame["approach"].isin(approaches) & (frame["kind"] == "pair")
        return relative_errors(frame[chosen & (frame["phase"] == phase)], oscillator)

    def largest_errors(
        self,
        oscillator: Oscillator,
        approaches: tuple[str, ...] = HARMONIC,
        frequency: str = "omega1",
    ) -> dict[str, float]:
        """The size of the largest of the `errors`, by term; NaN without any."""
        errors = self.errors(oscillator, approaches, frequency)
        return {name: float(error.abs().max()) for name, error in errors.items()}


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
        return {
            "exact": self.exact,
            "as_published": self.as_published,
            "from_print": self.from_print,
        }

    def features(self, column: str, level: int) -> dict[str, float]:
        """A feature by the routes that simulate; arguments as in `RouteTables.feature`."""
        return {
            "exact": self.exact.feature(column, level),
            "as_published": self.as_published.feature(column, level),
        }

    def unread(self, column: str, level: int) -> float:
        """A feature of the as-published simulation before it was read off, of the level counted from 1."""
        return RouteTables({"omega1": self.unrounded}, {}).feature(column, level)

    def estimates(self, column: str, approach: str, **which: str) -> dict[str, float]:
        """One number of the estimates by every route; arguments as in `RouteTables.estimate`."""
        return {
            name: route.estimate(column, approach, **which) for name, route in self.routes.items()
        }
