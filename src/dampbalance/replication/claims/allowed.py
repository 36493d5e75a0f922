"""The range that the other printed numbers leave for a number of Tables 2 and 3.

The estimates were computed from inputs with more digits than are printed. Every printed number, input or estimate,
stands for a range one unit of its last digit wide, and through (8), (16), (18), (19) the estimates are functions of the
inputs:

    Table 2    F_k and c of the five pairs, and a, b, W themselves                     of the 15 inputs a, b, W
    Table 3    F_k and c of the five pairs by three approaches, the read-outs          of the 17 inputs X, X_s, V_s,
               of Table 1, and the φ and t_s that the text states                      one φ and one t_s

Linear programs give the least and the greatest value of a number over all inputs that keep every other one within its
range. The functions are made linear where they come closest to print; over a unit of print the error of this is below
a hundredth of a unit. Table 3 is taken as computed, with the slip of sign in its V_s columns; the printed numbers alone
determine the sign only if all its columns share X and φ (`misfits`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...balance import Approach, Rows
from ...features import of_numbers
from ...project.case import Case
from ...solver import solve
from ..as_published import APPROACHES_OF_TABLE_3
from ..claim_ids import of_text
from ..printed import Printed
from ..printed_tables import TABLE_2, UNKNOWNS
from ..route_tables import HARMONIC
from .inputs import CORRECTED
from .judging import Range
from .published import LEVELS, PAIRS, Published, column_ids

_ESTIMATES = tuple(q.symbol for q in UNKNOWNS)


class _Table(NamedTuple):
    """Numbers of print and how they follow from the inputs among them.

    printed : by id, the inputs first.
    inputs : how many of them are inputs.
    of_inputs : the function from m sets of inputs, shape (inputs, m), to all numbers.
    """

    printed: Mapping[str, Printed]
    inputs: int
    of_inputs: Callable[[Array], Array]

    @property
    def print_(self) -> Array:
        """The printed numbers."""
        return np.array([number.value for number in self.printed.values()])

    @property
    def unit(self) -> Array:
        """A unit of the last digit of each."""
        return np.array([number.unit for number in self.printed.values()])


def by_table_2(published: Published) -> dict[str, Range | None]:
    """The ranges that Table 2 allows for b of each level, m²/s, and F_k, N, and c, N s/m, of each pair, by id.

    None: no value agrees with all other printed numbers.
    """
    wanted = [claim for symbol in ("b", *_ESTIMATES) for claim in column_ids("table2", symbol)]
    return _ranges(_table_2(published), wanted)


def by_table_3(published: Published, case: Case) -> dict[str, Range | None]:
    """The ranges that Tables 1 and 3 allow for F_k, N, and c, N s/m, of each pair, by id; None as in `by_table_2`.

    Empty where every number agrees with all others, which is seen at once.   case : for ω1 and k.
    """
    table = _table_3(published, case, _as_computed())
    if _misfit(table) <= 0.5:
        return {}
    return _ranges(table, list(table.printed)[table.inputs :])


def misfits(published: Published, case: Case) -> dict[str, float]:
    """How many units of the last digit the number furthest off print is off at best, with either sign in the V_s rows.

    "plus", "minus" : all columns from the same X, φ and t_s.   "minus alone" : the V_s columns for themselves. Above
    half a unit no inputs within the rounding of Table 1 give what is printed.
    """
    plus = _as_computed()
    minus = {"V_s": APPROACHES_OF_TABLE_3[CORRECTED]}
    ways = {"plus": plus, "minus": plus | minus, "minus alone": minus}
    return {name: _misfit(_table_3(published, case, rows)) for name, rows in ways.items()}


def _as_computed() -> dict[str, Approach]:
    """The rows behind the columns of Table 3, by approach."""
    return {name: APPROACHES_OF_TABLE_3[name] for name in HARMONIC}


def _table_2(published: Published) -> _Table:
    symbols = (*(q.symbol for q in TABLE_2), *_ESTIMATES)
    ids = [claim for symbol in symbols for claim in column_ids("table2", symbol)]

    def of_inputs(values: Array) -> Array:
        a, b, W = values.reshape(3, -1, values.shape[1])
        return np.vstack([values, _estimates(Rows({"F_k": a, "c": b}, W))])

    return _Table({claim: published[claim] for claim in ids}, len(TABLE_2) * LEVELS, of_inputs)


def _table_3(published: Published, case: Case, approaches: Mapping[str, Approach]) -> _Table:
    inputs = [claim for symbol in ("X", "X_s", "V_s") for claim in column_ids("table1", symbol)]
    inputs += [of_text("phi_mean"), of_text("t_s_mean")]
    estimates = [
        claim
        for approach in approaches
        for symbol in _ESTIMATES
        for claim in column_ids("table3", symbol, approach)
    ]
    Y = published.column("table1", "Y")[:, None]

    def of_inputs(values: Array) -> Array:
        X, X_s, V_s = values[:-2].reshape(3, len(Y), -1)
        phi, t_s = (np.broadcast_to(row, X.shape) for row in values[-2:])
        features = of_numbers(
            case.omega("omega1"),
            "",
            Y=np.broadcast_to(Y, X.shape),
            X=X,
            X_s=X_s,
            V_s=V_s,
            phi=phi,
            t_s=t_s,
        )
        rows = [approach(features, case.oscillator.k) for approach in approaches.values()]
        return np.vstack([values, *map(_estimates, rows)])

    printed = {claim: published[claim] for claim in [*inputs, *estimates]}
    return _Table(printed, len(inputs), of_inputs)


def _estimates(rows: Rows) -> Array:
    """F_k of all pairs, then c of all pairs, a column per set of inputs.   rows : shape (levels, sets)."""
    estimate = solve(rows[np.transpose(PAIRS)])
    return np.vstack([estimate[q.symbol] for q in UNKNOWNS])


def _ranges(table: _Table, wanted: Sequence[str]) -> dict[str, Range | None]:
    """The range that all other printed numbers leave for each wanted one, by id."""
    off, slopes = _linear(table, _closest(table))
    places = {claim: place for place, claim in enumerate(table.printed)}
    ranges: dict[str, Range | None] = {}
    for claim in wanted:
        number, ends = table.printed[claim], _ends(off, slopes, places[claim])
        value, unit = number.value, number.unit
        ranges[claim] = ends and (value + unit * ends[0], value + unit * ends[1])
    return ranges


def _misfit(table: _Table) -> float:
    """How many units the number furthest off print is off, with the inputs that suit it best."""
    off, _ = _linear(table, _closest(table))
    return float(np.max(np.abs(off)))


def _linear(table: _Table, inputs: Array) -> tuple[Array, Array]:
    """How far every number is off print, and its slopes, in units of its last digit per unit of each input."""
    n, print_, unit = table.inputs, table.print_, table.unit
    steps = 0.1 * np.diag(unit[:n])
    sets = np.hstack([inputs[:, None], inputs[:, None] + steps, inputs[:, None] - steps])
    values = table.of_inputs(sets) / unit[:, None]
    return values[:, 0] - print_ / unit, (values[:, 1 : n + 1] - values[:, n + 1 :]) / 0.2


def _closest(table: _Table) -> Array:
    """The inputs at which the number furthest off print is the fewest units off; twice, since the first is far off."""
    from scipy.optimize import linprog  # slow to import, and not needed to read or to check claims

    inputs = table.print_[: table.inputs]
    for _ in range(2):
        off, slopes = _linear(table, inputs)
        ones = np.ones((len(off), 1))  # the last unknown: by how many units the furthest is off
        program = linprog(
            np.append(np.zeros(table.inputs), 1.0),
            A_ub=np.vstack([np.hstack([slopes, -ones]), np.hstack([-slopes, -ones])]),
            b_ub=np.concatenate([-off, off]),
            bounds=(None, None),
            method="highs",
        )
        if program.x is not None:
            inputs = inputs + table.unit[: table.inputs] * program.x[:-1]
    return inputs


def _ends(off: Array, slopes: Array, place: int) -> Range | None:
    """Least and greatest of one number, in units off print, with all others within half a unit of it; None for none."""
    from scipy.optimize import linprog

    others, room = np.delete(slopes, place, axis=0), np.delete(off, place)
    ends = []
    for sign in (1.0, -1.0):
        program = linprog(
            sign * slopes[place],
            A_ub=np.vstack([others, -others]),
            b_ub=np.concatenate([0.5 - room, 0.5 + room]),
            bounds=(None, None),
            method="highs",
        )
        if program.status != 0 or program.x is None:
            return None
        ends.append(float(off[place] + slopes[place] @ program.x))
    return ends[0], ends[1]
