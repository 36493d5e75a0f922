"""The numbers of a case in one table: a row for each number, a column for each route that gives it.

What a number is, its `Key`, stands in columns; tables, verdicts and comparisons select rows by it. Features have a row
per level and one of their mean; estimates one per approach, kind and pair; their errors are those of F_k and c, %.
Printed numbers have the same keys.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import product
from typing import TYPE_CHECKING, Any, NamedTuple, get_args

import numpy as np

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
"""The routes: exactly; as the authors computed; before anything is read or rounded; from the printed tables."""

Values = Mapping[Key, float]
"""The numbers of one route."""

Numbers = Mapping[Key, Mapping[Any, Any]]
"""The rows of a table of numbers."""

PRINTED_APPROACHES = ("direct", "t_s", "X_s", "V_s")
"""The approaches that the paper prints estimates of, in the order of Tables 2 and 3."""

TABLE_1 = ("X", "X_s", "V_s", "phi", "t_s")
TABLE_2 = ("a", "b", "W")
"""The features that the paper prints, level by level."""

COEFFICIENTS = ("F_k", "c")
"""What the paper identifies; the table of numbers has every term of the balance."""

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

PARAMETERS = {"m": "kg", "c": "N s/m", "k": "N/m", "K_z": "N/m", "F_k": "N"}
"""Parameter of the case → its unit."""

UNITS = {**dict(QUANTITIES.values()), **PARAMETERS, "omega": "Hz", "omega_n": "Hz", "zeta": "1"}
"""Quantity → its unit."""


def key_of(
    frequency: str, quantity: str, approach: str = "", kind: str = "level", line: str = "all"
) -> Key:
    """Return the key of a number as the paper has it: φ and t_s are individual in least squares, otherwise common."""
    sharing = "individual" if kind == "least_squares" else "common"
    own = sharing if approach and takes_phase(approach) else ""
    unit = "%" if kind == "largest" else UNITS[quantity]
    return Key(frequency, quantity, approach, kind, "", own, line, unit)


def of_case(case: Case) -> dict[Key, float]:
    """Return the parameters of a case, and what follows from them."""
    osc = case.oscillator
    given = Key(kind="parameter")
    hertz = given._replace(unit="Hz")
    return {
        **{
            given._replace(quantity=s, unit=unit): getattr(osc, s) for s, unit in PARAMETERS.items()
        },
        given._replace(quantity="zeta", unit="1"): osc.zeta,
        hertz._replace(quantity="omega_n"): osc.omega_n / (2.0 * math.pi),
        **{
            hertz._replace(frequency=n, quantity="omega"): f for n, f in case.frequencies_hz.items()
        },
    }


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
        sharing = line["phase"] if takes_phase(line["approach"]) else ""
        way = Key(frequency, "", line["approach"], line["kind"], "", sharing, line["pair"])
        for column in (column for column in line if column in QUANTITIES):
            symbol, unit = QUANTITIES[str(column)]
            if symbol in TERMS or not math.isnan(line[column]):
                numbers[way._replace(quantity=symbol, unit=unit)] = line[column]
    return numbers


def of_errors(estimates: Values, osc: Oscillator, phase: str = "") -> dict[Key, float]:
    """Return the errors of F_k and c, %: of least squares, with sign, and the size of the largest of the pairs.

    osc : with the true values.   phase : as in `Key`.
    NaN: an estimate that does not exist (nothing slips), and an error relative to a true value of zero.
    """
    numbers: dict[Key, float] = {}
    for key, value in estimates.items():
        if key.quantity not in TERMS or key.kind not in ("least_squares", "pair"):
            continue
        error = 100.0 * (value / (getattr(osc, key.quantity, 0.0) or math.nan) - 1.0)
        own = key._replace(phase=phase, unit="%")
        if key.kind == "least_squares":
            numbers[own] = error
            continue
        together = key.sharing == "common" and key.approach in HARMONIC_APPROACHES
        approaches = (key.approach, HARMONIC) if together else (key.approach,)
        for name, quantity in product(approaches, (key.quantity, "any")):
            largest = own._replace(approach=name, quantity=quantity, kind="largest", line="all")
            numbers[largest] = float(np.fmax(numbers.get(largest, math.nan), abs(error)))
    return numbers


def of_routes(
    case: Case,
    features: Mapping[str, Mapping[str, pd.DataFrame]],
    estimates: Mapping[str, Mapping[str, pd.DataFrame]],
) -> dict[str, dict[Key, float]]:
    """Return all numbers of the routes that simulate, from route → frequency → table.

    The exact one has the errors of its approaches for every definition of the phase.
    """
    routes: dict[str, dict[Key, float]] = {}
    for route, frames in features.items():
        numbers = routes[route] = of_case(case) if route == "exact" else {}
        for name, frame in frames.items():
            numbers |= of_features(name, frame)
        for name, frame in estimates.get(route, {}).items():
            found = of_estimates(name, frame)
            numbers |= found | of_errors(found, case.oscillator)
    for name, frame in features["exact"].items():
        routes["exact"] |= _errors_by_phase(name, Features.from_frame(frame), case)
    return routes


def _errors_by_phase(frequency: str, features: Features, case: Case) -> dict[Key, float]:
    """Return the errors of every approach: with φ as it is, and with every definition of it."""
    osc, numbers = case.oscillator, dict[Key, float]()
    for phase in ("", *PHASES):
        of_phase = features.with_phase(phase) if phase else features
        table = of_estimates(frequency, estimate_table(of_phase, osc.k, case.pairs))
        chosen = {key: value for key, value in table.items() if key.sharing or not phase}
        numbers |= of_errors(chosen, osc, phase)
    return numbers


def numbers_table(routes: Mapping[str, Values], ids: Mapping[Key, str]) -> pd.DataFrame:
    """Join the numbers of the routes: a row per number, with the columns `id`, those of `Key`, and COLUMNS.

    ids : of printed numbers, by their keys.   NaN: the route has no such number.
    """
    import pandas as pd  # slow to import, and needed for tables only

    keys = dict.fromkeys(key for column in COLUMNS for key in routes.get(column, ()))
    return pd.DataFrame.from_records(
        [
            (ids.get(key, ""), *key, *(routes.get(c, {}).get(key, math.nan) for c in COLUMNS))
            for key in keys
        ],
        columns=["id", *Key._fields, *COLUMNS],
    )


def with_claims(table: pd.DataFrame, claims: pd.DataFrame) -> pd.DataFrame:
    """Return a table of numbers with the columns `printed` and `verdict` of the claims, "" where nothing is printed."""
    printed = claims[["id", "printed", "verdict"]]
    return table.merge(printed, "left", "id").fillna({"printed": "", "verdict": ""})


def select(table: pd.DataFrame, **keys: str) -> pd.DataFrame:
    """Return the rows of a table of numbers with these fields of `Key`, in the order of the table."""
    for name, value in keys.items():
        table = table[table[name] == value]
    return table


def by_key(table: pd.DataFrame) -> Numbers:
    """Return the rows of a table of numbers by their keys: the id, a number for each route, and any other column."""
    keys = map(Key._make, table[list(Key._fields)].itertuples(index=False, name=None))
    rows = table.drop(columns=list(Key._fields)).to_dict("records")
    return dict(zip(keys, rows, strict=True))


def number(numbers: Numbers, route: str, **keys: str) -> float:
    """Return a number by a route, NaN where it has none.   keys : fields of `Key`."""
    return float(numbers.get(Key(**keys), {}).get(route, math.nan))


def features_of(numbers: Numbers, route: str, frequency: str, omega: float) -> Features:
    """Return the features of all levels by a route.   omega : drive frequency, rad/s."""
    values: dict[str, list[float]] = {}
    for key, row in numbers.items():
        if (key.frequency, key.kind) == (frequency, "level") and key.quantity in FEATURE_COLUMNS:
            values.setdefault(key.quantity, []).append(row[route])
    return of_numbers(omega, "", **values)
