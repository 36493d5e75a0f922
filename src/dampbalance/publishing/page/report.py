"""The page: all results of a case in one HTML file that needs nothing else.

`report_page` makes it from a `PageContent`, the same bytes for the same results.
"""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from importlib.resources import files
from typing import Any

import jinja2
import pandas as pd
from markupsafe import Markup

from ... import __version__
from ...balance import TERMS
from ...figures.looks import label_of
from ...project.wording import (
    MINUS,
    NONE,
    dotted,
    frequency_name,
    minus,
    number,
    percent,
    power_of_ten,
    unit_of,
)
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
from ...replication.comparison import mends, off_resonance
from ...replication.printed_tables import TITLES
from ...studies.settings import Study
from ...studies.shown.facts import filled
from .. import words
from ..colours import css_variables, verdict_styles
from .cells import subtables
from .content import PageContent
from .drawings import Sheet
from .instruments import instruments_data
from .origins import ORIGINS, link, study_origin

TITLE = "How the printed numbers of an energy balance fare"
LARGEST_PAGE = 1_500_000  # bytes: a page that a phone loads
TITLE_OF_CASE = "Friction and damping from an energy balance"
HEADLINE_OF_CASE = (
    "Friction and viscous damping of a driven oscillator from the balance of energy over a period."
)
SCRIPTS = (
    *("page.js", "engine.js", "kit.js"),
    *("oscillator.js", "off_resonance.js", "integrator.js", "noise.js", "digits.js"),
)
SECTIONS = {
    "findings": "Findings",
    "instruments": "Instruments",
    "match": "Match",
    "numbers": "Every number",
    "tables": "Tables",
    "digits": "Digits",
    "figure3": "Figure 3",
    "errors": "Off resonance",
    "studies": "Studies",
    "noise": "Noise",
    "conclusion": "Conclusion",
    "provenance": "Sources",
}


def report_page(content: PageContent, page: str) -> str:
    """The page as HTML. page : where it will stand, as a path from the repository's root, for its links.

    Raises ValueError where it would become larger than LARGEST_PAGE.
    """
    case, frequencies = content.case.name, content.case.frequencies_hz
    tables = _paper_tables(content)
    shown = _numbers(content, next(iter(tables.values()))) | _drawings(content)
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
        evidence=content.evidence,
        facts=content.facts,
        style=_style(),
        **_instruments(content),
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


def _drawings(content: PageContent) -> dict[str, Any]:
    """The figures, those of the studies with what they show in words, and what they share."""
    sheet = Sheet()
    figures = {name: sheet.drawing(f"drawing-{name}", svg) for name, svg in content.figures.items()}
    studies = {
        study.name: {
            "name": study.name.replace("_", "-"),
            "title": study.title,
            "paragraph": filled(study, content.facts[study.name]),
            "figure": sheet.drawing(f"study-{study.name.replace('_', '-')}", svg),
            "origin": study_origin(study.name),
        }
        for study, svg in content.studies
    }
    noise = studies.pop("noise", None)
    return {"figures": figures, "studies": studies.values(), "noise": noise, "sheet": sheet}


def _instruments(content: PageContent) -> dict[str, Any]:
    """The scripts, and what the instruments need: the engine as base64, and their data as JSON."""
    static = files(__package__) / "static"
    scripts = [static / name for name in SCRIPTS if (static / name).is_file()]
    shown: dict[str, Any] = {"script": "\n".join(one.read_text("utf-8") for one in scripts)}
    shown["engine"] = base64.b64encode((static / "engine.wasm").read_bytes()).decode()
    shown["printed"] = content.claims is not None
    shown["misprints"] = shown["printed"] and content.digits is not None
    return shown | {"instruments": as_json(instruments_data(content))}


def as_json(data: Any) -> str:
    """Data to stand in a script element: compact, and without anything that could end it."""
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return text.replace("</", "<\\/").replace("<!--", "<\\u0021--")


def _provenance(content: PageContent) -> dict[str, Any]:
    """The sections that there are, where each comes from, and the configuration."""
    absent = {name for name in ("studies", "noise") if name not in _kinds(content.studies)}
    if content.claims is None:
        absent |= {"claims", "match", "numbers", "digits", "findings", "conclusion"}
    return {
        "sections": [(name, title) for name, title in SECTIONS.items() if name not in absent],
        "origins": ORIGINS,
        "all_origins": [origin for name, origin in ORIGINS.items() if name not in absent],
        "configuration": [(key, _value(value)) for key, value in dotted(content.config)],
    }


def _kinds(studies: Sequence[tuple[Study, str]]) -> set[str]:
    """The sections that studies fill."""
    return {"noise" if study.name == "noise" else "studies" for study, _ in studies}


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
        "bound": lambda error: f"{power_of_ten(error)} %",
        "significant": number,
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
        f"solution and {reconstructed} by reconstructing how they were computed; the others: {others}, and "
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
        f"{verdict_styles()}\n" + _text("static/style.css") + _text("static/instruments.css")
    )


def _text(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")
