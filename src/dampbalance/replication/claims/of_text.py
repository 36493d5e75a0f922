"""The claims of the running text: stated parameters, least squares, means and deviations, error bounds, comparisons."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from ...balance import TERMS
from ...estimates import estimate_table
from ...features import Features
from ...model import Oscillator
from ..claim_ids import of_parameter, of_text, statistic
from ..printed import Printed
from ..tables import RESIDUAL, UNKNOWNS
from ..verdicts import ROUTE_NAMES
from . import causes
from .from_print import printed_as_table1, printed_estimates, printed_pair_statistics
from .inputs import HARMONIC, PAIRS, RouteTables, Sources
from .judging import Claim
from .published import row

# What the least squares of each approach start from.
LEAST_SQUARES = {"direct": "Table 2's integrals"} | dict.fromkeys(HARMONIC, "Table 1's read-outs")
COLUMNS = {quantity.symbol: quantity.column for quantity in (*UNKNOWNS, RESIDUAL)}
# Every value of the text that has a claim, by its id in text_values.csv.
TEXT_IDS = frozenset(
    {statistic(symbol, name, "least_squares") for name in LEAST_SQUARES for symbol in COLUMNS}
    | {statistic(symbol, "direct", kind) for symbol in ("c", "F_k") for kind in ("mean", "std")}
    | {"t_s_mean", "phi_mean", "max_error_F_k", "max_error_c", "max_error_omega3"}
    | {"accuracy_omega2", "accuracy_omega3", "direct_best"}
)


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
    natural_hz = osc.omega_n / (2.0 * math.pi)
    for name in sources.published.parameters.index:
        stated = row(sources.published.parameters, name)
        symbol, printed = stated["symbol"], stated["printed"]
        holds = None
        if symbol == "zeta":
            value, cause = osc.zeta, ""
        elif symbol == "omega_n":  # a statement: equal to ω_1, to its digits
            value, cause = natural_hz, causes.natural_frequency(natural_hz)
            holds = {"exact": abs(value - Printed(printed).value) <= 0.5 * Printed(printed).unit}
        else:
            value, cause = held[symbol], causes.held(held[symbol], printed)
            holds = {"exact": causes.same(value, printed)}
        yield Claim(
            id=of_parameter(name),
            where=stated["where"],
            quantity=stated["quantity"],
            unit=stated["unit"],
            printed=printed,
            values={"exact": value},
            holds=holds,
            cause=cause,
        )


def least_squares(sources: Sources) -> Iterator[Claim]:
    """Least squares of (9) with the individual φ and t_s: F_k, c and residual of each approach."""
    for approach, inputs in LEAST_SQUARES.items():
        for symbol, column in COLUMNS.items():
            name = statistic(symbol, approach, "least_squares")
            values = sources.estimates(column, approach, kind="least_squares")
            printed = sources.published.text_values["printed"][name]
            cause = f"{causes.printed_inputs(values, inputs, printed)} {causes.cut_off(values['from_print'], printed)}"
            yield _claim(sources, name, values, cause.strip())


def means(sources: Sources) -> Iterator[Claim]:
    """Means and deviations of printed numbers: the pairs of Table 2, and the φ and t_s that Table 3 uses."""
    printed = printed_pair_statistics(sources.published)
    for symbol in ("c", "F_k"):
        for kind, moment in (("mean", printed.mean), ("std", printed.deviation)):
            values = sources.estimates(COLUMNS[symbol], "direct", kind=kind)
            values["from_print"] = moment[symbol]
            name = statistic(symbol, "direct", kind)
            yield _claim(sources, name, values, "Over the five pairs that Table 2 prints.")
    for name, column in (("t_s_mean", "t_s_s"), ("phi_mean", "phi_rad")):
        values = {route: table.mean_feature(column) for route, table in sources.routes.items()}
        yield _claim(sources, name, values, "Over the five values that Table 1 prints.")


def error_bounds(sources: Sources) -> Iterator[Claim]:
    """Bounds on the errors of the two-point formulas with common φ and t_s."""
    osc = sources.case.oscillator
    tables = sources.routes | {"from_print": printed_estimates(sources.published)}
    errors = {route: table.largest_errors(osc) for route, table in tables.items()}
    for symbol in TERMS:
        name = f"max_error_{symbol}"
        bound = Printed(sources.published.text_values["printed"][name]).value
        values = {route: largest[symbol] for route, largest in errors.items()}
        holds = {route: value < bound for route, value in values.items()}
        cause = f"Largest error in the fifteen pairs: {_each(values, '%')}."
        yield _claim(sources, name, values, cause, holds)

    name = "max_error_omega3"
    bound = Printed(sources.published.text_values["printed"][name]).value
    tables = sources.routes | {"from_print": _tabulated(sources, "omega3")}
    values = _worst(tables, osc, frequency="omega3")
    holds = {route: value > bound for route, value in values.items()}
    cause = (
        f"Exact features give {values['exact']:.1f} %, the same features with the decimals of Table 1 "
        f"{values['from_print']:.1f} %: the figure owes as much to rounding as to the method."
    )
    if not holds["from_print"] or holds["exact"]:
        cause = ""
    yield _claim(sources, name, values, cause, holds)


def comparisons(sources: Sources) -> Iterator[Claim]:
    """Statements without a number: accuracy off resonance, and which approach is the most accurate."""
    osc, hz = sources.case.oscillator, sources.case.frequencies_hz
    near = _worst(sources.routes, osc)
    for frequency in ("omega2", "omega3"):
        values = _worst(sources.routes, osc, frequency=frequency)
        here = f"{values['exact']:.1f} % at {hz[frequency]:g} Hz"
        there = f"{near['exact']:.1f} % at {hz['omega1']:g} Hz"
        cause = f"Largest error of the two-point formulas with exact features: {here}, {there}."
        holds = {route: values[route] > near[route] for route in values}
        yield _claim(sources, f"accuracy_{frequency}", values, cause, holds)

    tables = sources.routes | {"from_print": printed_estimates(sources.published)}
    direct = _worst(tables, osc, ("direct",))
    each = [_worst(tables, osc, (approach,)) for approach in HARMONIC]
    harmonic = {route: min(errors[route] for errors in each) for route in tables}
    cause = f"Largest error in the pairs, direct: {_each(direct, '%')}; best harmonic approach: {_each(harmonic, '%')}."
    holds = {route: direct[route] < harmonic[route] for route in direct}
    yield _claim(sources, "direct_best", direct, cause, holds)


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


def _claim(
    sources: Sources,
    name: str,
    values: Mapping[str, float],
    cause: str,
    holds: Mapping[str, bool] | None = None,
) -> Claim:
    stated = row(sources.published.text_values, name)
    comparable = holds is None and not math.isnan(values["from_print"])
    return Claim(
        id=of_text(name),
        where=stated["where"],
        quantity=stated["quantity"],
        unit=stated["unit"],
        printed=stated["printed"],
        values=values,
        holds=holds,
        cause=cause,
        evidence=causes.printed_inputs_differ(values, stated["printed"]) if comparable else "",
    )


def _tabulated(sources: Sources, frequency: str) -> RouteTables:
    """Pairs from the exact features of a frequency, had they been tabulated like Table 1; nothing if there are none."""
    frame = sources.exact.features.get(frequency)
    if frame is None:
        return RouteTables({}, {})
    features = printed_as_table1(Features.from_frame(frame), sources.published)
    return RouteTables({}, {frequency: estimate_table(features, sources.case.oscillator.k, PAIRS)})


def _each(values: Mapping[str, float], unit: str) -> str:
    """The values of the routes in words."""
    return ", ".join(
        f"{value:.3f} {unit} {ROUTE_NAMES[route]}"
        for route, value in values.items()
        if not math.isnan(value)
    )
