"""What Table 2 allows: each of its numbers from all the others, every one within half a unit of its last digit.

The printed pairs were computed from a, b, W with more digits than are printed. For a pair of levels i, j

    a_i F_k + b_i c = W_i,   a_j F_k + b_j c = W_j,                                                          (6), (8)

so the ten pair-wise numbers and the fifteen integrals are tied by ten equations. Each printed number stands for a range
one unit wide; within it the equations are linear up to 1e-16 J (a unit of a times a unit of F_k), against a unit of
1e-8 J in W. Linear programs then give the least and the greatest value of any one number, its own print left out.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog

from ...arrays import Array
from ..printed import Printed
from ..tables import TABLE_2, UNKNOWNS
from .inputs import PAIR_LABELS, PAIRS
from .published import Published

_FAR = 1e4  # units that the number asked for may move: further than the others ever let it


@dataclass(frozen=True, slots=True)
class Allowed:
    """Ranges (low, high) in SI units; None where no value agrees with all other printed numbers.

    pairs : by label and symbol, F_k and c.   b : of the viscous integrals, by level counted from 1.
    """

    pairs: Mapping[tuple[str, str], tuple[float, float] | None]
    b: Mapping[int, tuple[float, float] | None]


def allowed(published: Published) -> Allowed:
    """What the printed Table 2 allows for the estimates of its pairs, and for its viscous integrals b."""
    numbers, columns = _numbers(published)
    place = {name: i for i, name in enumerate(columns)}
    matrix, right = _balances(numbers, place)
    scaled = matrix * np.array([number.unit for number in numbers])

    def within(name: tuple[str, str]) -> tuple[float, float] | None:
        ends = _ends(scaled, right, place[name])
        number = numbers[place[name]]
        return ends and (
            number.value + ends[0] * number.unit,
            number.value + ends[1] * number.unit,
        )

    symbols = [q.symbol for q in UNKNOWNS]
    return Allowed(
        pairs={(label, s): within((s, label)) for label in PAIR_LABELS for s in symbols},
        b={int(level): within(("b", level)) for level in published.table2_integrals.index},
    )


def _numbers(published: Published) -> tuple[list[Printed], list[tuple[str, str]]]:
    """Every number of Table 2, and its name: symbol, then level or pair."""
    integrals, pairs = published.table2_integrals, published.table2_pairs
    cells = {
        (q.symbol, level): integrals[q.column][level] for q in TABLE_2 for level in integrals.index
    } | {
        (q.symbol, label): pairs[f"direct_{q.column}"][label]
        for q in UNKNOWNS
        for label in pairs.index
    }
    return [Printed(text) for text in cells.values()], list(cells)


def _balances(numbers: list[Printed], place: Mapping[tuple[str, str], int]) -> tuple[Array, Array]:
    """The balances of all pairs, linear about print: matrix · (deviations from print) = right, J."""
    value = {name: numbers[i].value for name, i in place.items()}
    matrix, right = np.zeros((2 * len(PAIRS), len(numbers))), np.zeros(2 * len(PAIRS))
    lines = (
        (str(level + 1), label)
        for pair, label in zip(PAIRS, PAIR_LABELS, strict=True)
        for level in pair
    )
    for line, (level, label) in enumerate(lines):
        a, b, F_k, c = (
            value[name] for name in (("a", level), ("b", level), ("F_k", label), ("c", label))
        )
        slopes = {
            ("a", level): F_k,
            ("b", level): c,
            ("W", level): -1.0,
            ("F_k", label): a,
            ("c", label): b,
        }
        for name, slope in slopes.items():
            matrix[line, place[name]] = slope
        right[line] = value["W", level] - a * F_k - b * c
    return matrix, right


def _ends(scaled: Array, right: Array, wanted: int) -> tuple[float, float] | None:
    """Least and greatest deviation of one number from its print, in units of its last digit; None if there is none.

    scaled : the balances, J per unit of the last digit of each number.
    """
    size = scaled.shape[1]
    bounds = [(-_FAR, _FAR) if i == wanted else (-0.5, 0.5) for i in range(size)]
    rows = np.max(np.abs(scaled), axis=1)
    ends = []
    for sign in (1.0, -1.0):
        found = linprog(
            sign * np.eye(size)[wanted],
            A_eq=scaled / rows[:, None],
            b_eq=right / rows,
            bounds=bounds,
            method="highs",
        )
        if found.status != 0 or found.x is None:
            return None
        ends.append(float(found.x[wanted]))
    return ends[0], ends[1]
