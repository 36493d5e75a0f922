"""The book of values: what the article prints, by key, each with its text, its unit and the place it comes from."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any

from .places import Place, ResultFiles
from .style import Style


class Book:
    """Collects values under their keys; each is read from its place and made into text once.

    results : the result files.   rules : file → the rule that makes it.   folder : where the results of the case are.
    """

    def __init__(self, results: ResultFiles, rules: Mapping[str, str], folder: str) -> None:
        self.results = results
        self.folder = folder
        self._rules = rules
        self._values: dict[str, dict[str, Any]] = {}

    def cell(
        self,
        key: str,
        file: str,
        row: Mapping[str, str],
        column: str,
        style: Style,
        unit: str = "",
    ) -> None:
        """A value from a table: the column of the one row with these entries."""
        self._enter(key, Place(self.path(file), row=row, column=column), style, unit)

    def item(self, key: str, file: str, pointer: str, style: Style, unit: str = "") -> None:
        """A value from a JSON document."""
        self._enter(key, Place(self.path(file), pointer=pointer), style, unit)

    def path(self, file: str) -> str:
        """A result file of the case by its short name; one that names its folder stays."""
        return file if file.startswith("results/") else f"{self.folder}/{file}"

    def rows(self, file: str) -> list[dict[str, str]]:
        """The rows of a table of the case."""
        return self.results.table(self.path(file))

    def as_json(self) -> dict[str, Any]:
        """The values by key, and the files they come from, numbered in the order in which they are first used."""
        uses = Counter(value["file"] for value in self._values.values())
        numbers = {file: number for number, file in enumerate(uses, start=1)}
        values = {k: v | {"source": numbers[v["file"]]} for k, v in self._values.items()}
        return {
            "values": values,
            "sources": [
                {
                    "number": number,
                    "file": file,
                    "name": file.removeprefix(f"{self.folder}/").removeprefix("results/"),
                    "rule": self._rules[file],
                    "values": uses[file],
                }
                for file, number in numbers.items()
            ],
        }

    def _enter(self, key: str, place: Place, style: Style, unit: str) -> None:
        if key in self._values:
            raise ValueError(f"the article's value {key!r} is entered twice")
        if place.file not in self._rules:
            raise ValueError(f"{key}: {place.file} is not among the inputs of the article")
        self._values[key] = {
            "text": style.render(self.results.at(place)),
            "unit": unit,
            **place.as_json(),
            "rule": self._rules[place.file],
            "style": style.as_json(),
        }
