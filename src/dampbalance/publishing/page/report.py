"""The page: all results of a case in one HTML file that needs nothing else.

`report_page` makes it from a `PageContent`, the same bytes for the same results.
"""

from __future__ import annotations

import base64
import html
import posixpath
import re
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import quote

import jinja2
import pandas as pd
from markupsafe import Markup

from ... import __version__
from ...balance import TERMS
from ...figures.looks import label_of
from ...figures.style import follows_the_screen
from ...project import wording
from ...project.case import Case
from ...project.documents import read_yaml
from ...project.wording import minus, number_text, unit_text
from ...replication.claims import verdicts as judged
from ...replication.comparison import WAY, approaches_table, error_text, mends, off_resonance
from ...replication.numbers import Numbers
from ...replication.rebuilt_tables import SHOWN_ROUTES, TITLES, blocks, paper_tables
from ...studies.study_file import Study
from .. import typesetting
from ..colours import css_variables
from .instruments import instruments_data, slider_controls

LARGEST_PAGE = 3_500_000  # bytes: a page that a phone loads in seconds
STATIC = Path(__file__).with_name("static")
STYLES = ("style.css", "instruments.css")
SCRIPTS = (*("page.js", "engine.js", "kit.js"), *("oscillator.js", "off_resonance.js"))

_POWER = re.compile(r"\b(\d[\d.]*)[eE]([-+]?\d+)\b")
_METADATA = re.compile("<metadata.*?</metadata>", re.DOTALL)
_DESCRIPTION = "<dc:description>(.*?)</dc:description>"
# what an attribute in single quotes and a data URL both take as it is; % and # would end or change the latter
_IN_A_URL = ' "<>=/:;,.()[]{}!@*+-_~?'


@dataclass(frozen=True)
class PageContent:
    """Content of the page.

    case : as configured.   config : the merged configuration, to be listed.
    numbers : of all routes, with what is printed, if anything is (`numbers.with_claims`).
    claims : `claims.csv` as text, or None for a case with nothing printed.
    figures : name → SVG by `figures.style.save`: figure3, estimation_error, and where something is printed glance and
    numerics.
    derived : id → value of derived.csv as text, {} for a case with nothing printed.
    studies : (study, its figure as SVG).   study_folder : the folder of their results.
    """

    case: Case
    config: Mapping[str, Any]
    numbers: Numbers
    claims: pd.DataFrame | None
    figures: Mapping[str, str]
    derived: Mapping[str, str] = field(default_factory=dict)
    studies: Sequence[tuple[Study, str]] = ()
    study_folder: str = "results/studies"


ORIGINS: dict[str, dict[str, Any]] = read_yaml(
    Path(__file__).with_name("templates") / "origins.yaml"
)
"""Origins of the results on the page, as that file explains."""


def report_page(content: PageContent, page: str) -> str:
    """Return the page as HTML. page : where it will stand, as a path from the repository's root, for its links.

    Warns where it is larger than LARGEST_PAGE.
    """
    case, frequencies, numbers = content.case, content.case.frequencies_hz, content.numbers
    approaches = approaches_table(numbers, frequencies)
    printed = (
        pd.DataFrame() if content.claims is None else content.claims.set_index("id", drop=False)
    )
    claims = printed.to_dict("index")
    counted = judged.counts(printed) if claims else []
    tables = (
        [(TITLES[n], list(_parts(table, claims))) for n, table in paper_tables(numbers, of).items()]
        for of in frequencies
    )
    figures = {name: _figure(f"drawing-{name}", svg) for name, svg in content.figures.items()}
    studies = {study.name: _study(content, study, svg) for study, svg in content.studies}
    template = _environment(case.name, page).get_template("report.html.j2")
    page_html = template.render(
        version=__version__,
        case=case.name,
        page=page,
        counts=counted,
        total=counted[-1] if claims else None,
        judged=judged,
        claims=claims,
        frequencies=[
            {"name": wording.frequency_name(name), "hz": f"{hz:g}", "tables": shown}
            for (name, hz), shown in zip(frequencies.items(), tables, strict=True)
        ],
        terms=list(TERMS),
        errors=[
            (key, rows.to_dict("records"))
            for key, rows in approaches.groupby(list(WAY), sort=False)
        ],
        costs=off_resonance(approaches, frequencies),
        mends=mends(approaches, frequencies),
        figures=figures,
        studies=studies,
        origins=ORIGINS,
        configuration=wording.dotted(content.config),
        derived=content.derived,
        css_variables=css_variables,
        style="".join(map(_static, STYLES)),
        script="\n".join(map(_static, SCRIPTS)),
        engine=base64.b64encode((STATIC / "engine.wasm").read_bytes()).decode(),
        sliders=slider_controls(case),
        instruments=instruments_data(case),
    )
    size = len(page_html.encode())
    if size > LARGEST_PAGE:
        warnings.warn(
            f"{page} has {size:,} bytes, more than the {LARGEST_PAGE:,} that a phone loads in seconds: show fewer "
            "studies, or coarser ones",
            stacklevel=2,
        )
    return page_html


def _parts(
    table: pd.DataFrame, claims: Mapping[Any, Mapping[Any, Any]]
) -> Iterator[dict[str, Any]]:
    """Yield a table as the paper lays it out, in parts whose rows share their quantities.

    columns : (symbol, unit) each.
    groups : a row's label and its lines, (route, cells) each, the printed one first where there is one; a cell is its
    text, and for a printed number the verdict and the claim that gives the reason.

    table : of `rebuilt_tables.paper_tables`.
    claims : id → row of the table of claims, from which the cells take their digits on the way, {} for none.
    """

    def text(cell: Mapping[Any, Any], route: str) -> str:
        return _typeset(claims.get(cell["id"], {}).get(route) or number_text(cell[route]))

    for quantities, block in blocks(table):
        groups = []
        for label, rows in block.groupby("row", sort=False):
            cells = rows.to_dict("records")
            printed = [
                (_typeset(c["printed"]), judged.VERDICTS.get(c["verdict"]), c["id"]) for c in cells
            ]
            lines = [("printed", printed)] if any(of for of, *_ in printed) else []
            for route in SHOWN_ROUTES:
                lines.append(
                    (judged.ROUTE_NAMES[route], [(text(c, route), None, "") for c in cells])
                )
            groups.append((label, lines))
        columns = list(zip(quantities, map(unit_text, block["unit"]), strict=False))
        yield {"columns": columns, "groups": groups}


def _study(content: PageContent, study: Study, svg: str) -> dict[str, Any]:
    """Return the figure of a study with its paragraph: the first sentence, and the rest."""
    name = study.name.replace("_", "-")
    first, _, more = content.derived[f"study.{study.name}.paragraph"].partition(". ")
    cases = f"{content.study_folder}/{study.name}/cases.parquet"
    files = (cases, f"config/studies/{study.name}.yaml")
    return {
        **{"title": study.title, "first": f"{first}.", "more": more},
        "figure": _figure(f"study-{name}", svg),
        "origin": ORIGINS["studies"] | {"results": files},  # its file says what is varied
    }


def _figure(name: str, svg: str) -> dict[str, Any]:
    """Return a figure that `figures.style.save` wrote, for the page.

    name : unique on the page.   alt : what it shows, in a sentence.   wide : its width, points.
    source : the SVG as drawn, without its metadata, as a data URL for an attribute in single quotes.
    """
    alt, box = (re.search(what, svg, re.DOTALL) for what in (_DESCRIPTION, 'viewBox="([^"]*)"'))
    drawn = follows_the_screen(_METADATA.sub("", svg[svg.index("<svg") :]))
    return {
        "name": name,
        "alt": html.unescape(alt[1]) if alt else "",
        "wide": box[1].split()[2] if box else "",
        # base64 would be a third larger; a URL loses its line ends
        "source": Markup(f"data:image/svg+xml,{quote(' '.join(drawn.split()), safe=_IN_A_URL)}"),
    }


def _environment(case: str, page: str) -> jinja2.Environment:
    """Return the templates with their filters; an undefined name is an error."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader(__package__),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    compact = {"ensure_ascii": False, "allow_nan": False, "separators": (",", ":")}
    environment.policies["json.dumps_kwargs"] = compact
    environment.filters |= {
        "rich": typesetting.rich_markup,
        "titled": typesetting.titled,
        "quantity": typesetting.quantity_markup,
        "reason": typesetting.reason,
        "symbol": typesetting.symbol,
        "minus": _typeset,
        "here": lambda path: posixpath.relpath(path.format(case=case), posixpath.dirname(page)),
        "at_case": lambda path: path.format(case=case),
        "approach": lambda key: typesetting.rich_markup(label_of(key)),
        "bound": lambda error: f"{wording.power_of_ten(float(error))} %",
        "significant": lambda value, digits: number_text(float(value), digits),
        "unit": unit_text,
        "part": lambda claim: judged.PARTS_OF_THE_PAPER[judged.part_of(claim)],
        "error": lambda error, plus="+": error_text(error, plus).removesuffix(" %"),
    }
    return environment


def _typeset(text: str) -> str:
    """Return text whose numbers have a true minus sign, and powers of ten as printed: 2.9E-3 is 2.9·10⁻³."""
    return minus(_POWER.sub(lambda of: wording.scientific(of[1], int(of[2])), text))


def _static(name: str) -> str:
    return (STATIC / name).read_text(encoding="utf-8")
