"""Records that need no times: measured loops, and tables of forces at steady speeds."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from . import samples
from .channel import ACCOMPANYING

if TYPE_CHECKING:
    from .guess import Guesses

OF_LOOP = "displacement", "force"
_OF_SPEEDS = "velocity", "force"


def is_loop(quantities: Iterable[str]) -> bool:
    """Return whether a record of these quantities is a measured loop, which needs no times."""
    return {*OF_LOOP} <= {*quantities} <= {*OF_LOOP, "velocity", *ACCOMPANYING}


def of_speeds(table: Guesses, columns: Mapping[str, int]) -> bool:
    """Return whether a record is a table of forces at steady speeds, without times: as known, or by its velocities.

    columns : quantity → number of the column.
    """
    if {*columns} - {*ACCOMPANYING} != {*_OF_SPEEDS} or table.mapping.free:
        return False
    v, F = (columns[quantity] for quantity in _OF_SPEEDS)
    timed = table.mapping.sample_rate_hz or table.times or table.channels[F].rate_hz
    return table.mapping.steady or bool(not timed and samples.steady_speeds(table.values[v]))
