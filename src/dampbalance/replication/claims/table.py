"""The table of claims: built, written as Markdown, summed up, and compared with the verdicts on record."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping
from pathlib import Path

import pandas as pd

from ...project.case import Case
from ...project.wording import in_markdown, markdown_table
from ..claim_ids import PARTS, part_of
from ..claim_verdicts import HOLDING, KINDS, ROUTE_NAMES, VERDICTS, counts
from ..route_tables import RouteTables
from .judging import Claim, explanation, verdict
from .published import Published, read_texts
from .rules import check_printed, claims
from .sources import Sources, require_paper

COLUMNS = (
    *("id", "where", "quantity", "unit", "printed", *ROUTE_NAMES),
    *("verdict", "explanation", "kind", "judged", "off_relative", "off_units"),
)
"""Those of claims.csv. judged : the route that judges.   off_… : how far it lies from a computed number as printed, of
itself and in units of the last digit."""
RECORD = ("id", "printed", "verdict")


def claims_table(
    published: Published,
    case: Case,
    exact: RouteTables,
    as_published: RouteTables,
    unrounded: pd.DataFrame,
) -> pd.DataFrame:
    """A row per printed number: what each route gives for it, the verdict, and why. Columns: COLUMNS.

    published : `read_published(folder)`.   case : as configured.
    exact, as_published : feature and estimate tables of the two routes; the from-print route is computed here.
    unrounded : the as-published simulation at ω1 before it was read, `ReadFeatures.to_frame()`.

    The numbers of the routes are text, written as the printed number is with four more digits; verdicts are judged on
    all digits. Raises ValueError when the printed ids and the claims do not match one to one, or the case is not the
    paper's.
    """
    require_paper(case)
    check_printed(published)
    sources = Sources(published, case, exact, as_published, unrounded)
    records = [
        {
            **claim.row._asdict(),
            **{route: claim.show(route) for route in ROUTE_NAMES},
            "verdict": verdict(claim).name,
            "explanation": explanation(claim),
            "judged": ROUTE_NAMES[claim.route],
            **_off(claim),
        }
        for claim in claims(sources, published.rows.values())
    ]
    return pd.DataFrame.from_records(records, columns=list(COLUMNS))


def _off(claim: Claim) -> dict[str, str]:
    """How far the judging route lies from a computed number as printed, as text."""
    if claim.row.kind != "computed" or claim.route not in claim.routes:
        return {"off_relative": "", "off_units": ""}
    relative, units = claim.off_relative(claim.route), claim.off(claim.route)
    return {"off_relative": f"{relative:+.1e}", "off_units": f"{units:+.2f}"}


def claims_markdown(frame: pd.DataFrame) -> str:
    """The claims as a Markdown page: counts first, then a table per part of the paper."""
    lines = ["# Every printed number and its verdict", "", *_meanings(frame), ""]
    for part, rows in frame.groupby(frame["id"].map(part_of), sort=False):
        lines += [f"## {PARTS[str(part)]}", "", markdown_table(_HEADS, _cells(rows), _ALIGN), ""]
    return "\n".join(lines)


_HEADS = (
    *("where", "quantity", "printed", *ROUTE_NAMES.values(), "verdict", "why"),
    *("kind", "judged", "off, of itself", "off, units"),
)
_ALIGN = "llrrrrllllrr"


def _cells(rows: pd.DataFrame) -> Iterator[list[str]]:
    for row in rows.to_dict("records"):
        unit = "" if row["unit"] in ("", "1") else f" ({row['unit']})"
        row["quantity"] = f"{row['quantity']}{unit}"
        row |= {name: in_markdown(row[name]) for name in ("where", "quantity", "printed")}
        yield [row[name] for name in COLUMNS if name not in ("id", "unit")]


WORSE = "printed numbers are worse off than on record"
"""The words by which a summary with offences is recognised."""


def summary(frame: pd.DataFrame, offences: pd.DataFrame) -> str:
    """The summary that ends a run, as text.

    It counts the computed numbers by part and verdict, with inputs and statements next to them, and lists each claim
    that is neither reproduced nor reconstructed, with the number that is obtained; the reasons stand in the table of
    claims. After WORSE there is a line for each offence that `check` returned.
    """
    counted = counts(frame)
    table = {
        count.part: {
            "computed": count.computed,
            **count.of_verdict,
            "given": count.given,
            "statements": count.statements,
        }
        for count in counted
    }
    total = counted[-1]
    lines = [
        "Verdicts on the printed numbers that are computed",
        "",
        pd.DataFrame(table).T.to_string(),
        "",
        f"Of {total.given} given inputs the configuration holds {total.given_held}; "
        f"of {total.statements} statements {total.statements_held} hold.",
        "",
    ]
    rest = frame[~frame["verdict"].isin(HOLDING)]
    if len(rest):
        shown = [
            {
                "number": row["id"],
                "printed": f"{row['printed']} {'' if row['unit'] == '1' else row['unit']}".strip(),
                "verdict": row["verdict"],
                "obtained": _obtained(row),
            }
            for row in rest.to_dict("records")
        ]
        lines.append("Neither reproduced nor reconstructed (why: claims.md)")
        lines.append(_aligned(pd.DataFrame.from_records(shown)))
    if len(offences):
        lines += ["", f"{len(offences)} {WORSE}:", *("  " + offences["message"])]
    return "\n".join(lines) + "\n"


def _obtained(row: Mapping[Hashable, str]) -> str:
    """The value of the route that judges, and how many units it is off."""
    column = next(name for name, words in ROUTE_NAMES.items() if words == row["judged"])
    off = f", {row['off_units']} units" if row["off_units"] else ""
    return f"{row[column] or 'nothing'} {row['judged']}{off}"


def _aligned(frame: pd.DataFrame) -> str:
    """The frame as text with its columns flush left."""
    widths = [max(len(name), *frame[name].str.len()) for name in frame.columns]
    rows = [list(frame.columns), *frame.to_numpy().tolist()]
    cells = ("  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)) for row in rows)
    return "\n".join(f"  {line}".rstrip() for line in cells)


def read_claims(path: Path) -> pd.DataFrame:
    """A table of claims from its CSV file, every cell the text that it is."""
    return read_texts(path, COLUMNS)


def read_record(path: Path) -> pd.DataFrame:
    """The verdicts on record, verdicts.csv. Raises ValueError for a wrong column or an unknown verdict."""
    recorded = read_texts(path, RECORD)
    unknown = recorded[~recorded["verdict"].isin(VERDICTS)]
    if len(unknown):
        first = unknown.iloc[0]
        raise ValueError(
            f"{path}: {first['id']} has the verdict {first['verdict']!r}; known are {', '.join(VERDICTS)}"
        )
    return recorded


def check(frame: pd.DataFrame, recorded: pd.DataFrame) -> pd.DataFrame:
    """The claims that are worse than on record, printed with other digits, missing, or not on record at all.

    Returns id, printed, was, now and message, a row per offence, none when all is well. A better verdict is no offence.
    """
    now, was = frame.set_index("id"), recorded.set_index("id")
    offences = []
    for name in [*now.index, *(name for name in was.index if name not in now.index)]:
        message = _offence(name, now, was)
        if message:
            offences.append(
                {
                    "id": name,
                    "printed": now["printed"].get(name, was["printed"].get(name)),
                    "was": was["verdict"].get(name, ""),
                    "now": now["verdict"].get(name, ""),
                    "message": message,
                }
            )
    return pd.DataFrame.from_records(offences, columns=["id", "printed", "was", "now", "message"])


def _offence(name: str, now: pd.DataFrame, was: pd.DataFrame) -> str:
    if name not in was.index:
        return f"{name}: printed {now['printed'][name]}, {now['verdict'][name]}, is not on record; add it"
    if name not in now.index:
        return f"{name}: printed {was['printed'][name]}, on record as {was['verdict'][name]}, has no claim any more"
    row = now.loc[name]
    if row["printed"] != was["printed"][name]:
        return f"{name}: printed {was['printed'][name]} on record, now read as {row['printed']}"
    ranks = list(VERDICTS)
    if ranks.index(str(row["verdict"])) > ranks.index(was["verdict"][name]):
        obtained = ", ".join(
            f"{ROUTE_NAMES[route]} {row[route]}" for route in ROUTE_NAMES if row[route]
        )
        return (
            f"{name}: printed {row['printed']}, obtained {obtained}: was {was['verdict'][name]}, now {row['verdict']}. "
            f"{row['explanation']}"
        )
    return ""


def _meanings(frame: pd.DataFrame) -> list[str]:
    total = counts(frame)[-1]
    kinds = frame["kind"].value_counts()
    return [
        *(f"- {kinds.get(kind, 0)} {kind}: {meaning}" for kind, meaning in KINDS.items()),
        "",
        f"Of the {total.computed} computed numbers:",
        "",
        *(f"- **{name}** {total.of_verdict[name]}: {v.meaning}" for name, v in VERDICTS.items()),
    ]
