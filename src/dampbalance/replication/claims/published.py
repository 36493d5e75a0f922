"""The numbers of the paper, as printed: strings keep their digits, and with them how finely they were rounded.

This package is the only place that reads `paper/published/`: what is compared with must not leak into what is computed.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from ..printed import Printed
from ..printed_tables import PRINTED_APPROACHES, TABLE_1, TABLE_2, UNKNOWNS

FILES = {
    "parameters": ("id", "symbol", "quantity", "printed", "unit", "where"),
    "table1": ("level", "Y_m", *(q.column for q in TABLE_1)),
    "table2_integrals": ("level", "Y_m", *(q.column for q in TABLE_2)),
    "table2_pairs": ("pair", "direct_c_N_s_per_m", "direct_F_k_N"),
    "table3": (
        "pair",
        *(f"{name}_{q.column}" for name in PRINTED_APPROACHES[1:] for q in UNKNOWNS),
    ),
    "text_values": ("id", "quantity", "printed", "unit", "where"),
}

_MOST_BYTES = 1_000_000  # of a table; the longest has 3 kB


@dataclass(frozen=True, slots=True)
class Published:
    """The printed tables and text values; every cell is a string. Columns: FILES; indexed by level, pair or id."""

    parameters: pd.DataFrame
    table1: pd.DataFrame
    table2_integrals: pd.DataFrame
    table2_pairs: pd.DataFrame
    table3: pd.DataFrame
    text_values: pd.DataFrame


def read_published(folder: Path) -> Published:
    """Read the printed numbers from `folder`. Raises ValueError naming file and column when one is missing or blank."""
    return Published(
        **{name: _read(folder / f"{name}.csv", columns) for name, columns in FILES.items()}
    )


def row(frame: pd.DataFrame, name: str) -> dict[str, str]:
    """The printed cells of one level, pair or id, by column."""
    return {column: str(frame[column][name]) for column in frame.columns}


def numbers(frame: pd.DataFrame, column: str) -> NDArray[np.float64]:
    """A printed column as floats."""
    return np.array([Printed(text).value for text in frame[column]])


def read_texts(path: Path, columns: tuple[str, ...]) -> pd.DataFrame:
    """A table with these columns, every cell the text that it is. Raises ValueError for anything else."""
    if not path.is_file() or path.stat().st_size > _MOST_BYTES:
        raise ValueError(f"{path}: needed is a file of this name, of {_MOST_BYTES:,} bytes at most")
    try:
        frame = pd.read_csv(path, dtype=str, keep_default_na=False, encoding="utf-8")
    except (OSError, ValueError) as error:  # not text, empty, or rows of different lengths
        reason = " ".join(str(error).split())[:120]
        raise ValueError(f"{path}: cannot be read as a table of text in UTF-8: {reason}") from None
    if tuple(frame.columns) != columns:
        raise ValueError(
            f"{path}: expected the columns {', '.join(columns)}, found {', '.join(frame.columns)[:120]}"
        )
    return frame


def _read(path: Path, columns: tuple[str, ...]) -> pd.DataFrame:
    frame = read_texts(path, columns)
    for column in columns:
        if column != "unit" and (frame[column].str.strip() == "").any():
            raise ValueError(
                f"{path}: column {column} has an empty cell; every printed number needs its digits"
            )
    if frame[columns[0]].duplicated().any():
        twice = frame[columns[0]][frame[columns[0]].duplicated()].iloc[0]
        raise ValueError(f"{path}: {columns[0]} {twice} appears twice; each needs its own name")
    return frame.set_index(columns[0])
