"""The claims on numbers of the running text: stated parameters, least squares, means and deviations."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ..printed_tables import COLUMN_OF, RESIDUAL
from . import causes
from .judging import WRITTEN, Claim
from .published import Row
from .sources import SIMULATING, Sources

if TYPE_CHECKING:
    pass


def held(sources: Sources, row: Row) -> Claim:
    """The inputs, amplitudes of Tables 1 and 2 among them: the configuration must hold what is printed."""
    case = sources.case
    if row.symbol == "Y":
        value = case.levels_m[int(row.line) - 1]
    else:
        frequency = case.frequencies_hz.get(row.symbol)
        value = frequency or getattr(case.oscillator, row.symbol)
    same = math.isclose(value, row.number.value, rel_tol=1e-12)
    other = f"The configuration holds {value:g}, the paper states {row.printed}."
    cause = "The configuration holds this value." if same else other
    return Claim(row, {"exact": value}, holds=same, cause=cause)


def follows(sources: Sources, row: Row) -> Claim:
    """The stated parameters ζ and ω_n, which follow from the others."""
    osc = sources.case.oscillator
    return Claim(
        row, {"exact": osc.zeta if row.symbol == "zeta" else osc.omega_n / (2.0 * math.pi)}
    )


def least_squares(sources: Sources, row: Row) -> Claim:
    """Least squares of (9) from the printed tables, with the individual φ and t_s: F_k, c and residual."""
    values = sources.estimates(COLUMN_OF[row.symbol], row.approach, kind="least_squares")
    inputs = "Table 2's integrals" if row.approach == "direct" else "Table 1's read-outs"
    moved = causes.printed_inputs(values, inputs, row.number)
    cause = f"{moved} {causes.cut_off(values['from_print'], row.number)}".strip()
    # The residual comes from the rounding of the printed tables; without it, its size is another.
    apart = SIMULATING if row.symbol == RESIDUAL.symbol else ()
    return _from_print(row, values, cause, apart=apart)


def moment_of_pairs(sources: Sources, row: Row) -> Claim:
    """Mean and deviation of the printed pairs of Table 2."""
    mean = row.rule == "mean of pairs"
    pairs = sources.published.column("table2", row.symbol)
    values = sources.estimates(
        COLUMN_OF[row.symbol], row.approach, kind="mean" if mean else "std"
    ) | {"from_print": float(pairs.mean() if mean else pairs.std(ddof=1))}
    apart = () if mean else SIMULATING  # the printed b_1 makes nearly all of the deviation
    return _from_print(row, values, "Over the five pairs that Table 2 prints.", apart=apart)


def mean_of_levels(sources: Sources, row: Row) -> Claim:
    """Mean of the φ and of the t_s of the levels, which Table 3 uses."""
    column = COLUMN_OF[row.symbol]
    values = {name: tables.mean_feature(column) for name, tables in sources.routes.items()}
    how: dict[str, Any] = {}
    if row.symbol == "t_s":
        # The mean of five times in whole tenths has no more digits than print; cut off, they lie below exact.
        how = {"reach": WRITTEN, "apart": SIMULATING[:1]}
    return _from_print(row, values, "Over the five values that Table 1 prints.", **how)


def _from_print(row: Row, values: Mapping[str, float], cause: str, **how: Any) -> Claim:
    """A number of the text that the paper computes from its own tables.   how : further fields of the claim."""
    contradiction = causes.printed_inputs_differ(values, row.number)
    return Claim(row, values, "from_print", cause=cause, contradiction=contradiction, **how)
