"""Tables of steady responses to a stepped sine, and frequency responses: what tells them from records in time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from . import samples
from .headings import by_unit, column_of, names_time
from .mapping import RecordMapping
from .table import Table
from .units import TABLE_DRIVES, TABLE_RESPONSES

if TYPE_CHECKING:
    from .guess import Guesses

_HALF_TURN = 181.0  # deg, up to which a phase goes


def is_table_of_lines(file: Table, rules: RecordMapping) -> bool:
    """Return whether a file is a table of steady responses: by its mapping, or by columns of frequency and phase, and
    none of times."""
    if rules.table or rules.channels:
        return bool(rules.table)
    held = {column_of(raw) for raw in file.channels}
    return {"frequency", "phase"} <= held and not any(map(names_time, file.channels))


def is_response(table: Guesses) -> bool:
    """Return whether the columns are a frequency response: no times, but frequencies, and phases, and no drive."""
    named = [column_of(raw) for raw in table.channels]
    driven = TABLE_DRIVES.keys() & {*named} or "force" in map(by_unit, table.channels)
    if driven or table.mapping.force_N or any(map(names_time, table.channels)):
        return False
    frequency = phase = False
    for i, values in table.values.items():
        of = values[np.isfinite(values)]
        even = samples.equal_step(of) is not None
        if even or not table.per_force:  # or else a stepped sine at a force to be stated
            rises = even and table.channels[i].unit is None and len(named) > 2
            # a frequency response goes up to 1 kHz or more
            frequency |= named[i] == "frequency" or (rises and bool(of[-1] >= 1000.0))
        turns = of.size and np.abs(of).max() <= _HALF_TURN and np.ptp(of) > 0.5 * _HALF_TURN
        phase |= named[i] == "phase" or bool(turns and not even)
    return frequency and phase


def slot(quantity: str) -> str:
    """Return what a table has one of: one drive, one response."""
    if quantity in TABLE_DRIVES:
        return "drive"
    return "response" if quantity in TABLE_RESPONSES else quantity
