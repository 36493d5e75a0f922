"""The numbers of the paper, as printed, and the route that computes from nothing but them.

Each row keeps the number as text, and so its digits and its rounding. The from-print route takes Table 1 and the
integrals of Table 2 through the same rows and the same solver as everything else. It gives the printed least squares,
residuals, means and deviations: the paper's arithmetic is sound.

This package is the only place that reads `paper/published/`: what is compared with must not leak into what is computed.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from ...arrays import Array
from ...estimates import estimate_table
from ...features import Features, of_numbers
from ...project.case import Case
from ...project.wording import cut
from ...solver import Pair, pair_label
from ..numbers import COEFFICIENTS, PRINTED_APPROACHES, Key, of_errors, of_estimates, of_features

LONGEST = 25
"""Most characters of a printed number."""

_POWERS = (-30, 30)  # powers of ten within which every quantity of the paper lies


@dataclass(frozen=True, slots=True)
class Printed:
    """A number as printed, e.g. "90.0402" or "2.9E-3"."""

    text: str

    @property
    def is_number(self) -> bool:
        """Whether the text is a number of a size that a quantity of the paper can have, and no word like "degraded"."""
        try:
            number = self.decimal
        except ValueError:
            return False
        fits = len(self.text) <= LONGEST and number.is_finite()
        return fits and self.exponent >= _POWERS[0] and number.adjusted() <= _POWERS[1]

    @property
    def decimal(self) -> Decimal:
        """The printed number, exactly. Raises ValueError when the text is not a number."""
        try:
            return Decimal(self.text)
        except InvalidOperation:
            text = f"printed value {self.text!r} is not a number such as 90.0402 or 2.9E-3"
            raise ValueError(text) from None

    @property
    def decimals(self) -> int:
        """Digits after the point: 4 of 0.0273, 4 of 2.9E-3."""
        return max(0, -self.exponent)

    @property
    def significant(self) -> int:
        """Significant digits: 3 of 0.0273, 2 of 2.9E-3."""
        return len(self.decimal.as_tuple().digits)

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

    def moved(self, units: int) -> str:
        """Return the text with its last digit moved by some units, in the same form: 90.0402 by 1 → 90.0403."""
        value = self.decimal + units * Decimal(1).scaleb(self.exponent)
        mantissa, power = re.split("(?=[eE])|$", self.text, maxsplit=1)  # the latter, e.g., E-3
        moved = value.scaleb(-int(power[1:] or 0))
        return f"{moved:.{Printed(mantissa).decimals}f}{power}"

    def show(self, value: float, extra: int = 4) -> str:
        """Write `value` like the printed number with `extra` more digits; "" for NaN.

        Where a word is printed, it has three decimals.
        """
        if math.isnan(value):
            return ""
        if not self.is_number:
            return f"{value:.3f}"
        if "e" in self.text.lower():
            return f"{value:.{self.decimal.adjusted() - self.exponent + extra}e}"
        return f"{value:.{self.decimals + extra}f}"


FILE = "printed.csv"

FREQUENCIES = ("omega1", "omega2", "omega3")
"""The paper's three drive frequencies, by the names they have in the configuration and in results/."""

LEVELS = 5
PAIRS: tuple[Pair, ...] = ((0, 1), (1, 2), (2, 3), (3, 4), (0, 4))
PAIR_LABELS = tuple(pair_label(i, j) for i, j in PAIRS)

_MOST_BYTES = 1_000_000  # the longest table, claims.csv, has 40 kB


class Row(NamedTuple):
    """A printed number, a row of `paper/published/printed.csv`: texts, as they are.

    id : as in claims.csv.   where : the place in the paper.   key : what it is.   words : the same in words.
    claim, rule : of KINDS and of `rules.RULES`: what judges the number.
    """

    id: str
    where: str
    key: Key
    words: str
    printed: str
    claim: str
    rule: str

    @property
    def number(self) -> Printed:
        """The number as it is printed."""
        return Printed(self.printed)


@dataclass(frozen=True)
class Published:
    """All printed numbers, by their ids, in the order of the file, which is that of claims.csv."""

    rows: Mapping[str, Row]

    def __getitem__(self, claim: str) -> Printed:
        """Return a printed number by its id."""
        return self.rows[claim].number

    @cached_property
    def ids(self) -> dict[Key, str]:
        """The ids of the printed numbers by what they are; of one that is printed in several places, the first."""
        return {row.key: row.id for row in reversed([*self.rows.values()])}

    def column(self, quantity: str, kind: str = "level", approach: str = "") -> list[Row]:
        """Return what is printed of a quantity: a column of a table, in the order of its lines, or a single number."""
        rows = (row for row in self.rows.values() if row.key[1:4] == (quantity, approach, kind))
        return [row for row in rows if self.ids[row.key] == row.id]

    def values(self, quantity: str, kind: str = "level", approach: str = "") -> Array:
        """Return the numbers of a `column`."""
        return np.array([row.number.value for row in self.column(quantity, kind, approach)])

    def changed(self, texts: Mapping[str, str]) -> Published:
        """Return these printed numbers with other texts for some of them, by id."""
        rows = {claim: self.rows[claim]._replace(printed=text) for claim, text in texts.items()}
        return Published({**self.rows, **rows})


_COLUMNS = ("id", "where", *Key._fields, "words", "printed", "claim", "rule")


def read_published(folder: Path) -> Published:
    """Read the printed numbers from `folder`.

    Raises ValueError naming file and column when a cell is blank.
    """
    frame = read_texts(folder / FILE, _COLUMNS)
    for column in ("id", "where", "quantity", "words", "printed", "claim", "rule"):
        if (frame[column].str.strip() == "").any():
            raise ValueError(
                f"{FILE}: column {column} has an empty cell; every printed number needs its digits, place and rule"
            )
    keys = map(Key._make, frame[list(Key._fields)].to_numpy())
    others = frame.drop(columns=list(Key._fields)).to_numpy()
    rows = (
        Row(name, where, key, *rest) for key, (name, where, *rest) in zip(keys, others, strict=True)
    )
    return Published({row.id: row for row in rows})


def read_texts(path: Path, columns: tuple[str, ...]) -> pd.DataFrame:
    """Read a table that has these columns, every cell as text.

    Raises ValueError for a file that is missing, too large or no such table, and for an `id` that appears twice.
    """
    problem = f"the file is missing, or has more than {_MOST_BYTES:,} bytes"
    if path.is_file() and path.stat().st_size <= _MOST_BYTES:
        try:
            frame = pd.read_csv(path, dtype=str, keep_default_na=False, encoding="utf-8")
        except (OSError, ValueError) as error:  # not text, empty, or rows of different lengths
            reason = " ".join(str(error).split())[:120]
            problem = f"cannot be read as a table of text in UTF-8: {reason}"
        else:
            if tuple(frame.columns) != columns:
                present = ", ".join(frame.columns)[:120]
                problem = f"expected the columns {', '.join(columns)}, found {present}"
            elif (twice := frame["id"][frame["id"].duplicated()]).any():
                rows = csv.reader(path.read_text(encoding="utf-8").splitlines())
                at = [rows.line_num for row in rows if row[:1] == [twice.iloc[0]]]
                name, where = cut(twice.iloc[0], LONGEST), ", ".join(map(str, at))
                problem = f"id {name} appears in lines {where}; each needs its own, so keep one"
            else:
                return frame
    raise ValueError(f"{path.name}: {problem}")


def printed_features(published: Published, omega: float) -> Features:
    """Return Tables 1 and 2 as features: each printed number as it stands, everything the paper does not print NaN.

    omega : drive frequency, rad/s.
    """
    levels = {row.key.quantity for row in published.rows.values() if row.key.kind == "level"}
    return of_numbers(omega, "as printed", **{name: published.values(name) for name in levels})


def from_print(published: Published, case: Case) -> dict[Key, float]:
    """Return the numbers at ω1 that follow from the printed ones: estimates, and statistics of features and pairs.

    Estimates follow from the printed features, those of pairs with φ = 1.542 and t_s = 2.1 ms of the text; mean,
    deviation and errors of the pairs follow from the pairs that Tables 2 and 3 print. Only ω, k, the pairs and the true
    values do not come from the print.
    """
    features = printed_features(published, case.omega("omega1"))
    stated = {name: published.values(name, "mean")[0] for name in ("phi", "t_s")}
    common, k = features.replaced(**stated), case.oscillator.k
    estimates = estimate_table(features, k, PAIRS, common=common, approaches=PRINTED_APPROACHES)
    means = of_features("omega1", features.to_frame())
    numbers = {key: mean for key, mean in means.items() if key.kind == "mean"}
    numbers |= of_estimates("omega1", estimates)
    for symbol, name in product(COEFFICIENTS, PRINTED_APPROACHES):
        first, *_ = published.column(symbol, "pair", name)
        pairs, moment = published.values(symbol, "pair", name), first.key._replace(line="all")
        numbers[moment._replace(kind="mean")] = float(pairs.mean())
        numbers[moment._replace(kind="std")] = float(pairs.std(ddof=1))
    printed = {
        row.key: row.number.value for row in published.rows.values() if row.key.kind == "pair"
    }
    return numbers | of_errors(printed, case.oscillator)
