"""What the claims are judged from: the case of the configuration, and the result tables of a route."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from ...model import Oscillator
from ...solver import Pair, pair_label
from .published import Published

# The paper's three drive frequencies, by the names they have in the configuration and in results/.
FREQUENCIES = ("omega1", "omega2", "omega3")
LEVELS = 5
PAIRS: tuple[Pair, ...] = ((0, 1), (1, 2), (2, 3), (3, 4), (0, 4))
PAIR_LABELS = tuple(pair_label(i, j) for i, j in PAIRS)
HARMONIC = ("X_s", "t_s", "V_s")
# Of balance.APPROACHES_OF_TABLE_3: the V_s pairs as (19) states them; those of "V_s" have the print's slip of sign.
CORRECTED = "V_s with minus"


@dataclass(frozen=True, slots=True)
class Setting:
    """What the configuration holds: the simulated system, its drive, and the numerics of the as-published route.

    oscillator : SI.   frequencies_hz : by name, Hz.   levels_m : amplitudes Y, m.
    scheme, step_s : of the as-published simulation, s.
    k_over_m : the coefficient as that simulation holds it, 1/s² (rounded: 954.545).
    """

    oscillator: Oscillator
    frequencies_hz: Mapping[str, float]
    levels_m: tuple[float, ...]
    scheme: str
    step_s: float
    k_over_m: float

    def __post_init__(self) -> None:
        missing = [name for name in FREQUENCIES if name not in self.frequencies_hz]
        if missing:
            raise ValueError(
                f"claims need the frequencies {', '.join(FREQUENCIES)}; missing: {', '.join(missing)}"
            )
        if len(self.levels_m) != LEVELS:
            raise ValueError(f"claims need the five levels of the paper, got {len(self.levels_m)}")

    def omega(self, frequency: str = "omega1") -> float:
        """Circular drive frequency ω = 2πf, rad/s."""
        return 2.0 * math.pi * self.frequencies_hz[frequency]


@dataclass(frozen=True, slots=True)
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
        frame = self.estimates.get(frequency)
        if frame is None:
            return math.nan
        wanted = {"approach": approach, "kind": kind, "phase": phase, "pair": pair}
        chosen = np.logical_and.reduce([frame[key] == value for key, value in wanted.items()])
        values = frame.loc[chosen, column]
        return float(values.iloc[0]) if len(values) else math.nan

    def largest_errors(
        self,
        oscillator: Oscillator,
        approaches: tuple[str, ...] = HARMONIC,
        frequency: str = "omega1",
    ) -> tuple[float, float]:
        """Largest errors of F_k and of c over the pairs, per cent; harmonic approaches with common φ and t_s."""
        frame = self.estimates.get(frequency)
        if frame is None:
            return math.nan, math.nan
        phase = np.where(frame["approach"] == "direct", "individual", "common")
        taken = frame[
            frame["approach"].isin(approaches)
            & (frame["kind"] == "pair")
            & (frame["phase"] == phase)
        ]
        F_k_error = (taken["F_k_N"] / oscillator.F_k - 1.0).abs().max()
        c_error = (taken["c_N_s_per_m"] / oscillator.c - 1.0).abs().max()
        return 100.0 * float(F_k_error), 100.0 * float(c_error)


@dataclass(frozen=True, slots=True)
class Sources:
    """All that claims are judged from: the printed numbers, the configuration and the three routes."""

    published: Published
    setting: Setting
    exact: RouteTables
    as_published: RouteTables
    from_print: RouteTables

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

    def estimates(self, column: str, approach: str, **which: str) -> dict[str, float]:
        """One number of the estimates by every route; arguments as in `RouteTables.estimate`."""
        return {
            name: route.estimate(column, approach, **which) for name, route in self.routes.items()
        }
