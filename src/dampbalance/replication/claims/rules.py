"""The rules by which printed numbers are judged, in one registry: for each what the routes give, and why it differs.

Statements, bounds and words, are judged by one route, as published: they speak of what the authors computed. "Less than
1.5 %" holds where the value is less, and the bound is the value rounded as it is printed, or one unit looser; any
looser, it would say nothing of the value. A bound at a frequency at which the paper prints no read-outs is undecided
where some that it may have used keep it and others do not (`unprinted.py`). A word holds where the comparison that it
names does.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from ...balance import TERMS
from ...estimates import estimate_table
from ...features import Features
from ...project.case import Case
from ...project.files import ROUTES, read_csv, read_routes
from ...project.wording import cut
from ...solver import levels_of
from .. import rebuilt_tables as paper
from ..authors_route import CORRECTED, SLIPPING_SAMPLE
from ..comparison import largest_errors, relative_errors
from ..read_out import ReadOut
from ..rebuilt_tables import COLUMN_OF, HARMONIC, PRINTED_APPROACHES, RESIDUAL, RouteTables
from . import causes, cross_checks, judging, unprinted
from . import print as paper_print
from .judging import Claim
from .print import FILE, FREQUENCIES, LEVELS, LONGEST, PAIRS, Published, Row, column_ids
from .verdicts import ROUTE_NAMES, ClaimKind, of_text, statistic


def require_paper(case: Case) -> None:
    """Raise ValueError when the case lacks a frequency or a level of the paper."""
    if missing := ", ".join(name for name in FREQUENCIES if name not in case.frequencies_hz):
        raise ValueError(
            f"claims need the frequencies {', '.join(FREQUENCIES)}; missing: {missing}"
        )
    if len(case.levels_m) != LEVELS:
        raise ValueError(f"claims need the five levels of the paper, got {len(case.levels_m)}")


@dataclass(frozen=True)
class Sources:
    """All that claims are judged from, and what is computed from it once for many of them.

    published : the printed numbers.   case : as configured.
    exact, as_published : the result tables of the routes that simulate.
    unrounded : the as-published simulation at ω1 in full digits, `ReadFeatures.to_frame()`.

    from_print : the route from the printed numbers.   routes : by their names in claims.csv.
    pairs : the routes as in Tables 2 and 3, which print the pairs themselves.   unread : the route of `unrounded`.
    refuted, by_table_2, by_table_3, misfits : by `cross_checks`.   allowed : by both tables.
    rules_at_work : what moves the number of a row of Table 3.
    """

    published: Published
    case: Case
    exact: RouteTables
    as_published: RouteTables
    unrounded: pd.DataFrame

    from_print = cached_property(lambda self: paper_print.from_print(self.published, self.case))
    routes = cached_property(lambda self: {name: getattr(self, name) for name in ROUTE_NAMES})
    pairs = cached_property(
        lambda self: self.routes | {"from_print": paper_print.printed_estimates(self.published)}
    )
    unread = cached_property(lambda self: RouteTables({"omega1": self.unrounded}, {}))
    refuted = cached_property(lambda self: cross_checks.refuted(self.published, self.case))
    by_table_2 = cached_property(lambda self: cross_checks.by_table_2(self.published))
    by_table_3 = cached_property(lambda self: cross_checks.by_table_3(self.published, self.case))
    allowed = cached_property(lambda self: self.by_table_2 | self.by_table_3)
    misfits = cached_property(lambda self: cross_checks.misfits(self.published, self.case))
    rules_at_work = cached_property(
        lambda self: causes.rules_at_work(self.case, self.exact, self.unrounded)
    )

    def features(self, column: str, level: int) -> dict[str, float]:
        """Return a feature by the routes that simulate; arguments as in `RouteTables.feature`."""
        return {name: self.routes[name].feature(column, level) for name in ROUTES}

    def estimates(self, row: Row, **which: str) -> dict[str, float]:
        """Return the estimates of a row by every route.   which : kind or pair, as in `RouteTables.estimate`."""
        column, routes = COLUMN_OF[row.symbol], self.routes.items()
        return {name: route.estimate(column, row.approach, **which) for name, route in routes}


def read_sources(folder: str | Path, published_in: str | Path, case: Case) -> Sources:
    """Read the sources of the claims on a case.   folder : of its results.   published_in : of the printed numbers."""
    features, estimates = (
        read_routes(folder, kind, case.frequencies_hz) for kind in ("features", "estimates")
    )
    exact, as_published = (RouteTables(features[route], estimates[route]) for route in ROUTES)
    first = next(iter(case.frequencies_hz))
    unrounded = read_csv(Path(folder, f"features/as_published/unrounded/{first}.csv"))
    printed = paper_print.read_published(Path(published_in))
    return Sources(printed, case, exact, as_published, unrounded)


def read_out(sources: Sources, row: Row) -> Claim:
    """Judge a cell of Table 1: X, X_s and V_s are rounded, φ is read off a plot, t_s is cut off to whole tenths."""
    level, column, number = int(row.id.line), COLUMN_OF[row.symbol], row.number
    exact = sources.exact.feature(column, level)
    how: dict[str, Any] = {}
    if row.rule == "time":
        how = {"route": "as_published", "half_unit": judging.WRITTEN}
        how["expected"] = _uncut(sources.unread.feature(column, level))
        how["cause"] = causes.slip_time_as_read(exact, sources.case.numerics.step_s, number)
    elif row.rule == "phase":
        how = {"route": "as_published", "half_unit": math.nan}
        how["tolerances"] = judging.phase_read(number, sources.case.omega("omega1"))
        crossing = sources.exact.feature("phi_zero_crossing_rad", level)
        how["cause"] = causes.phase(exact, crossing, number)
    elif row.rule == "velocity":
        sample = sources.unread.feature(SLIPPING_SAMPLE, level)
        how["cause"] = causes.slip_velocity_as_read(
            sample, number, sources.published.column("table1", row.symbol)
        )
    contradiction = sources.refuted.get(row.id, "")
    return Claim(row, sources.features(column, level), contradiction=contradiction, **how)


def _uncut(simulated: float) -> dict[str, float]:
    """Return where the exact route of a time belongs: at the simulated one, of which the print keeps whole tenths."""
    return {} if math.isnan(simulated) else {"exact": simulated}


def printed_integral(sources: Sources, row: Row) -> Claim:
    """Judge a cell of Table 2, upper part: the integrals a, b and W of the five levels."""
    case, level = sources.case, int(row.id.line)
    values = sources.features(COLUMN_OF[row.symbol], level)
    note = causes.starting_sample(case, level) if row.symbol == "a" else ""
    of_pairs = causes.implied_b(sources.published, row.id.line) if row.symbol == "b" else ()
    return Claim(
        row,
        values,
        "as_published",
        allowed=sources.allowed.get(row.id),
        tolerances=judging.simulated(row.number, case),
        cause=f"{causes.backward_euler(case, values)} {note}".strip(),
        contradiction=next(filter(None, (sources.refuted.get(row.id), *of_pairs)), ""),
    )


def direct_pair(sources: Sources, row: Row) -> Claim:
    """Judge a cell of Table 2, lower part: pair-wise direct integration, from more digits than are printed."""
    case, number, allowed = sources.case, row.number, sources.allowed[row.id]
    values = sources.estimates(row, pair=row.id.line)
    damped = causes.backward_euler(case, values) if row.symbol == "c" else ""
    with_b = causes.other_b(sources.published, sources.as_published, sources.allowed, row)
    implied = (causes.implied_b(sources.published, level)[0] for level in levels_of(row.id.line))
    unbalanced = " ".join(filter(None, implied))
    return Claim(
        row,
        values,
        "as_published",
        allowed=allowed,
        tolerances=(*judging.propagated(allowed, number), *judging.simulated(number, case)),
        cause=f"{damped} {with_b}".strip(),
        contradiction=causes.outside(allowed, number, "Table 2")
        or (unbalanced and f"{unbalanced} {with_b}".strip()),
    )


def harmonic_pair(sources: Sources, row: Row) -> Claim:
    """Judge a cell of Table 3: the pair-wise estimates of the three harmonic approaches with common φ and t_s."""
    values = sources.estimates(row, pair=row.id.line)
    corrected = CORRECTED if row.approach == "V_s" else row.approach
    correct = sources.as_published.estimate(COLUMN_OF[row.symbol], corrected, pair=row.id.line)
    slip = causes.sign(values["as_published"], correct, row.unit, sources.misfits)
    return Claim(
        row,
        values,
        "as_published",
        # The read-outs of Table 1 have fewer digits than those behind Table 3; the exact route has no slip of sign.
        shown_only=("from_print",),
        expected={"exact": correct} if slip else {},
        cause=f"{slip} {sources.rules_at_work(row)}".strip(),
        contradiction=causes.outside(sources.allowed.get(row.id), row.number, "Table 3"),
    )


def input_is_configured(sources: Sources, row: Row) -> Claim:
    """Judge an input, amplitudes of Tables 1 and 2 included: the configuration must hold what is printed."""
    case = sources.case
    if row.symbol == "Y":
        value = case.levels_m[int(row.id.line) - 1]
    else:
        value = case.frequencies_hz.get(row.symbol) or getattr(case.oscillator, row.symbol)
    same = math.isclose(value, row.number.value, rel_tol=1e-12)
    other = f"The configuration holds {value:g}, the paper states {row.printed}."
    cause = "The configuration holds this value." if same else other
    return Claim(row, {"exact": value}, holds=same, cause=cause)


def follows_from_others(sources: Sources, row: Row) -> Claim:
    """Judge the stated parameters ζ and ω_n, which follow from the others."""
    osc = sources.case.oscillator
    value = osc.zeta if row.symbol == "zeta" else osc.omega_n / (2.0 * math.pi)
    return Claim(row, {"exact": value})


def printed_least_squares(sources: Sources, row: Row) -> Claim:
    """Judge the least squares of (9) from the printed tables, with the individual φ and t_s: F_k, c and residual."""
    values = sources.estimates(row, kind="least_squares")
    inputs = "Table 2's integrals" if row.approach == "direct" else "Table 1's read-outs"
    moved = causes.printed_inputs(values, inputs, row.number)
    cause = f"{moved} {causes.cut_off(values['from_print'], row.number)}".strip()
    # The residual comes from the rounding of the printed tables; other routes give another size.
    shown_only = ROUTES if row.symbol == RESIDUAL.symbol else ()
    return _from_print(row, values, cause, shown_only=shown_only)


def moment_of_pairs(sources: Sources, row: Row) -> Claim:
    """Judge mean and deviation of the printed pairs of Table 2."""
    mean = row.rule == "mean of pairs"
    pairs = sources.published.column("table2", row.symbol)
    values = sources.estimates(row, kind="mean" if mean else "std")
    values["from_print"] = float(pairs.mean() if mean else pairs.std(ddof=1))
    shown_only = () if mean else ROUTES  # the printed b_1 makes nearly all of the deviation
    return _from_print(
        row, values, "Over the five pairs that Table 2 prints.", shown_only=shown_only
    )


def mean_of_levels(sources: Sources, row: Row) -> Claim:
    """Judge the mean of the φ and of the t_s of the levels, which Table 3 uses."""
    column = COLUMN_OF[row.symbol]
    values = {name: route.mean_feature(column) for name, route in sources.routes.items()}
    how: dict[str, Any] = {}
    if row.symbol == "t_s":
        # The mean of five times in whole tenths has no more digits than print.
        how = {
            "half_unit": judging.WRITTEN,
            "expected": _uncut(sources.unread.mean_feature(column)),
        }
    return _from_print(row, values, "Over the five values that Table 1 prints.", **how)


def _from_print(row: Row, values: Mapping[str, float], cause: str, **how: Any) -> Claim:
    """Judge a number of the text that the paper computes from its own tables.   how : further fields of the claim."""
    contradiction = causes.printed_inputs_differ(values, row.number)
    return Claim(row, values, "from_print", cause=cause, contradiction=contradiction, **how)


ROUTE = "as_published"
"""The route that judges every statement."""

_BOUNDS = {"less than": +1.0, "more than": -1.0}
COMPARISONS: dict[str, dict[str, Callable[[float, float], bool]]] = {
    "change": {"degraded": operator.gt, "improved": operator.lt},
    "truth": {"true": operator.lt, "false": operator.ge},
}
"""Rule → printed word → comparison of an error with its reference by which the word holds."""


def bound_holds(row: Row, value: float) -> tuple[bool, str]:
    """Return whether a bound on the value of ROUTE, less or more than the printed number, holds, and its rule.

    Raises ValueError when the quantity, which says what is bounded, does not end with either.
    """
    word = next((word for word in _BOUNDS if row.quantity.endswith(word)), None)
    if word is None:
        raise ValueError(
            f"{FILE}: {row.id}: the quantity must end with {' or '.join(map(repr, _BOUNDS))}, "
            f"which says how {row.printed} bounds it"
        )
    limit, side = row.number, _BOUNDS[word]
    value, units = side * value / limit.unit, side * limit.value / limit.unit
    tight = value < units <= value + 1.5  # rounded, at most half a unit above it, or one more
    return tight, f'"{word}": the bound is the value rounded as it is printed, or one unit looser'


def word_holds(row: Row, error: float, reference: float) -> tuple[bool, str]:
    """Return whether a word holds for how two errors of ROUTE compare, and the rule that judges it.

    error, reference : off and near resonance, or of direct integration and the best of the other approaches.
    Raises ValueError for a word that the rule of the row does not know.
    """
    words = COMPARISONS[row.rule]
    if row.printed not in words:
        raise ValueError(
            f"{FILE}: {row.id}: cannot judge the word {row.printed!r}; known are {', '.join(words)}"
        )
    what = ": the error against that near resonance" if row.rule == "change" else ""
    return words[row.printed](error, reference), f'"{row.printed}"{what}'


def bound(sources: Sources, row: Row) -> Claim:
    """Judge bounds on the errors of the two-point formulas with common φ and t_s, at ω1 and at other frequencies."""
    if row.symbol in TERMS:
        osc, pairs = sources.case.oscillator, sources.pairs.items()
        values = {name: largest_errors(route.pairs(), osc)[row.symbol] for name, route in pairs}
        cause = f"Largest error in the fifteen pairs: {_each(values)}."
        return _stated(row, values, bound_holds(row, values[ROUTE]), cause)
    values = _worst(sources, sources.routes, frequency=row.symbol)
    cause = _largest_with_sign(sources, row.symbol)
    claim = _stated(row, values, bound_holds(row, values[ROUTE]), cause)
    exact = sources.exact.features.get(row.symbol)
    drawn = [] if exact is None else unprinted.drawn(exact, sources.case, row.number.value)
    if not unprinted.open_to(drawn):
        return claim
    shares = unprinted.exceedances_in_words(drawn, row.printed)
    return replace(claim, undecided=True, cause=f"The print does not decide. {shares} {cause}")


def accuracy_in_words(sources: Sources, row: Row) -> Claim:
    """Judge words for how accurate the two-point formulas are off resonance."""
    hz = sources.case.frequencies_hz
    values = _worst(sources, sources.routes, frequency=row.symbol)
    error, near = values[ROUTE], _worst(sources, sources.routes)[ROUTE]
    cause = (
        f"Largest error of the two-point formulas: {error:.1f} % at {hz[row.symbol]:g} Hz, "
        f"{near:.1f} % at {hz['omega1']:g} Hz."
    )
    return _stated(row, values, word_holds(row, error, near), cause)


def truth(sources: Sources, row: Row) -> Claim:
    """Judge the statement that direct integration is the most accurate approach."""
    direct, *harmonic = (
        _worst(sources, sources.pairs, (approach,)) for approach in ("direct", *HARMONIC)
    )
    best = {route: min(errors[route] for errors in harmonic) for route in direct}
    cause = f"Largest error in the pairs, direct: {_each(direct)}; best harmonic approach: {_each(best)}."
    return _stated(row, direct, word_holds(row, direct[ROUTE], best[ROUTE]), cause)


def _worst(
    sources: Sources,
    routes: Mapping[str, RouteTables],
    approaches: tuple[str, ...] = HARMONIC,
    frequency: str = "omega1",
) -> dict[str, float]:
    """Return, by each route, the larger of the largest errors of F_k and c over the pairs, per cent."""
    osc = sources.case.oscillator
    return {
        name: max(largest_errors(route.pairs(approaches, frequency), osc).values())
        for name, route in routes.items()
    }


def _largest_with_sign(sources: Sources, frequency: str) -> str:
    """Return the largest error of F_k at a frequency by several ways to the features, a sentence."""
    osc = sources.case.oscillator
    exact = sources.exact.features.get(frequency)

    def largest(route: RouteTables) -> str:
        errors = relative_errors(route.pairs(frequency=frequency), osc)["F_k"].dropna()
        return f"{errors.iloc[errors.abs().argmax()]:+.1f} %" if errors.size else ""

    def with_decimals(decimals: int) -> str:
        """Return the error by exact features, X, X_s and V_s with so many decimals; nothing if there are none."""
        if exact is None:
            return ""
        read = ReadOut(X_decimals=decimals, X_s_decimals=decimals, V_s_decimals=decimals)
        pairs = estimate_table(read.apply(Features.from_frame(exact)), osc.k, PAIRS)
        return largest(RouteTables({}, {frequency: pairs}))

    return (
        f"Largest error of F_k by the recipe that gives Table 3: {largest(sources.as_published)}; by exact features "
        f"{largest(sources.exact)}, with six decimals {with_decimals(6)}, with the five of Table 1 {with_decimals(5)}."
    )


def _stated(row: Row, values: Mapping[str, float], judged: tuple[bool, str], cause: str) -> Claim:
    holds, rule = judged
    outcome = "holds" if holds else "does not hold"
    how = f"Judged {ROUTE_NAMES[ROUTE]}, by {rule}. It {outcome}."
    return Claim(row, values, ROUTE, holds=holds, cause=f"{how} {cause}")


def _each(values: Mapping[str, float]) -> str:
    """Return the errors by the routes in words."""
    present = ((route, value) for route, value in values.items() if not math.isnan(value))
    return ", ".join(f"{value:.3f} % {ROUTE_NAMES[route]}" for route, value in present)


class Rule(NamedTuple):
    """A rule by which some of the printed numbers are judged.

    claim : a function from a row to the claim on it.
    symbols, approaches : what such rows may hold.
    kind : of the claims.
    """

    claim: Callable[[Sources, Row], Claim]
    symbols: tuple[str, ...]
    approaches: tuple[str, ...] = ("",)
    kind: ClaimKind = "computed"


_ESTIMATES = tuple(q.symbol for q in paper.IDENTIFIED_QUANTITIES)
_FITTED_NUMBERS = (*_ESTIMATES, RESIDUAL.symbol)
_INPUTS = ("m", "c", "k", "K_z", "F_k", "Y", *FREQUENCIES)
RULES = {
    "input_is_configured": Rule(input_is_configured, _INPUTS, kind="given"),
    "follows_from_others": Rule(follows_from_others, ("zeta", "omega_n")),
    "rounded": Rule(read_out, ("X", "X_s")),
    "velocity": Rule(read_out, ("V_s",)),
    "phase": Rule(read_out, ("phi",)),
    "time": Rule(read_out, ("t_s",)),
    "integral": Rule(printed_integral, tuple(q.symbol for q in paper.TABLE_2)),
    "direct pair": Rule(direct_pair, _ESTIMATES, ("direct",)),
    "harmonic pair": Rule(harmonic_pair, _ESTIMATES, HARMONIC),
    "least squares": Rule(printed_least_squares, _FITTED_NUMBERS, PRINTED_APPROACHES),
    "mean of pairs": Rule(moment_of_pairs, _ESTIMATES, ("direct",)),
    "deviation of pairs": Rule(moment_of_pairs, _ESTIMATES, ("direct",)),
    "mean of levels": Rule(mean_of_levels, ("t_s", "phi")),
    "bound": Rule(bound, (*_ESTIMATES, *FREQUENCIES), kind="statement"),
    "change": Rule(accuracy_in_words, FREQUENCIES, kind="statement"),
    "truth": Rule(truth, ("",), kind="statement"),
}
"""Every rule by its name in the column `rule` of the printed numbers."""

_CELLS = {
    *(claim for q in paper.TABLE_1 for claim in column_ids("table1", q.symbol)),
    *(
        claim
        for q in (*paper.TABLE_2, *paper.IDENTIFIED_QUANTITIES)
        for claim in column_ids("table2", q.symbol)
    ),
    *(claim for table in ("table1", "table2") for claim in column_ids(table, "Y")),
    *(claim for a in HARMONIC for s in _ESTIMATES for claim in column_ids("table3", s, a)),
}
_OF_TEXT = {
    *(statistic(s, a, "least_squares") for a in PRINTED_APPROACHES for s in _FITTED_NUMBERS),
    *(statistic(s, "direct", kind) for s in _ESTIMATES for kind in ("mean", "std")),
    *("t_s_mean", "phi_mean", "max_error_F_k", "max_error_c", "max_error_omega3"),
    *("accuracy_omega2", "accuracy_omega3", "direct_best"),
}


def claims(sources: Sources, rows: Iterable[Row]) -> list[Claim]:
    """Return the claims on some printed numbers."""
    return [RULES[row.rule].claim(sources, row) for row in rows]


def check_printed(printed: Published) -> None:
    """Check the table before anything is judged by it.

    Raises ValueError naming file and row when a row is missing or has no claim, when its kind, symbol or approach does
    not suit its rule, or when what is printed cannot be judged.
    """
    judged = {claim for claim in printed.rows if not claim.startswith("parameter.")}
    if odd := sorted(judged ^ (_CELLS | set(map(of_text, _OF_TEXT)))):
        few = ", ".join(cut(claim, LONGEST) for claim in odd[:8]) + " …" * (len(odd) > 8)
        raise ValueError(
            f"{FILE}: rows and claims do not match: {few}; each printed number needs its row"
        )
    for row in printed.rows.values():
        if problem := _problem(row):
            raise ValueError(f"{FILE}: row {row.id}, column {problem}")
        if row.rule == "bound":
            bound_holds(row, math.nan)
        elif row.rule in COMPARISONS:
            word_holds(row, math.nan, math.nan)


def _problem(row: Row) -> str:
    """Return the column of the first cell that its rule does not know, and why; "" if there is none."""
    allowed: dict[str, Iterable[str]] = {"rule": RULES}
    if rule := RULES.get(row.rule):
        allowed = {"kind": (rule.kind,), "symbol": rule.symbols, "approach": rule.approaches}
    for column, words in allowed.items():
        if (text := getattr(row, column)) not in words:
            listed = ", ".join(word or "none" for word in words)
            return f"{column}: {cut(text, LONGEST)!r} is not known to its rule; known are {listed}"
    if row.rule not in COMPARISONS and not row.number.is_number:
        return f"printed: {cut(row.printed, LONGEST)!r} is not a number such as 90.0402 or 2.9E-3"
    return ""
