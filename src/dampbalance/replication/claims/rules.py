"""The rules by which printed numbers are judged, in one registry, and whether every row of the table suits its rule."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

from ...project.wording import cut
from ..claim_verdicts import Kind, statistic
from ..claim_verdicts import of_text as id_of_text
from ..printed import LONGEST
from ..printed_tables import RESIDUAL, TABLE_1, TABLE_2, UNKNOWNS
from ..route_tables import HARMONIC, PRINTED_APPROACHES
from . import of_tables, of_text, statements
from .judging import Claim
from .published import FILE, FREQUENCIES, Published, Row, column_ids
from .sources import Sources


class Rule(NamedTuple):
    """How some of the printed numbers are judged.

    claim : a function from a row to the claim on it.
    symbols, approaches : what such rows may hold.
    kind : of the claims.
    """

    claim: Callable[[Sources, Row], Claim]
    symbols: tuple[str, ...]
    approaches: tuple[str, ...] = ("",)
    kind: Kind = "computed"


_ESTIMATES = tuple(q.symbol for q in UNKNOWNS)
_OF_FIT = (*_ESTIMATES, RESIDUAL.symbol)
_INPUTS = ("m", "c", "k", "K_z", "F_k", "Y", *FREQUENCIES)
RULES = {
    "held": Rule(of_text.held, _INPUTS, kind="given"),
    "follows": Rule(of_text.follows, ("zeta", "omega_n")),
    "rounded": Rule(of_tables.read_out, ("X", "X_s")),
    "velocity": Rule(of_tables.read_out, ("V_s",)),
    "phase": Rule(of_tables.read_out, ("phi",)),
    "time": Rule(of_tables.read_out, ("t_s",)),
    "integral": Rule(of_tables.integral, tuple(q.symbol for q in TABLE_2)),
    "direct pair": Rule(of_tables.direct_pair, _ESTIMATES, ("direct",)),
    "harmonic pair": Rule(of_tables.harmonic_pair, _ESTIMATES, HARMONIC),
    "least squares": Rule(of_text.least_squares, _OF_FIT, PRINTED_APPROACHES),
    "mean of pairs": Rule(of_text.moment_of_pairs, _ESTIMATES, ("direct",)),
    "deviation of pairs": Rule(of_text.moment_of_pairs, _ESTIMATES, ("direct",)),
    "mean of levels": Rule(of_text.mean_of_levels, ("t_s", "phi")),
    "bound": Rule(statements.bound, (*_ESTIMATES, *FREQUENCIES), kind="statement"),
    "change": Rule(statements.change, FREQUENCIES, kind="statement"),
    "truth": Rule(statements.truth, ("",), kind="statement"),
}
"""Every rule by its name in the column `rule` of the printed numbers."""

_CELLS = {
    *(claim for q in TABLE_1 for claim in column_ids("table1", q.symbol)),
    *(claim for q in (*TABLE_2, *UNKNOWNS) for claim in column_ids("table2", q.symbol)),
    *(claim for table in ("table1", "table2") for claim in column_ids(table, "Y")),
    *(claim for a in HARMONIC for s in _ESTIMATES for claim in column_ids("table3", s, a)),
}
_OF_TEXT = {
    *(statistic(s, a, "least_squares") for a in PRINTED_APPROACHES for s in _OF_FIT),
    *(statistic(s, "direct", kind) for s in _ESTIMATES for kind in ("mean", "std")),
    *("t_s_mean", "phi_mean", "max_error_F_k", "max_error_c", "max_error_omega3"),
    *("accuracy_omega2", "accuracy_omega3", "direct_best"),
}


def claims(sources: Sources, rows: Iterable[Row]) -> list[Claim]:
    """The claims on some printed numbers."""
    return [RULES[row.rule].claim(sources, row) for row in rows]


def check_printed(published: Published) -> None:
    """Check the table before anything is judged by it.

    Raises ValueError naming file and row when a row is missing or has no claim, when its kind, symbol or approach does
    not suit its rule, or when what is printed cannot be judged.
    """
    parameters = {claim for claim in published.rows if claim.startswith("parameter.")}
    odd = (set(published.rows) - parameters) ^ (_CELLS | set(map(id_of_text, _OF_TEXT)))
    if odd:
        raise ValueError(
            f"{FILE}: rows and claims do not match: {_few(sorted(odd))}; each printed number needs its row"
        )
    for row in published.rows.values():
        if problem := _problem(row):
            raise ValueError(f"{FILE}: row {row.id}, column {problem}")
        if row.rule == "bound":
            statements.bound_holds(row, math.nan)
        elif row.rule in statements.WORDS:
            statements.word_holds(row, math.nan, math.nan)


def _problem(row: Row) -> str:
    """The column of the first cell that its rule does not know, and why; "" if there is none."""
    rule = RULES.get(row.rule)
    known: dict[str, Iterable[str]] = {"rule": RULES}
    if rule:
        known = {"kind": (rule.kind,), "symbol": rule.symbols, "approach": rule.approaches}
    for column, words in known.items():
        if (text := getattr(row, column)) not in words:
            listed = ", ".join(word or "none" for word in words)
            return f"{column}: {cut(text, LONGEST)!r} is not known to its rule; known are {listed}"
    if row.rule not in statements.WORDS and not row.number.is_number:
        return f"printed: {cut(row.printed, LONGEST)!r} is not a number such as 90.0402 or 2.9E-3"
    return ""


def _few(rows: Sequence[str]) -> str:
    return ", ".join(cut(row, LONGEST) for row in rows[:8]) + (" …" if len(rows) > 8 else "")
