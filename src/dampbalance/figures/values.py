"""The values behind the marks of a figure, kept in its SVG: whoever shows the drawing can state them.

A line carries its values when it has a name, matplotlib's `gid`: what its points are, in words and TeX. `values`
collects those of a figure, panel by panel; `figures.style.save` writes them into the SVG, and `read_values` returns
them.
"""

from __future__ import annotations

import html
import itertools
import json
import math
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

DIGITS = 6  # significant, of a value
MOST_PLACES = 90  # places of a line at which values are kept; a line of more is thinned evenly
_ELEMENT = '<metadata id="values">{}</metadata>'


def values(figure: Figure) -> list[dict[str, Any]]:
    """Return the panels of a figure whose lines have names, each with what is drawn in it. The figure has been drawn
    before: only then do its axes know their limits. Values are read upwards, or to the right where places are named
    along y.

    title : above the panel.
    x, y : what the places are, and what the values.
    blocks : lines at the same places, which are values or names. Each line has a name and its values (None where there
    is none).
    """
    named = {axes: [line for line in axes.get_lines() if line.get_gid()] for axes in figure.axes}
    return [_panel(axes, lines) for axes, lines in named.items() if lines]


def read_values(svg: str) -> list[dict[str, Any]]:
    """Return what `values` gave for the figure that an SVG shows; nothing for an SVG without values."""
    element = re.search(_ELEMENT.format("(.*?)"), svg, re.DOTALL)
    return json.loads(html.unescape(element[1])) if element else []


def with_values(svg: str, panels: list[dict[str, Any]]) -> str:
    """Return the SVG with the values of its panels in it."""
    text = json.dumps(panels, ensure_ascii=False, separators=(",", ":"))
    return svg.replace(" <defs>", f" {_ELEMENT.format(html.escape(text, quote=False))}\n <defs>", 1)


def _panel(axes: Axes, lines: list[Line2D]) -> dict[str, Any]:
    up = list(axes.get_yticks()) != list(range(len(axes.get_yticks())))
    return {
        "title": axes.get_title(),
        "x": _label(axes, "x") if up else "",
        "y": _label(axes, "y" if up else "x"),
        "blocks": list(_blocks(axes, lines, up)),
    }


def _blocks(axes: Axes, lines: list[Line2D], up: bool) -> Iterator[dict[str, Any]]:
    """Yield lines by their places; those of one name follow one another."""
    joined: dict[str, list[Any]] = {}
    for line in lines:
        x, y = (np.asarray(of, dtype=float) for of in line.get_data()[:: 1 if up else -1])
        if not np.isfinite(y).any():
            continue
        low, high = sorted(axes.get_xlim() if up else axes.get_ylim())
        seen = (x >= low) & (x <= high)
        if np.any(np.diff(x) < 0.0):  # a loop: only what the panel enlarges of it
            low, high = sorted(axes.get_ylim())
            seen &= (y >= low) & (y <= high)
        joined.setdefault(str(line.get_gid()), []).append(np.array([x, y])[:, seen])
    known = []
    for name, parts in joined.items():
        x, y = np.hstack(parts)
        if x.size:  # thinned, the last place among those that are kept
            kept = np.unique([*range(0, x.size, math.ceil(x.size / MOST_PLACES)), x.size - 1])
            known.append((_places(axes, x[kept], up), name, y[kept]))
    for places, group in itertools.groupby(known, lambda line: line[0]):
        columns = [[name, [_short(one) for one in y]] for _, name, y in group]
        yield {"places": places, "lines": columns}


def _places(axes: Axes, places: Any, up: bool) -> list[Any]:
    """Return values along the axis, or the names of its ticks, where these are as many as the places or stand at 0, 1,
    2 …"""
    from matplotlib.ticker import FixedLocator  # slow to import, and the page reads values only

    axis: Axis = axes.xaxis if up else axes.yaxis
    ticks, formatter = list(axis.get_majorticklocs()), axis.get_major_formatter()
    given = isinstance(axis.get_major_locator(), FixedLocator) and hasattr(formatter, "func")
    if not given or (len(ticks) != len(places) and ticks != list(range(len(ticks)))):
        return [_short(x) for x in places]
    names, scale = formatter.format_ticks(ticks), axis.get_transform()
    at = scale.transform(np.array(ticks, dtype=float))
    return [names[int(np.argmin(np.abs(at - x)))] for x in scale.transform(places)]


def _label(axes: Axes, which: str) -> str:
    """Return the label of an axis: its own, or what stands for all panels of the row or below all."""
    figure: Any = axes.get_figure()
    if which == "x":
        below = next((text.get_text() for text in figure.texts), "")
        return axes.get_xlabel() or below
    row = [other for other in figure.axes if abs(other.bbox.y0 - axes.bbox.y0) < 1.0]
    return next((other.get_ylabel() for other in (axes, *row) if other.get_ylabel()), "")


def _short(value: float) -> float | None:
    return float(f"{value:.{DIGITS}g}") if math.isfinite(value) else None
