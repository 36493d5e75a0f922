"""Errors of reading and writing records, and the bounds of a record: sizes, times and values beyond which
something is wrong with the file, not with the rig.

Sizes are looked at before anything is read. The bounds of values leave room for any squared number that the reading
forms, and for any rig: a signal of 1e-15 m is a proton wide.
"""

from __future__ import annotations

import importlib
from typing import Any


class RecordError(ValueError):
    """A record or its mapping that cannot be used; the message names the file, what is wrong and the remedy."""


class RecordWarning(UserWarning):
    """A record that can be used, but looks odd."""


def library(name: str, purpose: str) -> Any:
    """Import a module that only some formats need. Raises RecordError naming the extra when it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        missing = f"the package {name.partition('.')[0]}, which is not installed"
        remedy = 'pip install "dampbalance[records]", or `make setup` in a clone of the project'
        raise RecordError(f"{purpose} needs {missing}: {remedy}") from None


LARGEST = 200_000_000  # numbers in a record, samples × channels with times: 1.6 GB of memory
LARGEST_FILE = 4_000_000_000  # bytes: as many numbers as text, with some twenty characters each
LARGEST_VALUE = 1e15  # SI unit of the quantity; no signal goes beyond it
SMALLEST_RANGE = 1e-15  # SI unit of the quantity; values closer together than that are no signal
FINEST = 1e-10  # relative to the largest value; a smaller range is rounding
LATEST = 1e12  # s, time of a sample, either way from zero: 30,000 years
LOWEST_RATE, HIGHEST_RATE = 1e-6, 1e12  # samples per second
MOST_CHANNELS = 4096  # in a file
LONGEST_NAME = 1000  # characters of a channel's name


def require_size(path: object, numbers: int) -> None:
    """Raise RecordError for a record of more numbers than are taken into memory."""
    if numbers > LARGEST:
        much = f"{numbers:,} numbers, more than {LARGEST:,}"
        raise RecordError(f"{path}: the channels hold {much}; give a part of the record")
