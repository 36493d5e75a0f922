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


@dataclass
class Sheet:
    """What the drawings of a page share: outlines and words (SVG, with NAME for the name) and styles → their names.

    names : of the definitions in the file that is being drawn → those here.
    """

    outlines: dict[str, str] = field(default_factory=dict)
    styles: dict[str, str] = field(default_factory=dict)
    names: dict[str, str] = field(default_factory=dict)

    @property
    def svg(self) -> Markup:
        """The definitions of all drawings."""
        return Markup("".join(one.replace("NAME", name) for one, name in self.outlines.items()))

    @property
    def css(self) -> str:
        """The styles of all drawings."""
        return "\n".join(f".{name} {{ {text} }}" for text, name in self.styles.items())

    def drawing(self, name: str, svg: str) -> dict[str, Any]:
        """A figure that `figures.style.save` wrote, for the page.

        name : unique on the page.   alt : what it shows, in a sentence.   box : the viewBox of the SVG.
        inner : the elements in it.   tables : the values.   Raises ValueError for a colour without a name on the page.
        """
        root = ElementTree.fromstring(svg.replace("xmlns=", "xmlns:svg="))
        self.names = {}
        for one in (one for defs in root.iter("defs") for one in defs if "id" in one.attrib):
            self._define(one)
        return {
            "name": name,
            "alt": next((e.text or "" for e in root.iter() if e.tag.endswith("}description")), ""),
            "inner": Markup("".join(map(self._lean, root))),
            "box": _rounded(root.attrib["viewBox"]),
            "tables": list(_tables(read_values(svg))),
        }

    def _named(self, element: str) -> str:
        return self.outlines.setdefault(element, f"o{len(self.outlines)}")

    def _define(self, element: Any) -> None:
        """Put what other elements refer to into the sheet."""
        inner = "".join(map(self._lean, element))
        text = f'<{element.tag} id="NAME"{self._attributes(element, digits=2)}'
        text += f">{inner}</{element.tag}>" if inner else "/>"
        self.names[element.attrib["id"]] = self._named(text)

    def _lean(self, element: Any) -> str:
        """An element without what nobody sees, in the page's colours; words are put into the sheet."""
        if element.tag in ("metadata", "defs"):
            return ""
        inner = "".join(map(self._lean, element))
        attributes = self._attributes(element)
        if element.tag == "g" and not (attributes and inner):
            return inner
        if "scale(" in attributes and len(element) > 1:
            words = self._named(f'<g id="NAME">{inner}</g>')
            return f'<use href="#{words}"{attributes}/>'
        return f"<{element.tag}{attributes}" + (f">{inner}</{element.tag}>" if inner else "/>")

    def _attributes(self, element: Any, digits: int = 1) -> str:
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
            given["class"] = self.styles.setdefault(style, f"d{len(self.styles)}")
        return "".join(f' {key}="{value}"' for key, value in given.items())


def _declarations(style: str) -> str:
    """A style in the colours of the page, each as the variable of its style sheet."""
    pairs = ((part.strip() for part in one.split(":")) for one in filter(None, style.split(";")))
    kept = [(key, value) for key, value in pairs if _USUAL.get(key) != value]
    if lost := [v for _, v in kept if v.startswith("#") and v not in _VARIABLES]:
        raise ValueError(
            f"the page has no variable for the colour {lost[0]}: name it in drawings.py"
        )
    return "; ".join(f"{key}: {_VARIABLES.get(value, value)}" for key, value in kept)


def _rounded(text: str, digits: int = 1) -> str:
    """Numbers in a path or a place with few decimals, and no spaces that it can do without."""
    text = re.sub(
        r"-?\d+\.\d+", lambda m: f"{float(m[0]):.{digits}f}".rstrip("0").rstrip("."), text
    )
    return re.sub(r"\s*([A-Za-z])\s*", r"\1", " ".join(text.split())).replace("-0 ", "0 ")


def _tables(panels: list[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """The values of all panels: a table for the lines at the same places.

    title : what they are.   rows : tab-separated, below a head; a missing value is empty.   places : how to find a
    value on the drawing, for the script: the scale of the values and where the places lie.
    """
    for panel in panels:
        what = " against ".join(filter(None, (panel["y"], panel["x"])))
        labels = {axis: str(from_tex(panel[axis])) for axis in "xy"}
        for block in panel["blocks"]:
            names, values, at = zip(*block["lines"], strict=True)
            rows = [[panel["x"] or "what", *names], *zip(block["places"], *values, strict=True)]
            at = at[:1] if all(one == at[0] for one in at) else at
            places = {**labels, "up": panel["up"], "scale": panel["scale"], "at": at}
            yield {
                "title": from_tex(", ".join(filter(None, (panel["title"], what)))),
                "rows": Markup("\n").join(Markup("\t").join(map(_cell, row)) for row in rows),
                "places": json.dumps(places, ensure_ascii=False, separators=(",", ":")),
            }


def _cell(value: float | str | None) -> Markup:
    """A value or the name of a place."""
    if isinstance(value, str):
        return from_tex(value)
    return escape("" if value is None else f"{value:g}".replace("-", "−"))
