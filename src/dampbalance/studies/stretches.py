"""The table of cases, a stretch of it at a time: memory does not grow with the number of cases."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq

from ..arrays import Array, Words

# Bins of sizes: a quantile is good to 0.06 %, below the three digits that are shown.
_PER_DECADE = 2000
_LOWEST, _HIGHEST = -18, 8  # decades: smaller and larger sizes fall into the first and the last bin


def stretches(cases: str | Path, names: Sequence[str]) -> Iterator[dict[str, Words]]:
    """The columns named, row group by row group, in the order of the cases."""
    wanted = list(dict.fromkeys(names))
    with pq.ParquetFile(cases) as file:
        for group in range(file.num_row_groups):
            table = file.read_row_group(group, columns=wanted)
            yield {name: np.asarray(table[name].to_numpy()) for name in wanted}


def column_of(cases: str | Path, name: str) -> Words:
    """One whole column of the table of cases."""
    return np.concatenate([stretch[name] for stretch in stretches(cases, [name])])


class Sizes:
    """Sizes of errors, added a stretch at a time: how many there are, their extremes and quantiles."""

    def __init__(self, within: float) -> None:
        self.cases = self.known = self.within = 0
        self.smallest, self.largest = np.inf, -np.inf
        self._bound = within
        self._counts = np.zeros((_HIGHEST - _LOWEST) * _PER_DECADE, dtype=np.int64)

    def add(self, errors: Array) -> None:
        """Add the errors of a stretch; missing ones count as cases only."""
        size = np.abs(errors)
        size = size[np.isfinite(size)]
        self.cases += len(errors)
        self.known += len(size)
        if not len(size):
            return
        self.within += int(np.count_nonzero(size <= self._bound))
        self.smallest = min(self.smallest, float(size.min()))
        self.largest = max(self.largest, float(size.max()))
        with np.errstate(divide="ignore"):  # log 0: the first bin
            place = (np.log10(size) - _LOWEST) * _PER_DECADE
        bins = np.clip(place, 0, len(self._counts) - 1).astype(np.int64)
        self._counts += np.bincount(bins, minlength=len(self._counts))

    @property
    def share(self) -> float:
        """Share of all cases whose error is within the bound."""
        return self.within / self.cases

    def quantile(self, share: float) -> float:
        """The size that this share of the finite errors does not exceed, to 0.06 %; NaN without one."""
        if not self.known:
            return float("nan")
        reached = int(np.searchsorted(np.cumsum(self._counts), max(1.0, share * self.known)))
        middle = 10.0 ** (_LOWEST + (reached + 0.5) / _PER_DECADE)
        return float(min(max(middle, self.smallest), self.largest))
