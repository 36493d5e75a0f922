"""Points in time and spans of it, as text: read as seconds from the first of a column on.

2026-03-01T12:00:00.0005+01:00    ISO 8601, with T or a blank, a zone or none, a point or a comma
12:00:00.0005                     a time of day; midnight may pass
0 days 00:00:00.000500            a span, as pandas writes it
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import Array

if TYPE_CHECKING:
    import pandas as pd

_CLOCK = r"\d{1,2}:\d{2}(:\d{2}([.,]\d+)?)?"
_POINT = re.compile(rf"\d{{4}}-\d{{2}}-\d{{2}}[T ]{_CLOCK} ?(Z|[+-]\d{{2}}(:?\d{{2}})?)?")
_SPAN = re.compile(rf"(-?\d+ days? \+?)?{_CLOCK}")
_DATE = re.compile(r"\d{1,4}[-./]\d{1,2}[-./]\d{1,4}([T ].{1,30})?")
_DAY = 86400.0  # s


def is_stamp(cell: str) -> bool:
    """Whether a text is a point in time, or a span of it, that can be read."""
    return bool(_POINT.fullmatch(cell) or _SPAN.fullmatch(cell))


def is_date(cell: str) -> bool:
    """Whether a text is a date, perhaps with a time, in whatever order of day, month and year."""
    return bool(_DATE.fullmatch(cell))


class Clock:
    """Turns the texts of a column, part by part, into seconds from its first one on."""

    def __init__(self, first: str) -> None:
        self.points, self.of_day = bool(_POINT.fullmatch(first)), "day" not in first
        self.first = self._read([first])[0]
        self.passed, self.last = 0.0, 0.0

    def seconds(self, cells: pd.Series[str]) -> Array:
        """Seconds from the first text of the column on; NaN for an empty cell. Raises ValueError."""
        import pandas as pd  # slow to import

        spans = pd.TimedeltaIndex(self._read(cells) - self.first)
        seconds: Array = np.asarray(spans.total_seconds(), dtype=np.float64)
        if not self.points and self.of_day and seconds.size:
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
