"""Which law is chosen for records of each: a table of true law × chosen law, and its numbers."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from ...arrays import Mask, Words
from ...project.wording import markdown_table, percent
from ..routes import NONE, terms_named
from ..stretches import column_of
from .groups import share_interval


class Part(NamedTuple):
    """How many of so many cases are of a kind, as a share of them; its 95 % interval."""

    those: int
    cases: int

    @property
    def share(self) -> float:
        """The share itself; NaN of no case."""
        return self.those / self.cases if self.cases else np.nan

    @property
    def interval(self) -> tuple[float, float]:
        """What the number of cases leaves open of it (`share_interval`)."""
        return share_interval(self.those, self.cases)

    def __str__(self) -> str:
        low, high = self.interval
        return f"{percent(self.share)} ({percent(low)} to {percent(high)})"


class Choices(NamedTuple):
    """The true law of n cases, and the one that was chosen, by name, each (n,)."""

    law: Words
    chosen: Words

    @property
    def right(self) -> Part:
        """Where the true law is chosen."""
        return self._part(self.law == self.chosen)

    @property
    def extra(self) -> Part:
        """Where the law that is chosen has all terms of the true one, and more."""
        pairs = zip(self.law, self.chosen, strict=True)
        return self._part(np.array([_terms(true) < _terms(found) for true, found in pairs], bool))

    @property
    def none(self) -> Part:
        """Where no law is chosen."""
        return self._part(self.chosen == NONE)

    def of(self, law: str) -> Choices:
        """The cases of one law."""
        kept = self.law == law
        return Choices(self.law[kept], self.chosen[kept])

    @staticmethod
    def _part(kind: Mask) -> Part:
        return Part(int(np.count_nonzero(kind)), len(kind))


def _terms(name: str) -> frozenset[str]:
    """The terms of a law; none of NONE."""
    return frozenset() if name == NONE else frozenset(terms_named(name))


def choices_of(cases: str | Path) -> Choices:
    """The laws of a study's table of cases."""
    return Choices(
        *(np.asarray(column_of(cases, name), dtype=object) for name in ("law", "chosen"))
    )


def confusion(cases: str | Path) -> pd.DataFrame:
    """A row per true law, a column per law that is true or chosen somewhere, and for none: numbers of cases; how many
    are right and have a term too many, as shares with their 95 % intervals, %."""
    found = choices_of(cases)
    laws = list(dict.fromkeys(found.law))
    others = sorted(set(found.chosen) - {*laws, NONE}, key=lambda name: (len(_terms(name)), name))
    records = []
    for law in laws:
        own = found.of(law)
        record: dict[str, Any] = {"law": law, "cases": len(own.law)}
        for other in (*laws, *others, NONE):
            record[other] = int(np.count_nonzero(own.chosen == other))
        for name in ("right", "extra"):
            part = getattr(own, name)
            shares = zip(("", "_low", "_high"), (part.share, *part.interval), strict=True)
            record |= {f"{name}{end}_percent": 100.0 * share for end, share in shares}
        records.append(record)
    return pd.DataFrame.from_records(records)


def laws_in(summary: pd.DataFrame) -> list[str]:
    """The columns of `confusion` that hold numbers of cases by the law that is chosen."""
    names = [str(name) for name in summary]
    return [name for name in names if name not in ("law", "cases") and "percent" not in name]


def confusion_markdown(summary: pd.DataFrame) -> list[str]:
    """The table for reading."""
    chosen = laws_in(summary)
    heads = [*chosen, "right", "a term too many"]
    rows = []
    for row in summary.to_dict("records"):
        counts = [str(row[name] or "") for name in chosen]
        parts = [_part_in_words(row, name) for name in ("right", "extra")]
        rows.append([row["law"], *counts, *parts])
    return [
        "Rows: the true law. Columns: the law that is chosen, in cases. Right, a term too many: shares of the row, "
        "with the bounds between which the number of cases leaves them (95 %).",
        "",
        markdown_table(["true law", *heads], rows, "l" + "r" * len(heads)),
    ]


def _part_in_words(row: Mapping[Any, Any], name: str) -> str:
    share, low, high = (
        percent(0.01 * row[f"{name}{end}_percent"]) for end in ("", "_low", "_high")
    )
    return f"{share} ({low} to {high})"


def choice_fact(cases: str | Path, spec: Mapping[str, Any]) -> str:
    """A share of the cases in words: right, extra or none, of all laws or of one; or a bound of its interval."""
    found, (take, _, end) = choices_of(cases), spec["take"].partition("_")
    if "law" in spec.get("at", {}):
        found = found.of(spec["at"]["law"])
    part: Part = getattr(found, take)
    return percent(dict(zip(("low", "high"), part.interval, strict=True)).get(end, part.share))
