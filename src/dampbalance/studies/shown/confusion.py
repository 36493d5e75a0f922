"""Which law is chosen for records of each: a table of true law × chosen law, and its numbers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from ...project.wording import markdown_table, percent
from ..outputs import column_of
from ..routes import NONE, terms_named
from .statistics import share_interval


def choices_of(cases: str | Path) -> pd.DataFrame:
    """A row per case: its true law and the one that was chosen, by name; whether the choice is right, has all terms of
    the true law and more (extra), or is none."""
    laws = {name: np.asarray(column_of(cases, name), dtype=object) for name in ("law", "chosen")}
    true, chosen = (map(_terms, names) for names in laws.values())
    kinds = {
        "right": laws["law"] == laws["chosen"],
        "extra": [fewer < more for fewer, more in zip(true, chosen, strict=True)],
        "none": laws["chosen"] == NONE,
    }
    return pd.DataFrame(laws | kinds)


def _terms(name: str) -> frozenset[str]:
    """The terms of a law; NONE has none."""
    return frozenset() if name == NONE else frozenset(terms_named(name))


def share_of(held: pd.Series) -> dict[str, float]:
    """The share of the cases in which something holds, and the bounds of its 95 % interval (`share_interval`)."""
    low, high = share_interval(int(held.sum()), len(held))
    return {"": float(held.mean()), "_low": low, "_high": high}


def confusion(cases: str | Path) -> pd.DataFrame:
    """A row per true law, a column per law that is true or chosen somewhere, and for none: numbers of cases; how many
    are right and have a term too many, as shares with their 95 % intervals, %."""
    table, records = choices_of(cases), []
    laws = list(dict.fromkeys(table["law"]))
    others = sorted(set(table["chosen"]) - {*laws, NONE}, key=lambda law: (len(_terms(law)), law))
    for law, own in table.groupby("law", sort=False):
        record: dict[str, Any] = {"law": law, "cases": len(own)}
        record |= {other: int((own["chosen"] == other).sum()) for other in (*laws, *others, NONE)}
        for kind in ("right", "extra"):
            shares = share_of(own[kind]).items()
            record |= {f"{kind}{end}_percent": 100.0 * share for end, share in shares}
        records.append(record)
    return pd.DataFrame.from_records(records)


def laws_in(summary: pd.DataFrame) -> list[str]:
    """The columns of `confusion` that hold numbers of cases by the law that is chosen."""
    names = [str(name) for name in summary]
    return names[names.index("cases") + 1 : names.index("right_percent")]


def confusion_markdown(summary: pd.DataFrame) -> list[str]:
    """The table for reading."""
    chosen = laws_in(summary)
    heads = ["true law", *chosen, "right", "a term too many"]
    rows = [
        [row["law"], *(str(row[name] or "") for name in chosen), *_shares_in_words(row)]
        for row in summary.to_dict("records")
    ]
    return [
        "Rows: the true law. Columns: the law that is chosen, in cases. Right, a term too many: shares of the row, "
        "with the bounds between which the number of cases leaves them (95 %).",
        "",
        markdown_table(heads, rows, "l" + "r" * (len(heads) - 1)),
    ]


def _shares_in_words(row: Mapping[Any, Any]) -> Iterator[str]:
    """The shares of a row that are right and that have a term too many, each with its interval."""
    for kind in ("right", "extra"):
        shares = (percent(0.01 * row[f"{kind}{end}_percent"]) for end in ("", "_low", "_high"))
        yield "{} ({} to {})".format(*shares)
