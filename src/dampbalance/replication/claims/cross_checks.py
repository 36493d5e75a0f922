"""Cross-checks among the printed numbers: cells that the printed least squares refute, ranges that others leave.

Checksums: the text prints F_k, c and the residual of the least squares of every approach, computed from Tables 1 and 2
as they stand. Put back into the paper's equations, the printed tables give these numbers to the last digit. A residual
of five digits hardly ever survives a changed digit in a table; where it does not, and where one other last digit in a
cell restores every one of the printed results, that cell is refuted by the paper itself.

Ranges: the pairs were computed from inputs with more digits than are printed. Every printed number, input or estimate,
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

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Array, Mask
from ...balance import APPROACHES, Rows
from ...features import Features, of_numbers
from ...project.case import Case
from ...solver import solve
from ..authors_route import APPROACHES_OF_TABLE_3, CORRECTED
from ..numbers import COEFFICIENTS, HARMONIC_APPROACHES, TABLE_1, TABLE_2
from .judging import NumberRange
from .printed import PAIRS, Printed, Published, Row, printed_features

if TYPE_CHECKING:
    from scipy.optimize import OptimizeResult

_TABLES = ((TABLE_1, HARMONIC_APPROACHES), (TABLE_2, ("direct",)))
"""Columns of Tables 1 and 2, and the approaches whose least squares start from them."""

_AS_COMPUTED = {name: name for name in HARMONIC_APPROACHES}
"""The columns of Table 3 and the rows behind them, of APPROACHES_OF_TABLE_3."""

_OTHER_DIGITS = [sign * step for step in range(1, 10) for sign in (1, -1)]


def refuted(published: Published, case: Case) -> dict[str, str]:
    """Return the cells of Tables 1 and 2 that the printed least squares refute: by the id of each, a sentence.

    Only ω, k and the equations come from outside the print.
    """
    printed, refutations = printed_features(published, case.omega("omega1")), {}
    for symbols, approaches in _TABLES:
        if _restored(printed, published, case, approaches).all():
            continue
        cells = [row for symbol in symbols for row in published.column(symbol)]
        others = [row.number.moved(step) for row in cells for step in _OTHER_DIGITS]
        features = printed[:, None][:, np.zeros(len(others), dtype=np.int64)]  # a case each
        many = {symbol: getattr(features, symbol).copy() for symbol in symbols}
        for place, row in enumerate(cells):
            part = slice(place * len(_OTHER_DIGITS), (place + 1) * len(_OTHER_DIGITS))
            many[row.key.quantity][int(row.key.line) - 1, part] = [
                float(other) for other in others[part]
            ]
        restored = _restored(features.replaced(**many), published, case, approaches)
        for place in reversed(np.flatnonzero(restored)):  # the first of a cell comes last
            refutations[cells[place // len(_OTHER_DIGITS)].id] = (
                f"The printed least squares follow from {others[place]} here, not from the printed number."
            )
    return refutations


def agrees(value: ArrayLike, number: Printed) -> Mask:
    """Return whether values, rounded or cut off, have the printed digits."""
    computed, units = np.asarray(value) / number.unit, number.value / number.unit
    return (np.abs(computed - units) <= 0.5) | (np.trunc(computed) == round(units))


def _restored(
    features: Features, published: Published, case: Case, approaches: Iterable[str]
) -> Mask:
    """Return whether features of the printed tables give every printed result of these least squares, case by case."""
    restored = np.ones(features.Y.shape[1:], dtype=np.bool_)
    for approach in approaches:
        estimate = solve(APPROACHES[approach](features, case.oscillator.k))
        for symbol, value in {**estimate.values, "residual": estimate.residual}.items():
            (row,) = published.column(symbol, "least_squares", approach)
            restored &= agrees(value, row.number)
    return restored


def table_2(published: Published) -> Table:
    """Return Table 2, with ranges for b of each level, m²/s, and F_k, N, and c, N s/m, of each pair."""
    inputs = [row for symbol in TABLE_2 for row in published.column(symbol)]
    estimates = _pairs(published, "direct")

    def of_inputs(values: Array) -> Array:
        a, b, W = values.reshape(3, -1, values.shape[1])
        return np.vstack([values, _estimates(Rows({"F_k": a, "c": b}, W))])

    return Table(inputs, estimates, of_inputs, [*published.column("b"), *estimates])


def _pairs(published: Published, approach: str) -> list[Row]:
    """Return the printed F_k of all pairs, then c of all pairs, by an approach."""
    return [row for symbol in COEFFICIENTS for row in published.column(symbol, "pair", approach)]


def misfits(published: Published, case: Case) -> dict[str, float]:
    """Return the smallest possible misfit of Table 3, in units of the last digit, with either sign in the V_s rows.

    "plus", "minus" : all columns from the same X, φ and t_s.   "minus alone" : the V_s columns by themselves. Above
    half a unit, no inputs within the rounding of Table 1 give what is printed.
    """
    minus = {"V_s": CORRECTED}
    ways = {"plus": _AS_COMPUTED, "minus": _AS_COMPUTED | minus, "minus alone": minus}
    return {name: table_3(published, case, rows).misfit for name, rows in ways.items()}


def table_3(published: Published, case: Case, rows: Mapping[str, str] = _AS_COMPUTED) -> Table:
    """Return columns of Table 3 with their inputs in Table 1, and ranges for F_k, N, and c, N s/m, of each pair.

    case : for ω1 and k.   rows : column → the rows of the balance behind it.
    """
    read = ("X", "X_s", "V_s")
    inputs = [row for symbol in read for row in published.column(symbol)]
    inputs += [row for symbol in ("phi", "t_s") for row in published.column(symbol, "mean")]
    estimates = [row for column in rows for row in _pairs(published, column)]
    Y, omega = published.values("Y")[:, None], case.omega("omega1")

    def of_inputs(values: Array) -> Array:
        numbers = dict(zip(read, values[:-2].reshape(3, len(Y), -1), strict=True))
        numbers |= {"Y": Y, "phi": values[-2], "t_s": values[-1]}
        every = {name: np.broadcast_to(x, numbers["X"].shape) for name, x in numbers.items()}
        features = of_numbers(omega, "", **every)
        systems = (APPROACHES_OF_TABLE_3[row](features, case.oscillator.k) for row in rows.values())
        return np.vstack([values, *map(_estimates, systems)])

    return Table(inputs, estimates, of_inputs, estimates)


def _estimates(rows: Rows) -> Array:
    """Return F_k of all pairs, then c of all pairs, a column per set of inputs.   rows : shape (levels, sets)."""
    estimate = solve(rows[np.transpose(PAIRS)])
    return np.vstack([estimate[symbol] for symbol in COEFFICIENTS])


class Table:
    """Printed numbers as linear functions of the inputs among them, about the inputs that fit the print best.

    off : deviation of each number from the print there, in units of its last digit.
    slopes : change of each number, likewise, per unit of each input.
    ranged : ids of the numbers that have a `range`.
    """

    def __init__(
        self,
        inputs: list[Row],
        estimates: list[Row],
        of_inputs: Callable[[Array], Array],
        ranged: list[Row],
    ) -> None:
        """From the printed rows and the function from m sets of inputs, shape (inputs, m), to all numbers."""
        rows = inputs + estimates
        self._ids, self.inputs, self._of_inputs = [row.id for row in rows], len(inputs), of_inputs
        self.ranged = {row.id for row in ranged}
        self._value, self._unit = np.array([(r.number.value, r.number.unit) for r in rows]).T
        at, unit = self._value[: self.inputs], self._unit[: self.inputs]
        self.off, self.slopes = self._linear(at)
        self._closest = self._nearest()
        for _ in range(2):  # steps that bring the worst number closer to the print
            if self._closest.x is None:
                break
            at = at + unit * self._closest.x[:-1]
            there = self._linear(at)
            if not all(np.isfinite(part).all() for part in there):  # no value of the formulas
                break
            self.off, self.slopes = there
            self._closest = self._nearest()

    @property
    def misfit(self) -> float:
        """The largest deviation of a number from the print, in units of its last digit."""
        return float(np.max(np.abs(self.off)))

    def range(self, claim: str) -> NumberRange | None:
        """Return the range that all other printed numbers leave for one; None where no value agrees with them."""
        place, program = self._ids.index(claim), self._closest
        # Where the numbers do not agree, those that determine the misfit contradict each other in any case.
        agree = program.x is None or program.x[-1] <= 0.5 + 1e-6
        if not agree and place not in np.flatnonzero(program.ineqlin.marginals) % len(self.off):
            return None
        ends, value, unit = self._ends(place), self._value[place], self._unit[place]
        return ends and (float(value + unit * ends[0]), float(value + unit * ends[1]))

    def _linear(self, inputs: Array) -> tuple[Array, Array]:
        n, unit = self.inputs, self._unit
        steps = 0.1 * np.diag(unit[:n])
        sets = np.hstack([inputs[:, None], inputs[:, None] + steps, inputs[:, None] - steps])
        values = self._of_inputs(sets) / unit[:, None]
        return values[:, 0] - self._value / unit, (values[:, 1 : n + 1] - values[:, n + 1 :]) / 0.2

    def _nearest(self) -> OptimizeResult:
        """Return the steps of the inputs that fit the print best and, last, the largest deviation, in units."""
        off, slopes = self.off, self.slopes
        both = np.hstack([np.vstack([slopes, -slopes]), -np.ones((2 * len(off), 1))])
        least = np.append(np.zeros(self.inputs), 1.0)
        return _program(least, both, np.concatenate([-off, off]))

    def _ends(self, place: int) -> NumberRange | None:
        """Return the least and greatest deviation of one number from the print, all others within half a unit."""
        others, room = np.delete(self.slopes, place, axis=0), np.delete(self.off, place)
        bounds = np.vstack([others, -others]), np.concatenate([0.5 - room, 0.5 + room])
        ends = []
        for sign in (1.0, -1.0):
            program = _program(sign * self.slopes[place], *bounds)
            if program.status != 0 or program.x is None:
                return None
            ends.append(float(self.off[place] + self.slopes[place] @ program.x))
        return ends[0], ends[1]


def _program(least: Array, A: Array, b: Array) -> OptimizeResult:
    """Return the x of any sign with the smallest `least`·x among those of A x ≤ b."""
    from scipy.optimize import linprog  # slow to import, and not needed to read or to check claims

    return linprog(least, A_ub=A, b_ub=b, bounds=(None, None), method="highs")
