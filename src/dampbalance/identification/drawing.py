"""The pictures of a result: drawn on pages of their own, or in axes of a caller."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..arguments import one_of
from ..figures.style import drawn_in, lacking_glyphs
from ..records.coordinate import Coordinate

if TYPE_CHECKING:
    from .result import Picture, Result

DPI = 200  # pictures to look at: in print they are SVG


def draw(picture: Picture, coordinate: Coordinate) -> Figure:
    """Return a picture on a page of its own."""
    with lacking_glyphs():
        return picture.draw(*picture.of, coordinate)


def plot(
    found: Result[Any],
    figure: str | None,
    ax: Axes | Sequence[Axes | None] | None,
    style: Mapping[str, Any],
) -> Any:
    """Draw a picture and return its axes: see `Result.plot`."""
    pictures = found.pictures
    name = next(iter(pictures)) if figure is None else one_of("figure", figure, tuple(pictures))
    several = ax is None or isinstance(ax, Iterable)
    given: Any = ax if several else [ax]
    held = [] if given is None else [one for one in given if one is not None]
    before = {line for axes in held for line in axes.get_lines()}
    with drawn_in(given):
        drawn = draw(pictures[name], found.coordinate)
    axes = held or drawn.axes
    for one in held:  # what the panels of a picture share, each of these has
        shared = [panel.get_xlabel() for panel in drawn.axes if panel.get_xlabel()]
        one.set_xlabel(one.get_xlabel() or next(iter(shared), ""))
        one.tick_params(labelbottom=True)
    for line in (line for one in axes for line in one.get_lines() if line not in before):
        line.set(**style)
    return np.array(axes) if several else ax
