"""The numbers of the paper, as printed, and the route that computes from nothing but them.

A row for each number keeps its text, and so its digits and how finely it was rounded. The from-print route puts Table 1
and the integrals of Table 2 through the same rows and the same solver as everything else. For the least squares, the
residuals, the means and the deviations the printed numbers come out: the paper's arithmetic is sound.

This package is the only place that reads `paper/published/`: what is compared with must not leak into what is computed.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from ...arrays import Array
from ...estimates import estimate_table
from ...features import FEATURE_COLUMNS, Features, of_numbers
from ...project.case import Case
from ...project.wording import cut
from ...solver import Pair, pair_label
from ..numbers import Key, of_errors, of_estimates, of_features
from ..rebuilt_tables import (
    HARMONIC,
    IDENTIFIED_QUANTITIES,
    PRINTED_APPROACHES,
    TABLE_1,
    TABLE_2,
    RouteTables,
)
from .verdicts import ClaimId, of_cell, of_text

LONGEST = 25
"""Characters of a number at most."""

_POWERS = (-30, 30)  # powers of ten within which every quantity of the paper lies


@dataclass(frozen=True, slots=True)
class Printed:
    """A number as printed, e.g. "90.0402" or "2.9E-3"."""

    text: str

    @property
    def is_number(self) -> bool:
        """Whether the text is a number, of a size that a quantity of the paper can have, not a word as "degraded"."""
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
        """Return the text with its last digit moved by so many units, written alike: 90.0402 by 1 → 90.0403."""
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
    """A printed number: the columns of `paper/published/printed.csv`, each as the text that it is.

    id : as in claims.csv.
    where : the place in the paper.
    symbol : what the number is a value of, or what the statement is about.
    approach : by which an estimate was obtained; "" for anything else.
    kind, rule : of KINDS and of `rules.RULES`: what judges the number.
    """

    id: ClaimId
    where: str
    symbol: str
    approach: str
    quantity: str
    unit: str
    printed: str
    kind: str
    rule: str

    @property
    def number(self) -> Printed:
        """The number as it is printed."""
        return Printed(self.printed)


@dataclass(frozen=True, slots=True)
class Published:
    """All printed numbers, by their ids, in the order of the file, which is that of claims.csv."""

    rows: Mapping[str, Row]

    def __getitem__(self, claim: str) -> Printed:
        """Return a printed number by its id."""
        return self.rows[claim].number

    def column(self, table: str, symbol: str, approach: str = "") -> Array:
        """Return the numbers of a column of a table, from its first line to its last; arguments as in `column_ids`."""
        return np.array([self[claim].value for claim in column_ids(table, symbol, approach)])

    def changed(self, texts: Mapping[str, str]) -> Published:
        """Return these printed numbers with other texts for some of them, by id."""
        rows = {claim: self.rows[claim]._replace(printed=text) for claim, text in texts.items()}
        return Published({**self.rows, **rows})


def column_ids(table: str, symbol: str, approach: str = "") -> list[str]:
    """Return the ids of a column of Tables 1 to 3, from its first line to its last.   approach : for Table 3 only."""
    pairwise = symbol in {q.symbol for q in IDENTIFIED_QUANTITIES}
    lines = PAIR_LABELS if pairwise else range(1, LEVELS + 1)
    return [of_cell(table, symbol, line, approach) for line in lines]


def read_published(folder: Path) -> Published:
    """Read the printed numbers from `folder`.

    Raises ValueError naming file and column when a cell is blank.
    """
    frame = read_texts(folder / FILE, Row._fields)
    for column in ("id", "where", "quantity", "printed", "kind", "rule"):
        if (frame[column].str.strip() == "").any():
            raise ValueError(
                f"{FILE}: column {column} has an empty cell; every printed number needs its digits, place and rule"
            )
    return Published({name: Row(ClaimId(name), *cells) for name, *cells in frame.to_numpy()})


def read_texts(path: Path, columns: tuple[str, ...]) -> pd.DataFrame:
    """Return a table with these columns, every cell the text that it is, and each `id` once.

    Raises ValueError for anything else.
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
    printed = {"Y_m": published.column("table1", "Y")}
    for table, quantities in (("table1", TABLE_1), ("table2", TABLE_2)):
        printed |= {q.column: published.column(table, q.symbol) for q in quantities}
    missing = np.full(LEVELS, np.nan)
    features = {name: printed.get(column, missing) for name, column in FEATURE_COLUMNS.items()}
    return of_numbers(omega, "as printed", **features)


def from_print(published: Published, case: Case) -> RouteTables:
    """Return estimates at ω1 from the printed features, pair-wise with φ = 1.542 and t_s = 2.1 ms of the text.

    Only ω, k and the pairs come from outside the print.
    """
    features = printed_features(published, case.omega("omega1"))
    stated = {name: published[of_text(f"{name}_mean")].value for name in ("phi", "t_s")}
    common, k = features.replaced(**stated), case.oscillator.k
    estimates = estimate_table(features, k, PAIRS, common=common, approaches=PRINTED_APPROACHES)
    return RouteTables({"omega1": features.to_frame()}, {"omega1": estimates})


def printed_estimates(published: Published) -> RouteTables:
    """Return the printed pairs of Tables 2 and 3 as a table of estimates."""
    frames = []
    for name in PRINTED_APPROACHES:
        table, phase = ("table3", "common") if name in HARMONIC else ("table2", "individual")
        approach = name if name in HARMONIC else ""
        pairs = {
            q.column: published.column(table, q.symbol, approach) for q in IDENTIFIED_QUANTITIES
        }
        frames.append(pd.DataFrame(pairs).assign(approach=name, kind="pair", phase=phase))
    return RouteTables({}, {"omega1": pd.concat(frames)})


def numbers_from_print(published: Published, case: Case) -> dict[Key, float]:
    """Return the numbers at ω1 that follow from the printed ones: features, estimates, and what sums them up.

    Estimates come from the printed features, pair-wise with φ = 1.542 and t_s = 2.1 ms of the text; mean, deviation and
    errors of the pairs from the pairs that Tables 2 and 3 print. Only ω, k, the pairs and the true values come from
    outside the print.
    """
    features = printed_features(published, case.omega("omega1"))
    stated = {name: published[of_text(f"{name}_mean")].value for name in ("phi", "t_s")}
    common, k = features.replaced(**stated), case.oscillator.k
    estimates = estimate_table(features, k, PAIRS, common=common, approaches=PRINTED_APPROACHES)
    numbers = of_features("omega1", features.to_frame()) | of_estimates("omega1", estimates)
    pairs = printed_pairs(published)
    columns = [q.column for q in IDENTIFIED_QUANTITIES]
    by_approach = pairs.groupby(["approach", "phase"], sort=False)[columns]
    for kind, moments in (("mean", by_approach.mean()), ("std", by_approach.std())):
        frame = moments.reset_index().assign(kind=kind, pair="all")
        numbers |= of_estimates("omega1", frame)
    return numbers | of_errors("omega1", pairs, case.oscillator)


def printed_pairs(published: Published) -> pd.DataFrame:
    """Return the printed pairs of Tables 2 and 3 as a table of estimates."""
    frames = []
    for name in PRINTED_APPROACHES:
        table, phase = ("table3", "common") if name in HARMONIC else ("table2", "individual")
        approach = name if name in HARMONIC else ""
        pairs = {
            q.column: published.column(table, q.symbol, approach) for q in IDENTIFIED_QUANTITIES
        }
        frames.append(
            pd.DataFrame(pairs).assign(approach=name, kind="pair", phase=phase, pair=PAIR_LABELS)
        )
    return pd.concat(frames, ignore_index=True)
