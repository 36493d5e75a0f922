"""Samples of all channels of a file, looked at where headings do not say what they are: constants, counters, times."""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np

from ...arrays import Array
from ..errors import RecordError, RecordWarning, require_size
from ..table import Table
from .headings import holds_time, unusable

_FEWEST = 4  # samples of which it shows that they rise in equal steps
_ROUNDED = 0.6  # of a step, by which times with too few digits are off
_TRIED = 20  # channels that are read one by one where some column holds a text


class Samples:
    """The samples of each channel (`values`), or none of one that cannot be read.

    aside : channels that are no motion and no force, by name, unit or samples, with what they are instead.
    rising : steps of those that rise in equal steps and are no counters.
    """

    def __init__(self, file: Table) -> None:
        everything = range(len(file.channels))
        require_size(file.path, sum(raw.size or 0 for raw in file.channels))
        self.aside: dict[int, str] = {}
        self.rising: dict[int, float] = {}
        self.values = _samples(file, everything) or {}
        if not self.values:  # a text in some column
            for i in everything[:_TRIED]:
                self.values |= _samples(file, [i]) or {i: np.empty(0)}
                if not self.values[i].size:
                    self.aside[i] = "it holds what is no number"
        for i, values in self.values.items():
            raw, known = file.channels[i], values[np.isfinite(values)]
            if (other := unusable(raw)) is not None:
                self.aside[i] = other
            elif holds_time(raw) or known.size < _FEWEST:
                continue
            elif not np.ptp(known):
                self.aside[i] = f"constant, {known[0]:g}"
            elif (step := equal_step(known)) is not None:
                counts = step == 1.0 and not np.any(known % 1.0)
                kind = "a counter" if counts else "a time"
                self.aside[i] = f"rises by {step:.6g} from sample to sample: {kind}"
                if not counts:
                    self.rising[i] = step


def _samples(file: Table, wanted: Sequence[int]) -> dict[int, Array] | None:
    """The samples of some channels; None where they cannot be read."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RecordWarning)  # comes where the record is read
        try:
            return file.columns(wanted)
        except RecordError:
            return None


def equal_step(values: Array) -> float | None:
    """The step of values that rise in equal steps, as times and counters do; None for others."""
    if values.size < _FEWEST:
        return None
    line = np.linspace(values[0], values[-1], values.size)
    step = float(line[1] - line[0])
    rises = step > 0.0 and np.diff(values).min() >= 0.0
    return step if rises and np.abs(values - line).max() < _ROUNDED * step else None
