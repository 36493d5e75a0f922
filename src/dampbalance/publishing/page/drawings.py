"""Figures as they stand in the page: matplotlib's SVG inline, in the page's colours, with the values behind its marks.

Letters, markers and clips come many times in all figures: a `Sheet` holds each once, and the drawings refer to it.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any
from xml.etree import ElementTree

from markupsafe import Markup, escape

from ...figures import style
from ...figures.looks import LOOKS, SPARE
from ...figures.numerics import THIRD
from ...figures.values import read_values
from ..colours import variable
from ..words import from_tex

_XLINK = "{http://www.w3.org/1999/xlink}href"
_OF_PRINT = {look.colour: look.series for look in (*SPARE, *LOOKS.values())} | {
    style.SLIP: "slip",
    style.FAINT: "muted",
    style.GRID: "rule",
    THIRD: SPARE[0].series,
    "#FFFFFF": "paper",
}
_VARIABLES = {colour.lower(): variable(name) for colour, name in _OF_PRINT.items()}
_VARIABLES[style.INK] = "currentColor"
_PLACE = re.compile(r"translate\(.*?\)")
_USUAL = {"stroke-dashoffset": "0", "stroke-linejoin": "round", "stroke-width": "1"}


@dataclass(frozen=True, slots=True)
class Drawing:
    """A figure of the page.

    name : unique on the page.   alt : what it shows, in a sentence.   box : the viewBox of the SVG.   inner : what
    stands in it.   tables : the values.
    """

    name: str
    alt: str
    box: str
    inner: Markup
    tables: tuple[Table, ...]


@dataclass(frozen=True, slots=True)
class Table:
    """The values of lines at the same places.

    title : what they are.   rows : tab-separated, below a head; a missing value is empty.   places : how to find a
    value on the drawing, for the script: the scale of the values and where the places lie.
    """

    title: Markup
    rows: Markup
    places: str


@dataclass
class Sheet:
    """What the drawings of a page share: outlines and words by their content, styles by their declarations."""

    outlines: dict[str, str] = field(default_factory=dict)
    styles: dict[str, str] = field(default_factory=dict)

    def outline(self, element: str) -> str:
        """The name of an element, given as SVG with NAME for it."""
        return self.outlines.setdefault(element, f"o{len(self.outlines)}")

    def style(self, declarations: str) -> str:
        """The class of a style."""
        return self.styles.setdefault(declarations, f"d{len(self.styles)}")

    @property
    def svg(self) -> Markup:
        """The definitions of all drawings."""
        named = (element.replace("NAME", name) for element, name in self.outlines.items())
        return Markup("".join(named))

    @property
    def css(self) -> str:
        """The styles of all drawings."""
        return "\n".join(f".{name} {{ {text} }}" for text, name in self.styles.items())

    def drawing(self, name: str, svg: str) -> Drawing:
        """A figure that `figures.style.save` wrote. Raises ValueError for a colour that the page has no name for."""
        root = ElementTree.fromstring(svg.replace("xmlns=", "xmlns:svg="))
        alt = next((e.text or "" for e in root.iter() if e.tag.endswith("}description")), "")
        file = _File(self)
        for one in (one for defs in root.iter("defs") for one in defs if "id" in one.attrib):
            file.define(one)
        inner = "".join(map(file.lean, root))
        box, tables = _rounded(root.attrib["viewBox"]), tuple(_tables(read_values(svg)))
        return Drawing(name, alt, box, Markup(inner), tables)


class _File:
    """One SVG on its way into the page. names : of its definitions → those of the sheet."""

    def __init__(self, sheet: Sheet) -> None:
        self.sheet = sheet
        self.names: dict[str, str] = {}

    def define(self, element: Any) -> None:
        """Put what other elements refer to into the sheet."""
        inner = "".join(map(self.lean, element))
        text = f'<{element.tag} id="NAME"{self.attributes(element, digits=2)}'
        text += f">{inner}</{element.tag}>" if inner else "/>"
        self.names[element.attrib["id"]] = self.sheet.outline(text)

    def lean(self, element: Any) -> str:
        """An element without what nobody sees, in the page's colours; words are put into the sheet."""
        if element.tag in ("metadata", "defs"):
            return ""
        inner = "".join(map(self.lean, element))
        attributes = self.attributes(element)
        if element.tag == "g" and not (attributes and inner):
            return inner
        if "scale(" in attributes and len(element) > 1:
            words = self.sheet.outline(f'<g id="NAME">{inner}</g>')
            return f'<use href="#{words}"{attributes}/>'
        return f"<{element.tag}{attributes}" + (f">{inner}</{element.tag}>" if inner else "/>")

    def attributes(self, element: Any, digits: int = 1) -> str:
        """The attributes of an element as text, its style as a class."""
        given = {key: value for key, value in element.attrib.items() if key not in ("id", "style")}
        if _XLINK in given:
            given = {"href": "#" + self.names[given.pop(_XLINK)[1:]], **given}
        if "clip-path" in given:
            given["clip-path"] = f"url(#{self.names[given['clip-path'][5:-1]]})"
        if moved := re.fullmatch(r"translate\(([-\d.]+) ([-\d.]+)\)", given.get("transform", "")):
            del given["transform"]  # a letter within a word
            places = zip("xy", (str(round(float(place))) for place in moved.groups()), strict=True)
            given |= {axis: place for axis, place in places if place != "0"}
        for key in given.keys() & {"d", "x", "y", "width", "height"}:
            given[key] = _rounded(given[key], digits)
        if "transform" in given:
            given["transform"] = _PLACE.sub(lambda m: _rounded(m[0]), given["transform"])
        if style := _declarations(element.attrib.get("style", "")):
            given["class"] = self.sheet.style(style)
        return "".join(f' {key}="{value}"' for key, value in given.items())


def _declarations(style: str) -> str:
    """A style in the colours of the page."""
    pairs = ((part.strip() for part in one.split(":")) for one in filter(None, style.split(";")))
    return "; ".join(f"{k}: {_colour(v)}" for k, v in pairs if _USUAL.get(k) != v)


def _colour(value: str) -> str:
    """A colour of print as the variable of the page's style."""
    if value.startswith("#") and value not in _VARIABLES:
        raise ValueError(f"the page has no variable for the colour {value}: name it in drawings.py")
    return _VARIABLES.get(value, value)


def _rounded(text: str, digits: int = 1) -> str:
    """Numbers in a path or a place with few decimals, and no spaces that it can do without."""
    text = re.sub(
        r"-?\d+\.\d+", lambda m: f"{float(m[0]):.{digits}f}".rstrip("0").rstrip("."), text
    )
    return re.sub(r"\s*([A-Za-z])\s*", r"\1", " ".join(text.split())).replace("-0 ", "0 ")


def _tables(panels: list[dict[str, Any]]) -> Iterator[Table]:
    """The values of all panels."""
    for panel in panels:
        what = " against ".join(filter(None, (panel["y"], panel["x"])))
        title = from_tex(", ".join(filter(None, (panel["title"], what))))
        for block in panel["blocks"]:
            lines = block["lines"]
            head = [panel["x"] or "what", *(name for name, _, _ in lines)]
            rows = zip(block["places"], *(values for _, values, _ in lines), strict=True)
            text = [map(from_tex, head), *(map(_cell, row) for row in rows)]
            places = {"up": panel["up"], "scale": panel["scale"], "at": [at for *_, at in lines]}
            if all(at == lines[0][2] for *_, at in lines):
                places["at"] = [lines[0][2]]
            told = {"x": str(from_tex(panel["x"])), "y": str(from_tex(panel["y"])), **places}
            yield Table(
                title,
                Markup("\n").join(Markup("\t").join(row) for row in text),
                json.dumps(told, ensure_ascii=False, separators=(",", ":")),
            )


def _cell(value: float | str | None) -> Markup:
    """A value or the name of a place."""
    if isinstance(value, str):
        return from_tex(value)
    return escape("" if value is None else f"{value:g}".replace("-", "−"))
