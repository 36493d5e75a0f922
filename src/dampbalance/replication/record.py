"""Signals of one response in samples, from which features are read: those of an experiment or a fixed-step simulation.

A record holds the base motion y and the response x on a uniform time grid, and the velocity and acceleration where
they are known. It knows nothing of the oscillator: `clean.py` reads features off it.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import floats
from ..arrays import Array
from ..records.equal_steps import GRID_TOLERANCE, uneven

if TYPE_CHECKING:
    import pandas as pd


RECORD_COLUMNS = {
    "t": "time_s",
    "y": "y_m",
    "x": "x_m",
    "v": "v_m_per_s",
    "acceleration": "acceleration_m_per_s2",
}
"""Column of a data frame that holds each signal, named with its unit."""


@dataclass(frozen=True, eq=False)
class SimulatedRecord:
    """Signals of one response on a uniform time grid; read-only float arrays of one shape (n,), n ≥ 3.

    t : time, s, increasing in equal steps.   y : displacement of the base, m.   x : displacement of the mass, m.
    v : velocity of the mass, m/s, or None.   acceleration : of the mass, m/s², or None.

    Raises ValueError naming the signal and the sample: different lengths, NaN or infinity, a gap, unequal steps.
    """

    t: Array
    y: Array
    x: Array
    v: Array | None = None
    acceleration: Array | None = None

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if value is not None or field.name in ("t", "y", "x"):
                object.__setattr__(self, field.name, _signal(field.name, value))
        for name, signal in self.signals().items():
            if signal.size != self.t.size:
                raise ValueError(
                    f"SimulatedRecord.{name} has {signal.size} samples, t has {self.t.size}"
                )
        if problem := uneven(self.t, GRID_TOLERANCE):
            raise ValueError(f"SimulatedRecord.t {problem}; resample the record to equal steps")

    def __len__(self) -> int:
        return self.t.size

    @property
    def dt(self) -> float:
        """Sampling interval, s."""
        return float(self.t[-1] - self.t[0]) / (self.t.size - 1)

    def signals(self) -> dict[str, Array]:
        """Return the signals that are there, by name, t first."""
        present = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: signal for name, signal in present.items() if signal is not None}

    def samples(self, start: int, stop: int) -> Self:
        """Return the part of the record from sample `start` up to, not including, `stop`."""
        return type(self)(**{name: signal[start:stop] for name, signal in self.signals().items()})

    def to_frame(self) -> pd.DataFrame:
        """Return the record as a data frame, one row per sample, columns named with their units (`RECORD_COLUMNS`)."""
        import pandas as pd  # slow to import, and needed for tables only

        return pd.DataFrame(
            {RECORD_COLUMNS[name]: signal for name, signal in self.signals().items()}
        )


def _signal(name: str, values: ArrayLike) -> Array:
    """Return a read-only float copy of the signal, one-dimensional and finite."""
    try:
        signal = floats(values).copy()
    except ValueError as error:
        raise ValueError(f"SimulatedRecord.{name} must be numbers, not {error}") from None
    if signal.ndim != 1:
        raise ValueError(
            f"SimulatedRecord.{name} must be one-dimensional, got shape {signal.shape}"
        )
    if signal.size < 3:
        raise ValueError(f"SimulatedRecord.{name} must have at least 3 samples, got {signal.size}")
    bad = np.flatnonzero(~np.isfinite(signal))
    if bad.size:
        i = bad[0]
        raise ValueError(f"SimulatedRecord.{name} is {signal[i]} at sample {i} ({bad.size} in all)")
    signal.flags.writeable = False
    return signal
