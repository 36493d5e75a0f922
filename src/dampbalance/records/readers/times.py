"""Times of samples: in equal steps, as points in time or spans of it in text, and rounded to too few digits.

Texts are read as seconds from the first of a column on.

2026-03-01T12:00:00.0005+01:00    ISO 8601, with T or a blank, a zone or none, a point or a comma
12:00:00.0005                     a time of day; midnight may pass
0 days 00:00:00.000500            a span, as pandas writes it
"""

from __future__ import annotations

import re
import warnings
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import Array
from ...project.wording import Remark
from ...record import GRID_TOLERANCE
from ..errors import RecordWarning

if TYPE_CHECKING:
    import pandas as pd

_CLOCK = r"\d{1,2}:\d{2}(:\d{2}([.,]\d+)?)?"
_POINT = re.compile(rf"\d{{4}}-\d{{2}}-\d{{2}}[T ]{_CLOCK} ?(Z|[+-]\d{{2}}(:?\d{{2}})?)?")
_SPAN = re.compile(rf"(-?\d+ days? \+?)?{_CLOCK}")
_DATE = re.compile(r"\d{1,4}[-./]\d{1,2}[-./]\d{1,4}([T ].{1,30})?")
_DAY = 86400.0  # s
_INTEGER = 0.01  # of the resolution: room for the rounding of its multiples to floats
_WITHIN = 1.5  # resolutions; rounding, and what the line is off by itself
_ACCURATE = 1e-3  # of the rate, that it may be off by at the most: c is then off by as much


def times(rate_hz: float, start: float, first: int, count: int) -> Array:
    """Times, s, of `count` samples from number `first` on."""
    return start + np.arange(first, first + count) / rate_hz


def mean_rate(t: Array) -> float:
    """Samples per second of a channel with these times, s."""
    return (t.size - 1) / float(t[-1] - t[0])


def is_stamp(cell: str) -> bool:
    """Whether a text is a point in time, or a span of it, that can be read."""
    return bool(_POINT.fullmatch(cell) or _SPAN.fullmatch(cell))


def is_date(cell: str) -> bool:
    """Whether a text is a date, perhaps with a time, in whatever order of day, month and year."""
    return bool(_DATE.fullmatch(cell))


class Clock:
    """Turns the texts of a column, part by part, into seconds from its first one on."""

    def __init__(self, first: str) -> None:
        self.points = bool(_POINT.fullmatch(first))
        self.of_day = not self.points and "day" not in first
        self.first = self._read([first])[0]
        self.passed, self.last = 0.0, 0.0

    def seconds(self, cells: pd.Series[str]) -> Array:
        """Seconds from the first text of the column on; NaN for an empty cell. Raises ValueError."""
        import pandas as pd  # slow to import

        spans = pd.TimedeltaIndex(self._read(cells) - self.first)
        seconds = np.asarray(spans.total_seconds(), dtype=np.float64)
        if self.of_day and seconds.size:
            back = np.diff(seconds, prepend=self.last) < -0.5 * _DAY
            self.last = float(seconds[-1])
            seconds = seconds + self.passed + _DAY * np.cumsum(back)
            self.passed += _DAY * float(np.count_nonzero(back))
        return seconds

    def _read(self, cells: pd.Series[str] | list[str]) -> pd.DatetimeIndex | pd.TimedeltaIndex:
        import pandas as pd  # slow to import

        texts = pd.Index(cells).str.replace(",", ".").str.strip()
        # pandas takes many a text for a span
        if not texts.dropna().str.fullmatch((_POINT if self.points else _SPAN).pattern).all():
            raise ValueError("a cell is no time")
        if self.points:
            return pd.DatetimeIndex(pd.to_datetime(texts, format="ISO8601", utc=True))
        return pd.TimedeltaIndex(pd.to_timedelta(texts))


def in_equal_steps(t: Array, where: str) -> Array:
    """The times of a channel: t_i = t_0 + i Δt by least squares, where it holds these rounded to too few digits, as
    stamps in ms of 20,000 samples a second are.

    It does if all are multiples of a decimal resolution q apart and none is further than that from the line. Rounding
    errors of up to q/2 put the slope off by 3q/2T at the most, T being the length of the record; they rarely conspire
    like that, and a hundredth of it is common. A warning states the bound. Any other times are returned as they are.

    t : s.   where : file and channel, for the warning.
    """
    steps = np.diff(t)
    if t.size < 3 or not steps.min() >= 0.0 or not t[-1] > t[0]:
        return t
    even = np.linspace(t[0], t[-1], t.size)
    if np.abs(t - even).max() <= GRID_TOLERANCE * (even[1] - even[0]):
        return t
    q = next((q for n in range(13) if _are_multiples(steps, q := 10.0**-n)), np.inf)
    i = np.arange(t.size) - 0.5 * (t.size - 1)
    middle = float(t.mean())
    step = float(i @ (t - middle)) / float(i @ i)
    line = np.asarray(middle + step * i)
    bound = 1.5 * q / (step * t.size)
    if np.ptp(t - line) > _WITHIN * q or bound > _ACCURATE:
        return t
    rounded = Remark(
        "{} is rounded to {:.3g} s, its samples are {:.3g} s apart: {:.9g} samples a second are taken, from the line "
        "through it, off by {:.3g} ppm at the most; give sample_rate_hz if known",
        *(where, q, step, 1.0 / step, 1e6 * bound),
        doubts={"": bound},
    )
    warnings.warn(RecordWarning(rounded), stacklevel=2)
    return line


def _are_multiples(steps: Array, q: float) -> bool:
    """Whether all steps are multiples of q, none but zero being lost."""
    multiples = np.round(steps / q)
    lost = (multiples == 0.0) & (steps > 0.0)
    return not lost.any() and bool(np.abs(steps / q - multiples).max() < _INTEGER)
