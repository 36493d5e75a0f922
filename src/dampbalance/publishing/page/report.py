"""The page: all results of a case in one HTML file that needs nothing else.

`report_page` makes it from a `PageContent`, the same bytes for the same results.
"""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePosixPath
from typing import Any

import jinja2
import pandas as pd

from ... import __version__
from ...balance import TERMS
from ...figures.looks import label_of
from ...project import wording
from ...project.case import Case
from ...project.documents import read_yaml
from ...project.wording import minus, number, percent, signed_percent, unit_of
from ...replication import claim_verdicts as judged
from ...replication.comparison import mends, off_resonance
from ...replication.printed_tables import SHOWN_ROUTES, TITLES, blocks, claim_of
from ...studies.settings import Study
from ...studies.shown.facts import filled
from .. import words
from ..colours import css_variables
from .drawings import Sheet
from .instruments import instruments_data, sliders

LARGEST_PAGE = 1_500_000  # bytes: a page that a phone loads
STATIC = Path(__file__).with_name("static")
STYLES = ("style.css", "instruments.css")
SCRIPTS = (
    *("page.js", "engine.js", "kit.js"),
    *("oscillator.js", "off_resonance.js", "integrator.js", "noise.js", "digits.js"),
)


@dataclass(frozen=True)
class PageContent:
    """What the page shows.

    case : as configured.   config : the merged configuration, to be listed.
    claims : `claims.csv` as text, or None for a case with nothing printed.
    tables : frequency → name → frame of `printed_tables.COLUMNS`.   approaches : tables/approaches.csv.
    figures : name → SVG by `figures.style.save`: figure3, estimation_error, and where something is printed glance and
    numerics.
    evidence : `derived_numbers`, which the article argues with.   facts : study → its facts in words, as there.
    studies : (study, its figure as SVG).   digits : `changed_digits.packed`, if it is on record.
    """

    case: Case
    config: Mapping[str, Any]
    claims: pd.DataFrame | None
    tables: Mapping[str, Mapping[str, pd.DataFrame]]
    approaches: pd.DataFrame
    figures: Mapping[str, str]
    evidence: Mapping[str, Any] | None = None
    facts: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    studies: Sequence[tuple[Study, str]] = ()
    digits: Mapping[str, Any] | None = None


@dataclass(frozen=True, slots=True)
class Origin:
    """Where a result comes from; `templates/origins.yaml` says what each of these is."""

    what: str
    results: Sequence[str]
    rule: str
    rules: str
    code: Sequence[str]


_FILE = Path(__file__).with_name("templates") / "origins.yaml"
ORIGINS = {name: Origin(**origin) for name, origin in read_yaml(_FILE).items()}


def study_origin(name: str) -> Origin:
    """The origin of one study: its file says what is varied."""
    files = (f"results/studies/{name}/cases.parquet", f"config/studies/{name}.yaml")
    return replace(ORIGINS["studies"], results=files)


def link(path: str, page: str) -> str:
    """The address of a file of the repository as seen from the page, both as paths from the repository's root."""
    up = len(PurePosixPath(page).parent.parts)
    return "../" * up + path


def report_page(content: PageContent, page: str) -> str:
    """The page as HTML. page : where it will stand, as a path from the repository's root, for its links.

    Raises ValueError where it would become larger than LARGEST_PAGE.
    """
    case, frequencies, approaches = content.case, content.case.frequencies_hz, content.approaches
    claims: dict[Any, Any] = {}
    counted: list[judged.Count] = []
    if content.claims is not None:
        claims = content.claims.set_index("id", drop=False).to_dict("index")
        counted = judged.counts(content.claims)
    tables: dict[str, list[dict[str, Any]]] = {
        frequency: [
            {"title": TITLES[name], "parts": list(_parts(table, name, {} if n else claims))}
            for name, table in content.tables[frequency].items()
        ]
        for n, frequency in enumerate(frequencies)
    }
    sheet = Sheet()
    figures = {name: sheet.drawing(f"drawing-{name}", svg) for name, svg in content.figures.items()}
    studies = {study.name: _study(content, sheet, study, svg) for study, svg in content.studies}
    noise = studies.pop("noise", None)
    first = tables[next(iter(frequencies))]
    in_tables = {claim for table in first for part in table["parts"] for claim in part["claims"]}
    template = _environment(case.name, page).get_template("report.html.j2")
    html = template.render(
        version=__version__,
        case=case.name,
        page=page,
        counts=counted,
        total=counted[-1] if claims else None,
        claims=[
            {
                **row,
                **{
                    name: minus(row[name])
                    for name in ("printed", "explanation", *judged.ROUTE_NAMES)
                },
                **{"part": judged.PARTS[judged.part_of(id)], "unit": unit_of(row["unit"])},
                **{
                    "verdict": judged.VERDICTS[row["verdict"]],
                    "holds": row["verdict"] in judged.HOLDING,
                },
                "in_table": id in in_tables,
            }
            for id, row in claims.items()
        ],
        routes=judged.ROUTE_NAMES,
        verdicts=judged.VERDICTS.values(),
        kinds=judged.KINDS,
        frequencies=[
            {"name": wording.frequency_name(name), "hz": f"{hz:g}", "tables": tables[name]}
            for name, hz in frequencies.items()
        ],
        terms=list(TERMS),
        error_table=list(_error_lines(approaches, frequencies)),
        costs=off_resonance(approaches, frequencies),
        mends={
            recipe: [_error(error, signed_percent) for error in errors]
            for recipe, errors in mends(approaches, frequencies).items()
        },
        figures=figures,
        studies=studies.values(),
        noise=noise,
        sheet=sheet,
        origins=ORIGINS,
        configuration=[(key, _value(value)) for key, value in wording.dotted(content.config)],
        evidence=content.evidence,
        facts=content.facts,
        css_variables=css_variables,
        style="".join(map(_static, STYLES)),
        script="\n".join(map(_static, SCRIPTS)),
        engine=base64.b64encode((STATIC / "engine.wasm").read_bytes()).decode(),
        misprints=claims and content.digits is not None,
        sliders=sliders(case),
        instruments=instruments_data(case, content.claims, content.digits),
    )
    size = len(html.encode())
    if size > LARGEST_PAGE:
        raise ValueError(
            f"{page} would have {size:,} bytes, more than {LARGEST_PAGE:,}: show fewer studies, or coarser ones"
        )
    return html


def _parts(
    table: pd.DataFrame, name: str, claims: Mapping[str, Mapping[str, str]]
) -> Iterator[dict[str, Any]]:
    """A table as the paper lays it out, in parts whose rows share their quantities.

    columns : (symbol, unit) each.   claims : those on its printed numbers.
    groups : a row's label and its lines, (route, cells) each, the printed one first where there is one; a cell is its
    text, and for a printed number the verdict and the claim that gives the reason.

    table : a frame of `printed_tables.COLUMNS`, `printed` as text.   name : table1, table2, table3 or statistics.
    claims : id → row of the table of claims, from which the cells take their digits on the way, {} for none.
    """
    places = {row: place for place, row in enumerate(dict.fromkeys(table["row"]), start=1)}
    for quantities, block in blocks(table):
        groups, claimed = [], set()
        for label, rows in block.groupby("row", sort=False):
            cells = {
                claim_of(name, str(label), places[label], str(cell["quantity"])): cell
                for cell in rows.to_dict("records")
            }
            printed = [
                (minus(text), judged.VERDICTS[cell["verdict"]] if text else None, claim)
                for claim, cell in cells.items()
                for text in [cell["printed"]]
            ]
            claimed |= {claim for _, verdict, claim in printed if verdict}
            lines = [("printed", printed)] if any(text for text, *_ in printed) else []
            for route in SHOWN_ROUTES:
                texts = (
                    claims.get(claim, {}).get(route, "") or number(float(cell[route]))
                    for claim, cell in cells.items()
                )
                lines.append(
                    (judged.ROUTE_NAMES[route], [(minus(text), None, "") for text in texts])
                )
            groups.append((label, lines))
        columns = list(zip(quantities, map(unit_of, block["unit"]), strict=False))
        yield {"columns": columns, "groups": groups, "claims": claimed}


def _study(content: PageContent, sheet: Sheet, study: Study, svg: str) -> dict[str, Any]:
    """The figure of a study, with what it shows in words."""
    name = study.name.replace("_", "-")
    return {
        "title": study.title,
        "paragraph": filled(study, content.facts[study.name]),
        "figure": sheet.drawing(f"study-{name}", svg),
        "origin": study_origin(study.name),
    }


def as_json(data: Any) -> str:
    """Data to stand in a script element: compact, and without anything that could end it."""
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return text.replace("</", "<\\/").replace("<!--", "<\\u0021--")


def _environment(case: str, page: str) -> jinja2.Environment:
    """Templates with the filters that they use; an undefined name is an error."""
    environment = words.templates(jinja2.PackageLoader(__package__), html=True)
    environment.filters |= {
        "rich": words.rich,
        "titled": words.titled,
        "quantity": words.quantity,
        "reason": words.reason,
        "symbol": words.symbol,
        "here": lambda path: link(path.format(case=case), page),
        "at_case": lambda path: path.format(case=case),
        "approach": lambda key: words.rich(label_of(key)),
        "bound": lambda error: f"{wording.power_of_ten(error)} %",
        "significant": number,
        "as_json": as_json,
    }
    return environment


def _error_lines(approaches: pd.DataFrame, frequencies: Iterable[str]) -> Iterator[dict[str, Any]]:
    """The table of errors: (least squares, largest of the pairs) per frequency and quantity, side by side."""
    for key, rows in approaches.groupby(["approach", "phase", "sharing"], sort=False):
        approach, phase, sharing = (str(word) for word in key)
        at = rows.set_index("frequency")
        errors = [
            (
                _error(float(at[f"{unknown}_error_percent"][frequency]), signed_percent),
                _error(float(at[f"{unknown}_largest_pair_error_percent"][frequency])),
            )
            for frequency in frequencies
            for unknown in TERMS
        ]
        phase = phase.replace("_", " ") or wording.NONE
        yield {
            "approach": approach,
            "phase": phase,
            "sharing": sharing or wording.NONE,
            "errors": errors,
        }


def _error(error: float, in_percent: Callable[[float], str] = percent) -> str:
    """An error given in %, without its unit; a bound without a sign where it is nothing but rounding."""
    if not math.isfinite(error) or abs(error) < 1e-6:
        in_percent = percent
    text = in_percent(0.01 * error).removesuffix(" %")
    return f"≤ {text}" if abs(error) < 1e-6 else text


def _value(value: Any, inner: bool = False) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{key}: {_value(part)}" for key, part in value.items())
    if isinstance(value, Sequence) and not isinstance(value, str):
        mapped = any(isinstance(part, Mapping) for part in value)
        text = ("; " if mapped else ", ").join(_value(part, inner=True) for part in value)
        return f"({text})" if inner else text
    return "none" if value is None else str(value)


def _static(name: str) -> str:
    return (STATIC / name).read_text(encoding="utf-8")
