"""Whether every printed cell is what its place asks for, before anything is judged by it."""

from __future__ import annotations

from collections.abc import Iterable

import pandas as pd

from ..printed import Printed
from . import of_text
from .inputs import FREQUENCIES, LEVELS, PAIR_LABELS
from .published import Published

_LEVELS = tuple(str(level) for level in range(1, LEVELS + 1))
_SYMBOLS = ("m", "c", "k", "K_z", "F_k", "zeta", "omega_n", *FREQUENCIES)
_WORDS = ("accuracy_", "direct_best")  # values of the text that are judged by a word
_LONGEST, _POWERS = 25, (-30, 30)  # characters of a number, and of ten


def check(published: Published) -> None:
    """Raise ValueError naming file, row and column for a row that is missing or too many, or a cell that is no number,
    and for what `of_text.check` finds."""
    tables = {
        "table1": _LEVELS,
        "table2_integrals": _LEVELS,
        "table2_pairs": PAIR_LABELS,
        "table3": PAIR_LABELS,
    }
    for name, rows in tables.items():
        table = getattr(published, name)
        if tuple(table.index) != rows:
            raise ValueError(
                f"{name}.csv: the rows must be {', '.join(rows)}, in this order, got {_few(table.index)}"
            )
        _numbers(name, table, table.columns)
    symbols = published.parameters["symbol"]
    for parameter, symbol in symbols[~symbols.isin(_SYMBOLS)].items():
        raise ValueError(
            f"parameters.csv: row {parameter}, column symbol: {symbol!r} is not known; "
            f"known are {', '.join(_SYMBOLS)}"
        )
    _numbers("parameters", published.parameters, ["printed"])
    words = published.text_values.index.str.startswith(_WORDS)
    _numbers("text_values", published.text_values[~words], ["printed"])
    of_text.check(published)


def _numbers(name: str, table: pd.DataFrame, columns: Iterable[str]) -> None:
    for column in columns:
        for row, text in table[column].items():
            if not _is_number(text):
                shown = text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"
                raise ValueError(
                    f"{name}.csv: row {row}, column {column}: {shown!r} is not a number such as 90.0402 or 2.9E-3"
                )


def _is_number(text: str) -> bool:
    """Whether the text is a number with digits, of a size that a quantity of the paper can have."""
    printed = Printed(text)
    if len(text) > _LONGEST or not printed.is_number or not printed.decimal.is_finite():
        return False
    low, high = _POWERS
    return low <= printed.exponent and printed.decimal.adjusted() <= high


def _few(rows: Iterable[object]) -> str:
    names = [str(row)[:_LONGEST] for row in rows]
    return ", ".join(names[:8]) + (" …" if len(names) > 8 else "")
