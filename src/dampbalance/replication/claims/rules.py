"""The rules by which printed numbers are judged, in one table: by which route, how closely, and why they may differ.

A printed number is judged as a row: what is printed, joined with what the routes give for the same key.

Statements (bounds and words) are judged by the as-published route, as they refer to what the authors computed. "Less
than 1.5 %" holds if the value is smaller and the bound is the value rounded to the printed digits, or one unit looser;
a looser bound would say nothing about the value. Where the paper prints no read-outs at a frequency, a bound is
undecided if some read-outs that the authors may have used keep it and others do not (`unprinted.py`). A word holds if
the comparison that it names does.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any

from ...estimates import estimate_table
from ...project.case import Case
from ...project.files import ROUTES
from ...project.wording import cut
from ..numbers import (
    COEFFICIENTS,
    HARMONIC,
    HARMONIC_APPROACHES,
    PARAMETERS,
    PRINTED_APPROACHES,
    TABLE_2,
    Key,
    key_of,
)
from ..read_out import ReadOut
from . import causes, judging, unprinted
from .causes import Joined, Sources
from .judging import HALF, WRITTEN, Claim, Tolerance
from .printed import FILE, FREQUENCIES, LEVELS, LONGEST, PAIR_LABELS, PAIRS, Published, Row
from .verdicts import ROUTE_NAMES, ClaimKind


def require_paper(case: Case) -> None:
    """Raise ValueError when the case lacks a frequency or a level of the paper."""
    if missing := ", ".join(name for name in FREQUENCIES if name not in case.frequencies_hz):
        raise ValueError(
            f"claims need the frequencies {', '.join(FREQUENCIES)}; missing: {missing}"
        )
    if len(case.levels_m) != LEVELS:
        raise ValueError(f"claims need the five levels of the paper, got {len(case.levels_m)}")


ROUTE = "as_published"
"""The route that judges statements, and the numbers that were obtained by it."""

Sentence = Callable[[Joined], str]
"""Why a number differs; "" where this is not the reason."""

Holding = tuple[bool, bool, str]
"""Whether an input or a statement holds, whether the print leaves that open, and why."""

_LINES = {"level": tuple(map(str, range(1, LEVELS + 1))), "pair": PAIR_LABELS}
"""Kind of number → the lines of its table."""


@dataclass(frozen=True)
class Rule:
    """A rule by which some of the printed numbers are judged.

    kind, quantities, approaches, frequencies : what it judges, as in `Key`.   claim : the kind of these claims.
    route, half_unit, shown_only : as in `Claim`.   ranged : whether the paper's other numbers leave a range for it.
    tolerances, expected : of a number, as in `Claim`.
    holds : of an input or a statement: whether it holds, whether the print leaves that open, and why.
    """

    kind: str
    quantities: Iterable[str]
    approaches: Iterable[str] = ("",)
    frequencies: Iterable[str] = ("omega1",)
    claim: ClaimKind = "computed"
    route: str = "exact"
    half_unit: float = HALF
    shown_only: tuple[str, ...] = ()
    ranged: bool = False
    tolerances: Callable[[Joined], tuple[Tolerance, ...]] = lambda joined: ()
    expected: Callable[[Joined], Mapping[str, float]] = lambda joined: {}
    holds: Callable[[Joined], Holding] | None = None

    @cached_property
    def keys(self) -> list[Key]:
        """The numbers that it judges."""
        lines = _LINES.get(self.kind, ("all",))
        ways = product(self.frequencies, self.quantities, self.approaches, lines)
        return [key_of(name, of, approach, self.kind, line) for name, of, approach, line in ways]


def claims(sources: Sources, rows: Iterable[Row]) -> list[Claim]:
    """Return the claims on some printed numbers."""
    return [_claim(RULES[row.rule], Joined(sources, row)) for row in rows]


def _claim(rule: Rule, joined: Joined) -> Claim:
    holds, undecided, how = rule.holds(joined) if rule.holds else (None, False, "")
    routes = ("exact",) if rule.claim == "given" else ROUTE_NAMES
    return Claim(
        joined.row,
        {route: joined.values[route] for route in routes},
        rule.route,
        holds,
        undecided,
        rule.half_unit,
        joined.allowed if rule.ranged else None,
        rule.tolerances(joined),
        rule.shown_only,
        rule.expected(joined),
        cause=" ".join(filter(None, (how, *_said(CAUSES, joined)))),
        contradiction=next(filter(None, _said(CONTRADICTIONS, joined)), ""),
    )


def _said(table: Mapping[Sentence, tuple[str, ...]], joined: Joined) -> Iterator[str]:
    """Yield the sentences of a table on a number."""
    return (sentence(joined) for sentence, rules in table.items() if joined.row.rule in rules)


# ---- Inputs ---------------------------------------------------------------------------------------------------------


def _configured(joined: Joined) -> Holding:
    value, printed = joined.values["exact"], joined.number
    if math.isclose(value, printed.value, rel_tol=1e-12):
        return True, False, "The configuration holds this value."
    return False, False, f"The configuration holds {value:g}, the paper states {printed.text}."


# ---- Tables ---------------------------------------------------------------------------------------------------------


def _uncut(joined: Joined) -> dict[str, float]:
    """Return the time that the exact route should give: the simulated one, of which the print keeps whole tenths."""
    simulated = joined.values["unrounded"]
    return {} if math.isnan(simulated) else {"exact": simulated}


def _as_read(joined: Joined) -> tuple[Tolerance, ...]:
    return judging.phase_read(joined.number, joined.case.omega("omega1"))


def _propagated(joined: Joined) -> tuple[Tolerance, ...]:
    return (*judging.propagated(joined.allowed, joined.number), *_simulated(joined))


def _simulated(joined: Joined) -> tuple[Tolerance, ...]:
    return judging.simulated(joined.number, joined.case)


def _unslipped(joined: Joined) -> dict[str, float]:
    return {"exact": causes.corrected(joined)} if causes.sign(joined) else {}


def _over_levels(joined: Joined) -> str:
    return "Over the five values that Table 1 prints."


def _over_pairs(joined: Joined) -> str:
    return "Over the five pairs that Table 2 prints."


# ---- Statements -----------------------------------------------------------------------------------------------------

_BOUNDS = {"less than": +1.0, "more than": -1.0}
COMPARISONS: dict[str, dict[str, Callable[[float, float], bool]]] = {
    "change": {"degraded": operator.gt, "improved": operator.lt},
    "truth": {"true": operator.lt, "false": operator.ge},
}
"""Rule → printed word → comparison of an error with its reference by which the word holds."""


def bound_holds(row: Row, value: float) -> tuple[bool, str]:
    """Return whether a bound on the value of ROUTE, less or more than the printed number, holds, and its rule.

    Raises ValueError when the words, which say what is bounded, do not end with either.
    """
    word = next((word for word in _BOUNDS if row.words.endswith(word)), None)
    if word is None:
        raise ValueError(
            f"{FILE}: {row.id}: the words must end with {' or '.join(map(repr, _BOUNDS))}, "
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


def _stated(holds: bool, rule: str) -> Holding:
    outcome = "holds" if holds else "does not hold"
    return holds, False, f"Judged {ROUTE_NAMES[ROUTE]}, by {rule}. It {outcome}."


def _bound(joined: Joined) -> Holding:
    return _stated(*bound_holds(joined.row, joined.values[ROUTE]))


def _degraded(joined: Joined) -> Holding:
    near = joined.of(frequency="omega1")[ROUTE]
    return _stated(*word_holds(joined.row, joined.values[ROUTE], near))


def _most_accurate(joined: Joined) -> Holding:
    return _stated(*word_holds(joined.row, joined.values[ROUTE], _best_harmonic(joined)[ROUTE]))


def _best_harmonic(joined: Joined) -> dict[str, float]:
    """Return the largest error by the best of the harmonic approaches, for each route."""
    errors = [joined.of(approach=name, sharing="common") for name in HARMONIC_APPROACHES]
    return {route: min(of[route] for of in errors) for route in ROUTE_NAMES}


def _each(values: Mapping[str, float]) -> str:
    """Return the errors by the routes in words."""
    present = ((route, value) for route, value in values.items() if not math.isnan(value))
    return ", ".join(f"{value:.3f} % {ROUTE_NAMES[route]}" for route, value in present)


def _of_fifteen(joined: Joined) -> str:
    return f"Largest error in the fifteen pairs: {_each(joined.values)}."


def _off_resonance(joined: Joined) -> str:
    hz, near = joined.case.frequencies_hz, joined.of(frequency="omega1")[ROUTE]
    return (
        f"Largest error of the two-point formulas: {joined.values[ROUTE]:.1f} % at {hz[joined.key.frequency]:g} Hz, "
        f"{near:.1f} % at {hz['omega1']:g} Hz."
    )


def _direct_and_best(joined: Joined) -> str:
    best = _each(_best_harmonic(joined))
    return f"Largest error in the pairs, direct: {_each(joined.values)}; best harmonic approach: {best}."


def _bound_without_read_outs(joined: Joined) -> Holding:
    """Judge a bound; where unprinted read-outs leave it open, state in how many draws of them it is exceeded."""
    sources, row = joined.sources, joined.row
    exact = sources.features("exact", row.key.frequency)
    drawn = unprinted.drawn(exact, sources.case, row.number.value)
    if not unprinted.open_to(drawn):
        return _bound(joined)
    shares = unprinted.exceedances_in_words(drawn, row.printed)
    return _bound(joined)[0], True, f"The print does not decide. {shares}"


def _largest_with_sign(joined: Joined) -> str:
    """Return the largest error of F_k at a frequency by several ways to the features, a sentence."""
    sources, frequency = joined.sources, joined.key.frequency
    osc, exact = sources.case.oscillator, sources.features("exact", frequency)

    def largest(F_k: Iterable[float]) -> str:
        errors = [100.0 * (value / osc.F_k - 1.0) for value in F_k if not math.isnan(value)]
        return f"{max(errors, key=abs):+.1f} %" if errors else ""

    def by_route(route: str) -> str:
        pairs = (
            joined.of(quantity="F_k", approach=name, kind="pair", line=label, unit="N")
            for name, label in product(HARMONIC_APPROACHES, PAIR_LABELS)
        )
        return largest(of[route] for of in pairs)

    def with_decimals(decimals: int) -> str:
        """Return the error by exact features, with X, X_s and V_s rounded to these decimals."""
        read = ReadOut(X_decimals=decimals, X_s_decimals=decimals, V_s_decimals=decimals)
        table = estimate_table(read.apply(exact), osc.k, PAIRS, approaches=HARMONIC_APPROACHES)
        pairs = table[(table["kind"] == "pair") & (table["phase"] == "common")]
        return largest(pairs["F_k_N"])

    return (
        f"Largest error of F_k by the recipe that gives Table 3: {by_route('as_published')}; by exact features "
        f"{by_route('exact')}, with six decimals {with_decimals(6)}, with the five of Table 1 {with_decimals(5)}."
    )


# ---- The table ------------------------------------------------------------------------------------------------------

_GIVEN: dict[str, Any] = {"claim": "given", "holds": _configured}
_RUN: dict[str, Any] = {"route": ROUTE}
_PRINT: dict[str, Any] = {"route": "from_print"}
_STATEMENT: dict[str, Any] = {"route": ROUTE, "claim": "statement"}

RULES = {
    "parameter": Rule("parameter", PARAMETERS, frequencies=("",), **_GIVEN),
    "drive": Rule("parameter", ("omega",), frequencies=FREQUENCIES, **_GIVEN),
    "amplitude": Rule("level", ("Y",), **_GIVEN),
    "follows_from_others": Rule("parameter", ("zeta", "omega_n"), frequencies=("",)),
    # Table 1: X, X_s and V_s are rounded, φ is read off a plot, t_s is cut off to whole tenths
    "rounded": Rule("level", ("X", "X_s")),
    "velocity": Rule("level", ("V_s",)),
    "phase": Rule("level", ("phi",), half_unit=math.nan, tolerances=_as_read, **_RUN),
    "time": Rule("level", ("t_s",), half_unit=WRITTEN, expected=_uncut, **_RUN),
    # Table 2: the integrals of the levels; pairs by direct integration, from more digits than are printed
    "integral": Rule("level", TABLE_2, ranged=True, tolerances=_simulated, **_RUN),
    "direct pair": Rule(
        "pair", COEFFICIENTS, ("direct",), ranged=True, tolerances=_propagated, **_RUN
    ),
    # Table 3, common φ and t_s: the read-outs of Table 1 have fewer digits than those behind it; the exact route has no
    # slip of sign
    "harmonic pair": Rule(
        "pair",
        COEFFICIENTS,
        HARMONIC_APPROACHES,
        shown_only=("from_print",),
        expected=_unslipped,
        **_RUN,
    ),
    # The text, from the printed tables: least squares of (9) with individual φ and t_s; moments of what is printed.
    # The residual is made of the rounding of the tables, and the printed b_1 makes nearly all of a deviation: other
    # routes give another size. A mean of five times in whole tenths has no more digits than print.
    "least squares": Rule("least_squares", COEFFICIENTS, PRINTED_APPROACHES, **_PRINT),
    "residual": Rule(
        "least_squares", ("residual",), PRINTED_APPROACHES, shown_only=ROUTES, **_PRINT
    ),
    "mean of pairs": Rule("mean", COEFFICIENTS, ("direct",), **_PRINT),
    "deviation of pairs": Rule("std", COEFFICIENTS, ("direct",), shown_only=ROUTES, **_PRINT),
    "mean of levels": Rule("mean", ("phi",), **_PRINT),
    "mean of times": Rule("mean", ("t_s",), half_unit=WRITTEN, expected=_uncut, **_PRINT),
    "bound": Rule("largest", COEFFICIENTS, (HARMONIC,), holds=_bound, **_STATEMENT),
    "bound without read-outs": Rule(
        "largest", ("any",), (HARMONIC,), ("omega3",), holds=_bound_without_read_outs, **_STATEMENT
    ),
    "change": Rule(
        "largest", ("any",), (HARMONIC,), ("omega2", "omega3"), holds=_degraded, **_STATEMENT
    ),
    "truth": Rule("largest", ("any",), ("direct",), holds=_most_accurate, **_STATEMENT),
}
"""Every rule by its name in the column `rule` of the printed numbers."""

_ARITHMETIC = tuple(name for name, rule in RULES.items() if rule.route == "from_print")
CAUSES: dict[Sentence, tuple[str, ...]] = {
    causes.slip_velocity_as_read: ("velocity",),
    causes.phase: ("phase",),
    causes.slip_time_as_read: ("time",),
    causes.backward_euler: ("integral", "direct pair"),
    causes.starting_sample: ("integral",),
    causes.other_b: ("direct pair",),
    causes.sign: ("harmonic pair",),
    causes.rules_at_work: ("harmonic pair",),
    causes.printed_inputs: ("least squares", "residual"),
    causes.cut_off: ("least squares", "residual"),
    _over_pairs: ("mean of pairs", "deviation of pairs"),
    _over_levels: ("mean of levels", "mean of times"),
    _of_fifteen: ("bound",),
    _largest_with_sign: ("bound without read-outs",),
    _off_resonance: ("change",),
    _direct_and_best: ("truth",),
}
"""What moves a number → the rules of the numbers that it may move. All that apply are given."""

CONTRADICTIONS: dict[Sentence, tuple[str, ...]] = {
    causes.refuted: ("rounded", "velocity", "phase", "time", "integral"),
    causes.outside: ("direct pair", "harmonic pair"),
    causes.unbalanced: ("direct pair",),
    causes.printed_inputs_differ: _ARITHMETIC,
}
"""What refutes a number → the rules of the numbers that it may refute. The first counts."""


def check_printed(printed: Published) -> None:
    """Check the table of printed numbers before any of them is judged.

    Raises ValueError naming file and row when a row is missing, when a cell does not fit the rule of its row, or when
    what is printed cannot be judged.
    """
    for row in printed.rows.values():
        if problem := _problem(row):
            raise ValueError(f"{FILE}: row {row.id}, column {problem}")
        if row.rule.startswith("bound"):
            bound_holds(row, math.nan)
        elif row.rule in COMPARISONS:
            word_holds(row, math.nan, math.nan)
    rows = {(row.rule, row.key) for row in printed.rows.values()}
    wanted = ((name, key) for name, rule in RULES.items() for key in rule.keys)
    if missing := [" ".join(filter(None, of[1])) for of in wanted if of not in rows]:
        few = ", ".join(missing[:8]) + " …" * (len(missing) > 8)
        raise ValueError(f"{FILE}: no row for {few}; each printed number needs its row")


def _problem(row: Row) -> str:
    """Return the column of the first cell that its rule does not know, and what is wrong; "" if there is none."""
    allowed: dict[str, Iterable[str]] = {"rule": RULES}
    if rule := RULES.get(row.rule):
        allowed = {"claim": (rule.claim,)}
        # the keys that agree with the row in all columns before
        near = rule.keys
        for column in Key._fields:
            allowed[column] = dict.fromkeys(getattr(key, column) for key in near)
            near = [key for key in near if getattr(key, column) == getattr(row.key, column)]
    for column, words in allowed.items():
        if (text := getattr(row.key if column in Key._fields else row, column)) not in words:
            listed = ", ".join(word or "none" for word in words)
            return f"{column}: {cut(text, LONGEST)!r} is not known to its rule; known are {listed}"
    if row.rule not in COMPARISONS and not row.number.is_number:
        return f"printed: {cut(row.printed, LONGEST)!r} is not a number such as 90.0402 or 2.9E-3"
    return ""
