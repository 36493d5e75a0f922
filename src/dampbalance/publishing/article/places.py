"""One number out of a result file, and where it stood."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any


class MissingValue(KeyError):
    """A result file lacks the value that the article wants to print."""

    def __str__(self) -> str:
        return str(self.args[0])


@dataclass(frozen=True)
class Place:
    """Where a value stands: in a JSON file at a pointer, or in a CSV in the row with these entries and a column."""

    file: str
    pointer: str = ""
    row: Mapping[str, str] = field(default_factory=dict)
    column: str = ""

    def as_json(self) -> dict[str, Any]:
        """For the record beside the value."""
        if self.pointer:
            return {"file": self.file, "pointer": self.pointer}
        return {"file": self.file, "row": dict(self.row), "column": self.column}


class ResultFiles:
    """The result files, each read once; what is asked of them is checked to be there, and to be unique."""

    def __init__(self, root: str | Path = ".") -> None:
        self._root = Path(root)
        self._tables: dict[str, list[dict[str, str]]] = {}
        self._documents: dict[str, Any] = {}

    def table(self, file: str) -> list[dict[str, str]]:
        """The rows of a CSV, every entry as the text that stands there."""
        if file not in self._tables:
            with (self._root / file).open(encoding="utf-8", newline="") as stream:
                self._tables[file] = list(csv.DictReader(stream))
        return self._tables[file]

    def document(self, file: str) -> Any:
        """A JSON document."""
        if file not in self._documents:
            text = (self._root / file).read_text(encoding="utf-8")
            self._documents[file] = json.loads(text)
        return self._documents[file]

    def at(self, place: Place) -> Any:
        """The value at a place. Raises MissingValue when there is none, or more than one row."""
        if place.pointer:
            return self._pointed(place)
        rows = [
            row
            for row in self.table(place.file)
            if all(row.get(name) == wanted for name, wanted in place.row.items())
        ]
        if len(rows) != 1:
            raise MissingValue(
                f"{place.file}: {len(rows)} rows with {dict(place.row)}, the article needs one"
            )
        if place.column not in rows[0]:
            raise MissingValue(f"{place.file}: no column {place.column!r}")
        return rows[0][place.column]

    def _pointed(self, place: Place) -> Any:
        value = self.document(place.file)
        for part in place.pointer.strip("/").split("/"):
            name = part.replace("~1", "/").replace("~0", "~")
            try:
                value = value[int(name)] if isinstance(value, list) else value[name]
            except (KeyError, IndexError, ValueError, TypeError):
                raise MissingValue(f"{place.file}: nothing at {place.pointer}") from None
        return value
