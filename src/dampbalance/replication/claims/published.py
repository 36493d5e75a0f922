"""The numbers of the paper, as printed: strings keep their digits, and with them how finely they were rounded.

This package is the only place that reads `paper/published/`: what is compared with must not leak into what is computed.
"""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

FILES = {
    "parameters": ("id", "symbol", "quantity", "printed", "unit", "where"),
    "table1": ("level", "Y_m", "X_m", "X_s_m", "V_s_m_per_s", "phi_rad", "t_s_s"),
    "table2_integrals": ("level", "Y_m", "a_m", "b_m2_per_s", "W_J"),
    "table2_pairs": ("pair", "direct_c_N_s_per_m", "direct_F_k_N"),
    "table3": (
        "pair",
        *(
            f"{approach}_{unknown}"
            for approach in ("t_s", "X_s", "V_s")
            for unknown in ("F_k_N", "c_N_s_per_m")
        ),
    ),
    "text_values": ("id", "quantity", "printed", "unit", "where"),
}


@dataclass(frozen=True, slots=True)
class Printed:
    """A number as printed, e.g. "90.0402" or "2.9E-3"."""

    text: str

    @property
    def is_number(self) -> bool:
        """Whether the text is a number at all, and not a word such as "degraded"."""
        try:
            Decimal(self.text)
        except InvalidOperation:
            return False
        return True

    @property
    def decimal(self) -> Decimal:
        """The printed number, exactly. Raises ValueError when the text is not a number."""
        try:
            return Decimal(self.text)
        except InvalidOperation:
            raise ValueError(
                f"printed value {self.text!r} is not a number such as 90.0402 or 2.9E-3"
            ) from None

    @property
    def value(self) -> float:
        """The printed number as a float."""
        return float(self.decimal)

    @property
    def unit(self) -> float:
        """One unit of the last printed digit: 0.0001 for "90.0402"."""
        return float(Decimal(1).scaleb(self.exponent))

    @property
    def exponent(self) -> int:
        """Power of ten of the last printed digit: −4 for "90.0402"."""
        return int(self.decimal.as_tuple().exponent)

    def show(self, value: float, extra: int = 4) -> str:
        """`value` written as the printed number is, with `extra` more digits; "" for NaN."""
        if np.isnan(value):
            return ""
        if "e" in self.text.lower():
            return f"{value:.{self.decimal.adjusted() - self.exponent + extra}e}"
        return f"{value:.{max(0, -self.exponent) + extra}f}"


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


def _read(path: Path, columns: tuple[str, ...]) -> pd.DataFrame:
    frame = pd.read_csv(path, dtype=str, keep_default_na=False)
    if tuple(frame.columns) != columns:
        raise ValueError(
            f"{path}: expected the columns {', '.join(columns)}, found {', '.join(frame.columns)}"
        )
    for column in columns:
        if column != "unit" and (frame[column].str.strip() == "").any():
            raise ValueError(
                f"{path}: column {column} has an empty cell; every printed number needs its digits"
            )
    if frame[columns[0]].duplicated().any():
        twice = frame[columns[0]][frame[columns[0]].duplicated()].iloc[0]
        raise ValueError(f"{path}: {columns[0]} {twice} appears twice; each needs its own name")
    return frame.set_index(columns[0])
