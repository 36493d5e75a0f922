"""The estimates of several sets of records in one table, with the error of each set that could not be identified."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from ..project.files import read_csv, write_csv, write_text
from .answer import Interval, ParameterEstimate, Verdict, column
from .outputs import ESTIMATES, SUMMARY
from .screen import aligned, headed, in_one, with_interval

_VERDICT = "_verdict"


def summarise(folder: Path, errors: Mapping[str, str]) -> str:
    """Write the estimates of all sets as one table, and as text a line for each set; return the text.

    folder : with one of its name for each set that is identified.   errors : set → why it could not be identified,
    empty where it was.
    """
    failed = {name: error for name, error in errors.items() if error}
    parts = []
    for name, error in errors.items():
        one = pd.DataFrame({"error": [error]}) if error else read_csv(folder / name / ESTIMATES)
        one.insert(0, "set", name)
        parts.append(one)
    every = pd.concat(parts, ignore_index=True)
    every["error"] = every.pop("error") if failed else ""
    symbols = [str(head).removesuffix(_VERDICT) for head in every if str(head).endswith(_VERDICT)]
    symbols.sort(key=lambda symbol: symbol == "K_z")  # the contact last
    table = [["set", "answer", *map(headed, symbols), "verdict"]]
    for row in every.groupby("set", sort=False).head(1).to_dict("records"):
        name, verdicts, cells = row["set"], {}, []
        for symbol in symbols:
            word = row[symbol + _VERDICT]
            if isinstance(word, str) and word:
                verdicts[symbol] = Verdict(word)
            cells.append("–" if name in failed else with_interval(_parameter(row, symbol)))
        words = "not identified" if name in failed else in_one(verdicts)
        table.append([name, "–" if name in failed else row["approach"], *cells, words])
    head = f"{len(errors) - len(failed)} of {len(errors)} sets of records identified"
    lines = [f"{head} in {folder}; the answer to use of each:", "", *aligned(table)]
    lines += ["", *(f"{name}: {error}" for name, error in failed.items())] if failed else []
    text = "\n".join(lines) + "\n"
    write_csv(folder / ESTIMATES, every)
    write_text(folder / SUMMARY, text)
    return text


def _parameter(row: Mapping[Any, Any], symbol: str) -> ParameterEstimate:
    """A number of a row of the table of estimates."""
    value, low, high = (
        float(row.get(column(symbol, end), math.nan)) for end in ("", "_low", "_high")
    )
    if math.isnan(high) and math.isfinite(low):  # an open end is empty in the table
        high = math.inf
    return ParameterEstimate(value, math.nan, Interval(low, high))
