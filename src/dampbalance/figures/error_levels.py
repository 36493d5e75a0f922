"""The figure the paper lacks: how wrong each approach is, at which level and at which frequency."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator

from ..balance import takes_phase
from ..model import Oscillator
from .style import APPROACH_LOOKS, DOUBLE_COLUMN, FAINT, INK, MM, page, place, styled

COMMON, INDIVIDUAL = "common", "individual"
EXACT = 1e-5  # %: an approach nowhere worse than this is exact but for rounding (which uneven levels magnify)
ROUNDING = 1e-11  # %: the least bound stated for rounding; below it the errors are chance
FLOOR = 1e-14  # %: a smaller error, zero too, counts as this on a logarithmic axis

LEFT, RIGHT, BOTTOM, TOP = 17.0, 3.0, 20.0, 7.0  # mm, margins of the page
MAIN, STRIP, BREAK, ROW_GAP, COLUMN_GAP = 42.0, 5.0, 1.6, 4.0, 3.5  # mm
BLOCK = MAIN + BREAK + STRIP

Errors = dict[tuple[str, str, str], float]
"""(approach, phase, pair or "all") → relative error, %."""


class Quantity(NamedTuple):
    """One of the two identified parameters: its column, symbol and true value."""

    column: str
    symbol: str
    true: float


@styled()
def estimation_error(
    estimates: Mapping[str, pd.DataFrame],
    oscillator: Oscillator,
    frequencies_hz: Mapping[str, float],
    levels_m: Sequence[float],
) -> Figure:
    """Relative error of F_k (top) and c (bottom), %, of every pair of levels and of all levels together.

    estimates : frequency → table of `identify.estimate_table` (columns approach, kind, phase, pair,
    F_k_N, c_N_s_per_m).   oscillator : the true F_k and c.   frequencies_hz : frequency → f, Hz; a
    column of panels each, in this order.   levels_m : excitation levels Y_i, m, that a pair "i-j" names.

    Filled markers: φ and t_s common to all levels; open: those of each level. Approaches that know no
    such choice (`balance.takes_phase`) are filled. An approach that is exact but for rounding stands
    below the break of the axis, beside the bound it keeps. An estimate that does not exist (nothing
    slips) is left out.
    Raises ValueError for an approach without a look in `style.APPROACH_LOOKS`, for a frequency without
    estimates, and for no frequency at all.
    """
    missing = sorted(set(frequencies_hz) - set(estimates))
    if missing or not frequencies_hz:
        raise ValueError(
            f"estimates needed for the frequencies {missing or '(none named)'}, "
            f"there are tables for {sorted(estimates)}"
        )
    tables = {name: estimates[name] for name in frequencies_hz}
    approaches = _in_order(tables.values(), "approach")
    unknown = sorted(set(approaches) - set(APPROACH_LOOKS))
    if unknown:
        raise ValueError(f"approaches {unknown} have no look: add them to style.APPROACH_LOOKS")
    pairs = [pair for pair in _in_order(tables.values(), "pair") if pair != "all"]
    names = [*(_levels(pair, levels_m) for pair in pairs), "all"]

    figure = page(DOUBLE_COLUMN, BOTTOM + 2 * BLOCK + ROW_GAP + TOP)
    for bottom, quantity in (
        (BOTTOM + BLOCK + ROW_GAP, Quantity("F_k_N", "F_k", oscillator.F_k)),
        (BOTTOM, Quantity("c_N_s_per_m", "c", oscillator.c)),
    ):
        errors = {name: relative_errors(table, quantity) for name, table in tables.items()}
        panels = _row(figure, bottom, errors, approaches, pairs, quantity.symbol)
        for name, (main, lowest) in zip(tables, panels, strict=True):
            if bottom == BOTTOM:
                lowest.set_xticks(range(len(names)), names, size=7.5)
            else:
                main.set_title(_frequency(name, frequencies_hz[name]), pad=4.0)
    figure.text(
        *_centre(figure, 11.0),
        "excitation levels $Y_i$–$Y_j$ of the pair (mm); all: least squares over all levels",
        ha="center",
        va="center",
    )
    _legend(figure, approaches)
    return figure


def relative_errors(table: pd.DataFrame, quantity: Quantity) -> Errors:
    """|estimate/true − 1| in %, of the pairs and of the least squares, those that exist."""
    errors: Errors = {}
    for row in table[table["kind"].isin(["pair", "least_squares"])].to_dict("records"):
        error = 100.0 * abs(float(row[quantity.column]) / quantity.true - 1.0)
        if math.isfinite(error):
            errors[row["approach"], row["phase"], row["pair"]] = max(error, FLOOR)
    return errors


def _row(
    figure: Figure,
    bottom: float,
    errors: Mapping[str, Errors],
    approaches: Sequence[str],
    pairs: Sequence[str],
    symbol: str,
) -> list[tuple[Axes, Axes]]:
    """The panels of one quantity, one per frequency: (main, lowest), the same axes where nothing is exact."""
    known = [(key, error) for one in errors.values() for (key, *_), error in one.items()]
    worst = {key: max(error for k, error in known if k == key) for key, _ in known}
    exact = {key: error for key, error in worst.items() if error < EXACT}
    limits = _decades([error for key, error in known if key not in exact])
    raised = BREAK + STRIP if exact else 0.0
    width = (DOUBLE_COLUMN - LEFT - RIGHT - (len(errors) - 1) * COLUMN_GAP) / len(errors)
    panels = []
    for column, (name, of_frequency) in enumerate(errors.items()):
        left = LEFT + column * (width + COLUMN_GAP)
        main = place(figure, left, bottom + raised, width, BLOCK - raised)
        main.set_label(f"{symbol} {name}")
        _frame(main, len(pairs))
        main.set_yscale("log")
        main.set_ylim(*limits)
        main.yaxis.set_major_locator(LogLocator(base=10.0, numticks=20))
        main.grid(axis="y", color="#E4E4E4", lw=0.4)
        for key in approaches:
            if key not in exact:
                _draw(main, of_frequency, key, pairs, approaches)
        lowest = main
        if exact:
            lowest = place(figure, left, bottom, width, STRIP)
            lowest.set_label(f"{symbol} {name} exact")
            _frame(lowest, len(pairs))
            bound = max(ROUNDING, *exact.values())
            lowest.set_ylim(0.0, 1.0)
            lowest.set_yticks([0.5], [rf"$\leq 10^{{{math.ceil(math.log10(bound))}}}$"])
            lowest.tick_params(axis="y", length=0)
            for key in exact:  # where exactly is chance: all on one line
                _draw(lowest, dict.fromkeys(of_frequency, 0.5), key, pairs, approaches)
            _break(main, lowest)
        for axes in (main, lowest):
            axes.tick_params(labelleft=column == 0)
        if column == 0:
            main.set_ylabel(f"error of ${symbol}$ (%)")
            main.yaxis.set_label_coords(-11.0 / width, 0.5)
        panels.append((main, lowest))
    return panels


def _draw(
    axes: Axes, errors: Errors, key: str, pairs: Sequence[str], approaches: Sequence[str]
) -> None:
    """One approach: pairs of neighbouring levels joined by a line, all else on its own."""
    others = [name for name in approaches if name != "direct"]
    beside = 0.18 * (others.index(key) - 0.5 * (len(others) - 1)) if key in others else 0.0
    places = {pair: n + beside for n, pair in enumerate([*pairs, "all"])}
    steps = [pair for pair in pairs if _is_step(pair)]
    alone = [pair for pair in places if pair not in steps]
    for phase in (COMMON, INDIVIDUAL):
        for names, joined in ((steps, True), (alone, False)):
            axes.plot(
                [places[name] for name in names],
                [errors.get((key, phase, name), math.nan) for name in names],
                label=f"{key} {phase}",
                **_drawing(key, phase, joined),
            )


def _drawing(key: str, phase: str, joined: bool) -> dict[str, Any]:
    """Filled and solid for common features and for approaches that know no choice of them; else open and dashed."""
    look = APPROACH_LOOKS[key]
    filled = phase == COMMON or not takes_phase(key)
    return {
        "color": look.colour,
        "marker": look.marker,
        "ms": 3.2 if look.marker in "Ds" else 3.8,
        "mfc": look.colour if filled else "white",
        "mew": 0.7,
        "lw": 0.7,
        "ls": "none" if key == "direct" or not joined else "-" if filled else (0, (4, 2)),
    }


def _frame(axes: Axes, pairs: int) -> None:
    """A place for each pair and, behind a thin line, one for the least squares."""
    axes.set_xlim(-0.6, pairs + 0.6)
    axes.set_xticks(range(pairs + 1), [""] * (pairs + 1))
    axes.tick_params(axis="x", length=0)
    axes.axvline(pairs - 0.5, color=FAINT, lw=0.4)


def _break(upper: Axes, lower: Axes) -> None:
    """Show that the axis is broken between the two: slashes for the line that would part them."""
    upper.spines["bottom"].set_visible(False)
    lower.spines["top"].set_visible(False)
    slash: dict[str, Any] = {
        "marker": [(-1, -0.5), (1, 0.5)],
        "ms": 6,
        "ls": "none",
        "color": INK,
        "mew": 0.6,
        "clip_on": False,
    }
    upper.plot([0, 1], [0, 0], transform=upper.transAxes, **slash)
    lower.plot([0, 1], [1, 1], transform=lower.transAxes, **slash)


def _legend(figure: Figure, approaches: Sequence[str]) -> None:
    """The approaches by colour and marker, common and individual features by filling."""

    def handle(key: str, phase: str) -> Line2D:
        return Line2D([], [], **_drawing(key, phase, joined=True))

    choosing = [key for key in approaches if takes_phase(key)]
    handles: list[Any] = [handle(key, COMMON) for key in approaches]
    labels = [APPROACH_LOOKS[key].label for key in approaches]
    for phase, text in (
        (COMMON, r"common $\phi$, $t_s$"),
        (INDIVIDUAL, r"individual $\phi_i$, $t_{is}$"),
    ):
        handles.append(tuple(handle(key, phase) for key in choosing))
        labels.append(text)
    figure.legend(
        handles,
        labels,
        loc="center",
        bbox_to_anchor=_centre(figure, 4.0),
        ncols=len(handles),
        handler_map={tuple: HandlerTuple(ndivide=None, pad=0.2)},
        columnspacing=1.1,
        handlelength=2.2,
        handletextpad=0.6,
    )


def _centre(figure: Figure, level: float) -> tuple[float, float]:
    """The point below the middle of the panels, `level` mm above the edge of the page, in shares of the page."""
    height = float(figure.get_size_inches()[1]) / MM
    return (LEFT + 0.5 * (DOUBLE_COLUMN - LEFT - RIGHT)) / DOUBLE_COLUMN, level / height


def _in_order(tables: Iterable[pd.DataFrame], column: str) -> list[str]:
    """The different entries of a column, in the order in which they first come."""
    return list(dict.fromkeys(value for table in tables for value in table[column]))


def _is_step(pair: str) -> bool:
    """Whether a pair "i-j" is one of neighbouring levels."""
    i, j = (int(level) for level in pair.split("-"))
    return abs(j - i) == 1


def _levels(pair: str, levels_m: Sequence[float]) -> str:
    """The pair "i-j" by its two excitation levels in mm."""
    return "–".join(f"{levels_m[int(level) - 1] * 1e3:g}" for level in pair.split("-"))


def _decades(errors: Sequence[float]) -> tuple[float, float]:
    """Limits of a logarithmic axis: whole decades around the errors."""
    exponents = [math.log10(error) for error in errors] or [-1.0, 1.0]
    low, high = math.floor(min(exponents)), math.ceil(max(exponents))
    return 10.0**low, 10.0 ** max(high, low + 1)


def _frequency(name: str, hz: float) -> str:
    """Title of a column, e.g. ω_1/2π = 4.92 Hz."""
    number = name.removeprefix("omega")
    symbol = rf"\omega_{{{number}}}/2\pi" if name.startswith("omega") and number.isdigit() else "f"
    return rf"${symbol}$ = {hz:g} Hz"
