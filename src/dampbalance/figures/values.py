"""The values behind the marks of a figure, kept in its SVG: whoever shows the drawing can state them.

A line carries its values when it has a name, matplotlib's `gid`: what its points are, in words and TeX. `values`
collects those of a figure, panel by panel; `figures.style.save` writes them into the SVG, and `read_values` returns
them.
"""

from __future__ import annotations

import itertools
import json
import math
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import escape, unescape

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

DIGITS = 6  # significant, of a value
MOST = 90  # places of a line at which values are kept; a line of more is thinned evenly
_ELEMENT = '<metadata id="values">{}</metadata>'


def values(figure: Figure) -> list[dict[str, Any]]:
    """The panels of a figure whose lines have names, each with what is drawn in it.

    title : above the panel.
    x, y : what the places are, and what the values.
    up : whether the values are read upwards, or to the right, for places that are named along the axis y.
    scale : of the values: its kind, its limits, where these lie on the drawing (points from its left upper corner), and
    the width of its linear part.
    blocks : lines at the same places, which are values or names. Each line has a name, its values (None where there is
    none), and where its places lie on the drawing.
    """
    if not any(line.get_gid() for axes in figure.axes for line in axes.get_lines()):
        return []  # drawing takes as long as writing
    figure.draw_without_rendering()
    return [panel for axes in figure.axes if (panel := _panel(axes))]


def read_values(svg: str) -> list[dict[str, Any]]:
    """What `values` gave for the figure that an SVG shows; nothing for an SVG without values."""
    found = re.search(_ELEMENT.format("(.*?)"), svg, re.DOTALL)
    return json.loads(unescape(found[1])) if found else []


def with_values(svg: str, panels: list[dict[str, Any]]) -> str:
    """The SVG with the values of its panels in it."""
    text = json.dumps(panels, ensure_ascii=False, separators=(",", ":"))
    return svg.replace(" <defs>", f" {_ELEMENT.format(escape(text))}\n <defs>", 1)


def _panel(axes: Axes) -> dict[str, Any] | None:
    """What a panel shows, None where no line has a name."""
    lines = [line for line in axes.get_lines() if line.get_gid()]
    if not lines:
        return None
    up = list(axes.get_yticks()) != list(range(len(axes.get_yticks())))
    along, across = (axes.xaxis, axes.yaxis) if up else (axes.yaxis, axes.xaxis)
    return {
        "title": axes.get_title(),
        "x": _label(axes, "x") if up else "",
        "y": _label(axes, "y" if up else "x"),
        "up": up,
        "scale": _scale(axes, across),
        "blocks": list(_blocks(axes, lines, along, up)),
    }


def _blocks(axes: Axes, lines: list[Line2D], along: Axis, up: bool) -> Iterator[dict[str, Any]]:
    """Lines by their places; those of one name follow one another."""
    joined: dict[str, tuple[Any, Any]] = {}
    for line in lines:
        x, y = (np.asarray(values, dtype=float) for values in line.get_data()[:: 1 if up else -1])
        if not np.isfinite(y).any():
            continue
        seen = _within(x, axes.get_xlim() if up else axes.get_ylim())
        if np.any(np.diff(x) < 0.0):  # a loop: only what the panel enlarges of it
            seen &= _within(y, axes.get_ylim())
        before = joined.get(str(line.get_gid()), ((), ()))
        joined[str(line.get_gid())] = np.append(before[0], x[seen]), np.append(before[1], y[seen])
    known = (_thinned(name, *of) for name, of in joined.items() if len(of[0]))
    for places, group in itertools.groupby(known, lambda line: _places(axes, along, line[1], up)):
        columns = [
            [name, [_short(y) for y in values], _along(axes, x, up)] for name, x, values in group
        ]
        yield {"places": places, "lines": columns}


def _within(values: Any, limits: tuple[float, float]) -> Any:
    """Which values lie within the limits of an axis."""
    return (values >= min(limits)) & (values <= max(limits))


def _thinned(name: str, x: Any, y: Any) -> tuple[str, Any, Any]:
    """A line at MOST places or little more, the last among them."""
    kept = np.unique([*range(0, len(x), math.ceil(len(x) / MOST)), len(x) - 1])
    return name, x[kept], y[kept]


def _places(axes: Axes, axis: Axis, places: Any, up: bool) -> list[Any]:
    """Values along the axis, or the names of its ticks, where these are as many as the places or stand at 0, 1, 2 …"""
    from matplotlib.ticker import FixedLocator  # slow to import, and the page reads values only

    ticks, formatter = list(axis.get_majorticklocs()), axis.get_major_formatter()
    given = isinstance(axis.get_major_locator(), FixedLocator) and hasattr(formatter, "func")
    if not given or (len(ticks) != len(places) and ticks != list(range(len(ticks)))):
        return [_short(x) for x in places]
    names, at = formatter.format_ticks(ticks), np.array(_along(axes, ticks, up))
    return [names[int(np.argmin(np.abs(at - x)))] for x in _along(axes, places, up)]


def _along(axes: Axes, places: Any, up: bool) -> list[float]:
    """Where values along the axis lie on the drawing."""
    on_page = _on_page(axes, np.column_stack([places, places]))
    return [round(float(p), 1) for p in on_page[:, 0 if up else 1]]


def _scale(axes: Axes, axis: Axis) -> list[Any]:
    """Kind of a scale, its limits and where they lie, and the width of its linear part; 0 where it has none."""
    up = axis is axes.yaxis
    limits = axes.get_ylim() if up else axes.get_xlim()
    places = _on_page(axes, np.column_stack([limits, limits]))[:, 1 if up else 0]
    scale: Any = axis.get_transform()
    linear = float(getattr(scale, "linear_width", 0.0))
    return [axis.get_scale(), *map(float, limits), *(round(float(p), 1) for p in places), linear]


def _on_page(axes: Axes, points: Any) -> Any:
    """Where points stand on the drawing, from its left upper corner, in points of 1/72 inch."""
    figure: Any = axes.get_figure()
    placed = axes.transData.transform(points) * 72.0 / figure.dpi
    return np.column_stack([placed[:, 0], 72.0 * figure.get_figheight() - placed[:, 1]])


def _label(axes: Axes, which: str) -> str:
    """The label of an axis: its own, or what stands for all panels of the row or below all."""
    own = axes.get_xlabel() if which == "x" else axes.get_ylabel()
    if own:
        return own
    figure: Any = axes.get_figure()
    if which == "x":
        return next((text.get_text() for text in figure.texts), "")
    row = [other for other in figure.axes if abs(other.bbox.y0 - axes.bbox.y0) < 1.0]
    return next((other.get_ylabel() for other in row if other.get_ylabel()), "")


def _short(value: float) -> float | None:
    """A value with DIGITS digits."""
    return float(f"{value:.{DIGITS}g}") if math.isfinite(value) else None
