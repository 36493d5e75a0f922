"""A map over two axes of a study: where does each approach stay within a bound?"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...arrays import Array
from ...figures.looks import in_maths, label_of
from ...figures.style import DOUBLE_COLUMN, note, place, styled
from ...figures.style import page as empty_page
from ...project.wording import listed, percent
from ..axes import Sampled
from ..outputs import stretches, terms_of
from ..settings import Fit, Study
from .error_curves import symbol_of
from .logarithmic import is_even, logarithmic_ticks

MOST_BINS = 72  # along each axis
PER_BIN = 40  # cases that a bin should hold on average: its share is then good to 0.08
REGION = 0.9  # share of the cases within the bound that makes a bin part of the region where the approach holds

LEFT, RIGHT, BOTTOM, TOP, GAP, ROW_GAP, BAR = 14.0, 15.0, 15.0, 7.0, 3.0, 3.0, 3.0  # mm
HEIGHT = 40.0  # mm, of a panel

_PAPER = {"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": 1.2}
_LABEL: dict[str, Any] = {"xycoords": "axes fraction", "size": 8.0, "bbox": _PAPER}


class Shares(NamedTuple):
    """Share of the cases within the bound in each bin, (bins of y, bins of x), NaN where there is no case; bin edges;
    share over all cases."""

    share: Array
    x_edges: Array
    y_edges: Array
    overall: float


@styled()
def share_map(study: Study, cases: str | Path) -> Figure:
    """Share of the cases whose error is within the bound, over two axes, averaged over all other axes.

    Rows: the terms, with each phase definition. Columns: approaches; one that takes no phase has a panel as high as
    all rows of a term. The line encloses the region in which at least 90 % of the cases are within the bound.
    An approach that is within it in every case is named below the panels and not drawn.
    """
    within = study.figure.get("within", 0.01)
    fits, symbols = study.fits_of(study.figure), terms_of(cases)
    shares = shares_within(study, cases, fits, within)
    perfect = _perfect(fits, shares)
    fits = [fit for fit in fits if fit.approach not in perfect]
    approaches = list(dict.fromkeys(fit.approach for fit in fits))
    phases = dict.fromkeys((fit.phase, fit.sharing) for fit in fits if fit.phase)
    kinds = list(phases) or [("", "")]
    rows = [(symbol, *kind) for symbol in symbols for kind in kinds]
    width = (DOUBLE_COLUMN - LEFT - RIGHT - (len(approaches) - 1) * GAP) / len(approaches)
    height = min(width, HEIGHT)
    panels_height = len(rows) * height + (len(rows) - 1) * ROW_GAP
    figure = empty_page(DOUBLE_COLUMN, BOTTOM + panels_height + TOP)
    mesh: Any = None
    for fit in fits:
        column = approaches.index(fit.approach)
        for symbol in symbols:
            wanted = [kind for kind in kinds if not fit.phase or kind == (fit.phase, fit.sharing)]
            covered = [rows.index((symbol, *kind)) for kind in wanted]
            lowest = covered[-1] == len(rows) - 1
            bottom = BOTTOM + (len(rows) - 1 - covered[-1]) * (height + ROW_GAP)
            tall = len(covered) * (height + ROW_GAP) - ROW_GAP
            axes = place(figure, LEFT + column * (width + GAP), bottom, width, tall)
            share = shares[fit, symbol]
            mesh = _panel(axes, study, share, last=column == len(approaches) - 1)
            axes.tick_params(labelbottom=lowest, labelleft=column == 0)
            if covered[0] == 0:
                axes.set_title(f"{in_maths(label_of(fit.approach))} approach", pad=4.0)
            if lowest:
                axes.set_xlabel(symbol_of(study.figure["x"]), labelpad=1.0)
            if column == 0:
                axes.set_ylabel(symbol_of(study.figure["y"]))
                axes.yaxis.set_label_coords(-9.5 / width, 0.5)
            text = f"{_words(symbol, fit, kinds)}: {percent(share.overall)}"
            note(axes, text, (0.0, 1.0), (3.0, -3.5), va="top", **_LABEL)
    bar = place(figure, DOUBLE_COLUMN - RIGHT + 2.0, BOTTOM, BAR, panels_height)
    _scale(figure, mesh, bar, within)
    if perfect:
        names = listed([in_maths(label_of(key)) for key in perfect])
        coefficients = listed([f"${symbol}$" for symbol in symbols])
        text = f"Within {100 * within:g} % in every case, for {coefficients}: {names}"
        middle = (LEFT + 0.5 * (DOUBLE_COLUMN - LEFT - RIGHT)) / DOUBLE_COLUMN
        level = 2.5 / (BOTTOM + panels_height + TOP)
        figure.text(middle, level, text, ha="center", va="center")
    return figure


def _words(symbol: str, fit: Fit, kinds: list[tuple[str, str]]) -> str:
    """What a panel shows, as far as others of its column show something else."""
    words = [f"${symbol}$"]
    if len(kinds) > 1 and fit.phase:
        words.append(fit.phase.replace("_", " "))
        words += [fit.sharing] if len({sharing for _, sharing in kinds}) > 1 else []
    return ", ".join(words)


def _scale(figure: Figure, mesh: Any, bar: Axes, within: float) -> None:
    """The scale of colours."""
    scale = figure.colorbar(mesh, cax=bar, ticks=[0.0, 0.25, 0.5, 0.75, 1.0])
    scale.ax.set_yticklabels(["0", "25", "50", "75", "100"])
    scale.set_label(f"cases within {100 * within:g} % of the true value (%)", labelpad=2.0)
    scale.ax.axhline(REGION, color="white", lw=1.0)


def _perfect(fits: list[Fit], shares: Mapping[tuple[Fit, str], Shares]) -> list[str]:
    """The approaches that are within the bound in every case and by every fit, so that a map would show one colour.

    Empty where that holds for all approaches: something must be drawn.
    """
    short = {fit.approach for (fit, _), share in shares.items() if share.overall < 1.0}
    approaches = dict.fromkeys(fit.approach for fit in fits)
    return [key for key in approaches if key not in short] if short else []


def shares_within(
    study: Study, cases: str | Path, fits: list[Fit], within: float
) -> dict[tuple[Fit, str], Shares]:
    """The map of each term and fit, counted a stretch of cases at a time."""
    settings = study.figure
    x_edges, y_edges = (_edges(study, settings[axis])[0] for axis in ("x", "y"))
    keys = [(fit, symbol) for fit in fits for symbol in terms_of(cases)]
    wanted = {key: f"{key[1]}_relative_error__{key[0].label}" for key in keys}
    total = np.zeros((len(y_edges) - 1, len(x_edges) - 1))
    good = {key: np.zeros_like(total) for key in wanted}
    names = [settings["x"], settings["y"], *wanted.values()]
    for values in stretches(cases, names):
        i, j = (
            np.clip(np.searchsorted(edges, values[name], "right") - 1, 0, len(edges) - 2)
            for edges, name in ((x_edges, settings["x"]), (y_edges, settings["y"]))
        )
        bins = j * total.shape[1] + i
        total += np.bincount(bins, minlength=total.size).reshape(total.shape)
        for key, name in wanted.items():
            inside = np.abs(values[name]) <= within  # NaN, nothing identified: not inside
            good[key] += np.bincount(bins[inside], minlength=total.size).reshape(total.shape)
    filled = np.where(total > 0, total, np.nan)
    return {
        key: Shares(count / filled, x_edges, y_edges, float(count.sum() / total.sum()))
        for key, count in good.items()
    }


def _panel(axes: Axes, study: Study, shares: Shares, last: bool) -> Any:
    """One map, with the line around the region where the approach holds."""
    look: dict[str, Any] = {"cmap": "viridis", "rasterized": True, "linewidth": 0}
    mesh = axes.pcolormesh(shares.x_edges, shares.y_edges, shares.share, vmin=0.0, vmax=1.0, **look)
    axes.set(xlim=shares.x_edges[[0, -1]], ylim=shares.y_edges[[0, -1]])
    centres = []
    for which in ("x", "y"):
        edges, logarithmic = _edges(study, study.figure[which])
        middle = 0.5 * (edges[1:] + edges[:-1])
        centres.append(np.sqrt(edges[1:] * edges[:-1]) if logarithmic else middle)
        if logarithmic:
            logarithmic_ticks(axes, which, edges[0], edges[-1], ends=last or which == "y")
    if min(shares.share.shape) > 2:
        from scipy.ndimage import gaussian_filter  # slow to import, and needed for maps only

        smooth = gaussian_filter(np.nan_to_num(shares.share), sigma=1.0, mode="nearest")
        if smooth.max() > REGION > smooth.min():
            axes.contour(*centres, smooth, levels=[REGION], colors="white", linewidths=1.0)
    return mesh


def _edges(study: Study, name: str) -> tuple[Array, bool]:
    """Bin edges along an axis, around each listed value or over the range of a sample; whether it is logarithmic."""
    block = study.block_of(name)
    if isinstance(block, Sampled):
        limits = block.ranges[name]
        bins = int(np.clip(np.sqrt(study.cases / PER_BIN), 4, MOST_BINS))
        return limits.at(np.linspace(0.0, 1.0, bins + 1)), limits.spacing == "log"
    values = np.unique(np.asarray(study.values_of(name), dtype=float))
    if values[0] > 0.0 and not is_even(values):
        middle = np.sqrt(values[1:] * values[:-1])
        return np.array([values[0] ** 2 / middle[0], *middle, values[-1] ** 2 / middle[-1]]), True
    middle = 0.5 * (values[1:] + values[:-1])
    return np.array([2 * values[0] - middle[0], *middle, 2 * values[-1] - middle[-1]]), False
