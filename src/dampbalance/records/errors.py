"""Errors of reading and writing records, and the bounds beyond which times and values show a fault of the file.

The bounds of values leave room for any rig, and for the squares that are formed on reading: 1e-15 m is the width of a
proton.
"""

from __future__ import annotations

import importlib
from typing import Any

from ..findings.finding import Finding
from ..findings.words import sentence
from .coordinate import TRANSLATION


class RecordError(ValueError):
    """A record or mapping that cannot be used; the message names the file, what is wrong and the remedy."""


class RecordWarning(UserWarning):
    """Something odd about a record that can still be used.   finding : what it is."""

    def __init__(self, path: object, finding: Finding) -> None:
        super().__init__(f"{path}: {sentence(finding, TRANSLATION)}")
        self.finding = finding


def library(name: str, purpose: str) -> Any:
    """Import a module that only some formats need. Raises RecordError naming the extra if it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        missing = f"the package {name.partition('.')[0]}, which is not installed"
        remedy = 'pip install "dampbalance[records]", or `make setup` in a clone of the project'
        raise RecordError(f"{purpose} needs {missing}: {remedy}") from None


LARGEST_FILE = 4_000_000_000  # bytes
LARGEST_VALUE = 1e15  # SI unit of the quantity
SMALLEST_RANGE = 1e-15  # SI unit of the quantity; a smaller range is no signal
FINEST = 1e-10  # relative to the largest value; a smaller range is rounding
LATEST = 1e12  # s; 30,000 years, positive or negative
LOWEST_RATE, HIGHEST_RATE = 1e-6, 1e12  # samples per second
