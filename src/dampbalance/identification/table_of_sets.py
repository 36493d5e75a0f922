"""The estimates of several sets of records in one table, with the error of each set that could not be identified."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from ..law.terms import FRICTION
from ..project.files import read_csv, write_csv, write_text
from ..records.coordinate import ROTATION, TRANSLATION, Coordinate
from .answer import Interval, ParameterEstimate, Verdict, column
from .outputs import ESTIMATES, SUMMARY
from .screen import aligned, headed, in_one, with_interval

_VERDICT, _WITHIN = "_verdict", "_within_percent"


def summarise(folder: Path, errors: Mapping[str, str]) -> str:
    """Write the estimates of all sets as one table, and as text a line for each set; return the text.

    folder : with one of its name for each set that is identified.   errors : set → why it could not be identified,
    empty where it was.
    """
    failed = {name: error for name, error in errors.items() if error}
    parts, coordinates = [], dict[str, Coordinate]()
    for name, error in errors.items():
        one = pd.DataFrame({"error": [error]}) if error else read_csv(folder / name / ESTIMATES)
        one.insert(0, "set", name)
        rotates = ROTATION.key(column("K_z")) in one
        coordinates[name] = ROTATION if rotates else TRANSLATION
        parts.append(one)
    every = pd.concat(parts, ignore_index=True)
    every["error"] = every.pop("error") if failed else ""
    rows = every.groupby("set", sort=False).head(1).to_dict("records")
    silent = {
        row["set"]: why for row in rows if isinstance(why := row.get("no_answer"), str) and why
    }
    tables = []
    for coordinate in dict.fromkeys(coordinates.values()):
        own = [row for row in rows if coordinates[row["set"]] is coordinate]
        tables += ["", *aligned(_table(own, failed, silent, coordinate))]
    head = f"{len(errors) - len(failed) - len(silent)} of {len(errors)} sets of records identified"
    lines = [f"{head} in {folder}; the answer to use of each:", *tables]
    causes = {**failed, **{name: f"no answer: {why}" for name, why in silent.items()}}
    lines += ["", *(f"{name}: {causes[name]}" for name in errors if name in causes)] * bool(causes)
    text = "\n".join(lines) + "\n"
    write_csv(folder / ESTIMATES, every)
    write_text(folder / SUMMARY, text)
    return text


def _table(
    rows: Sequence[Mapping[Any, Any]],
    failed: Collection[str],
    silent: Collection[str],
    coordinate: Coordinate,
) -> list[list[str]]:
    """Return the lines of sets of one coordinate, from the rows of the answers to use.

    failed, silent : sets that could not be identified, and those that give no answer.
    """
    keys = [str(head).removesuffix(_VERDICT) for head in rows[0] if str(head).endswith(_VERDICT)]
    # a column that another set alone has is empty in all rows
    shown = [key for key in keys if any(isinstance(row[key + _VERDICT], str) for row in rows)]
    shown.sort(key=lambda key: key == "K_z")  # the contact last
    symbols = {key: FRICTION if key == coordinate.key(FRICTION) else key for key in shown}
    heads = (coordinate.text(headed(symbol)) for symbol in symbols.values())
    table = [["set", "answer", *heads, "verdict"]]
    for row in rows:
        name, verdicts, cells = row["set"], {}, []
        for key, symbol in symbols.items():
            word = row[key + _VERDICT]
            if isinstance(word, str) and word:
                verdicts[key] = Verdict(word, within=0.01 * float(row.get(key + _WITHIN, math.nan)))
            parameter = _parameter(row, symbol, coordinate)
            cells.append("–" if name in failed else with_interval(parameter))
        words = "no answer" if name in silent else in_one(verdicts)
        words = "not identified" if name in failed else words
        table.append([name, "–" if name in failed else row["approach"], *cells, words])
    return table


def _parameter(row: Mapping[Any, Any], symbol: str, coordinate: Coordinate) -> ParameterEstimate:
    """Return a number of a row of the table of estimates."""
    value, low, high = (
        float(row.get(coordinate.key(column(symbol, end)), math.nan))
        for end in ("", "_low", "_high")
    )
    if math.isnan(high) and math.isfinite(low):  # an open end is empty in the table
        high = math.inf
    return ParameterEstimate(value, math.nan, Interval(low, high))
