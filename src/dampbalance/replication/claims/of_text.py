"""The claims of the running text: stated parameters, least squares, means and deviations, error bounds, comparisons."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ...balance import TERMS
from ...estimates import estimate_table
from ...features import Features
from ...model import Oscillator
from ..claim_verdicts import ROUTE_NAMES
from ..printed_tables import COLUMN_OF, RESIDUAL
from ..readout import ReadOut
from ..route_tables import HARMONIC, RouteTables
from . import causes, statements
from .from_print import printed_estimates, printed_pair_statistics
from .inputs import Sources
from .judging import WRITTEN, Claim
from .published import PAIRS, Row

if TYPE_CHECKING:
    import pandas as pd

SIMULATING: tuple[str, ...] = ("exact", "as_published")


def held(sources: Sources, rows: Sequence[Row]) -> Iterator[Claim]:
    """The inputs, amplitudes of Tables 1 and 2 among them: the configuration must hold what is printed."""
    osc, case = sources.case.oscillator, sources.case
    parameters = {name: getattr(osc, name) for name in ("m", "c", "k", "K_z", "F_k")}
    values = parameters | dict(case.frequencies_hz)
    for row in rows:
        value = case.levels_m[int(row.line) - 1] if row.symbol == "Y" else values[row.symbol]
        yield row.claim(
            {"exact": value},
            holds=causes.same(value, row.printed),
            cause=causes.held(value, row.printed),
        )


def follows(sources: Sources, rows: Sequence[Row]) -> Iterator[Claim]:
    """The stated parameters ζ and ω_n, which follow from the others."""
    osc = sources.case.oscillator
    values = {"zeta": osc.zeta, "omega_n": osc.omega_n / (2.0 * math.pi)}
    for row in rows:
        yield row.claim({"exact": values[row.symbol]})


def least_squares(sources: Sources, rows: Sequence[Row]) -> Iterator[Claim]:
    """Least squares of (9) from the printed tables, with the individual φ and t_s: F_k, c and residual."""
    for row in rows:
        values = sources.estimates(COLUMN_OF[row.symbol], row.approach, kind="least_squares")
        inputs = "Table 2's integrals" if row.approach == "direct" else "Table 1's read-outs"
        moved = causes.printed_inputs(values, inputs, row.printed)
        cause = f"{moved} {causes.cut_off(values['from_print'], row.printed)}".strip()
        # The residual comes from the rounding of the printed tables; without it, its size is another.
        apart = SIMULATING if row.symbol == RESIDUAL.symbol else ()
        yield _from_print(row, values, cause, apart=apart)


def moments(sources: Sources, rows: Sequence[Row]) -> Iterator[Claim]:
    """Means and deviations of printed numbers: the pairs of Table 2, and the φ and t_s that Table 3 uses."""
    printed = printed_pair_statistics(sources.published)
    for row in rows:
        column, how = COLUMN_OF[row.symbol], {}
        if row.rule == "mean of levels":
            values = {route: table.mean_feature(column) for route, table in sources.routes.items()}
            cause = "Over the five values that Table 1 prints."
            if row.symbol == "t_s":
                # The mean of five times in whole tenths has no more digits than print; cut off, they lie below exact.
                how = {"reach": WRITTEN, "apart": SIMULATING[:1]}
        else:
            mean = row.rule == "mean of pairs"
            values = sources.estimates(column, row.approach, kind="mean" if mean else "std")
            values["from_print"] = (printed.mean if mean else printed.deviation)[row.symbol]
            cause = "Over the five pairs that Table 2 prints."
            if not mean:
                how = {"apart": SIMULATING}  # the printed b_1 makes nearly all of it
        yield _from_print(row, values, cause, **how)


def bounds(sources: Sources, rows: Sequence[Row]) -> Iterator[Claim]:
    """Bounds on the errors of the two-point formulas with common φ and t_s, at ω1 and at other frequencies."""
    osc = sources.case.oscillator
    tables = sources.routes | {"from_print": printed_estimates(sources.published)}
    errors = {route: table.largest_errors(osc) for route, table in tables.items()}
    for row in rows:
        if row.symbol in TERMS:
            values = {route: largest[row.symbol] for route, largest in errors.items()}
            cause = f"Largest error in the fifteen pairs: {_each(values, '%')}."
        else:
            values = _worst(sources.routes, osc, frequency=row.symbol)
            cause = _largest_with_sign(sources, row.symbol)
        judged = statements.bound(row.id, row.quantity, row.printed, values)
        yield _stated(row, values, cause, judged)


def changes(sources: Sources, rows: Sequence[Row]) -> Iterator[Claim]:
    """Words for how accurate the two-point formulas are off resonance."""
    osc, hz = sources.case.oscillator, sources.case.frequencies_hz
    near = _worst(sources.routes, osc)
    for row in rows:
        values = _worst(sources.routes, osc, frequency=row.symbol)
        here = f"{values[statements.ROUTE]:.1f} % at {hz[row.symbol]:g} Hz"
        there = f"{near[statements.ROUTE]:.1f} % at {hz['omega1']:g} Hz"
        cause = f"Largest error of the two-point formulas: {here}, {there}."
        judged = statements.change(row.id, row.printed, values, near)
        yield _stated(row, values, cause, judged)


def truths(sources: Sources, rows: Sequence[Row]) -> Iterator[Claim]:
    """That direct integration is the most accurate approach."""
    osc = sources.case.oscillator
    tables = sources.routes | {"from_print": printed_estimates(sources.published)}
    direct = _worst(tables, osc, ("direct",))
    each = [_worst(tables, osc, (approach,)) for approach in HARMONIC]
    harmonic = {route: min(errors[route] for errors in each) for route in tables}
    cause = f"Largest error in the pairs, direct: {_each(direct, '%')}; best harmonic approach: {_each(harmonic, '%')}."
    facts = {route: direct[route] < harmonic[route] for route in direct}
    for row in rows:
        yield _stated(row, direct, cause, statements.truth(row.id, row.printed, facts))


def _largest_with_sign(sources: Sources, frequency: str) -> str:
    """The largest error of F_k at a frequency by several ways to the features, a sentence."""
    osc = sources.case.oscillator
    tables = sources.routes | {str(n): _with_decimals(sources, frequency, n) for n in (6, 5)}
    signed = {
        name: _extreme(table.errors(osc, frequency=frequency)["F_k"])
        for name, table in tables.items()
    }
    return (
        f"Largest error of F_k by the recipe that gives Table 3: {signed['as_published']}; by exact features "
        f"{signed['exact']}, with six decimals {signed['6']}, with the five of Table 1 {signed['5']}. The paper prints "
        "no number at this frequency to hold against it."
    )


def _worst(
    tables: Mapping[str, RouteTables],
    osc: Oscillator,
    approaches: tuple[str, ...] = HARMONIC,
    frequency: str = "omega1",
) -> dict[str, float]:
    """By each route, the larger of the largest errors of F_k and c over the pairs, per cent."""
    return {
        route: max(table.largest_errors(osc, approaches, frequency).values())
        for route, table in tables.items()
    }


def _from_print(row: Row, values: Mapping[str, float], cause: str, **how: Any) -> Claim:
    """A number of the text that the paper computes from its own tables.   how : further fields of the claim."""
    return row.claim(
        values,
        route="from_print",
        cause=cause,
        contradiction=causes.printed_inputs_differ(values, row.printed),
        **how,
    )


def _stated(row: Row, values: Mapping[str, float], cause: str, judged: statements.Judged) -> Claim:
    return row.claim(
        values, route=statements.ROUTE, holds=judged.holds, cause=f"{judged.how} {cause}"
    )


def _with_decimals(sources: Sources, frequency: str, decimals: int) -> RouteTables:
    """Pairs from exact features of a frequency, X, X_s and V_s with so many decimals; nothing if there are none."""
    frame = sources.exact.features.get(frequency)
    if frame is None:
        return RouteTables({}, {})
    read = ReadOut(X_decimals=decimals, X_s_decimals=decimals, V_s_decimals=decimals)
    features = read.apply(Features.from_frame(frame))
    return RouteTables({}, {frequency: estimate_table(features, sources.case.oscillator.k, PAIRS)})


def _extreme(errors: pd.Series[float]) -> str:
    """The largest of some errors, per cent, with its sign and pair; "" for none."""
    values = errors.to_numpy()
    return "" if np.isnan(values).all() else f"{values[np.nanargmax(np.abs(values))]:+.1f} %"


def _each(values: Mapping[str, float], unit: str) -> str:
    """The values of the routes in words."""
    return ", ".join(
        f"{value:.3f} {unit} {ROUTE_NAMES[route]}"
        for route, value in values.items()
        if not math.isnan(value)
    )
