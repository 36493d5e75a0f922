"""The figure the paper lacks: how wrong each approach is, at which level and at which frequency."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D

from ..balance import TERMS, takes_phase
from ..model import Oscillator
from ..solver import levels_of
from .grid import Grid, grid, signed_axis
from .looks import in_maths, label_of, look_of
from .series import COMMON, EXACT, INDIVIDUAL, signed_scale
from .style import DASHED, FAINT, omega_of, styled

if TYPE_CHECKING:
    import pandas as pd

ALL = "all"  # what the tables name in place of a pair: least squares over all levels
ROUNDING = 1e-11  # %: the least bound stated for rounding; below it the errors are chance
_BELOW = "excitation levels $Y_i$–$Y_j$ of the pair (mm); all: least squares over all levels"

ErrorsOfPairs = dict[tuple[str, str, str], float]
"""(approach, phase, pair or ALL) → relative error, %, with its sign."""


@styled()
def estimation_error(
    estimates: Mapping[str, pd.DataFrame],
    oscillator: Oscillator,
    frequencies_hz: Mapping[str, float],
    levels_m: Sequence[float],
) -> Figure:
    """Draw relative error of each term's coefficient, %, of every pair of levels and of all levels together.

    A row of panels per term, a column per frequency. Filled markers: φ and t_s common to all levels; open: those of
    each level. Approaches that know no such choice (`balance.takes_phase`) are filled. Errors have their sign; an
    approach that is exact to rounding lies on zero, and the legend states the bound that it keeps.

    estimates : frequency → table of `estimates.estimate_table`.
    oscillator : with the true coefficients.
    frequencies_hz : frequency → f, Hz, in the order of the columns.
    levels_m : excitation levels Y_i, m, that a pair "i-j" names.

    An estimate that does not exist (nothing slips) is left out.
    Raises ValueError for a frequency without estimates, and for no frequency at all.
    """
    missing = sorted(set(frequencies_hz) - set(estimates))
    if missing or not frequencies_hz:
        raise ValueError(
            f"estimates needed for the frequencies {missing or '(none named)'}, "
            f"there are tables for {sorted(estimates)}"
        )
    approaches, pairs = (
        list(dict.fromkeys(value for name in frequencies_hz for value in estimates[name][column]))
        for column in ("approach", "pair")
    )
    pairs = [pair for pair in pairs if pair != ALL]
    names = ["–".join(f"{levels_m[i - 1] * 1e3:g}" for i in levels_of(pair)) for pair in pairs]
    terms = [term for term in TERMS.values() if hasattr(oscillator, term.symbol)]
    panels = grid(len(terms), len(frequencies_hz), left=17.0, bottom=20.0, height=48.0)
    exact = []  # for each term: approach that is exact to rounding → bound of its error, %
    for row, term in enumerate(terms):
        true = getattr(oscillator, term.symbol)
        by_frequency = {f: _relative(estimates[f], term.column, true) for f in frequencies_hz}
        sizes: dict[str, list[float]] = {}
        for (approach, *_), error in (item for of in by_frequency.values() for item in of.items()):
            sizes.setdefault(approach, []).append(error)
        worst = {key: float(np.abs(of).max()) for key, of in sizes.items()}
        exact.append({key: max(e, ROUNDING) for key, e in worst.items() if e < EXACT})
        others = [np.array(of) for key, of in sizes.items() if key not in exact[-1]]
        # %: a smaller error is drawn on the linear part of the axis
        scale = signed_scale(others, 1e-4, math.inf, cut=0.02)
        for column, (name, errors) in enumerate(by_frequency.items()):
            axes = panels.panel(row, column)
            axes.set_label(f"{term.symbol} {name}")
            # a place for each pair and, behind a thin line, one for the least squares
            axes.set_xlim(-0.6, len(pairs) + 0.6)
            axes.set_xticks(range(len(pairs) + 1), [*names, ALL], size=7.5)
            axes.tick_params(axis="x", length=0, labelbottom=row == len(terms) - 1)
            axes.axvline(len(pairs) - 0.5, color=FAINT, lw=0.4)
            signed_axis(axes, scale)
            axes.tick_params(labelleft=column == 0)
            for key in approaches:
                _draw(axes, errors, key, approaches, [*pairs, ALL])
            if column == 0:
                panels.name_row(axes, f"error of ${term.symbol}$ (%)")
            if row == 0:
                omega = omega_of(name)  # ω_1/2π = 4.92 Hz
                symbol = rf"{omega}/2\pi" if omega else "f"
                axes.set_title(rf"${symbol}$ = {frequencies_hz[name]:g} Hz", pad=4.0)
    panels.text_below(_BELOW)
    always = [key for key in approaches if all(key in of for of in exact)]
    _legend(panels, approaches, {key: max(of[key] for of in exact) for key in always})
    return panels.figure


def _relative(table: pd.DataFrame, column: str, true: float) -> ErrorsOfPairs:
    """Return estimate/true − 1 in %, of the pairs and of the least squares, those that exist."""
    errors: ErrorsOfPairs = {}
    for row in table[table["kind"].isin(["pair", "least_squares"])].to_dict("records"):
        error = 100.0 * (float(row[column]) / true - 1.0)
        if math.isfinite(error):
            errors[row["approach"], row["phase"], row["pair"]] = error
    return errors


def _draw(
    axes: Axes, errors: ErrorsOfPairs, key: str, approaches: Sequence[str], pairs: Sequence[str]
) -> None:
    """Draw one approach: pairs of neighbouring levels joined by a line, all else by itself."""
    others = [name for name in approaches if name != "direct"]
    step = min(0.18, 0.8 / max(1, len(others)))  # of an approach from the next, in places
    shift = step * (others.index(key) - 0.5 * (len(others) - 1)) if key in others else 0.0
    places = {pair: n + shift for n, pair in enumerate(pairs)}
    for phase in (COMMON, INDIVIDUAL):
        for joined in (True, False):
            group = [pair for pair in pairs if _is_step(pair) is joined]
            axes.plot(
                [places[name] for name in group],
                [errors.get((key, phase, name), math.nan) for name in group],
                label=f"{key} {phase}",
                **_drawing(key, phase, joined),
            )


def _drawing(key: str, phase: str, joined: bool = True) -> dict[str, Any]:
    """Return the look of an approach: filled and solid for common features and for approaches that know no choice of
    them; else open and dashed."""
    look = look_of(key)
    filled = phase == COMMON or not takes_phase(key)
    marks = {"marker": look.marker, "ms": 3.2 if look.marker in "Ds" else 3.8, "mew": 0.7}
    marks |= {"color": look.colour, "mfc": look.colour if filled else "white"}
    line = "none" if key == "direct" or not joined else "-" if filled else DASHED
    return marks | {"lw": 0.7, "ls": line}


def _legend(panels: Grid, approaches: Sequence[str], exact: Mapping[str, float]) -> None:
    """Draw the approaches by colour and marker, an exact one with the power of ten that it stays below; common and
    individual features by filling."""

    def handle(key: str, phase: str) -> Line2D:
        return Line2D([], [], **_drawing(key, phase))

    def label(key: str) -> str:
        bound = f" (${{<}}10^{{{math.ceil(math.log10(exact[key]))}}}$ %)" if key in exact else ""
        return in_maths(label_of(key)) + bound

    choosing = [key for key in approaches if takes_phase(key)]
    handles: list[Any] = [handle(key, COMMON) for key in approaches]
    handles += [tuple(handle(key, phase) for key in choosing) for phase in (COMMON, INDIVIDUAL)]
    panels.legend_below(
        handles,
        labels=[
            *map(label, approaches),
            r"common $\varphi$, $t_s$",
            r"individual $\varphi_i$, $t_{is}$",
        ],
        handler_map={tuple: HandlerTuple(ndivide=None, pad=0.2)},
        columnspacing=0.9,
        handlelength=2.0,
        handletextpad=0.5,
    )


def _is_step(pair: str) -> bool:
    """Return whether a pair "i-j" is one of neighbouring levels."""
    return pair != ALL and abs(int(np.diff(levels_of(pair))[0])) == 1
