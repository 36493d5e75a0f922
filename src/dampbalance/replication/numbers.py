"""The numbers of a case in one table: a row for each number, a column for each route that gives it.

What a number is, its `Key`, stands in columns; tables, verdicts and comparisons select rows by it. Features have a row
per level and one of their mean; estimates one per approach, kind and pair; their errors are those of F_k and c, %.
Printed numbers have the same keys (`paper/published/printed.csv`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple, get_args

from ..balance import TERMS, takes_phase
from ..estimates import estimate_table
from ..features import FEATURE_COLUMNS, Features, PhaseKind, of_numbers
from ..model import Oscillator
from ..project.case import Case
from .authors_route import SLIPPING_SAMPLE

if TYPE_CHECKING:
    import pandas as pd


class Key(NamedTuple):
    """What a number is: its columns in the table, each a text, "" where it does not apply.

    frequency : name of the drive frequency; "" for a parameter of the case.
    quantity : symbol, of FEATURE_COLUMNS, TERMS or the case; "any" for the larger error of F_k and c.
    approach : of an estimate: a key of APPROACHES; HARMONIC for the largest error of the three that the paper prints.
    kind : parameter; level or mean of a feature; pair, mean, std or least_squares of an estimate; largest, of pairs.
    phase : the definition of φ, for errors by another than that of the case.
    sharing : φ and t_s individual to each level or common to all; "" for an approach that takes no phase.
    line : the level, counted from 1, the label of a pair, or all.
    unit : SI; % for errors.
    """

    frequency: str = ""
    quantity: str = ""
    approach: str = ""
    kind: str = ""
    phase: str = ""
    sharing: str = ""
    line: str = "all"
    unit: str = ""


COLUMNS = ("exact", "as_published", "unrounded", "from_print")
"""The routes: exactly; as the authors computed; the same before anything is read or rounded; from the printed tables."""

Values = Mapping[Key, float]
"""The numbers of one route."""

PRINTED_APPROACHES = ("direct", "t_s", "X_s", "V_s")
"""The approaches that the paper prints estimates of, in the order of Tables 2 and 3."""

HARMONIC = "harmonic"
HARMONIC_APPROACHES = PRINTED_APPROACHES[1:]

PHASES: tuple[PhaseKind, ...] = get_args(PhaseKind)
"""The lags of x behind y that the harmonic approaches can use."""


def _feature(name: str, column: str) -> tuple[str, str]:
    return name, column.removeprefix(f"{name}_").replace("_per_", "/").replace("m2", "m^2")


QUANTITIES = {
    **{column: _feature(name, column) for name, column in FEATURE_COLUMNS.items()},
    SLIPPING_SAMPLE: ("V_s_at_sample", "m/s"),
    **{term.column: (symbol, term.unit) for symbol, term in TERMS.items()},
    **{t.error_column: (f"{symbol}_standard_error", t.unit) for symbol, t in TERMS.items()},
    "residual": ("residual", "1"),
    "K_z_N_per_m": ("K_z", "N/m"),
}
"""Column of a table of features or estimates → its quantity and unit in the table of numbers."""

UNITS = dict(QUANTITIES.values())


def of_case(case: Case) -> dict[Key, float]:
    """Return the parameters of a case, and what follows from them."""
    osc = case.oscillator
    units = {"m": "kg", "c": "N s/m", "k": "N/m", "K_z": "N/m", "F_k": "N"}
    numbers = {(s, unit): getattr(osc, s) for s, unit in units.items()}
    numbers |= {("zeta", "1"): osc.zeta, ("omega_n", "Hz"): osc.omega_n / (2.0 * math.pi)}
    parameters = {
        Key(quantity=s, kind="parameter", unit=unit): v for (s, unit), v in numbers.items()
    }
    driven = {
        Key(name, "omega", kind="parameter", unit="Hz"): hz
        for name, hz in case.frequencies_hz.items()
    }
    return parameters | driven


def of_features(frequency: str, frame: pd.DataFrame) -> dict[Key, float]:
    """Return every feature of every level, and its mean over the levels that have it.

    frame : `Features.to_frame()`.
    """
    numbers = {}
    for column in (column for column in frame if column in QUANTITIES):
        symbol, unit = QUANTITIES[str(column)]
        feature = Key(frequency, symbol, unit=unit)
        for level, value in enumerate(frame[column], 1):
            numbers[feature._replace(kind="level", line=str(level))] = value
        numbers[feature._replace(kind="mean")] = frame[column].mean()
    return numbers


def of_estimates(frequency: str, frame: pd.DataFrame) -> dict[Key, float]:
    """Return the numbers of a table of estimates: F_k and c, and what exists of all else.

    frame : `estimates.estimate_table`.
    """
    numbers = {}
    for line in frame.to_dict("records"):
        way = Key(frequency, "", line["approach"], line["kind"], "", _sharing(line), line["pair"])
        for column in (column for column in line if column in QUANTITIES):
            symbol, unit = QUANTITIES[str(column)]
            if symbol in TERMS or not math.isnan(line[column]):
                numbers[way._replace(quantity=symbol, unit=unit)] = line[column]
    return numbers


def of_errors(
    frequency: str, frame: pd.DataFrame, osc: Oscillator, phase: str = ""
) -> dict[Key, float]:
    """Return the errors of F_k and c, %: of the least squares, with sign, and the size of the largest of the pairs.

    frame : `estimates.estimate_table`.   osc : with the true values.   phase : as in `Key`.
    NaN: an estimate that does not exist (nothing slips), and an error relative to a true value of zero.
    """
    numbers: dict[Key, float] = {}
    errors = relative_errors(frame, osc)

    def largest(way: Key, rows: pd.DataFrame) -> None:
        of_terms = rows.abs().max()
        numbers.update({way._replace(quantity=s): error for s, error in of_terms.items()})
        numbers[way._replace(quantity="any")] = of_terms.max()

    pair = frame["kind"] == "pair"
    for _, lines in frame.groupby(["approach", "phase"], sort=False):
        way = Key(frequency, "", lines["approach"].iloc[0], "largest", phase, unit="%")
        way = way._replace(sharing=_sharing(lines.iloc[0]))
        for _, fit in errors.loc[lines.index[lines["kind"] == "least_squares"]].iterrows():
            kind = way._replace(kind="least_squares")
            numbers |= {kind._replace(quantity=s): error for s, error in fit.items()}
        largest(way, errors.loc[lines.index[lines["kind"] == "pair"]])
    common = pair & (frame["phase"] == "common") & frame["approach"].isin(HARMONIC_APPROACHES)
    largest(Key(frequency, "", HARMONIC, "largest", phase, "common", unit="%"), errors[common])
    return numbers


def relative_errors(frame: pd.DataFrame, osc: Oscillator) -> pd.DataFrame:
    """Return the signed errors of F_k and c, %, of each line of a table of estimates; NaN for a true value of zero."""
    import pandas as pd  # slow to import, and needed for tables only

    return pd.DataFrame(
        {
            name: 100.0 * (frame[term.column] / (getattr(osc, name, 0.0) or math.nan) - 1.0)
            for name, term in TERMS.items()
        }
    )


def of_route(
    case: Case, features: Mapping[str, pd.DataFrame], estimates: Mapping[str, pd.DataFrame]
) -> dict[Key, float]:
    """Return all numbers of a route that simulates, from its tables by frequency."""
    numbers: dict[Key, float] = {}
    for name, frame in features.items():
        numbers |= of_features(name, frame)
    for name, frame in estimates.items():
        numbers |= of_estimates(name, frame) | of_errors(name, frame, case.oscillator)
    return numbers


def errors_by_phase(case: Case, features: Mapping[str, pd.DataFrame]) -> dict[Key, float]:
    """Return the errors of every approach with exact features, for every definition of the phase."""
    numbers: dict[Key, float] = {}
    osc = case.oscillator
    for name, frame in features.items():
        of = Features.from_frame(frame)
        for phase in ("", *PHASES):
            of_phase = of.with_phase(phase) if phase else of
            table = estimate_table(of_phase, osc.k, case.pairs)
            if phase:
                table = table[table["approach"].map(takes_phase)]
            numbers |= of_errors(name, table, osc, phase)
    return numbers


def numbers_table(routes: Mapping[str, Values]) -> pd.DataFrame:
    """Join the numbers of the routes: a row per number, the columns of `Key` and COLUMNS; NaN where a route has none."""
    import pandas as pd  # slow to import, and needed for tables only

    keys = dict.fromkeys(key for column in COLUMNS for key in routes.get(column, ()))
    return pd.DataFrame.from_records(
        [(*key, *(routes.get(c, {}).get(key, math.nan) for c in COLUMNS)) for key in keys],
        columns=[*Key._fields, *COLUMNS],
    )


def by_key(numbers: pd.DataFrame) -> dict[Key, dict[str, float]]:
    """Return the rows of a table of numbers by their keys, each with a number per route."""
    cells = numbers[[*Key._fields, *COLUMNS]].itertuples(index=False, name=None)
    n = len(Key._fields)
    return {Key(*row[:n]): dict(zip(COLUMNS, row[n:], strict=True)) for row in cells}


def select(numbers: pd.DataFrame, **keys: str) -> pd.DataFrame:
    """Return the rows with these keys, in the order of the table.   keys : of `Key`."""
    chosen = numbers
    for name, value in keys.items():
        chosen = chosen[chosen[name] == value]
    return chosen


def number(numbers: pd.DataFrame, route: str, **keys: str) -> float:
    """Return one number by a route, NaN where it has none.   keys : of `Key`, its defaults for those not given."""
    chosen = select(numbers, **Key(**keys)._asdict())[route]
    return float(chosen.iloc[0]) if len(chosen) else math.nan


def features_of(numbers: pd.DataFrame, route: str, frequency: str, omega: float) -> Features:
    """Return the features of all levels by a route.   omega : drive frequency, rad/s. Raises ValueError: none."""
    rows = select(numbers, frequency=frequency, kind="level")
    of = {name: select(rows, quantity=name)[route].to_numpy() for name in FEATURE_COLUMNS}
    return of_numbers(omega, "", **of)


def _sharing(line: Mapping[str, str]) -> str:
    """Return the sharing of φ and t_s behind a line of estimates."""
    return line["phase"] if takes_phase(line["approach"]) else ""
