"""Whether a figure can be read: its text as matplotlib's renderer places it."""

from __future__ import annotations

import itertools

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

from dampbalance.figures.style import styled


def texts(figure: Figure) -> list[tuple[str, object]]:
    """Every text that is seen, with the box it takes on the page."""
    canvas = FigureCanvasAgg(figure)
    figure.draw_without_rendering()
    hidden = set()
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            if not axes.axison:
                hidden.update(axis.findobj(Text))
            for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks()):
                if not low <= tick.get_loc() <= high:
                    hidden.update(tick.findobj(Text))
    return [
        (text.get_text(), Text.get_window_extent(text, canvas.get_renderer()))
        for text in figure.findobj(Text)
        if text.get_visible() and text.get_text().strip() and text not in hidden
    ]


@styled()
def faults(figure: Figure) -> list[tuple[str, ...]]:
    """Texts that the edge of the page clips, and pairs of texts of which one lies on the other."""
    seen, page = texts(figure), figure.bbox
    assert len(seen) > 5
    clipped = [
        (text,)
        for text, box in seen
        if box.x0 < page.x0 or box.y0 < page.y0 or box.x1 > page.x1 or box.y1 > page.y1
    ]
    return clipped + [
        (one, other)
        for (one, a), (other, b) in itertools.combinations(seen, 2)
        if min(a.x1, b.x1) > max(a.x0, b.x0) and min(a.y1, b.y1) > max(a.y0, b.y0)
    ]
