"""The claims of the running text: stated parameters, least squares, means and deviations, error bounds, comparisons."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ...balance import TERMS
from ...estimates import estimate_table
from ...features import Features
from ...model import Oscillator
from ..claim_ids import of_parameter, of_text, statistic
from ..claim_verdicts import ROUTE_NAMES, Kind
from ..printed_tables import RESIDUAL, UNKNOWNS
from ..readout import ReadOut
from . import causes, statements
from .from_print import printed_estimates, printed_pair_statistics
from .inputs import HARMONIC, PAIRS, RouteTables, Sources
from .judging import HALF, WRITTEN, Claim
from .published import Published, row

if TYPE_CHECKING:
    import pandas as pd

# What the least squares of each approach start from.
LEAST_SQUARES = {"direct": "Table 2's integrals"} | dict.fromkeys(HARMONIC, "Table 1's read-outs")
SIMULATING: tuple[str, ...] = ("exact", "as_published")
COLUMNS = {quantity.symbol: quantity.column for quantity in (*UNKNOWNS, RESIDUAL)}
# Every value of the text that has a claim, by its id in text_values.csv.
TEXT_IDS = frozenset(
    {statistic(symbol, name, "least_squares") for name in LEAST_SQUARES for symbol in COLUMNS}
    | {statistic(symbol, "direct", kind) for symbol in ("c", "F_k") for kind in ("mean", "std")}
    | {"t_s_mean", "phi_mean", "max_error_F_k", "max_error_c", "max_error_omega3"}
    | {"accuracy_omega2", "accuracy_omega3", "direct_best"}
)


def check(published: Published) -> None:
    """Raise ValueError for values of the text that have no claim, or that its rule cannot judge."""
    odd = TEXT_IDS ^ set(published.text_values.index)
    if odd:
        raise ValueError(
            f"text_values.csv and the claims of the text do not match: {', '.join(sorted(odd))}; "
            "each printed value needs its claim"
        )
    for name in published.text_values.index:
        stated = row(published.text_values, name)
        if name.startswith("max_error_"):
            statements.bound(name, stated["quantity"], stated["printed"], {})
        elif name.startswith("accuracy_"):
            statements.change(name, stated["printed"], {}, {})
        elif name == "direct_best":
            statements.truth(name, stated["printed"], {})


def parameters(sources: Sources) -> Iterator[Claim]:
    """The stated parameters, wherever the paper prints them; ζ and ω_n follow from the others."""
    osc = sources.case.oscillator
    held = {
        "m": osc.m,
        "c": osc.c,
        "k": osc.k,
        "K_z": osc.K_z,
        "F_k": osc.F_k,
        **sources.case.frequencies_hz,
    }
    computed = {"zeta": osc.zeta, "omega_n": osc.omega_n / (2.0 * math.pi)}
    for name in sources.published.parameters.index:
        stated = row(sources.published.parameters, name)
        symbol, printed = stated["symbol"], stated["printed"]
        kind: Kind = "computed"
        holds, cause = None, ""
        if symbol in computed:
            value = computed[symbol]
        else:
            kind, value = "given", held[symbol]
            holds, cause = causes.same(value, printed), causes.held(value, printed)
        yield Claim(
            id=of_parameter(name),
            where=stated["where"],
            quantity=stated["quantity"],
            unit=stated["unit"],
            printed=printed,
            values={"exact": value},
            kind=kind,
            holds=holds,
            cause=cause,
        )


def least_squares(sources: Sources) -> Iterator[Claim]:
    """Least squares of (9) from the printed tables, with the individual φ and t_s: F_k, c and residual."""
    for approach, inputs in LEAST_SQUARES.items():
        for symbol, column in COLUMNS.items():
            name = statistic(symbol, approach, "least_squares")
            values = sources.estimates(column, approach, kind="least_squares")
            printed = sources.published.text_values["printed"][name]
            cause = f"{causes.printed_inputs(values, inputs, printed)} {causes.cut_off(values['from_print'], printed)}"
            # A residual is made of rounding: without that of print it has another size.
            apart = SIMULATING if symbol == RESIDUAL.symbol else ()
            yield _computed(sources, name, values, cause.strip(), apart=apart)


def means(sources: Sources) -> Iterator[Claim]:
    """Means and deviations of printed numbers: the pairs of Table 2, and the φ and t_s that Table 3 uses."""
    printed = printed_pair_statistics(sources.published)
    for symbol in ("c", "F_k"):
        for kind, moment in (("mean", printed.mean), ("std", printed.deviation)):
            values = sources.estimates(COLUMNS[symbol], "direct", kind=kind)
            values["from_print"] = moment[symbol]
            name = statistic(symbol, "direct", kind)
            apart = SIMULATING if kind == "std" else ()  # the printed b_1 makes nearly all of it
            cause = "Over the five pairs that Table 2 prints."
            yield _computed(sources, name, values, cause, apart=apart)
    for name, column in (("t_s_mean", "t_s_s"), ("phi_mean", "phi_rad")):
        values = {route: table.mean_feature(column) for route, table in sources.routes.items()}
        # The mean of five times in whole tenths comes out even; those that are cut off lie below the exact ones.
        tenths = name == "t_s_mean"
        reach, apart = (WRITTEN, SIMULATING[:1]) if tenths else (HALF, ())
        cause = "Over the five values that Table 1 prints."
        yield _computed(sources, name, values, cause, apart=apart, reach=reach)


def error_bounds(sources: Sources) -> Iterator[Claim]:
    """Bounds on the errors of the two-point formulas with common φ and t_s."""
    osc = sources.case.oscillator
    tables = sources.routes | {"from_print": printed_estimates(sources.published)}
    errors = {route: table.largest_errors(osc) for route, table in tables.items()}
    for symbol in TERMS:
        values = {route: largest[symbol] for route, largest in errors.items()}
        cause = f"Largest error in the fifteen pairs: {_each(values, '%')}."
        yield _bound(sources, f"max_error_{symbol}", values, cause)

    values = _worst(sources.routes, osc, frequency="omega3")
    tables = sources.routes | {str(n): _with_decimals(sources, "omega3", n) for n in (6, 5)}
    signed = {
        name: _extreme(table.errors(osc, frequency="omega3")["F_k"])
        for name, table in tables.items()
    }
    cause = (
        f"Largest error of F_k by the recipe that gives Table 3: {signed['as_published']}; by exact features "
        f"{signed['exact']}, with six decimals {signed['6']}, with the five of Table 1 {signed['5']}. The paper prints "
        "no number at this frequency to hold against it."
    )
    yield _bound(sources, "max_error_omega3", values, cause)


def comparisons(sources: Sources) -> Iterator[Claim]:
    """Statements without a number: accuracy off resonance, and which approach is the most accurate."""
    osc, hz = sources.case.oscillator, sources.case.frequencies_hz
    near = _worst(sources.routes, osc)
    for frequency in ("omega2", "omega3"):
        values = _worst(sources.routes, osc, frequency=frequency)
        here = f"{values[statements.ROUTE]:.1f} % at {hz[frequency]:g} Hz"
        there = f"{near[statements.ROUTE]:.1f} % at {hz['omega1']:g} Hz"
        cause = f"Largest error of the two-point formulas: {here}, {there}."
        name = f"accuracy_{frequency}"
        judged = statements.change(
            name, sources.published.text_values["printed"][name], values, near
        )
        yield _stated(sources, name, values, cause, judged)

    tables = sources.routes | {"from_print": printed_estimates(sources.published)}
    direct = _worst(tables, osc, ("direct",))
    each = [_worst(tables, osc, (approach,)) for approach in HARMONIC]
    harmonic = {route: min(errors[route] for errors in each) for route in tables}
    cause = f"Largest error in the pairs, direct: {_each(direct, '%')}; best harmonic approach: {_each(harmonic, '%')}."
    facts = {route: direct[route] < harmonic[route] for route in direct}
    judged = statements.truth(
        "direct_best", sources.published.text_values["printed"]["direct_best"], facts
    )
    yield _stated(sources, "direct_best", direct, cause, judged)


def _bound(sources: Sources, name: str, values: Mapping[str, float], cause: str) -> Claim:
    stated = row(sources.published.text_values, name)
    judged = statements.bound(name, stated["quantity"], stated["printed"], values)
    return _stated(sources, name, values, cause, judged)


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


def _computed(
    sources: Sources, name: str, values: Mapping[str, float], cause: str, **rule: Any
) -> Claim:
    """A number of the text that the paper computes from its own tables.   rule : further fields of the claim."""
    stated = row(sources.published.text_values, name)
    return Claim(
        id=of_text(name),
        where=stated["where"],
        quantity=stated["quantity"],
        unit=stated["unit"],
        printed=stated["printed"],
        values=values,
        route="from_print",
        cause=cause,
        contradiction=causes.printed_inputs_differ(values, stated["printed"]),
        **rule,
    )


def _stated(
    sources: Sources,
    name: str,
    values: Mapping[str, float],
    cause: str,
    judged: statements.Judged,
) -> Claim:
    stated = row(sources.published.text_values, name)
    return Claim(
        id=of_text(name),
        where=stated["where"],
        quantity=stated["quantity"],
        unit=stated["unit"],
        printed=stated["printed"],
        values=values,
        route=statements.ROUTE,
        kind="statement",
        holds=judged.holds,
        cause=f"{judged.how} {cause}",
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
