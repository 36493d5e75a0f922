"""The rules by which printed numbers are judged, in one table: which route, how near, and why they may differ.

A printed number is judged as a row: what is printed, joined with what the routes give for the same key.

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
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any

from ...balance import TERMS, takes_phase
from ...estimates import estimate_table
from ...project.case import Case
from ...project.files import ROUTES
from ...project.wording import cut
from ..numbers import HARMONIC, HARMONIC_APPROACHES, PARAMETERS, PRINTED_APPROACHES, UNITS, Key
from ..read_out import ReadOut
from . import causes, judging, unprinted
from .causes import Joined, Sources
from .judging import HALF, WRITTEN, Claim, Tolerance
from .print import FILE, FREQUENCIES, LEVELS, LONGEST, PAIR_LABELS, PAIRS, Published, Row
from .verdicts import ROUTE_NAMES, ClaimKind


def require_paper(case: Case) -> None:
    """Raise ValueError when the case lacks a frequency or a level of the paper."""
    if missing := ", ".join(name for name in FREQUENCIES if name not in case.frequencies_hz):
        raise ValueError(
            f"claims need the frequencies {', '.join(FREQUENCIES)}; missing: {missing}"
        )
    if len(case.levels_m) != LEVELS:
        raise ValueError(f"claims need the five levels of the paper, got {len(case.levels_m)}")


Sentence = Callable[[Joined], str]
"""Why a number differs: "" where it does not explain that."""


_LINES = {"level": tuple(map(str, range(1, LEVELS + 1))), "pair": PAIR_LABELS}
_SHARING = {"least_squares": "individual", "pair": "common", "largest": "common"}
"""By kind, the lines of a table, and how the paper takes φ and t_s where an approach needs them."""


@dataclass(frozen=True)
class Rule:
    """A rule by which some of the printed numbers are judged.

    kind, quantities, approaches, frequencies : what it judges, as in `Key`.   claim : the kind of these claims.
    route, half_unit, shown_only : as in `Claim`.   ranged : whether the paper's other numbers leave a range for it.
    tolerances, expected : of a number, as in `Claim`.   holds : of an input or a statement, and by which rule.
    undecided : whether the print does not decide on a statement, and why.
    causes : sentences on what moves it; all that apply are given.   contradictions : what refutes it; the first counts.
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
    holds: Callable[[Joined], tuple[bool, str]] | None = None
    undecided: Sentence = lambda joined: ""
    causes: tuple[Sentence, ...] = ()
    contradictions: tuple[Sentence, ...] = ()

    @cached_property
    def keys(self) -> list[Key]:
        """The numbers that it judges."""
        ways = product(self.frequencies, self.quantities, self.approaches)
        return [
            Key(
                frequency,
                quantity,
                approach,
                self.kind,
                sharing=_SHARING.get(self.kind, "") if approach and takes_phase(approach) else "",
                line=line,
                unit="%" if self.kind == "largest" else UNITS[quantity],
            )
            for frequency, quantity, approach in ways
            for line in _LINES.get(self.kind, ("all",))
        ]


def claims(sources: Sources, rows: Iterable[Row]) -> list[Claim]:
    """Return the claims on some printed numbers."""
    return [_claim(RULES[row.rule], Joined(sources, row)) for row in rows]


def _claim(rule: Rule, joined: Joined) -> Claim:
    said = [sentence(joined) for sentence in rule.causes]
    judged: dict[str, Any] = {}
    if rule.holds:
        holds, how = rule.holds(joined)
        undecided = rule.undecided(joined)
        said = [undecided or how, *said]
        judged = {"holds": holds, "undecided": bool(undecided)}
    routes = ("exact",) if rule.claim == "given" else ROUTE_NAMES
    return Claim(
        joined.row,
        {route: joined.values[route] for route in routes},
        rule.route,
        half_unit=rule.half_unit,
        allowed=joined.allowed if rule.ranged else None,
        tolerances=rule.tolerances(joined),
        shown_only=rule.shown_only,
        expected=rule.expected(joined),
        cause=" ".join(filter(None, said)),
        contradiction=next(filter(None, (say(joined) for say in rule.contradictions)), ""),
        **judged,
    )


# ---- Inputs ---------------------------------------------------------------------------------------------------------


def _configured(joined: Joined) -> tuple[bool, str]:
    value, printed = joined.values["exact"], joined.number
    if math.isclose(value, printed.value, rel_tol=1e-12):
        return True, "The configuration holds this value."
    return False, f"The configuration holds {value:g}, the paper states {printed.text}."


# ---- Tables ---------------------------------------------------------------------------------------------------------


def _uncut(joined: Joined) -> dict[str, float]:
    """Return where the exact route of a time belongs: at the simulated one, of which the print keeps whole tenths."""
    simulated = joined.values["unrounded"]
    return {} if math.isnan(simulated) else {"exact": simulated}


def _simulated(joined: Joined) -> tuple[Tolerance, ...]:
    return judging.simulated(joined.number, joined.case)


def _without_slip(joined: Joined) -> dict[str, float]:
    return {"exact": causes.corrected(joined)} if causes.sign(joined) else {}


def _over(what: str) -> Sentence:
    return lambda joined: f"Over the five {what}."


# ---- Statements -----------------------------------------------------------------------------------------------------

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


def _stated(holds: bool, rule: str) -> tuple[bool, str]:
    outcome = "holds" if holds else "does not hold"
    return holds, f"Judged {ROUTE_NAMES[ROUTE]}, by {rule}. It {outcome}."


def _bound(joined: Joined) -> tuple[bool, str]:
    return _stated(*bound_holds(joined.row, joined.values[ROUTE]))


def _degraded(joined: Joined) -> tuple[bool, str]:
    near = joined.of(frequency="omega1")[ROUTE]
    return _stated(*word_holds(joined.row, joined.values[ROUTE], near))


def _most_accurate(joined: Joined) -> tuple[bool, str]:
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
        f"Largest error of the two-point formulas: {joined.values[ROUTE]:.1f} % at {hz[joined.row.frequency]:g} Hz, "
        f"{near:.1f} % at {hz['omega1']:g} Hz."
    )


def _direct_and_best(joined: Joined) -> str:
    best = _each(_best_harmonic(joined))
    return f"Largest error in the pairs, direct: {_each(joined.values)}; best harmonic approach: {best}."


def _open_to_read_outs(joined: Joined) -> str:
    """State in how many draws of unprinted read-outs a bound is exceeded, where they leave it open."""
    sources, row = joined.sources, joined.row
    exact = sources.features("exact", row.frequency)
    drawn = unprinted.drawn(exact, sources.case, row.number.value)
    shares = unprinted.exceedances_in_words(drawn, row.printed)
    return f"The print does not decide. {shares}" if unprinted.open_to(drawn) else ""


def _largest_with_sign(joined: Joined) -> str:
    """Return the largest error of F_k at a frequency by several ways to the features, a sentence."""
    sources, frequency = joined.sources, joined.row.frequency
    osc, exact = sources.case.oscillator, sources.features("exact", frequency)

    def largest(F_k: Iterable[float]) -> str:
        errors = [100.0 * (value / osc.F_k - 1.0) for value in F_k if not math.isnan(value)]
        return f"{max(errors, key=abs):+.1f} %" if errors else ""

    def by_route(route: str) -> str:
        pairs = Key(frequency, "F_k", "", "pair", "", "common", "", "N")
        keys = (
            pairs._replace(approach=name, line=line)
            for name in HARMONIC_APPROACHES
            for line in PAIR_LABELS
        )
        return largest(sources.numbers.get(key, {}).get(route, math.nan) for key in keys)

    def with_decimals(decimals: int) -> str:
        """Return the error by exact features, X, X_s and V_s with so many decimals."""
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
_TABLE_2: dict[str, Any] = {"route": "as_published", "ranged": True}
_PRINT: dict[str, Any] = {"route": "from_print", "contradictions": (causes.printed_inputs_differ,)}
_STATEMENT: dict[str, Any] = {"route": ROUTE, "claim": "statement"}
_OF_LEVELS = (_over("values that Table 1 prints"),)
_OF_PAIRS = (_over("pairs that Table 2 prints"),)

RULES = {
    "parameter": Rule("parameter", PARAMETERS, frequencies=("",), **_GIVEN),
    "drive": Rule("parameter", ("omega",), frequencies=FREQUENCIES, **_GIVEN),
    "amplitude": Rule("level", ("Y",), **_GIVEN),
    "follows_from_others": Rule("parameter", ("zeta", "omega_n"), frequencies=("",)),
    # Table 1: X, X_s and V_s are rounded, φ is read off a plot, t_s is cut off to whole tenths
    "rounded": Rule("level", ("X", "X_s"), contradictions=(causes.refuted,)),
    "velocity": Rule(
        "level", ("V_s",), causes=(causes.slip_velocity_as_read,), contradictions=(causes.refuted,)
    ),
    "phase": Rule(
        "level",
        ("phi",),
        route="as_published",
        half_unit=math.nan,
        tolerances=lambda j: judging.phase_read(j.number, j.case.omega("omega1")),
        causes=(causes.phase,),
        contradictions=(causes.refuted,),
    ),
    "time": Rule(
        "level",
        ("t_s",),
        route="as_published",
        half_unit=WRITTEN,
        expected=_uncut,
        causes=(causes.slip_time_as_read,),
        contradictions=(causes.refuted,),
    ),
    # Table 2: the integrals of the levels; pairs by direct integration, from more digits than are printed
    "travel": Rule(
        "level",
        ("a",),
        tolerances=_simulated,
        causes=(causes.backward_euler, causes.starting_sample),
        contradictions=(causes.refuted,),
        **_TABLE_2,
    ),
    "integral": Rule(
        "level",
        ("b", "W"),
        tolerances=_simulated,
        causes=(causes.backward_euler,),
        contradictions=(causes.refuted,),
        **_TABLE_2,
    ),
    "direct pair": Rule(
        "pair",
        TERMS,
        ("direct",),
        tolerances=lambda j: (*judging.propagated(j.allowed, j.number), *_simulated(j)),
        causes=(causes.backward_euler, causes.other_b),
        contradictions=(causes.outside, causes.unbalanced),
        **_TABLE_2,
    ),
    # Table 3, common φ and t_s: the read-outs of Table 1 have fewer digits than those behind it; the exact route has no
    # slip of sign
    "harmonic pair": Rule(
        "pair",
        TERMS,
        HARMONIC_APPROACHES,
        route="as_published",
        shown_only=("from_print",),
        expected=_without_slip,
        causes=(causes.sign, lambda j: j.sources.rules_at_work(j.row)),
        contradictions=(causes.outside,),
    ),
    # The text, from the printed tables: least squares of (9) with individual φ and t_s; moments of what is printed
    "least squares": Rule(
        "least_squares",
        TERMS,
        PRINTED_APPROACHES,
        causes=(causes.printed_inputs, causes.cut_off),
        **_PRINT,
    ),
    "residual": Rule(  # made of the rounding of the printed tables; other routes give another size
        "least_squares",
        ("residual",),
        PRINTED_APPROACHES,
        shown_only=ROUTES,
        causes=(causes.printed_inputs, causes.cut_off),
        **_PRINT,
    ),
    "mean of pairs": Rule("mean", TERMS, ("direct",), causes=_OF_PAIRS, **_PRINT),
    "deviation of pairs": Rule(  # the printed b_1 makes nearly all of it
        "std", TERMS, ("direct",), shown_only=ROUTES, causes=_OF_PAIRS, **_PRINT
    ),
    "mean of levels": Rule("mean", ("phi",), causes=_OF_LEVELS, **_PRINT),
    "mean of times": Rule(  # of five times in whole tenths: it has no more digits than print
        "mean", ("t_s",), half_unit=WRITTEN, expected=_uncut, causes=_OF_LEVELS, **_PRINT
    ),
    "bound": Rule("largest", TERMS, (HARMONIC,), holds=_bound, causes=(_of_fifteen,), **_STATEMENT),
    "bound without read-outs": Rule(
        "largest",
        ("any",),
        (HARMONIC,),
        ("omega3",),
        holds=_bound,
        undecided=_open_to_read_outs,
        causes=(_largest_with_sign,),
        **_STATEMENT,
    ),
    "change": Rule(
        "largest",
        ("any",),
        (HARMONIC,),
        ("omega2", "omega3"),
        holds=_degraded,
        causes=(_off_resonance,),
        **_STATEMENT,
    ),
    "truth": Rule(
        "largest",
        ("any",),
        ("direct",),
        holds=_most_accurate,
        causes=(_direct_and_best,),
        **_STATEMENT,
    ),
}
"""Every rule by its name in the column `rule` of the printed numbers."""


def check_printed(printed: Published) -> None:
    """Check the table before anything is judged by it.

    Raises ValueError naming file and row when a row is missing, when what it says of a number does not suit its rule,
    or when what is printed cannot be judged.
    """
    for row in printed.rows.values():
        if problem := _problem(row):
            raise ValueError(f"{FILE}: row {row.id}, column {problem}")
        if RULES[row.rule].holds is _bound:
            bound_holds(row, math.nan)
        elif row.rule in COMPARISONS:
            word_holds(row, math.nan, math.nan)
    rows = {(row.rule, row.key) for row in printed.rows.values()}
    wanted = ((name, key) for name, rule in RULES.items() for key in rule.keys)
    if missing := [" ".join(filter(None, of[1])) for of in wanted if of not in rows]:
        few = ", ".join(missing[:8]) + " …" * (len(missing) > 8)
        raise ValueError(f"{FILE}: no row for {few}; each printed number needs its row")


def _problem(row: Row) -> str:
    """Return the column of the first cell that its rule does not know, and why; "" if there is none."""
    allowed: dict[str, Iterable[str]] = {"rule": RULES}
    if rule := RULES.get(row.rule):
        allowed = {"claim": (rule.claim,)}
        # the keys that agree with the row in all columns before
        near = rule.keys
        for column in Key._fields:
            allowed[column] = dict.fromkeys(getattr(key, column) for key in near)
            near = [key for key in near if getattr(key, column) == getattr(row, column)]
    for column, words in allowed.items():
        if (text := getattr(row, column)) not in words:
            listed = ", ".join(word or "none" for word in words)
            return f"{column}: {cut(text, LONGEST)!r} is not known to its rule; known are {listed}"
    if row.rule not in COMPARISONS and not row.number.is_number:
        return f"printed: {cut(row.printed, LONGEST)!r} is not a number such as 90.0402 or 2.9E-3"
    return ""
