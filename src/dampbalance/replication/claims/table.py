"""The table of claims: built, written as Markdown, summed up, and compared with the verdicts on record."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping
from itertools import zip_longest
from pathlib import Path

import pandas as pd

from ...project.wording import in_markdown, markdown_table
from .causes import Sources
from .judging import explanation, verdict
from .printed import read_texts
from .rules import check_printed, claims, require_paper
from .verdicts import HOLDING, KINDS, PARTS_OF_THE_PAPER, ROUTE_NAMES, VERDICTS, counts, part_of

CLAIM_COLUMNS = (
    *("id", "where", "quantity", "unit", "printed", *ROUTE_NAMES),
    *("verdict", "explanation", "kind", "agrees", "judged", "off_relative", "off_units"),
)
"""Those of claims.csv. agrees : the routes that give the printed digits of a computed number, the best first.
judged : the route by which the number's column was obtained.   off_… : its deviation from a computed number as printed,
relative and in units of the last digit."""
SEPARATOR = "; "
"""Separates the routes in the column `agrees`."""

RECORDED_COLUMNS = ("id", "printed", "verdict")


def claims_table(sources: Sources) -> pd.DataFrame:
    """Return a row per printed number: what each route gives for it, the verdict, and why. Columns: CLAIM_COLUMNS.

    The numbers of the routes are text, written as the printed number is with four more digits; verdicts are judged on
    all digits. Raises ValueError when the printed ids and the claims do not match one to one, or the case is not the
    paper's.
    """
    require_paper(sources.case)
    check_printed(sources.published)
    records = []
    for claim in claims(sources, sources.published.rows.values()):
        printed = claim.row
        unit = printed.key.unit if printed.number.is_number else ""
        row = {"id": printed.id, "where": printed.where, "quantity": printed.words, "unit": unit}
        row |= {"printed": printed.printed, "kind": printed.claim}
        row |= {route: claim.show(route) for route in ROUTE_NAMES}
        row |= {"verdict": verdict(claim).name, "explanation": explanation(claim)}
        row |= {"agrees": SEPARATOR.join(ROUTE_NAMES[route] for route in claim.agreeing)}
        row |= {"judged": ROUTE_NAMES[claim.route], "off_relative": "", "off_units": ""}
        if printed.claim == "computed" and claim.route in claim.routes:
            row["off_relative"] = f"{claim.off_relative(claim.route):+.1e}"
            row["off_units"] = f"{claim.off(claim.route):+.2f}"
        records.append(row)
    return pd.DataFrame.from_records(records, columns=list(CLAIM_COLUMNS))


def claims_markdown(frame: pd.DataFrame) -> str:
    """Return the claims as a Markdown page: counts first, then a table per part of the paper."""
    kinds, total = frame["kind"].value_counts(), counts(frame)[-1]
    lines = ["# Every printed number and its verdict", ""]
    lines += [f"- {kinds.get(kind, 0)} {kind}: {meaning}" for kind, meaning in KINDS.items()]
    lines += ["", f"Of the {total.computed} computed numbers:", ""]
    lines += [f"- **{name}** {total.of_verdict[name]}: {v.meaning}" for name, v in VERDICTS.items()]
    for part, rows in frame.groupby(frame["id"].map(part_of), sort=False):
        cells = map(_cells, rows.to_dict("records"))
        lines += [
            "",
            f"## {PARTS_OF_THE_PAPER[str(part)]}",
            "",
            markdown_table(_HEADS, cells, "llrrrrlllllrr"),
        ]
    return "\n".join([*lines, ""])


_HEADS = (
    *("where", "quantity", "printed", *ROUTE_NAMES.values(), "verdict", "why"),
    *("kind", "agrees", "judged", "off, relative", "off, units"),
)


def _cells(row: dict[Hashable, str]) -> list[str]:
    row["quantity"] += "" if row["unit"] in ("", "1") else f" ({row['unit']})"
    row |= {name: in_markdown(row[name]) for name in ("where", "quantity", "printed")}
    return [row[name] for name in CLAIM_COLUMNS if name not in ("id", "unit")]


WORSE = "printed numbers come out worse than on record"
"""The words by which a summary with offences is recognised."""


def summary(frame: pd.DataFrame, offences: pd.DataFrame) -> str:
    """Return the summary of the verdicts, as text.

    Its first paragraph is shown on the screen when a run ends: whether all verdicts are as on record, otherwise how
    many are not, and the worst of them. Then it counts the computed numbers by part and verdict, with inputs and
    statements next to them, and lists each claim of which no route gives the digits or which the paper refutes, with
    the number that is obtained; the reasons are in the table of claims. At the end it has a line for each offence that
    `check_claims` returned.
    """
    counted = counts(frame)
    total, table = counted[-1], {}
    for count in counted:
        inputs = {"given": count.given, "statements": count.statements}
        table[count.part] = {"computed": count.computed, **count.of_verdict, **inputs}
    lines = [
        *_opening(frame, offences),
        "",
        "Verdicts on the printed numbers that are computed",
        "",
        pd.DataFrame(table).T.to_string(),
        "",
        f"The configuration has {total.given_held} of {total.given} given inputs; "
        f"{total.statements_held} of {total.statements} statements hold.",
        "",
    ]
    if rest := [row for row in frame.to_dict("records") if row["verdict"] not in HOLDING]:
        lines.append("Numbers that no route gives, or that the paper refutes (reasons: claims.md)")
        units = [f"{row['off_units']} units" for row in rest]
        lines += _aligned([_HEAD, *map(_open, rest, units)])
    if len(offences):
        lines += ["", "All numbers worse than on record:", *("  " + offences["message"])]
    return "\n".join(lines) + "\n"


def _opening(frame: pd.DataFrame, offences: pd.DataFrame) -> list[str]:
    """Return the first paragraph of the summary: numbers without a claim or a value first, then the farthest off."""
    if offences.empty:
        return [f"{len(frame)} verdicts as on record."]
    claims = {row["id"]: row for row in frame.to_dict("records")}
    off = pd.to_numeric(frame.set_index("id")["off_relative"].replace("", "0")).abs()
    ranked = (
        off.reindex(offences["id"]).fillna(math.inf).sort_values(ascending=False, kind="stable")
    )
    printed = offences.set_index("id")["printed"]
    rows = [
        _open(claims[name], f"{100 * off[name]:g} % off")
        if name in claims
        else (name, printed[name], "no claim")
        # with the sentences above them, half of a terminal's 24 lines
        for name in map(str, ranked.index[:10])
    ]
    return [
        f"{len(offences)} of {len(frame)} {WORSE}; the results are built.",
        "For your own case, set `published: null` in the configuration: then nothing is compared.",
        *_aligned([_HEAD, *rows]),
    ]


_HEAD = ("number", "printed", "verdict", "obtained")


def _aligned(rows: list[tuple[str, ...]]) -> list[str]:
    """Return the rows of a table as lines, indented, their columns as wide as needed."""
    widths = [max(map(len, column)) for column in zip_longest(*rows, fillvalue="")]
    return [
        f"  {'  '.join(cell.ljust(n) for cell, n in zip(row, widths, strict=False))}".rstrip()
        for row in rows
    ]


def _open(row: Mapping[Hashable, str], off: str) -> tuple[str, ...]:
    """Return a line of the summary: the number by the column's route, and how far it is off, if it is a number."""
    value = row[next(name for name, words in ROUTE_NAMES.items() if words == row["judged"])]
    printed = f"{row['printed']} {'' if row['unit'] == '1' else row['unit']}".strip()
    obtained = f"{value or 'nothing'} {row['judged']}"
    return (
        row["id"],
        printed,
        row["verdict"],
        f"{obtained}, {off}" if row["off_units"] else obtained,
    )


def read_record(path: Path) -> pd.DataFrame:
    """Return the verdicts on record, verdicts.csv. Raises ValueError for a wrong column or an unknown verdict."""
    recorded = read_texts(path, RECORDED_COLUMNS)
    unknown = recorded[~recorded["verdict"].isin(VERDICTS)]
    if len(unknown):
        first = unknown.iloc[0]
        raise ValueError(
            f"{path.name}: {first['id']} has the verdict {first['verdict']!r}; known are {', '.join(VERDICTS)}"
        )
    return recorded


def check_claims(frame: pd.DataFrame, recorded: pd.DataFrame) -> pd.DataFrame:
    """Return the claims that are worse than on record, printed with other digits, missing, or not on record at all.

    Returns id, printed, was, now and message, a row per offence, none when all is well. A better verdict is no offence.
    """
    now, was = ({row["id"]: row for row in table.to_dict("records")} for table in (frame, recorded))
    offences = []
    for name in dict.fromkeys([*now, *was]):
        new, old = now.get(name, {}), was.get(name, {})
        if message := _offence(new, old):
            printed = (new or old)["printed"]
            verdicts = (row.get("verdict", "") for row in (old, new))
            offences.append((name, printed, *verdicts, f"{name}: printed {message}"))
    return pd.DataFrame.from_records(offences, columns=["id", "printed", "was", "now", "message"])


def _offence(new: Mapping[Hashable, str], old: Mapping[Hashable, str]) -> str:
    if not old:
        return f"{new['printed']}, {new['verdict']}, is not on record; add it"
    if not new:
        return f"{old['printed']}, on record as {old['verdict']}, has no claim any more"
    if new["printed"] != old["printed"]:
        return f"{old['printed']} on record, now read as {new['printed']}"
    now, was = (list(VERDICTS).index(row["verdict"]) for row in (new, old))
    if now <= was:
        return ""
    obtained = ", ".join(f"{words} {new[name]}" for name, words in ROUTE_NAMES.items() if new[name])
    return (
        f"{new['printed']}, obtained {obtained}: was {old['verdict']}, now {new['verdict']}. "
        f"{new['explanation']}"
    )
