"""Signals of one simulated response in samples, from which `clean.py` reads features."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False)
class SimulatedRecord:
    """Signals of one response on a uniform time grid: float arrays of one shape (n,).

    t : time, s, increasing in equal steps.
    y : displacement of the base, m.
    x, v, acceleration : displacement, m, velocity, m/s, and acceleration, m/s², of the mass.
    """

    t: Array
    y: Array
    x: Array
    v: Array
    acceleration: Array

    def __len__(self) -> int:
        return self.t.size

    @property
    def dt(self) -> float:
        """Sampling interval, s."""
        return float(self.t[-1] - self.t[0]) / (self.t.size - 1)

    @property
    def signals(self) -> Array:
        """The rows y, x, v and acceleration, (4, n)."""
        return np.stack([self.y, self.x, self.v, self.acceleration])

    def to_frame(self) -> pd.DataFrame:
        """Return the record as a data frame, one row per sample; the names of the columns end with their units."""
        import pandas as pd  # slow to import, and needed for tables only

        return pd.DataFrame(
            {
                "time_s": self.t,
                "y_m": self.y,
                "x_m": self.x,
                "v_m_per_s": self.v,
                "acceleration_m_per_s2": self.acceleration,
            }
        )
