"""The report of an identification: one self-contained HTML file to read, print and hand on.

The templates have the layout and the fixed text; this module has the text that depends on the numbers.
"""

from __future__ import annotations

import base64
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import jinja2
from markupsafe import Markup

from .. import __version__
from ..figures.style import (
    COOL,
    DARK,
    GRID,
    INK,
    PAPER_COLOUR,
    follows_the_screen,
    in_one_column,
    lacking_glyphs,
    save,
    save_svg,
)
from ..findings.finding import Finding
from ..findings.words import phrase
from ..law.terms import term
from ..project.wording import (
    dotted,
    in_html,
    larger_by,
    listed,
    number_text,
    part,
    percent,
    plain_text,
    sentence,
    signed_percent,
    visible,
)
from ..records.coordinate import ROTATION, Coordinate
from .answer import DOUBTFUL, Answer
from .outputs import PICTURES, pictures_of
from .pictures import DPI
from .screen import (
    answer_in_words,
    answers_table,
    damping_of,
    interval_of,
    laws_table,
    measured_block,
    named,
    numbers,
    short,
    short_blocks,
    value_of,
    with_ties,
    worded_first,
)
from .sensitivities import FAULTS, told

if TYPE_CHECKING:
    from .result import Result

_COLOURS = {  # on paper, on a dark screen: contrast of text of at least 4.5 : 1
    "paper": (PAPER_COLOUR, DARK[PAPER_COLOUR]),
    "ink": (INK, DARK[INK]),
    "raised": (COOL, DARK[COOL]),
    "rule": (GRID, DARK[GRID]),
    "muted": ("#4F5966", "#AAB4C0"),
    "good": ("#1B6B2F", "#7FD494"),
    "doubt": ("#8A4B00", "#FFB066"),
    "bad": ("#A31515", "#FF9C94"),
}


def report(found: Result[Any], folder: Path | None = None) -> str:
    """Return the report: see `Result.report`.   folder : for the pictures as SVG and PNG."""
    with TemporaryDirectory() as unkept:
        pictures, noun = [], found.coordinate.noun
        nouns = {of: noun(of) for of in ("force", "displacement")}
        for name, picture in found.pictures.items():
            caption = PICTURES[found.basis.kind][name].format(**nouns)
            svg, png = (Path(folder or unkept, file) for file in pictures_of([name]))
            narrow = Path(unkept, f"narrow-{svg.name}")
            with lacking_glyphs():
                drawn = picture.drawn(found.coordinate)
                if folder is None:
                    save_svg(drawn, svg, caption, DPI)
                else:
                    save(drawn, svg, png, caption, DPI)
                save_svg(in_one_column(drawn), narrow, caption, DPI)
            texts = (file.read_text(encoding="utf-8") for file in (svg, narrow))
            pictures.append((*texts, caption, caption))
    files = [record.files or {} for record in found.records] or [{}] * len(found.sources)
    of, effects = found.sensitivities()
    return _page(
        "report",
        found,
        pictures=pictures,
        effects=effects,
        effects_of=of,
        files=dict(zip(found.sources, files, strict=True)),
    )


def notebook(found: Result[Any]) -> str:
    """Return what a notebook shows of a result: the screen, with its numbers as a table."""
    return _page("notebook", found, blocks=short_blocks(found, tabled=True))


def _page(template: str, found: Result[Any], **content: Any) -> str:
    """Return a page, or a part of one, as HTML.   content : variables of the template."""
    content |= {"version": __version__, "colours": _COLOURS, "found": found}
    content["levels"] = found.level_documents
    of = found.coordinate
    content |= {"unit": of.unit, "symbol": of.symbol, "key": of.key, "noun": of.noun}
    return _TEMPLATES.get_template(f"{template}.html.j2").render(**content)


def rich(text: str) -> Markup:
    """Return text as HTML, with symbols and options of the command typeset."""
    return Markup(re.sub(r"--[a-z][a-z-]*", r"<code>\g<0></code>", in_html(with_ties(text))))


_NAMES = {"K_z": "contact stiffness", "m": "mass", "f_n": "natural frequency"}
_NAMES |= {"zeta": "damping ratio"}


# --- text that depends on the numbers -------------------------------------------------------------


def _kind(answer: Answer) -> str:
    """Return the class of the paragraph on the answer: usable, doubtful or none."""
    words = {one.verdict for one in answer.verdicts.values()}
    return words.pop() if len(words) == 1 else DOUBTFUL


def _why(findings: Sequence[Finding], coordinate: Coordinate) -> str:
    """Return the first finding of a verdict in words, and whether there are others."""
    others = any(one.kind != findings[0].kind for one in findings)
    return worded_first(findings, coordinate) + " …" * others


def _names(sources: Sequence[str]) -> str:
    """Return the names of up to three records, or the number of more."""
    return f"{len(sources)} records" if len(sources) > 3 else listed([*map(short, sources)])


def _first_check(found: Result[Any], effects: Mapping[str, Mapping[str, float]]) -> list[str]:
    """Return the first checks: a sentence on the fault with the largest effect relative to an interval, unless all
    effects are smaller than their intervals, and the mass and frequency to compare with the rig."""
    felt = [("", 1.0)]
    for fault, shifts in effects.items():
        for symbol, p in found.answer.parameters.items():
            change, half = abs(shifts.get(symbol, math.nan)), p.within
            if half > 0.0 and math.isfinite(half) and math.isfinite(change):
                off = f"{found.coordinate.symbol(symbol)} is off by {larger_by(change)}"
                words = f"{told(found, FAULTS[fault].words)}, {off}, but its interval allows {part(half)} only"
                felt.append((f"check first: if {words}", change / half))
    return [*filter(None, [max(felt, key=lambda one: one[1])[0]]), *damping_of(found)[:1]]


PAGE = "howto/symptoms"
"""The page of the site with a section for each symptom."""


def address(page: str) -> str:
    """Return the address of the explanation of a symptom, relative to the first page of the site."""
    return f"{PAGE}.html#{page}"


def _explained(findings: Iterable[Finding]) -> list[str]:
    """Return a sentence with the addresses that explain findings on the site; none if there are none."""
    if not (names := [*dict.fromkeys(page for one in findings for page in one.pages)]):
        return []
    return [
        "how this looks in a record, what it does to each number and what to do: on the site (make docs), "
        f"{listed([*map(address, names)])}"
    ]


def _rig(found: Result[Any]) -> str:
    """Return the drawing of the rig that the options describe, SVG; empty for kinds without a drawing."""
    from ..figures.rig_drawings import LOAD_CELL, MOUNT, RELEASE, TO_GROUND, rigs  # slow to import

    kind, options = found.basis.kind, found.options
    if found.coordinate == ROTATION or kind not in ("forced", "ring-down"):
        return ""
    name = RELEASE if kind == "ring-down" else TO_GROUND
    name = LOAD_CELL if options.get("fixture_mass_kg") else name
    name = MOUNT if options.get("contact_to") == "base" else name
    with TemporaryDirectory() as folder:
        file = Path(folder, "rig.svg")
        save_svg(rigs(name), file, name)
        return file.read_text(encoding="utf-8")


def _setting(value: Any) -> str:
    if isinstance(value, list | tuple):
        return ", ".join(map(_setting, value))
    if isinstance(value, bool):
        return "yes" if value else "no"
    return visible(f"{value:.10g}" if isinstance(value, float) else str(value))


_TEMPLATES = jinja2.Environment(
    loader=jinja2.PackageLoader("dampbalance.identification"),
    autoescape=True,
    undefined=jinja2.StrictUndefined,
    extensions=["jinja2.ext.do"],
    trim_blocks=True,
    lstrip_blocks=True,
    keep_trailing_newline=True,
)
_TEMPLATES.filters |= {
    **{of.__name__: of for of in (phrase, plain_text, rich, sentence, short, visible)},
    "base64": lambda svg: base64.b64encode(follows_the_screen(svg).encode()).decode(),
    "names": _names,
    "value": value_of,
    "interval": interval_of,
    "part": part,
    "words": lambda symbol: _NAMES.get(symbol) or term(symbol).words,
    "figures": lambda value: number_text(value, 4),
    "percent": percent,
    "change": lambda share: signed_percent(0.01 * round(100.0 * share, 3)),
    "setting": _setting,
}
_TABLES = (answers_table, laws_table, measured_block, numbers)
_WORDS = (answer_in_words, dotted, named, told, _explained, _first_check, _kind, _why)
_TEMPLATES.globals |= {of.__name__.removeprefix("_"): of for of in (*_TABLES, *_WORDS, _rig)}
_TEMPLATES.globals |= {"FAULTS": FAULTS, "nan": math.nan, "inf": math.inf}
