"""A map over two axes of a study: how large is the error of each approach, and where does it stay within a bound?"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import AsinhNorm, LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.patheffects import AbstractPathEffect, withStroke

from ...arrays import Array
from ...figures.grid import LINEAR_SHARE, clear_labels, grid, logarithmic_ticks
from ...figures.looks import bounded_label, in_maths, label_of
from ...figures.series import EXACT, SignedScale, decades, is_even, signed_scale
from ...figures.style import DOUBLE_COLUMN, GREY, INK, note, place, styled
from ...project.wording import listed, minus, percent
from ..case_files import CasesLike, column_of, terms_of
from ..study_file import Estimator, Sampled, Study
from .shown_as import ShownAs, shown_as
from .statistics import Sizes, places_of

REGION = 0.9  # share of the cases of a bin whose error its colour bounds; the largest one would depend on chance
FINEST_LEVEL = 0.1  # of the bound: smallest error with a line
# %: smaller errors have the colour of zero, larger ones all the same colour
LEAST_COLOURED, MOST_COLOURED = 1e-2, 1e3

RIGHT_OF_MAPS = 17.0  # mm
SIDE_BY_SIDE = 4  # panels of a single approach that fit into a row
SIGNED, SIZES = "coolwarm", "viridis_r"
"""Colours of errors with a sign, from blue to red through a light grey at zero, and of sizes, the larger the darker:
both change evenly to the eye, and for colour-blind readers."""

# Of a histogram of errors from 1e-8 on: a quantile is good to 5 %. Its last place is for what is not identified.
_LOWEST_BIN, _BINS_PER_DECADE, _BINS = -8, 24, 288
_HALO: list[AbstractPathEffect] = [withStroke(linewidth=1.6, foreground="white", alpha=0.7)]


_Key = tuple[Estimator, str]  # of a map: fit and term


class _Axis(NamedTuple):
    """An axis of a map: edges and centres of its bins, whether it is logarithmic, and how it is shown."""

    edges: Array
    centres: Array
    logarithmic: bool
    of: ShownAs


def _axis(study: Study, name: str) -> _Axis:
    """Return an axis whose bins lie around each listed value, or over the range of a sample."""
    block = study.block_of(name)
    if isinstance(block, Sampled):
        limits = block.axes[name]
        # 40 cases in a bin on average, and 72 bins along each axis at most
        bins = int(np.clip(np.sqrt(study.cases / 40), 4, 72))
        edges, logarithmic = limits.at(np.linspace(0.0, 1.0, bins + 1)), limits.spacing == "log"
    else:
        values = np.unique(np.asarray(study.values_of(name), dtype=float))
        logarithmic = bool(values[0] > 0.0 and not is_even(values))
        if logarithmic:
            middle = np.sqrt(values[1:] * values[:-1])
            ends = values[0] ** 2 / middle[0], values[-1] ** 2 / middle[-1]
        else:
            middle = 0.5 * (values[1:] + values[:-1])
            ends = 2 * values[0] - middle[0], 2 * values[-1] - middle[-1]
        edges = np.array([ends[0], *middle, ends[1]])
    centres = np.sqrt(edges[1:] * edges[:-1]) if logarithmic else 0.5 * (edges[1:] + edges[:-1])
    of = shown_as(study, name)
    return _Axis(of.factor * edges, of.factor * centres, logarithmic, of)


@styled()
def error_map(study: Study, cases: CasesLike) -> Figure:
    """Return relative error, %, over two axes, by colour, with a line at each power of ten and a thick one at the
    bound.

    Where each place is one case, its error with the sign. Where it stands for several (a sample, further axes), the
    size that nine of ten do not exceed: the thick line encloses the region in which they are within the bound.
    Rows: the terms, with each phase definition. Columns: approaches; one that takes no phase has a panel as high as
    all rows of a term. A single approach has up to four panels side by side instead. An approach that is exact in every
    case is named below the panels and not drawn.
    """
    within, names = 100.0 * study.figure.get("within", 0.01), [study.figure[x] for x in ("x", "y")]
    x, y = (_axis(study, name) for name in names)
    # whether each place is one case: two axes of listed values, and nothing else that varies
    places = math.prod(len(set(study.values_of(name))) for name in names)
    signed = study.cases == places and study.block_of(names[0]) is not study.block_of(names[1])
    fits, symbols = study.fits_of(study.figure), terms_of(cases)
    keys = [(fit, symbol) for fit in fits for symbol in symbols if symbol in fit.identified]
    columns = {(fit, s): f"{s}_relative_error__{fit.label}" for fit, s in keys}
    sizes = {key: Sizes(column_of(cases, name), 0.01 * within) for key, name in columns.items()}
    errors = _errors(cases, dict(zip(names, (x, y), strict=True)), columns, signed)
    worst: dict[str, float] = {}
    for (fit, _), of in sizes.items():
        largest = 100.0 * of.largest if of.known else math.inf
        worst[fit.approach] = max(largest, worst.get(fit.approach, 0.0))
    exact = {key: bound for key, bound in worst.items() if bound < EXACT}
    exact = {} if len(exact) == len(worst) else exact  # something must be drawn
    shown = {key: of for key, of in errors.items() if key[0].approach not in exact}
    approaches = list(dict.fromkeys(fit.approach for fit, _ in shown))
    kinds = [*dict.fromkeys((fit.phase, fit.sharing) for fit, _ in shown if fit.phase)]
    rows = [(symbol, *kind) for symbol in symbols for kind in kinds or [("", "")]]
    norm, lines = _scale([of.ravel() for of in shown.values()], signed, within)
    single = len(approaches) == 1 and len(rows) <= SIDE_BY_SIDE
    shape = (1, len(rows)) if single else (len(rows), len(approaches))
    panels = grid(*shape, right=RIGHT_OF_MAPS, most=32.0 if single else 40.0)
    lowest: dict[int, Axes] = {}
    for (fit, symbol), values in shown.items():
        column, kind = approaches.index(fit.approach), (symbol, fit.phase, fit.sharing)
        covered = [
            i for i, row in enumerate(rows) if row == kind or (not fit.phase and row[0] == symbol)
        ]
        if single:
            column, covered = rows.index(kind), [0]
        axes = panels.panel(covered[-1], column, rows=len(covered))
        _draw(
            axes, x, y, values, norm, {line: 1.2 if abs(line) == within else 0.5 for line in lines}
        )
        axes.tick_params(labelbottom=covered[-1] == shape[0] - 1, labelleft=column == 0)
        lowest[column] = axes  # the last row comes last
        if covered[0] == 0 and not single:
            axes.set_title(in_maths(label_of(fit.approach)), pad=14.0)  # above what the panel shows
        if column == 0:
            panels.name_row(axes, y.of.label)
        # what the panel shows, as far as others of its column show something else
        words = [f"${symbol}$"]
        if len(kinds) > 1 and fit.phase:
            words.append(fit.phase.replace("_", " "))
            words += [fit.sharing] if len({sharing for _, sharing in kinds}) > 1 else []
        text = f"{', '.join(words)}: {percent(sizes[fit, symbol].share)}"
        note(axes, text, (0.0, 1.0), (0.0, 2.0), size=7.5, xycoords="axes fraction")
    clear_labels([lowest[column] for column in sorted(lowest)])
    panels.text_below(x.of.label)
    what = "error" if signed else f"error that {100 * REGION:g} % of the cases do not exceed"
    # beside a single row there is no room for more than a word
    by = f"Colour: {what}, by {in_maths(label_of(approaches[0]))}. " if single else ""
    words = [f"{by}Above each panel: share of the cases within {within:g} %."]
    if any(np.isnan(values).any() for values in shown.values()):
        words.append("Grey: not identified.")
    if exact:
        words.append(f"Exact: {listed([bounded_label(key, exact[key]) for key in exact])}.")
    panels.text_below(" ".join(words), level=4.0)
    left, tall = DOUBLE_COLUMN - RIGHT_OF_MAPS + 2.0, panels.tall(shape[0])
    bar = place(panels.figure, left, panels.bottom, 3.0, tall)
    ticks = sorted({*lines, 0.0}) if signed else lines
    scale = panels.figure.colorbar(axes.collections[0], cax=bar, ticks=ticks)
    scale.minorticks_off()
    bar.set_yticklabels([minus(f"{tick:g}") for tick in ticks])
    scale.set_label("error (%)" if single else f"{what} (%)", labelpad=2.0)
    return panels.figure


def _errors(
    cases: CasesLike, axes: Mapping[str, _Axis], columns: Mapping[_Key, str], single: bool
) -> dict[_Key, Array]:
    """Return the map of each fit and term, %, (bins of y, bins of x), NaN where it is unknown.

    axes : x and y, by name.   columns : of the errors.   single : whether each place is one case.
    """
    i, j = (
        np.digitize(axis.of.factor * column_of(cases, name), axis.edges[1:-1])
        for name, axis in axes.items()
    )
    width, height = (len(axis.centres) for axis in axes.values())
    bins, maps = j * width + i, {}
    for key, name in columns.items():
        errors = column_of(cases, name)
        if single:
            values = np.empty(height * width)
            values[bins] = 100.0 * errors
        else:
            places = places_of(errors, _LOWEST_BIN, _BINS_PER_DECADE, _BINS)
            counts = np.bincount(bins * _BINS + places, minlength=height * width * _BINS)
            values = _quantiles(counts.reshape(-1, _BINS).astype(np.float64))
        maps[key] = values.reshape(height, width)
    return maps


def _quantiles(counts: Array) -> Array:
    """Return the size that the share REGION of the cases of each bin does not exceed, %; NaN where that is not
    known."""
    reached = np.cumsum(counts, axis=-1)
    total = reached[..., -1]
    at = np.argmax(reached >= REGION * total[..., None], axis=-1)
    sizes = 10.0 ** (2.0 + _LOWEST_BIN + (at + 0.5) / _BINS_PER_DECADE)
    return np.where((total > 0) & (at < _BINS - 1), sizes, np.nan)


def _scale(values: Sequence[Array], signed: bool, within: float) -> tuple[Normalize, list[float]]:
    """Return the scale of colours, with zero in its middle for errors with a sign, and where its lines are, %."""
    if signed:
        scale = signed_scale(values, LEAST_COLOURED, MOST_COLOURED, cut=0.02)
        top = max(scale.high, -scale.low)
        ticks = SignedScale(scale.linear, -top, top).ticks
        norm: Normalize = AsinhNorm(LINEAR_SHARE * scale.linear, vmin=-top, vmax=top)
        return norm, sorted(
            {*(x for x in ticks if abs(x) >= FINEST_LEVEL * within), within, -within}
        )
    low, high = decades(values, LEAST_COLOURED, MOST_COLOURED, cut=0.02)
    powers = range(round(math.log10(low)), round(math.log10(high)) + 1)
    ticks = [float(f"1e{power}") for power in powers]
    return LogNorm(low, high), sorted({within, *(x for x in ticks if x >= FINEST_LEVEL * within)})


def _draw(
    axes: Axes, x: _Axis, y: _Axis, values: Array, norm: Normalize, lines: Mapping[float, float]
) -> None:
    """Draw one map with its lines, each with its level in %.   lines : level → width."""
    for which, axis in (("x", x), ("y", y)):
        axes.set(**{f"{which}lim": axis.edges[[0, -1]]})
        if axis.logarithmic:
            logarithmic_ticks(axes, which, axis.edges[0], axis.edges[-1])
    axes.set_facecolor(GREY)
    signed, smooth = isinstance(norm, AsinhNorm), values
    look: dict[str, Any] = {"cmap": SIGNED if signed else SIZES, "rasterized": True, "linewidth": 0}
    axes.pcolormesh(x.edges, y.edges, values, norm=norm, **look)
    if not signed:  # sizes in bins of a few cases: their logarithms over neighbouring bins
        from scipy.ndimage import gaussian_filter  # slow to import, and needed for maps only

        known = np.isfinite(values)
        logs = np.log(np.where(known, values, 1.0))
        total, weight = (gaussian_filter(part, 1.0, mode="nearest") for part in (logs, 1.0 * known))
        smooth = np.exp(np.divide(total, weight, out=np.full_like(total, np.nan), where=known))
    if min(values.shape) < 2 or not np.isfinite(smooth).any():
        return
    low, high = np.nanmin(smooth), np.nanmax(smooth)
    if crossed := {level: width for level, width in lines.items() if low < level < high}:
        look = {"colors": INK, "linewidths": [*crossed.values()], "linestyles": "solid"}
        drawn = axes.contour(x.centres, y.centres, smooth, [*crossed], **look)
        drawn.set_path_effects(_HALO)
        look = {"fontsize": 6.0, "inline_spacing": 1.0, "fmt": lambda level: minus(f"{level:g}")}
        labels: list[Any] = [*axes.clabel(drawn, **look)]
        for label in labels:
            label.set_path_effects(_HALO)
            box, at = label.get_window_extent(), axes.transData.transform(label.get_position())
            inside = at + np.maximum(axes.bbox.min - box.min, 0.0)  # so that the frame cuts none
            inside -= np.maximum(box.max - axes.bbox.max, 0.0)
            label.set_position(axes.transData.inverted().transform(inside))
