"""Several sets of records, identified one by one: their estimates in one table, and what became of each."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from ..project.files import read_csv, write_csv, write_text
from .answer import Interval, ParameterEstimate, Verdict, column
from .outputs import TABLES
from .screen import aligned, headed, in_one, with_interval

ESTIMATES, SUMMARY = TABLES[1], TABLES[3]
"""Names of the files of a set, and of those of all sets."""

_VERDICT = "_verdict"


def summarise(folder: Path, errors: Mapping[str, str]) -> str:
    """Write the estimates of all sets as one table, and as text a line for each set; return the text.

    folder : with one of its name for each set that is identified.   errors : set → why it could not be identified,
    empty where it was.
    """
    parts, table, failed = [], [], {name: error for name, error in errors.items() if error}
    for name, error in errors.items():
        one = pd.DataFrame({"error": [error]}) if error else read_csv(folder / name / ESTIMATES)
        one.insert(0, "set", name)
        parts.append(one)
    every = pd.concat(parts, ignore_index=True)
    every["error"] = every.pop("error") if failed else ""
    symbols = [str(head).removesuffix(_VERDICT) for head in every if str(head).endswith(_VERDICT)]
    symbols.sort(key=lambda symbol: symbol == "K_z")  # the contact last
    for row in every.groupby("set", sort=False).head(1).to_dict("records"):
        found = row["set"] not in failed
        cells = [_cell(row, symbol) if found else "–" for symbol in symbols]
        words_of = {symbol: row.get(symbol + _VERDICT) for symbol in symbols}
        verdicts = {s: Verdict(word, "") for s, word in words_of.items() if isinstance(word, str)}
        words = in_one(verdicts) if found else "not identified"
        table.append([row["set"], row["approach"] if found else "–", *cells, words])
    count = len(errors) - len(failed)
    lines = [
        f"{count} of {len(errors)} sets of records identified in {folder}; the answer to use of each:",
        "",
    ]
    lines += aligned([["set", "answer", *map(headed, symbols), "verdict"], *table])
    lines += ["", *(f"{name}: {error}" for name, error in failed.items())] if failed else []
    text = "\n".join(lines) + "\n"
    write_csv(folder / ESTIMATES, every)
    write_text(folder / SUMMARY, text)
    return text


def _cell(row: Mapping[Any, Any], symbol: str) -> str:
    """A value with its interval; a dash where the answer has none."""
    value, low, high = (
        float(row.get(column(symbol, end), math.nan)) for end in ("", "_low", "_high")
    )
    high = (
        math.inf if math.isnan(high) and math.isfinite(low) else high
    )  # an open end is empty in the table
    return with_interval(ParameterEstimate(value, math.nan, math.nan, Interval(low, high)))
