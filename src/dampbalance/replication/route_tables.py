"""The result tables of a route by which the paper's numbers are computed, and single numbers looked up in them."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd

from ..balance import TERMS
from ..model import Oscillator
from .comparison import relative_errors

PRINTED_APPROACHES = ("direct", "t_s", "X_s", "V_s")
"""The approaches that the paper prints estimates of, in the order of Tables 2 and 3."""

HARMONIC = PRINTED_APPROACHES[1:]


@dataclass(frozen=True)
class RouteTables:
    """The result tables of one route, by frequency name.

    features : `Features.to_frame()`, one row per level.   estimates : `estimates.estimate_table`.
    Look-ups of a number that a route does not have give NaN.
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
