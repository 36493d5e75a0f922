"""How every figure looks, and how it is written: one place for fonts, colours, sizes and bytes.

Figures are drawn for print: sizes are given in millimetres, a single column is 90 mm wide and a double one
180 mm. Fonts are those that come with matplotlib. Colours keep apart for colour-blind readers and in grey, where
the markers help; each has a dark partner, in which a screen may show the drawing.
"""

from __future__ import annotations

import re
import sys
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..project.files import replacing
from .looks import HARMONIC_LOOK, LOOKS, SPARE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text

SINGLE_COLUMN, DOUBLE_COLUMN = 90.0, 180.0  # mm
MM = 1.0 / 25.4  # inches
EXPORT_DPI = 300

SLIP, STICK = "#16324F", "#D55E00"  # the two phases of the motion
INK, FAINT = "#000000", "#6E6E6E"  # text and axes; what only guides the eye
PAPER_COLOUR, GRID = "#FFFFFF", "#E4E4E4"
GREY, COOL, WARM = "#D9D9D9", "#EDF1F5", "#FBE9DD"  # surfaces
DASHED, DOTTED = (0, (4, 2)), (0, (1, 1.5))

STYLE: dict[str, Any] = {
    "font.family": "STIXGeneral",
    "mathtext.fontset": "stix",
    "font.size": 9.0,
    "axes.labelsize": 9.0,
    "axes.titlesize": 9.0,
    "legend.fontsize": 8.5,
    "axes.linewidth": 0.6,
    "lines.linewidth": 0.9,
    "lines.markersize": 4.0,
    "xtick.top": True,
    "ytick.right": True,
    "legend.frameon": False,
    "figure.dpi": EXPORT_DPI,
    "savefig.dpi": EXPORT_DPI,
    "svg.fonttype": "path",  # the letters are in the file: it looks the same where the font is not installed
    "svg.hashsalt": "dampbalance",  # names inside the file follow from its content, not from chance
}
for _ticks in ("xtick", "ytick"):
    STYLE |= {f"{_ticks}.labelsize": 8.0, f"{_ticks}.direction": "in"}
    STYLE |= {f"{_ticks}.major.width": 0.6, f"{_ticks}.major.size": 3.0}
    STYLE |= {f"{_ticks}.minor.width": 0.4, f"{_ticks}.minor.size": 1.6}


@contextmanager
def styled() -> Iterator[None]:
    """Apply STYLE on matplotlib's defaults, ignoring the user's matplotlibrc."""
    import matplotlib.style  # slow to import, and not needed for the colours of this module

    with matplotlib.style.context(STYLE, after_reset=True):
        yield


# panels of a caller that are left to draw in; none of them on a page, or on a figure of pyplot
_PAGE: Iterator[Axes | None] = iter(())
_PYPLOT: Iterator[Axes | None] = iter(())
_PANELS: ContextVar[Iterator[Axes | None]] = ContextVar("panels", default=_PAGE)


@contextmanager
def lacking_glyphs() -> Iterator[None]:
    """Suppress matplotlib's warning about glyphs that the font lacks."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", r"Glyph .* missing from font", UserWarning)
        yield


@contextmanager
def drawn_in(axes: Iterable[Axes | None] | None) -> Iterator[None]:
    """Draw the panels of a picture in given axes, in order, or on a figure of pyplot if `axes` is None. A panel without
    axes is drawn on a page that is discarded."""
    token = _PANELS.set(_PYPLOT if axes is None else iter(axes))
    try:
        yield
    finally:
        _PANELS.reset(token)


def page(width: float, height: float) -> Figure:
    """Return an empty figure of this size, mm, which a notebook displays like those of pyplot."""
    if _PANELS.get() is _PYPLOT:
        from matplotlib import pyplot  # slow to import

        return pyplot.figure(figsize=(width * MM, height * MM))
    from matplotlib.figure import Figure

    if (
        "IPython" in sys.modules
    ):  # which otherwise displays figures after the first import of pyplot only
        from matplotlib import pyplot

        pyplot.install_repl_displayhook()
    return Figure(figsize=(width * MM, height * MM))


def place(figure: Figure, left: float, bottom: float, width: float, height: float) -> Axes:
    """Return axes whose frame has this lower left corner and size on the page, mm."""
    if (panel := next(_PANELS.get(), None)) is not None:
        return panel
    wide, high = (float(size) / MM for size in figure.get_size_inches())
    return figure.add_axes((left / wide, bottom / high, width / wide, height / high))


def panel_letter(axes: Axes, letter: str) -> Text:
    """Return the letter of a panel, (a), (b) …, above the upper left corner of its frame."""
    look = {"xycoords": "axes fraction", "weight": "bold"}
    return note(axes, f"({letter})", (0.0, 1.0), (0.0, 3.0), **look)


def note(
    axes: Axes,
    text: str,
    at: tuple[float, float],
    shift: tuple[float, float],
    ha: str = "left",
    va: str = "bottom",
    **look: Any,
) -> Text:
    """Return a text next to a point of the axes.   shift : from the point, in points of print."""
    look |= {"ha": ha, "va": va}
    return axes.annotate(text, xy=at, xytext=shift, textcoords="offset points", **look)


def explained(figure: Figure, scale: float = 1.0, ncols: int = 0) -> Figure:
    """Return the figure with a legend of all its panels at its foot.

    scale : size of the marks in the legend, relative to those in the panels.
    ncols : entries in a line of the legend; by default all.
    """
    named = {
        label: handle
        for axes in figure.axes
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    look: dict[str, Any] = {"loc": "lower center", "borderaxespad": 0.3, "markerscale": scale}
    figure.legend([*named.values()], [*named], ncols=ncols or max(1, len(named)), **look)
    return figure


@styled()
def in_one_column(figure: Figure) -> Figure:
    """Rearrange the panels of a figure below each other on a page of a single column, as for a phone.

    They keep their height and the order in which they were drawn, and are as wide as their labels allow. The legend
    takes as many lines as it needs.
    """
    mm = figure.dpi * MM
    heights = [axes.get_window_extent().height / mm for axes in figure.axes]
    figure.set_size_inches(SINGLE_COLUMN * MM, figure.get_figheight())
    for axes in figure.axes:  # about as wide as they will be, as their ticks depend on it
        axes.set_position((0.15, axes.get_position().y0, 0.8, axes.get_position().height))
    frames = [axes.get_window_extent().extents for axes in figure.axes]
    boxes = [(axes.get_tightbbox() or axes.bbox).extents for axes in figure.axes]
    # mm that the labels of each panel take beside its frame: left, below, right, above
    beside = 1.0 + np.abs(np.array(boxes) - frames) / mm
    (left, _, right, _), under, over = beside.max(axis=0), beside[:, 1], beside[:, 3]
    foot = _narrow_legend(figure, SINGLE_COLUMN * mm) / mm
    width, level = SINGLE_COLUMN - left - right, foot + sum((*heights, *over, *under))
    figure.set_size_inches(SINGLE_COLUMN * MM, level * MM)
    page = np.array([SINGLE_COLUMN, level, SINGLE_COLUMN, level])
    for axes, height, above, below in zip(figure.axes, heights, over, under, strict=True):
        level -= above + height
        axes.set_position(tuple(np.array([left, level, width, height]) / page))
        level -= below
    return figure


def _narrow_legend(figure: Figure, width: float) -> float:
    """Draw the legend of a figure, if it has one, in lines of at most this width; return its height, both in dots."""
    height = 0.0
    for legend in [*figure.legends]:
        ncols = len(legend.get_texts())
        while (box := legend.get_window_extent()).width > width and ncols > 1:
            legend.remove()
            ncols -= 1
            legend = explained(figure, legend.markerscale, ncols).legends[-1]
        height = box.height
    return float(height)


def arrow(
    axes: Axes,
    start: tuple[float, float],
    end: tuple[float, float],
    colour: str,
    head: str = "-|>,head_length=0.4,head_width=0.18",
) -> None:
    """Draw an arrow between two points, in the units of the axes."""
    properties = {"arrowstyle": head, "lw": 0.8, "color": colour, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", xy=end, xytext=start, arrowprops=properties)


def omega_of(frequency: str) -> str:
    """Return a frequency of the configuration as a symbol in TeX: omega1 becomes \\omega_{1}; "" for other names."""
    number = frequency.removeprefix("omega")
    return rf"\omega_{{{number}}}" if frequency.startswith("omega") and number.isdigit() else ""


def save(
    figure: Figure, svg: str | Path, png: str | Path, alt: str = "", dpi: int = EXPORT_DPI
) -> None:
    """Write the figure as SVG and as PNG: complete or not at all, the same bytes each time.

    alt : what the figure shows, in one sentence; it becomes the description inside both files.
    dpi : of the PNG, and of what the SVG holds as dots.
    """
    save_svg(figure, svg, alt, dpi)
    with replacing(png) as temporary:
        _write(figure, temporary, "png", alt, dpi)


def save_svg(figure: Figure, svg: str | Path, alt: str = "", dpi: int = EXPORT_DPI) -> None:
    """Write the figure as SVG alone."""
    with replacing(svg) as temporary:
        _write(figure, temporary, "svg", alt, dpi)


@styled()
def _write(figure: Figure, path: Path, kind: str, alt: str, dpi: int) -> None:
    # No date and no version of the software: neither says anything about the figure.
    unsaid = ("Date", "Creator") if kind == "svg" else ("Software",)
    metadata: dict[str, Any] = dict.fromkeys(unsaid) | ({"Description": alt} if alt else {})
    options: dict[str, Any] = {"format": kind, "dpi": dpi, "metadata": metadata}
    if kind == "png":
        # at 6, the usual level, packing takes half as long again and saves one byte in a hundred
        options["pil_kwargs"] = {"compress_level": 4}
    figure.savefig(path, **options)


DARK: dict[str, str] = {
    INK: "#E7EBF0",
    PAPER_COLOUR: "#14181D",
    FAINT: "#AAB4C0",
    GRID: "#353E49",
    SLIP: "#8FBCEC",
    STICK: "#FF9A4D",
    GREY: "#4A525C",
    COOL: "#242C36",
    WARM: "#43301F",
    **{look.colour: look.dark for look in (*LOOKS.values(), *SPARE, HARMONIC_LOOK)},
}
"""Colour on white paper → colour on a dark screen, as #RRGGBB. Colour maps of errors are the same on both."""


def follows_the_screen(svg: str) -> str:
    """Return an SVG file of matplotlib that is displayed in dark colours if the reader prefers them.

    Rules of CSS replace the colours, which matplotlib writes into the `style` of each element. Text in the ink has no
    colour there: it takes the `fill` of what is around it.
    """
    partners = {colour.lower(): dark.lower() for colour, dark in DARK.items()}
    colours = sorted(set(re.findall(r"\b(fill|stroke): (#[0-9a-f]{6})", svg)))
    rules = "".join(
        f'[style*="{what}: {colour}"] {{ {what}: {partners[colour]} !important }}'
        for what, colour in colours
        if colour in partners
    )
    style = f"<style>@media (prefers-color-scheme: dark) {{ :root {{ fill: {DARK[INK]} }} {rules} }}</style>"
    return re.sub(r"<svg\b[^>]*>", lambda tag: tag[0] + style, svg, count=1)
