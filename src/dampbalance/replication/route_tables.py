"""The result tables of a route by which the paper's numbers are computed, and single numbers looked up in them."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd

from ..estimates import estimate_columns

PRINTED_APPROACHES = ("direct", "t_s", "X_s", "V_s")
"""The approaches that the paper prints estimates of, in the order of Tables 2 and 3."""

HARMONIC = PRINTED_APPROACHES[1:]

_NOTHING = pd.DataFrame(columns=estimate_columns(), dtype=float)


@dataclass(frozen=True)
class RouteTables:
    """The result tables of one route, by frequency name.

    features : `Features.to_frame()`, one row per level.   estimates : `estimates.estimate_table`.

    Estimates are looked up as the paper has them: with φ and t_s common to all levels for the pairs of the harmonic
    approaches, individual for all others. A number that a route does not have is NaN.
    """

    features: Mapping[str, pd.DataFrame]
    estimates: Mapping[str, pd.DataFrame]

    def feature(self, column: str, level: int, frequency: str = "omega1") -> float:
        """A feature of the level counted from 1."""
        frame = self.features.get(frequency)
        if frame is None or level > len(frame):
            return math.nan
        return float(frame[column].iloc[level - 1])

    def mean_feature(self, column: str) -> float:
        """Mean of a feature at ω1 over the levels that have it."""
        frame = self.features.get("omega1")
        return math.nan if frame is None else float(frame[column].mean())

    def estimate(
        self,
        column: str,
        approach: str,
        kind: str = "pair",
        pair: str = "all",
        frequency: str = "omega1",
    ) -> float:
        """One number of the estimates."""
        line = self._lines.get((frequency, approach, kind, pair))
        return math.nan if line is None else float(line[column])

    def pairs(
        self, approaches: tuple[str, ...] = HARMONIC, frequency: str = "omega1"
    ) -> pd.DataFrame:
        """The estimates of all pairs by some approaches."""
        frame = _as_in_paper(self.estimates.get(frequency, _NOTHING))
        return frame[frame["approach"].isin(approaches) & (frame["kind"] == "pair")]

    @cached_property
    def _lines(self) -> dict[tuple[str, ...], dict[Hashable, Any]]:
        """The lines of the estimates by frequency, approach, kind and pair."""
        return {
            (frequency, line["approach"], line["kind"], line["pair"]): line
            for frequency, frame in self.estimates.items()
            for line in _as_in_paper(frame).to_dict("records")
        }


def _as_in_paper(frame: pd.DataFrame) -> pd.DataFrame:
    individual = (frame["approach"] == "direct") | (frame["kind"] == "least_squares")
    return frame[frame["phase"] == np.where(individual, "individual", "common")]
