"""The studies from which the tests of this folder start, by name."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import yaml

_FOLDER = Path(__file__).parent
DOCUMENTS = yaml.safe_load((_FOLDER / "documents.yaml").read_text(encoding="utf-8"))
REFUSALS = [
    (name, change, words)
    for name, rows in yaml.safe_load((_FOLDER / "refusals.yaml").read_text("utf-8")).items()
    for change, words in rows
]


def document(name: str, /, **changes: Any) -> dict[str, Any]:
    """A copy of a document with changed keys; a change to None leaves the key out."""
    changed = copy.deepcopy(DOCUMENTS[name]) | changes
    return {key: value for key, value in changed.items() if value is not None}
