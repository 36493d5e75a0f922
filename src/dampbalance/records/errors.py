"""Errors of reading and writing records, and the bounds of a record: times and values beyond which something is
wrong with the file, not with the rig.

The bounds of values leave room for any squared number that the reading forms, and for any rig: a signal of 1e-15 m is a
proton wide.
"""

from __future__ import annotations

import importlib
from typing import Any

from ..findings.finding import Finding
from ..findings.words import sentence
from .coordinate import TRANSLATION


class RecordError(ValueError):
    """A record or its mapping that cannot be used; the message names the file, what is wrong and the remedy."""


class RecordWarning(UserWarning):
    """A record that can be used, but looks odd.   finding : what is odd about it."""

    def __init__(self, path: object, finding: Finding) -> None:
        super().__init__(f"{path}: {sentence(finding, TRANSLATION)}")
        self.finding = finding


def library(name: str, purpose: str) -> Any:
    """Import a module that only some formats need. Raises RecordError naming the extra when it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        missing = f"the package {name.partition('.')[0]}, which is not installed"
        remedy = 'pip install "dampbalance[records]", or `make setup` in a clone of the project'
        raise RecordError(f"{purpose} needs {missing}: {remedy}") from None


LARGEST_FILE = 4_000_000_000  # bytes
LARGEST_VALUE = 1e15  # SI unit of the quantity; no signal goes beyond it
SMALLEST_RANGE = 1e-15  # SI unit of the quantity; values closer together than that are no signal
FINEST = 1e-10  # relative to the largest value; a smaller range is rounding
LATEST = 1e12  # s, time of a sample, either way from zero: 30,000 years
LOWEST_RATE, HIGHEST_RATE = 1e-6, 1e12  # samples per second
