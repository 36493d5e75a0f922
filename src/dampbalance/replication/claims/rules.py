"""The rules by which printed numbers are judged, in one registry, and whether every row of the table suits its rule."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import groupby
from typing import NamedTuple

from ..claim_ids import of_text as id_of_text
from ..claim_ids import statistic
from ..claim_verdicts import Kind
from ..printed import Printed
from ..printed_tables import RESIDUAL, TABLE_1, TABLE_2, UNKNOWNS
from ..route_tables import HARMONIC, PRINTED_APPROACHES
from . import of_tables, of_text, statements
from .inputs import Sources
from .judging import Claim
from .published import FILE, FREQUENCIES, Published, Row, column_ids

_LONGEST, _POWERS = 25, (-30, 30)  # characters of a number, and of ten


class Rule(NamedTuple):
    """How some of the printed numbers are judged.

    claims : a function from rows that follow each other in the table to the claims on them.
    symbols, approaches : what these rows may hold.
    kind : the kind of the claims.
    """

    claims: Callable[[Sources, Sequence[Row]], Iterator[Claim]]
    symbols: tuple[str, ...]
    approaches: tuple[str, ...] = ("",)
    kind: Kind = "computed"


_ESTIMATES = tuple(q.symbol for q in UNKNOWNS)
_OF_FIT = (*_ESTIMATES, RESIDUAL.symbol)
_INPUTS = ("m", "c", "k", "K_z", "F_k", "Y", *FREQUENCIES)
RULES = {
    "held": Rule(of_text.held, _INPUTS, kind="given"),
    "follows": Rule(of_text.follows, ("zeta", "omega_n")),
    "rounded": Rule(of_tables.read_outs, ("X", "X_s")),
    "velocity": Rule(of_tables.read_outs, ("V_s",)),
    "phase": Rule(of_tables.read_outs, ("phi",)),
    "time": Rule(of_tables.read_outs, ("t_s",)),
    "integral": Rule(of_tables.integrals, tuple(q.symbol for q in TABLE_2)),
    "direct pair": Rule(of_tables.direct_pairs, _ESTIMATES, ("direct",)),
    "harmonic pair": Rule(of_tables.harmonic_pairs, _ESTIMATES, HARMONIC),
    "least squares": Rule(of_text.least_squares, _OF_FIT, PRINTED_APPROACHES),
    "mean of pairs": Rule(of_text.moments, _ESTIMATES, ("direct",)),
    "deviation of pairs": Rule(of_text.moments, _ESTIMATES, ("direct",)),
    "mean of levels": Rule(of_text.moments, ("t_s", "phi")),
    "bound": Rule(of_text.bounds, (*_ESTIMATES, *FREQUENCIES), kind="statement"),
    "change": Rule(of_text.changes, FREQUENCIES, kind="statement"),
    "truth": Rule(of_text.truths, ("",), kind="statement"),
}
"""Every rule by its name in the column `rule` of the printed numbers."""

_STATEMENTS: dict[str, Callable[[Row], object]] = {
    "bound": lambda row: statements.bound(row.id, row.quantity, row.printed, {}),
    "change": lambda row: statements.change(row.id, row.printed, {}, {}),
    "truth": lambda row: statements.truth(row.id, row.printed, {}),
}
"""Functions that raise ValueError for a statement that cannot be judged."""

_WORDS = ("change", "truth")  # rules for which a word is printed, not a number
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


def claims(sources: Sources, rows: Iterable[Row]) -> Iterator[Claim]:
    """The claims on some printed numbers, in the order of their rows."""
    for judged, group in groupby(rows, key=lambda row: RULES[row.rule].claims):
        yield from judged(sources, list(group))


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
        problem = _problem(row)
        if problem:
            raise ValueError(f"{FILE}: row {row.id}, {problem}")
        if row.rule in _STATEMENTS:
            _STATEMENTS[row.rule](row)


def _problem(row: Row) -> str:
    """The message for the first cell that its rule does not know; "" if there is none."""
    if row.rule not in RULES:
        return _unknown("rule", row.rule, RULES)
    rule = RULES[row.rule]
    allowed = {"kind": (rule.kind,), "symbol": rule.symbols, "approach": rule.approaches}
    for column, known in allowed.items():
        if getattr(row, column) not in known:
            return _unknown(column, getattr(row, column), known)
    if row.rule not in _WORDS and not _is_number(row.printed):
        return f"column printed: {_cut(row.printed)!r} is not a number such as 90.0402 or 2.9E-3"
    return ""


def _unknown(column: str, text: str, known: Iterable[str]) -> str:
    words = ", ".join(word or "none" for word in known)
    return f"column {column}: {_cut(text)!r} is not known to its rule; known are {words}"


def _is_number(text: str) -> bool:
    """Whether the text is a number with digits, of a size that a quantity of the paper can have."""
    printed = Printed(text)
    if len(text) > _LONGEST or not printed.is_number or not printed.decimal.is_finite():
        return False
    low, high = _POWERS
    return low <= printed.exponent and printed.decimal.adjusted() <= high


def _cut(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"


def _few(rows: Sequence[str]) -> str:
    return ", ".join(map(_cut, rows[:8])) + (" …" if len(rows) > 8 else "")
