"""Charts: Vega-Lite specifications that follow light and dark by themselves, and a still picture of each.

A `Chart` is one panel. Its data are the rows of a table, kept as CSV and shared by the panels of a figure; the page's
script puts them in, marks the row under the pointer or chosen by the keyboard (parameter `cursor`, field `i`), and
says its values. The still picture is there before the script has run, without it, and in print.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any, Literal

import numpy as np
import vl_convert
from numpy.typing import NDArray

from ...arrays import Array, Mask
from ...figures.series import SignedScale
from .colours import variable
from .legend import Entry
from .words import titled

Spec = dict[str, Any]
Scale = Literal["linear", "log", "symlog"]

VERSION = "6.4"  # of Vega-Lite, in vl-convert's bundle
# px: a panel of a still picture; on the page a panel is as wide as its column.
WIDTH, HEIGHT = 340, 230
OFF = 0.15  # px: how far a curve of a still picture may lie off; on the page, the script draws every point
DIGITS = 5  # significant, of data: what a hovered value shows at most
FONT = "system-ui, 'Segoe UI', Roboto, 'Helvetica Neue', 'DejaVu Sans', sans-serif"

CONFIG: Spec = {
    "background": "transparent",
    "font": FONT,
    "view": {"stroke": variable("edge"), "strokeWidth": 0.8},
    "axis": {
        "labelColor": variable("muted"),
        "labelFontSize": 11.5,
        "tickColor": variable("edge"),
        "domain": False,
        "gridColor": variable("rule"),
        "gridWidth": 0.6,
        "labelOverlap": "greedy",
    },
    "text": {"color": variable("ink"), "fontSize": 11.5},
}
"""Looks that all charts share; sent once, not with every chart."""


@dataclass(frozen=True, slots=True)
class Value:
    """One value that a chart says of a row: the column it stands in, its name as for `words.titled`, and its unit."""

    column: str
    name: str
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of data by their columns; numbers keep DIGITS digits, words stay."""

    id: str
    columns: Mapping[str, Sequence[Any] | NDArray[Any]]
    digits: Mapping[str, int] = field(default_factory=dict)  # of columns that need more

    @property
    def csv(self) -> str:
        """The rows, with their number in front, column `i`."""
        cells = [
            [_short(value, self.digits.get(name, DIGITS)) for value in values]
            for name, values in self.columns.items()
        ]
        lines = (f"{i}," + ",".join(row) for i, row in enumerate(zip(*cells, strict=True)))
        return "\n".join([",".join(["i", *self.columns]), *lines])


@dataclass(frozen=True, slots=True)
class Axis:
    """One axis: the column drawn along it, its title as for `words.titled`, scale and limits."""

    column: str
    title: str
    scale: Scale = "linear"
    limits: tuple[float, float] | None = None
    labels: Sequence[str] | None = None  # of the places 0, 1, 2 …, where numbers mean nothing
    signed: SignedScale | None = None  # of a symlog axis

    def encoding(self, channel: str, still: bool = False) -> Spec:
        """The position channel, x or y, of Vega-Lite; where nothing moves, a logarithmic axis has only named ticks."""
        scale: Spec = {"type": self.scale, "nice": False}
        if self.scale == "linear":
            scale["zero"] = False
        if self.limits:
            scale["domain"] = [float(f"{limit:.9g}") for limit in self.limits]
        axis: Spec = {"title": None, "tickCount": 6}  # the page writes it, where symbols can be set
        if self.labels is not None:
            names = json.dumps(list(self.labels), ensure_ascii=False)
            axis |= {"values": list(range(len(self.labels)))}
            axis |= {"labelExpr": f"{names}[datum.value]", "grid": False}
        elif self.scale == "log":
            seen = {"condition": {"test": _IS_POWER, "value": 1}, "value": 0}
            axis |= {"labelExpr": _LOG_LABEL.replace("CHANNEL", channel), "gridOpacity": seen}
        elif self.signed:
            scale["constant"] = self.signed.linear / 9.0  # to ±linear as far as a decade
            ticks = self.signed.ticks
            axis |= {"values": ticks, "tickCount": len(ticks), "labelExpr": _SIGNED_LABEL}
        if still and self.scale == "log" and self.limits:
            axis |= {"values": _named_ticks(*self.limits)}
        return {**quantitative(self.column), "scale": scale, "axis": axis}


# A tick of a logarithmic axis is named if it is a power of ten, and 2 and 5 times one where under two decades are seen;
# as a number from 0.001 to 1000, with its power of ten beyond.
_POWER = "floor(log(datum.value) / LN10 + 1e-9)"
_LEAD = f"round(datum.value / pow(10, {_POWER}))"
_IS_POWER = f"{_LEAD} == 1"
_RAISED = "substring('⁰¹²³⁴⁵⁶⁷⁸⁹', {0}, {0} + 1)"
_LOG_LABEL = (
    f"{_LEAD} != 1 && (domain('CHANNEL')[1] / domain('CHANNEL')[0] >= 100 || indexof([2, 5], {_LEAD}) < 0) ? '' : "
    "datum.value > 0.00099 && datum.value < 1001 ? format(datum.value, '~r') : "
    f"({_LEAD} == 1 ? '' : {_LEAD} + '·') + '10' + ({_POWER} < 0 ? '⁻' : '') + "
    f"(abs({_POWER}) > 9 ? {_RAISED.format(f'floor(abs({_POWER}) / 10)')} : '') + "
    f"{_RAISED.format(f'abs({_POWER}) % 10')}"
)


_SIZE = "round(log(abs(datum.value)) / LN10)"
_SIGNED_LABEL = (
    f"datum.value == 0 ? '0' : (datum.value < 0 ? '−' : '') + ({_SIZE} > -4 && {_SIZE} < 4 ? "
    f"format(abs(datum.value), '~r') : '10' + ({_SIZE} < 0 ? '⁻' : '') + {_RAISED.format(f'abs({_SIZE})')})"
)


def signed_axis(column: str, title: str, scale: SignedScale) -> Axis:
    """An axis of errors of either sign, logarithmic beyond a linear part around zero."""
    return Axis(column, title, "symlog", (scale.low, scale.high), signed=scale)


def _named_ticks(low: float, high: float) -> list[float]:
    """Powers of ten between two limits, and 2 and 5 times them where there are less than two decades."""
    decades_seen = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    leads = (1, 2, 5) if high / low < 100.0 else (1,)
    ticks = (float(f"{lead}e{power}") for power in decades_seen for lead in leads)
    return [tick for tick in ticks if low * (1.0 - 1e-9) <= tick <= high * (1.0 + 1e-9)]


@dataclass(frozen=True, slots=True)
class Chart:
    """One panel.

    title : what it shows, as its heading, as for `words.titled`.   says : the values told of a row.
    nearest : which row is meant by a place of the pointer: the one nearest along x, or nearest on the picture.
    layers : without the cursor.   legend : of this chart alone.   remark : what it tells, as for `words.titled`.
    """

    id: str
    title: str
    description: str
    table: Table
    x: Axis
    y: Axis
    layers: tuple[Spec, ...]
    says: tuple[Value, ...]
    nearest: Literal["x", "xy"] = "x"
    legend: tuple[Entry, ...] = ()
    remark: str = ""

    @property
    def spec(self) -> Spec:
        """The specification that the page's script draws: zoom bound to the scales, and the cursor."""
        first, *others = self.layers
        grid = {"name": "grid", "select": _ZOOM, "bind": "scales"}
        return {
            **self._frame(),
            "width": "container",
            "height": HEIGHT,
            "params": [{"name": "cursor", "value": -1}],
            "layer": [{**first, "params": [grid]}, *others, *self._cursor()],
            "usermeta": {
                "table": self.table.id,
                "x": self.x.column,
                "y": self.y.column,
                "nearest": self.nearest,
                "says": [[value.column, titled(value.name), value.unit] for value in self.says],
            },
        }

    @property
    def still(self) -> str:
        """The chart as SVG, without zoom and cursor; names inside it are its own."""
        spec = {
            **self._frame(still=True),
            "width": WIDTH,
            "height": HEIGHT,
            "data": {"values": self.table.csv, "format": {"type": "csv", "parse": self._parse}},
            "layer": list(self.layers),
            "config": CONFIG,
        }
        return _lean(_drawn(json.dumps(spec)), self.id)

    def _frame(self, still: bool = False) -> Spec:
        """What both have in common."""
        return {
            "description": self.description,
            "autosize": {"type": "fit-x", "contains": "padding"},
            "data": {"name": "rows"},
            "encoding": {"x": self.x.encoding("x", still), "y": self.y.encoding("y", still)},
        }

    @property
    def _parse(self) -> dict[str, str]:
        """Columns that hold numbers."""
        numeric = (n for n, v in self.table.columns.items() if np.asarray(v).dtype.kind in "fiu")
        return {"i": "number", **dict.fromkeys(numeric, "number")}

    def _cursor(self) -> list[Spec]:
        """The row that is spoken of: a line across the curves, or a ring around the point."""
        here = [{"filter": "datum.i === cursor"}]
        if self.nearest == "x":
            line: Spec = {"type": "rule", "color": variable("focus"), "strokeWidth": 1.4}
            return [{"transform": here, "mark": line, "encoding": _ACROSS}]
        ring: Spec = {"type": "point", "size": 150, "color": variable("focus"), "strokeWidth": 2}
        ring |= {"filled": False, "clip": True, "tooltip": None}
        return [{"transform": here, "mark": ring}]


@dataclass(frozen=True, slots=True)
class ChartSet:
    """Charts that share a legend and a remark.

    legend : what their lines and marks stand for.   exact : approach → bound of its error, %, of those not drawn.
    """

    charts: tuple[Chart, ...]
    legend: tuple[Entry, ...] = ()
    exact: Mapping[str, str] = field(default_factory=dict)


_ACROSS: Spec = {"y": {"value": 0}, "y2": {"value": "height"}}  # from edge to edge of the panel

# The wheel scrolls the page; with Ctrl (or a pinch) it zooms. A drag moves, a double click resets.
_WHEEL = "wheel![event.ctrlKey || event.metaKey]"
_ZOOM: Spec = {"type": "interval", "zoom": _WHEEL, "clear": "dblclick"}


def nominal(column: str) -> Spec:
    """A column of words, as a channel."""
    return {"field": column, "type": "nominal"}


def quantitative(column: str) -> Spec:
    """A column of numbers, as a channel."""
    return {"field": column, "type": "quantitative"}


def coded(column: str, codes: Mapping[str, str]) -> Spec:
    """A column of words, each shown by its colour or shape; the page has legends of its own."""
    scale = {"domain": list(codes), "range": list(codes.values())}
    return {**nominal(column), "scale": scale, "legend": None}


NAMED: Spec = {"encoding": {"text": nominal("name")}}
"""Encoding of a layer of text that writes the column `name`."""


def curve(column: str, colour: str, width: float = 1.4, dashed: bool = False) -> Spec:
    """A layer: one curve over x, interrupted where a value is missing."""
    mark: Spec = {"type": "line", "color": colour, "strokeWidth": width, "clip": True}
    mark["invalid"] = "break-paths-show-domains"
    if dashed:
        mark["strokeDash"] = [5, 3]
    return {"mark": mark, "encoding": {"y": quantitative(column)}}


def with_points(layer: Spec) -> Spec:
    """The curve with a mark at each value."""
    mark = layer["mark"]
    point = {"filled": True, "size": 34, "fill": variable("paper"), "stroke": mark["color"]}
    return {**layer, "mark": {**mark, "point": point | {"strokeWidth": 1.4, "opacity": 1}}}


def dots(column: str, colour: str, shape: str, size: int = 52, filled: bool = True) -> Spec:
    """A layer: a mark at each value, none where it is missing."""
    mark: Spec = {"type": "point", "shape": shape, "size": size, "opacity": 1, "clip": True}
    mark |= {"stroke": colour, "strokeWidth": 1.6, "fill": colour if filled else variable("paper")}
    return {"mark": mark, "encoding": {"y": quantitative(column)}}


def at_height(value: float, colour: str) -> Spec:
    """A layer: a dotted line across the panel at a value of y."""
    line = {"type": "rule", "color": colour, "strokeDash": [2, 3], "strokeWidth": 1.4, "clip": True}
    place = {"y": quantitative("at"), "x": {"value": 0}, "x2": {"value": "width"}}
    return {"data": {"values": [{"at": value}]}, "mark": line, "encoding": place}


def mark_at(value: float, name: str, at_end: bool) -> list[Spec]:
    """Layers: a dotted line across the panel at a place on x, and its name at the lower end."""
    data = {"data": {"values": [{"at": value, "name": name}]}}
    place: Spec = {"x": quantitative("at"), "y": {"value": "height"}}
    line = {"type": "rule", "color": variable("muted"), "strokeDash": [2, 3], "strokeWidth": 1}
    side, shift = ("right", -4) if at_end else ("left", 4)
    words = {"type": "text", "align": side, "baseline": "bottom", "dx": shift, "dy": -4}
    words |= {"color": variable("muted"), "clip": True}
    return [
        {**data, "mark": {**line, "clip": True}, "encoding": {"x": place["x"], **_ACROSS}},
        {**data, "mark": words, "encoding": {**place, "text": {"field": "name"}}},
    ]


def runtime() -> str:
    """Vega, Vega-Lite and Vega-Embed as one script, to stand inside the page."""
    bundle: str = vl_convert.javascript_bundle("window.vegaEmbed = vegaEmbed;", vl_version=VERSION)
    return bundle.replace("</script", "<\\/script").replace("<!--", "<\\!--")


def as_json(data: Any) -> str:
    """Data to stand in a script element: compact, and without anything that could end it."""
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return text.replace("</", "<\\/").replace("<!--", "<\\u0021--")


def _short(value: Any, digits: int) -> str:
    """A cell of CSV."""
    if isinstance(value, (float, np.floating)):
        return f"{value:.{digits}g}" if math.isfinite(value) else ""
    return str(value)


@cache
def _drawn(spec: str) -> str:
    """The picture of a specification, as Vega draws it."""
    return str(vl_convert.vegalite_to_svg(spec, vl_version=VERSION))


def _lean(svg: str, name: str) -> str:
    """The picture without what a style sheet says or nobody sees; its names are its own, its curves good to OFF px."""
    clips = {old: n for n, old in enumerate(dict.fromkeys(re.findall(r"\bclip\d+\b", svg)))}
    svg = re.sub(r"\bclip\d+\b", lambda m: f"{name}-clip{clips[m[0]]}", svg)  # numbered by process
    svg = re.sub(r' (?:aria-[a-z]+|role|class|pointer-events|font-family)="[^"]*"', "", svg)
    svg = re.sub(r' (?:opacity|stroke-width)="1"| [xy]2="0"', "", svg)
    svg = re.sub(r'<path[^>]* d="(?:M0,0h0v0h0Z)?"[^>]*/>|<text[^>]*/>', "", svg)
    svg = re.sub(r' d="(M[-\d.]+,[-\d.]+(?:[ML][-\d.]+,[-\d.]+)*)"', _thinned, svg)
    svg = re.sub(r' (?:d|transform|x2|y2)="[^"]*"', lambda m: _tenths(m[0]), svg)
    while re.search(r"<g(?: transform=\"translate\(0,0\)\")?></g>", svg):
        svg = re.sub(r"<g(?: transform=\"translate\(0,0\)\")?></g>", "", svg)
    return svg.replace(
        ' xmlns:xlink="http://www.w3.org/1999/xlink" version="1.1"', ' aria-hidden="true"'
    )


def _tenths(text: str) -> str:
    """Numbers in the text to a tenth."""
    return re.sub(r"-?\d+\.\d+", lambda m: f"{float(m[0]):.1f}".removesuffix(".0"), text)


def _thinned(path: re.Match[str]) -> str:
    """A path of straight pieces, without the points that lie within OFF px of the line through their neighbours."""
    pieces = []
    for piece in path[1].split("M")[1:]:
        points = np.array([point.split(",") for point in piece.split("L")], dtype=float)
        kept = points[_needed(points)]
        pieces.append("M" + "L".join(f"{x:.1f},{y:.1f}" for x, y in kept))
    return f' d="{"".join(pieces)}"'


def _needed(points: Array) -> Mask:
    """Which points a line needs to stay within OFF px of all of them (Ramer, Douglas and Peucker)."""
    needed = np.zeros(len(points), dtype=bool)
    needed[[0, -1]] = True
    waiting = [(0, len(points) - 1)]
    while waiting:
        first, last = waiting.pop()
        if last - first < 2:
            continue
        chord = points[last] - points[first]
        away = points[first + 1 : last] - points[first]
        length = float(np.hypot(*chord))
        distances = (
            np.abs(chord[0] * away[:, 1] - chord[1] * away[:, 0]) / length
            if length
            else np.hypot(away[:, 0], away[:, 1])
        )
        worst = int(np.argmax(distances))
        if distances[worst] > OFF:
            middle = first + 1 + worst
            needed[middle] = True
            waiting += [(first, middle), (middle, last)]
    return needed
