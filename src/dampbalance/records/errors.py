"""What reading and writing records may complain about."""

from __future__ import annotations

import importlib
from typing import Any


class RecordError(ValueError):
    """A record or its mapping that cannot be used; the message names the file, what is wrong and the remedy."""


class RecordWarning(UserWarning):
    """A record that can be used, but looks odd."""


def library(name: str, purpose: str) -> Any:
    """A module that only some formats need. Raises RecordError naming the extra when it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        package = name.partition(".")[0]
        raise RecordError(
            f"{purpose} needs the package {package}, which is not installed: "
            'pip install "dampbalance[records]"'
        ) from None
