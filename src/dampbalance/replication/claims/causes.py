"""Sentences that explain why a computed number differs from the printed one: one function for each cause.

Each computes its sentence from the row of the number, or returns "" where the numbers of the run do not support it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ...balance import Rows
from ...features import Features
from ...project.case import Case
from ...solver import least_squares, levels_of
from ..authors_route import CORRECTED, effective_damping, estimates
from ..numbers import COEFFICIENTS, TABLE_2, Key, Numbers, features_of, of_estimates
from ..read_out import ReadOut
from . import cross_checks
from .judging import TIME_UNIT_S, VELOCITY_MARK, NumberRange, range_text
from .printed import PAIR_LABELS, PAIRS, Printed, Published, Row
from .verdicts import ROUTE_NAMES


@dataclass(frozen=True)
class Sources:
    """What claims are judged from, with results that many of them share.

    published : the printed numbers.   case : as configured.   numbers : of all routes.

    refuted, table_2, table_3, misfits : by `cross_checks`.
    rules_at_work : function that names what moves a number of Table 3.
    """

    published: Published
    case: Case
    numbers: Numbers

    refuted = cached_property(lambda self: cross_checks.refuted(self.published, self.case))
    table_2 = cached_property(lambda self: cross_checks.table_2(self.published))
    table_3 = cached_property(lambda self: cross_checks.table_3(self.published, self.case))
    misfits = cached_property(lambda self: cross_checks.misfits(self.published, self.case))
    as_published = cached_property(lambda self: self.features("as_published"))
    rules_at_work = cached_property(
        lambda self: _rules_at_work(self.case, self.features("exact"), self.features("unrounded"))
    )

    def features(self, route: str, frequency: str = "omega1") -> Features:
        """Return the features of all levels by a route."""
        return features_of(self.numbers, route, frequency, self.case.omega(frequency))

    def allowed(self, claim: str) -> NumberRange | None:
        """Return the range that the other numbers of its table leave for one, if they leave one.

        None where all of Table 3 agrees, which has nothing to refute then, and for a number that has no range.
        """
        if claim in self.table_2.ranged:
            return self.table_2.range(claim)
        refutes = claim in self.table_3.ranged and self.table_3.misfit > 0.5
        return self.table_3.range(claim) if refutes else None


@dataclass(frozen=True)
class Joined:
    """A printed number joined with what the routes give for it."""

    sources: Sources
    row: Row

    @cached_property
    def values(self) -> dict[str, float]:
        """What each route gives."""
        return self.of()

    def of(self, **other: str) -> dict[str, float]:
        """Return what each route gives for the same number, except for these fields of its key."""
        numbers = self.sources.numbers.get(self.key._replace(**other), {})
        return {route: numbers.get(route, math.nan) for route in (*ROUTE_NAMES, "unrounded")}

    @property
    def case(self) -> Case:
        """The case as configured."""
        return self.sources.case

    @property
    def key(self) -> Key:
        """What the number is."""
        return self.row.key

    @property
    def number(self) -> Printed:
        """The number as it is printed."""
        return self.row.number

    @property
    def level(self) -> int:
        """The level of a feature, counted from 1."""
        return int(self.key.line)

    @cached_property
    def allowed(self) -> NumberRange | None:
        """The range that the paper's other numbers leave, if they leave one."""
        return self.sources.allowed(self.row.id)


def backward_euler(joined: Joined) -> str:
    """State the numerical dissipation: c acts as c + mω²h, and every integral shrinks by about as much.

    It does not affect F_k.
    """
    case, exact, simulated = joined.case, joined.values["exact"], joined.values["as_published"]
    applies = case.numerics.scheme == "backward-euler" and joined.key.quantity != "F_k"
    if not applies or math.isnan(simulated) or not exact:
        return ""
    effective = effective_damping(case, case.omega("omega1"))
    return (
        f"Backward Euler, {1e6 * case.numerics.step_s:g} µs: c acts as c + mω²h = {effective:.4f}; "
        f"as published deviates from exact by a relative {simulated / exact - 1.0:+.1e}."
    )


def implied_b(published: Published, level: int) -> tuple[str, str]:
    """Compare a printed b with b = (W − a F_k)/c of the printed pairs: two contradictions, "" where there is none.

    The first refutes b and the pairs with this level alike: these pairs were computed with this b, but the F_k and c of
    all other pairs balance the level with another b only. The second refutes b alone: the pairs were computed with
    another b. The rounding of a, W, F_k and c limits how precisely each b is known.
    """
    b, a, W = (published.column(symbol)[level - 1].number for symbol in "baW")
    pairs = [published.column(symbol, "pair", "direct") for symbol in COEFFICIENTS]

    def implied(with_it: bool) -> tuple[str, list[bool]]:
        """Return the range of b by the pairs with this level or by the others, and which pairs exclude the print."""
        values, excluded = [], []
        for of_F_k, of_c in zip(*pairs, strict=True):
            if (level in levels_of(of_c.key.line)) is not with_it:
                continue
            F_k, c = of_F_k.number, of_c.number
            values.append((W.value - a.value * F_k.value) / c.value)
            rounding = a.value * F_k.unit + F_k.value * a.unit + b.value * c.unit + W.unit
            slack = 0.5 * (b.unit + rounding / c.value)
            excluded.append(abs(values[-1] - b.value) > slack)
        return range_text((min(values), max(values)), b), excluded

    (used, not_used), (wanted, not_wanted) = implied(with_it=True), implied(with_it=False)
    names = " and ".join(label for label in PAIR_LABELS if level in levels_of(label))
    if any(not_used):
        return "", f"It contradicts Table 2 itself: the printed pairs {names} give b = {used}."
    if all(not_wanted):
        family = f"b_{level} and F_k and c of the pairs {names} are judged alike"
        return (
            f"Table 2 contradicts itself; {family}: these pairs were computed with b_{level} = {used}, "
            f"and with the F_k and c of the other pairs level {level} balances for {wanted} only.",
            "",
        )
    return "", ""


def refuted(joined: Joined) -> str:
    """State that the printed least squares, or for a b the printed pairs, refute a cell of Tables 1 and 2."""
    of_cell, sources = joined.sources.refuted.get(joined.row.id, ""), joined.sources
    if of_cell or joined.key.quantity != "b":
        return of_cell
    return "".join(implied_b(sources.published, joined.level))


def unbalanced(joined: Joined) -> str:
    """State that a level of the pair has a b that other pairs refute."""
    levels, published = levels_of(joined.key.line), joined.sources.published
    said = " ".join(filter(None, (implied_b(published, level)[0] for level in levels)))
    return said and f"{said} {other_b(joined)}".strip()


def printed_inputs_differ(joined: Joined) -> str:
    """State what the paper's own inputs give in its own equations, where it prints another number."""
    value, number = joined.values["from_print"], joined.number
    if cross_checks.agrees(value, number):
        return ""
    return f"It contradicts the paper's own inputs, which give {number.show(value)}."


def slip_time_as_read(joined: Joined) -> str:
    """Explain t_s as read between the first and last sample of the microstick phase, in whole tenths of a ms."""
    t_s, step = joined.values["exact"], joined.case.numerics.step_s
    between, tenths = t_s - 2.0 * step, round(joined.number.value / TIME_UNIT_S)
    if math.isnan(t_s) or math.floor(between / TIME_UNIT_S) != tenths:
        return ""
    chosen = math.floor(t_s / TIME_UNIT_S) != tenths
    return (
        f"The microstick phase lasts {1e3 * t_s:.3f} ms, without a step of {1e6 * step:g} µs at each end "
        f"{1e3 * between:.3f} ms; the print keeps whole tenths."
        + " Leaving out these steps was chosen to give this number; its agreement is no evidence."
        * chosen
    )


def slip_velocity_as_read(joined: Joined) -> str:
    """Explain V_s as read off the velocity axis, and name levels that no mark of the axis explains."""
    sample = joined.of(quantity="V_s_at_sample")["unrounded"]
    if math.isnan(sample):
        return ""
    read = round(sample / VELOCITY_MARK) * VELOCITY_MARK
    as_printed = math.isclose(read, joined.number.value, rel_tol=1e-9)
    marks = joined.sources.published.values("V_s") / VELOCITY_MARK
    fits = np.isclose(
        marks, np.round(marks), atol=1e-6
    )  # 1e-6 of a mark: the rounding of binary fractions
    between = ", ".join(str(level) for level, on in enumerate(fits, 1) if not on)
    return (
        f"Read at the corner of the acceleration-velocity plot: the first slipping sample has {1e3 * sample:.3f} mm/s, "
        f"to the nearest {1e3 * VELOCITY_MARK:g} mm/s {1e3 * read:.2f}, {'as' if as_printed else 'not as'} printed"
        + (f"; at level {between} the print is no multiple of this." if between else ".")
    )


def phase(joined: Joined) -> str:
    """State which phase the printed one is."""
    to_reversal = joined.number.value - joined.values["exact"]
    to_crossing = joined.number.value - joined.of(quantity="phi_zero_crossing")["exact"]
    if not abs(to_reversal) < abs(to_crossing):
        return ""
    return (
        f"It is the phase of the velocity reversal ({to_reversal:+.4f} rad), "
        f"not of the zero crossing that the text names ({to_crossing:+.4f} rad)."
    )


def corrected(joined: Joined) -> float:
    """Return the as-published pair by the row that (19) states, without the slip of sign of the V_s columns."""
    approach = joined.key.approach
    return joined.of(approach=CORRECTED if approach == "V_s" else approach)["as_published"]


def sign(joined: Joined) -> str:
    """State the slip of sign in the V_s columns of Table 3 and its proof; return "" elsewhere."""
    correct, unit = corrected(joined), joined.key.unit
    if math.isnan(correct) or joined.values["as_published"] == correct:
        return ""
    digits, misfits = 4 if unit == "N" else 3, joined.sources.misfits
    return (
        "Slip of sign: alpha with a plus under the root. "
        f"With the minus of (19) it would be {correct:.{digits}f} {unit}. "
        f"Where the columns share X and phi, print excludes the minus ({misfits['minus']:.1f} units off at best; the "
        f"plus {misfits['plus']:.1f}); the V_s columns alone do not ({misfits['minus alone']:.2f})."
    )


def starting_sample(joined: Joined) -> str:
    """State where the integral a begins."""
    if joined.key.quantity != "a":
        return ""
    numerics = joined.case.numerics
    count = numerics.after_slip(joined.level - 1)
    samples = "a sample" if count == 1 else f"{count} samples"
    return (
        f"The integral begins {samples} after slip is seen, in the cycle that starts in period {numerics.cycles - 2}. "
        "This start was chosen to give this number; only its fraction of a sample is evidence."
    )


def other_b(joined: Joined) -> str:
    """State the pair with the b that the printed pairs need, where the printed b is not the simulated one."""
    row, sources = joined.row, joined.sources
    pair = PAIRS[PAIR_LABELS.index(row.key.line)]
    a, b, W = (getattr(sources.as_published, symbol)[list(pair)] for symbol in TABLE_2)
    if not np.all(np.isfinite([a, b, W])):
        return ""
    notes = []
    for place, level in enumerate(pair):
        cell, simulated_b = sources.published.column("b")[level], float(b[place])
        used, number = sources.allowed(cell.id), cell.number
        if used is None or abs(simulated_b / number.unit - number.value / number.unit) <= 0.5:
            continue
        b[place] = needed = 0.5 * (used[0] + used[1])
        notes.append(
            f"b_{level + 1} = {number.show(needed, 2)}, which the printed pairs need "
            f"(simulated: {number.show(simulated_b, 2)})"
        )
    if not notes:
        return ""
    value = float(least_squares(Rows({"F_k": a, "c": b}, W))[row.key.quantity])
    units = (value - row.number.value) / row.number.unit
    pair_is = (
        f"the as-published pair is {row.number.show(value, 2)} ({round(units, 1) + 0.0:+.1f} units)"
    )
    return f"With {' and '.join(notes)}, {pair_is}."


def outside(joined: Joined) -> str:
    """State that the rest of the table, within its rounding, does not allow a number."""
    allowed, number = joined.allowed, joined.number
    half, table = 0.5 * number.unit, "Table 2" if joined.key.approach == "direct" else "Table 3"
    if allowed is None or allowed[0] - half <= number.value <= allowed[1] + half:
        return ""
    return f"The rest of {table}, within its rounding, allows {range_text(allowed, number)} only."


def printed_inputs(joined: Joined) -> str:
    """State how far the digits of a printed table move what is computed from it."""
    shift = joined.values["from_print"] - joined.values["exact"]
    if math.isnan(shift):
        return ""
    inputs = "Table 2's integrals" if joined.key.approach == "direct" else "Table 1's read-outs"
    sign = "+" if shift > 0 else "-"
    return f"{inputs}, as printed, move it by {sign}{joined.number.show(abs(shift), 0)} from exact."


def cut_off(joined: Joined) -> str:
    """State that the printed digits are those of the number from print cut off, where rounding would give others."""
    value, number = joined.values["from_print"], joined.number
    units = value / number.unit
    if math.floor(units) == round(number.value / number.unit) != round(units):
        return f"{number.show(value, 2)} has the printed digits if cut off, not rounded."
    return ""


class _Read(NamedTuple):
    """A feature that is read: keys of its rules in the configuration, words for how it reads, and the features whose
    sum reads so, with its format, scale and unit."""

    keys: tuple[str, ...]
    words: str
    features: tuple[str, ...]
    digits: str
    scale: float
    unit: str

    def shown(self, read: Features, label: str) -> str:
        """Return how the feature reads at the levels of a pair; once if it reads the same."""
        sums = (
            math.fsum(getattr(read, name)[level - 1] for name in self.features)
            for level in levels_of(label)
        )
        texts = [f"{self.scale * value:{self.digits}} {self.unit}" for value in sums]
        return f"{self.words} {' and '.join(dict.fromkeys(texts))}"


_X_s = ("X_s_mark_m", "X_s_decimals")
_t_s = ("t_s_inset_s", "t_s_unit_s", "common_t_s_decimals")
_READ = (
    _Read(("X_decimals",), "X read as", ("X",), "g", 1e3, "mm"),
    _Read(_X_s, "X + X_s read as", ("X", "X_s"), ".4g", 1e6, "µm"),
    _Read(("V_s_decimals",), "V_s read as", ("V_s",), "g", 1e3, "mm/s"),
    _Read(_t_s, "one t_s of", ("t_s",), "g", 1e3, "ms"),
    _Read(("phi_decimals", "common_phi_decimals"), "one phi of", ("phi",), ".6g", 1.0, "rad"),
)


def rules_at_work(joined: Joined) -> str:
    """State what moves a number of Table 3 from exact."""
    return joined.sources.rules_at_work(joined.row)


def _rules_at_work(case: Case, exact: Features, unrounded: Features) -> Callable[[Row], str]:
    """Return a function of a row that says what moves that number of Table 3 from exact, in a sentence.

    Named are the largest share, and every other that moves the number by half a unit of its last printed digit.

    exact, unrounded : features at ω1 by these routes.
    """
    configured = {key: rule for key, rule in case.numerics.two_point.items() if rule is not None}

    def pairs(features: Features, *keys: str) -> tuple[Features, dict[Key, float]]:
        rules = {key: configured[key] for key in keys if key in configured}
        read = ReadOut.from_config(rules).common(features)
        table = estimates(features, read, replace(case, pairs=PAIRS))
        return read, of_estimates("omega1", table)

    (_, of_exact), (_, unread) = pairs(exact), pairs(unrounded)
    readings = {
        feature: pairs(unrounded, *feature.keys)
        for feature in _READ
        if not configured.keys().isdisjoint(feature.keys)
    }

    def sentence(row: Row) -> str:
        shifts = {"the simulation": unread[row.key] - of_exact[row.key]}
        for feature, (read, table) in readings.items():
            shifts[feature.shown(read, row.key.line)] = table[row.key] - unread[row.key]
        if not all(map(math.isfinite, shifts.values())):
            return ""
        first, *others = sorted(shifts, key=lambda what: -abs(shifts[what]))
        named = [first, *(what for what in others if abs(shifts[what]) >= 0.5 * row.number.unit)]
        digits = row.number.decimals + 1
        shares = (f"{what} ({shifts[what]:+.{digits}f} {row.key.unit})" for what in named)
        return f"Shares of its deviation from exact: {', '.join(shares)}."

    return sentence
