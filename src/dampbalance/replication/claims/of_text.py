"""The claims of the running text: stated parameters, least squares, means and deviations, error bounds, comparisons."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ...balance import TERMS
from ...estimates import estimate_table
from ...features import Features
from ..claim_verdicts import ROUTE_NAMES
from ..comparison import largest_errors, relative_errors
from ..printed_tables import COLUMN_OF, RESIDUAL
from ..readout import ReadOut
from ..route_tables import HARMONIC, RouteTables
from . import causes, statements
from .judging import WRITTEN, Claim
from .published import PAIRS, Row
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


def bound(sources: Sources, row: Row) -> Claim:
    """Bounds on the errors of the two-point formulas with common φ and t_s, at ω1 and at other frequencies."""
    if row.symbol in TERMS:
        osc = sources.case.oscillator
        values = {
            name: largest_errors(tables.pairs(), osc)[row.symbol]
            for name, tables in sources.pairs.items()
        }
        cause = f"Largest error in the fifteen pairs: {_each(values)}."
    else:
        values = _worst(sources, sources.routes, frequency=row.symbol)
        cause = _largest_with_sign(sources, row.symbol)
    return _stated(row, values, cause, statements.bound(row, values[statements.ROUTE]))


def change(sources: Sources, row: Row) -> Claim:
    """Words for how accurate the two-point formulas are off resonance."""
    hz = sources.case.frequencies_hz
    values = _worst(sources, sources.routes, frequency=row.symbol)
    error, near = (of[statements.ROUTE] for of in (values, _worst(sources, sources.routes)))
    cause = (
        f"Largest error of the two-point formulas: {error:.1f} % at {hz[row.symbol]:g} Hz, "
        f"{near:.1f} % at {hz['omega1']:g} Hz."
    )
    return _stated(row, values, cause, statements.word(row, error, near))


def truth(sources: Sources, row: Row) -> Claim:
    """That direct integration is the most accurate approach."""
    direct, *harmonic = (
        _worst(sources, sources.pairs, (approach,)) for approach in ("direct", *HARMONIC)
    )
    best = {route: min(errors[route] for errors in harmonic) for route in direct}
    cause = f"Largest error in the pairs, direct: {_each(direct)}; best harmonic approach: {_each(best)}."
    judged = statements.word(row, direct[statements.ROUTE], best[statements.ROUTE])
    return _stated(row, direct, cause, judged)


def _largest_with_sign(sources: Sources, frequency: str) -> str:
    """The largest error of F_k at a frequency by several ways to the features, a sentence."""

    def largest(tables: RouteTables) -> str:
        errors = relative_errors(tables.pairs(frequency=frequency), sources.case.oscillator)
        of_F_k = errors["F_k"].to_numpy()
        signless = np.abs(of_F_k)
        return "" if np.isnan(signless).all() else f"{of_F_k[np.nanargmax(signless)]:+.1f} %"

    return (
        f"Largest error of F_k by the recipe that gives Table 3: {largest(sources.as_published)}; by exact features "
        f"{largest(sources.exact)}, with six decimals {largest(_with_decimals(sources, frequency, 6))}, with the five "
        f"of Table 1 {largest(_with_decimals(sources, frequency, 5))}. The paper prints no number at this frequency to "
        "hold against it."
    )


def _worst(
    sources: Sources,
    routes: Mapping[str, RouteTables],
    approaches: tuple[str, ...] = HARMONIC,
    frequency: str = "omega1",
) -> dict[str, float]:
    """By each route, the larger of the largest errors of F_k and c over the pairs, per cent."""
    osc = sources.case.oscillator
    return {
        name: max(largest_errors(tables.pairs(approaches, frequency), osc).values())
        for name, tables in routes.items()
    }


def _with_decimals(sources: Sources, frequency: str, decimals: int) -> RouteTables:
    """Pairs from exact features of a frequency, X, X_s and V_s with so many decimals; nothing if there are none."""
    frame = sources.exact.features.get(frequency)
    if frame is None:
        return RouteTables({}, {})
    read = ReadOut(X_decimals=decimals, X_s_decimals=decimals, V_s_decimals=decimals)
    features = read.apply(Features.from_frame(frame))
    return RouteTables({}, {frequency: estimate_table(features, sources.case.oscillator.k, PAIRS)})


def _from_print(row: Row, values: Mapping[str, float], cause: str, **how: Any) -> Claim:
    """A number of the text that the paper computes from its own tables.   how : further fields of the claim."""
    contradiction = causes.printed_inputs_differ(values, row.number)
    return Claim(row, values, "from_print", cause=cause, contradiction=contradiction, **how)


def _stated(row: Row, values: Mapping[str, float], cause: str, judged: statements.Judged) -> Claim:
    cause = f"{judged.how} {cause}"
    return Claim(row, values, statements.ROUTE, holds=judged.holds, cause=cause)


def _each(values: Mapping[str, float]) -> str:
    """The errors by the routes in words."""
    return ", ".join(
        f"{value:.3f} % {ROUTE_NAMES[route]}"
        for route, value in values.items()
        if not math.isnan(value)
    )
