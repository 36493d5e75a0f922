"""The numbers of the paper, as printed: a row for each, whose text keeps its digits and so how finely it was rounded.

This package is the only place that reads `paper/published/`: what is compared with must not leak into what is computed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from ...arrays import Array
from ...solver import Pair, pair_label
from ..claim_verdicts import of_cell
from ..printed import Printed
from ..printed_tables import UNKNOWNS

FILE = "printed.csv"

FREQUENCIES = ("omega1", "omega2", "omega3")
"""The paper's three drive frequencies, by the names they have in the configuration and in results/."""

LEVELS = 5
PAIRS: tuple[Pair, ...] = ((0, 1), (1, 2), (2, 3), (3, 4), (0, 4))
PAIR_LABELS = tuple(pair_label(i, j) for i, j in PAIRS)

_MOST_BYTES = 1_000_000  # of a table; the longest, claims.csv, has 40 kB


class Row(NamedTuple):
    """A printed number: the columns of `paper/published/printed.csv`, each as the text that it is.

    id : as in claims.csv.
    where : the place in the paper.
    symbol : what the number is a value of, or what the statement is about.
    approach : by which an estimate was obtained; "" for anything else.
    kind, rule : of KINDS and of `rules.RULES`: what judges the number.
    """

    id: str
    where: str
    symbol: str
    approach: str
    quantity: str
    unit: str
    printed: str
    kind: str
    rule: str

    @property
    def line(self) -> str:
        """The line of a table in which the number stands: a level, counted from 1, or the label of a pair."""
        return self.id.rpartition(".")[2]

    @property
    def number(self) -> Printed:
        """The number as it is printed."""
        return Printed(self.printed)


@dataclass(frozen=True, slots=True)
class Published:
    """All printed numbers, by their ids, in the order of the file, which is that of claims.csv."""

    rows: Mapping[str, Row]

    def __getitem__(self, claim: str) -> Printed:
        """A printed number by its id."""
        return self.rows[claim].number

    def column(self, table: str, symbol: str, approach: str = "") -> Array:
        """The numbers of a column of a table, from its first line to its last; arguments as in `column_ids`."""
        return np.array([self[claim].value for claim in column_ids(table, symbol, approach)])

    def changed(self, texts: Mapping[str, str]) -> Published:
        """These printed numbers with other texts for some of them, by id."""
        rows = {claim: self.rows[claim]._replace(printed=text) for claim, text in texts.items()}
        return Published({**self.rows, **rows})


def column_ids(table: str, symbol: str, approach: str = "") -> list[str]:
    """The ids of a column of Tables 1 to 3, from its first line to its last.   approach : for Table 3 only."""
    pairwise = symbol in {q.symbol for q in UNKNOWNS}
    lines = PAIR_LABELS if pairwise else range(1, LEVELS + 1)
    return [of_cell(table, symbol, line, approach) for line in lines]


def read_published(folder: Path) -> Published:
    """Read the printed numbers from `folder`.

    Raises ValueError naming file and column when a cell is blank or an id appears twice.
    """
    frame = read_texts(folder / FILE, Row._fields)
    for column in ("id", "where", "quantity", "printed", "kind", "rule"):
        if (frame[column].str.strip() == "").any():
            raise ValueError(
                f"{FILE}: column {column} has an empty cell; every printed number needs its digits, place and rule"
            )
    if (twice := frame["id"][frame["id"].duplicated()]).any():
        raise ValueError(f"{FILE}: id {twice.iloc[0]} appears twice; each needs its own name")
    return Published({row.id: row for row in map(Row._make, frame.to_numpy())})


def read_texts(path: Path, columns: tuple[str, ...]) -> pd.DataFrame:
    """A table with these columns, every cell the text that it is. Raises ValueError for anything else."""
    if not path.is_file() or path.stat().st_size > _MOST_BYTES:
        raise ValueError(
            f"{path.name}: needed is a file of this name, of {_MOST_BYTES:,} bytes at most"
        )
    try:
        frame = pd.read_csv(path, dtype=str, keep_default_na=False, encoding="utf-8")
    except (OSError, ValueError) as error:  # not text, empty, or rows of different lengths
        reason = " ".join(str(error).split())[:120]
        raise ValueError(
            f"{path.name}: cannot be read as a table of text in UTF-8: {reason}"
        ) from None
    if tuple(frame.columns) != columns:
        raise ValueError(
            f"{path.name}: expected the columns {', '.join(columns)}, found {', '.join(frame.columns)[:120]}"
        )
    return frame
