"""The ids of claims, one per printed number, such as table2.F_k.1-5 or text.c_Xs_ls: how they are built and parsed."""

from __future__ import annotations

PARTS = {
    "parameter": "Parameters",
    "table1": "Table 1",
    "table2": "Table 2",
    "table3": "Table 3",
    "text": "Text",
}
"""The parts of the paper: how their ids begin → in words."""

STATISTICS = {"least_squares": "ls", "mean": "mean", "std": "std"}
"""Kinds of estimates over all levels or pairs → how the id of such a number ends."""


def of_cell(table: str, symbol: str, line: str | int = "", approach: str = "") -> str:
    """A cell of Tables 1 to 3: table1.X_s.3, table2.F_k.1-5, table3.V_s.c.1-2; without the line, how a column begins.

    line : level, counted from 1, or label of a pair.   approach : in Table 3, whose columns repeat.
    """
    return ".".join([table, *([approach] if approach else []), symbol, str(line)])


def of_text(name: str) -> str:
    """A number of the running text by its name: text.phi_mean."""
    return f"text.{name}"


def statistic(symbol: str, approach: str, kind: str) -> str:
    """The name of a statistic of the running text: c_Xs_ls.   kind : of STATISTICS."""
    return f"{symbol}_{approach.replace('_', '')}_{STATISTICS[kind]}"


def part_of(claim: str) -> str:
    """The part of the paper that a claim belongs to, a key of PARTS; raises KeyError where there is none."""
    part = claim.partition(".")[0]
    if part not in PARTS:
        raise KeyError(f"{claim!r} belongs to no part of the paper; known are {', '.join(PARTS)}")
    return part
