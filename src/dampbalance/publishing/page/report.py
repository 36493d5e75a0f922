"""The page: all results of a case in one HTML file that needs nothing else.

`PageContent` holds what the page is made from; `report_page` makes it, the same bytes for the same results.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import jinja2
import pandas as pd
from markupsafe import Markup

from ... import __version__
from ...balance import TERMS
from ...figures.cycle import POINTS
from ...figures.looks import label_of
from ...figures.numerics import Evidence
from ...motion.orbit import Orbit
from ...project.case import Case
from ...project.wording import MINUS, NONE, dotted, frequency_name, minus, percent, unit_of
from ...replication.claim_verdicts import (
    DIFFERS,
    HOLDING,
    KINDS,
    PARTS,
    RECONSTRUCTED,
    REPRODUCED,
    ROUTE_NAMES,
    VERDICTS,
    Count,
    counts,
    part_of,
)
from ...replication.printed_tables import TITLES
from ...studies.settings import Study
from ...studies.shown.facts import paragraph
from . import words
from .cells import subtables
from .charts import CONFIG, as_json, runtime
from .colours import css_variables, verdict_styles
from .curves import study_charts
from .digits import digit_charts
from .error_levels import error_charts
from .loops import figure3_charts
from .origins import ORIGINS, link, study_origin
from .resonance import mends, off_resonance

TITLE = "How the printed numbers of an energy balance fare"
LARGEST_PAGE = 3_000_000  # bytes: a page that a phone loads
TITLE_OF_CASE = "Friction and damping from an energy balance"
HEADLINE_OF_CASE = (
    "Friction and viscous damping of a driven oscillator from the balance of energy over a period."
)
SECTIONS = {
    "match": "Match",
    "numbers": "Every number",
    "tables": "Tables",
    "digits": "Digits",
    "figure3": "Figure 3",
    "errors": "Off resonance",
    "studies": "Studies",
    "provenance": "Sources",
}


@dataclass(frozen=True)
class PageContent:
    """What the page shows.

    case : as configured.   config : the merged configuration, to be listed.
    claims : `claims.csv` as text, or None for a case with nothing printed.
    tables : frequency → name → frame of `tables.COLUMNS`.   approaches : tables/approaches.csv.
    orbits : of the first frequency.   estimates : the exact ones by frequency.   evidence : what the printed digits are
    told from, or None.   studies : (study, its table of cases).
    """

    case: Case
    config: Mapping[str, Any]
    claims: pd.DataFrame | None
    tables: Mapping[str, Mapping[str, pd.DataFrame]]
    approaches: pd.DataFrame
    orbits: Sequence[Orbit]
    estimates: Mapping[str, pd.DataFrame]
    evidence: Evidence | None = None
    studies: Sequence[tuple[Study, Path]] = ()


def report_page(content: PageContent, page: str) -> str:
    """The page as HTML. page : where it will stand, as a path from the repository's root, for its links.

    Raises ValueError where it would become larger than LARGEST_PAGE.
    """
    case, frequencies = content.case.name, content.case.frequencies_hz
    tables = _paper_tables(content)
    shown = _numbers(content, next(iter(tables.values()))) | _charts(content)
    template = _environment(case, page).get_template("report.html.j2")
    html = template.render(
        version=__version__,
        case=case,
        page=page,
        verdicts=VERDICTS.values(),
        kinds=KINDS,
        frequencies=[
            {"name": frequency_name(name), "hz": f"{hz:g}", "tables": tables[name]}
            for name, hz in frequencies.items()
        ],
        terms=list(TERMS),
        error_table=list(_error_lines(content.approaches, frequencies)),
        costs=off_resonance(content.approaches, frequencies),
        mends={
            recipe: [_signed(error) for error in errors]
            for recipe, errors in mends(content.approaches, frequencies).items()
        },
        **shown,
        **_provenance(content),
        style=_style(),
        script=_text("static/page.js"),
        charts_script=_text("static/charts.js"),
        runtime=runtime(),
    )
    size = len(html.encode())
    if size > LARGEST_PAGE:
        raise ValueError(
            f"{page} would have {size:,} bytes, more than {LARGEST_PAGE:,}: show fewer studies, or coarser ones"
        )
    return html


def _paper_tables(content: PageContent) -> dict[str, list[dict[str, Any]]]:
    """The paper's tables at each frequency; those of the first have the digits and the verdicts of the claims."""
    claims: dict[Any, Any] = {}
    if content.claims is not None:
        claims = content.claims.set_index("id").to_dict("index")
    return {
        frequency: [
            {"title": TITLES[name], "subtables": subtables(table, name, {} if n else claims)}
            for name, table in content.tables[frequency].items()
        ]
        for n, frequency in enumerate(content.case.frequencies_hz)
    }


def _numbers(content: PageContent, tables: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """The printed numbers, counted and one by one, and the title above them. tables : those with verdicts."""
    if content.claims is None:
        nothing: dict[str, Any] = {"counts": [], "claims": [], "total": None}
        return {"title": TITLE_OF_CASE, "headline": HEADLINE_OF_CASE, **nothing}
    counted = counts(content.claims)
    in_tables = {claim for table in tables for part in table["subtables"] for claim in part.claims}
    claims = [
        _claim(row) | {"in_table": row["id"] in in_tables}
        for row in content.claims.to_dict("records")
    ]
    total = counted[-1]
    return {
        "title": TITLE,
        "headline": _headline(total),
        "counts": counted,
        "total": total,
        "claims": claims,
    }


def _charts(content: PageContent) -> dict[str, Any]:
    """Figure 3, the errors of the approaches and the studies, with what their charts need."""
    figure3 = figure3_charts(content.orbits)
    case = content.case
    errors = error_charts(content.estimates, case.oscillator, case.frequencies_hz, case.levels_m)
    studies: list[dict[str, Any]] = [
        {
            "name": study.name.replace("_", "-"),
            "title": study.title,
            "paragraph": paragraph(study, cases),
            "figure": study_charts(study, cases),
            "origin": study_origin(study.name),
        }
        for study, cases in content.studies
    ]
    digits = []
    if content.evidence is not None:
        numerics = case.numerics
        unit = numerics.tabulated["t_s_unit_s"]
        digits = digit_charts(content.evidence, case.oscillator, numerics.step_s, unit)
    charts = [*digits, *figure3, *errors.charts]
    charts += [chart for study in studies for chart in study["figure"].charts]
    return {
        "digits": digits,
        "figure3": figure3,
        "points_slip": POINTS[False],
        "points_stick": POINTS[True],
        "errors": errors,
        "studies": studies,
        "chart_tables": {chart.table.id: chart.table for chart in charts}.values(),
        "chart_specs": as_json({"config": CONFIG, "charts": {c.id: c.spec for c in charts}}),
    }


def _provenance(content: PageContent) -> dict[str, Any]:
    """The sections that there are, where each comes from, and the configuration."""
    absent = set() if content.studies else {"studies"}
    if content.claims is None:
        absent |= {"claims", "match", "numbers"}
    if content.evidence is None:
        absent |= {"digits"}
    return {
        "sections": [(name, title) for name, title in SECTIONS.items() if name not in absent],
        "origins": ORIGINS,
        "all_origins": [origin for name, origin in ORIGINS.items() if name not in absent],
        "configuration": [(key, _value(value)) for key, value in dotted(content.config)],
    }


def _environment(case: str, page: str) -> jinja2.Environment:
    """Templates with the filters that they use; an undefined name is an error."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("dampbalance.publishing.page"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= {
        "rich": words.rich,
        "titled": words.titled,
        "quantity": words.quantity,
        "reason": words.reason,
        "symbol": _quantity,
        "here": lambda path: link(path.format(case=case), page),
        "at_case": lambda path: path.format(case=case),
        "approach": lambda key: words.rich(label_of(key)),
    }
    return environment


def _quantity(text: str) -> Markup:
    """A column head: F_k by X_s, a."""
    symbol, by, approach = text.partition(" by ")
    return words.one_letter(symbol) + by + words.rich(approach)


def _claim(row: Mapping[Any, str]) -> dict[str, Any]:
    """One printed number as the page shows it, from its row of the table of claims."""
    return {
        **{name: row[name] for name in ("id", "where", "quantity", "kind")},
        **{name: minus(row[name]) for name in ("printed", "explanation")},
        "part": PARTS[part_of(row["id"])],
        "unit": unit_of(row["unit"]),
        "routes": [(route.capitalize(), minus(row[name])) for name, route in ROUTE_NAMES.items()],
        "verdict": VERDICTS[row["verdict"]],
        "holds": row["verdict"] in HOLDING,
    }


def _headline(total: Count) -> str:
    """The whole match in two sentences: the computed numbers, and how those fare that neither route gives."""
    n = dict(total.of_verdict)
    reproduced, reconstructed, differs = (
        n.pop(verdict.name) for verdict in (REPRODUCED, RECONSTRUCTED, DIFFERS)
    )
    others = ", ".join(f"{count} {name}" for name, count in n.items() if count) or "none"
    return (
        f"Of the {total.computed} computed numbers that the paper prints, {reproduced} are reproduced by the exact "
        f"solution and {reconstructed} by reconstructing how they were computed. The others: {others}; "
        f"{'none differs' if not differs else f'{differs} differ'}."
    )


def _error_lines(approaches: pd.DataFrame, frequencies: Iterable[str]) -> Iterator[dict[str, Any]]:
    """The table of errors: (least squares, largest of the pairs) per frequency and quantity, side by side."""
    for key, rows in approaches.groupby(["approach", "phase", "sharing"], sort=False):
        approach, phase, sharing = (str(word) for word in key)
        at = rows.set_index("frequency")
        errors = [
            (
                _signed(float(at[f"{unknown}_error_percent"][frequency])),
                _size(float(at[f"{unknown}_largest_pair_error_percent"][frequency])),
            )
            for frequency in frequencies
            for unknown in TERMS
        ]
        phase = phase.replace("_", " ") or NONE
        yield {"approach": approach, "phase": phase, "sharing": sharing or NONE, "errors": errors}


def _size(error: float) -> str:
    """The size of an error given in %; a bound where it is nothing but rounding."""
    text = percent(0.01 * error).removesuffix(" %")
    return f"≤ {text}" if abs(error) < 1e-6 else text


def _signed(error: float) -> str:
    """An error given in %, with its sign unless it is nothing but rounding."""
    if not math.isfinite(error) or abs(error) < 1e-6:
        return _size(error)
    return (MINUS if error < 0.0 else "+") + _size(error)


def _value(value: Any, inner: bool = False) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{key}: {_value(part)}" for key, part in value.items())
    if isinstance(value, Sequence) and not isinstance(value, str):
        mapped = any(isinstance(part, Mapping) for part in value)
        text = ("; " if mapped else ", ").join(_value(part, inner=True) for part in value)
        return f"({text})" if inner else text
    return "none" if value is None else str(value)


def _style() -> str:
    """The style sheet, with the colours of both modes; print is always light."""
    return (
        f":root {{ color-scheme: light dark; {css_variables('light')} }}\n"
        f"@media screen and (prefers-color-scheme: dark) {{ :root {{ {css_variables('dark')} }} }}\n"
        f"{verdict_styles()}\n" + _text("static/style.css")
    )


def _text(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")
