"""The figure the paper lacks: how wrong each approach is, at which level and at which frequency."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D

from ..balance import takes_phase
from ..model import Oscillator
from .grid import Grid, grid, signed_axis
from .looks import in_maths, label_of, look_of, named
from .series import COMMON, INDIVIDUAL, Errors, ErrorsByLevel, errors_by_level
from .style import DASHED, FAINT, omega_of, styled

if TYPE_CHECKING:
    import pandas as pd

HEIGHT = 48.0  # mm, of a panel


@styled()
def estimation_error(
    estimates: Mapping[str, pd.DataFrame],
    oscillator: Oscillator,
    frequencies_hz: Mapping[str, float],
    levels_m: Sequence[float],
) -> Figure:
    """Relative error of each term's coefficient, %, of every pair of levels and of all levels together.

    The arguments are those of `series.errors_by_level`; a row of panels per term, a column per frequency.

    Filled markers: φ and t_s common to all levels; open: those of each level. Approaches that know no
    such choice (`balance.takes_phase`) are filled. Errors have their sign; an approach that is exact to rounding lies
    on zero, and the legend states the bound that it keeps.
    """
    shown = errors_by_level(estimates, oscillator, frequencies_hz, levels_m)
    panels = grid(len(shown.terms), len(frequencies_hz), left=17.0, bottom=20.0, height=HEIGHT)
    pairs = len(shown.places) - 1
    for number, of_term in enumerate(shown.terms):
        for column, (name, errors) in enumerate(of_term.errors.items()):
            axes = panels.panel(number, column)
            axes.set_label(f"{of_term.term.symbol} {name}")
            # a place for each pair and, behind a thin line, one for the least squares
            axes.set_xlim(-0.6, pairs + 0.6)
            lowest = number == len(shown.terms) - 1
            axes.set_xticks(range(pairs + 1), shown.names, size=7.5)
            axes.tick_params(axis="x", length=0, labelbottom=lowest)
            axes.axvline(pairs - 0.5, color=FAINT, lw=0.4)
            signed_axis(axes, of_term.scale)
            axes.tick_params(labelleft=column == 0)
            for key in shown.approaches:
                _draw(axes, errors, key, shown)
            if column == 0:
                panels.name_row(axes, f"error of ${of_term.term.symbol}$ (%)")
            if number == 0:
                omega = omega_of(name)  # ω_1/2π = 4.92 Hz
                symbol = rf"{omega}/2\pi" if omega else "f"
                axes.set_title(rf"${symbol}$ = {frequencies_hz[name]:g} Hz", pad=4.0)
    panels.text_below(
        "excitation levels $Y_i$–$Y_j$ of the pair (mm); all: least squares over all levels"
    )
    _legend(panels, shown)
    return panels.figure


def _draw(axes: Axes, errors: Errors, key: str, shown: ErrorsByLevel) -> None:
    """One approach: pairs of neighbouring levels joined by a line, all else on its own."""
    others = [name for name in shown.approaches if name != "direct"]
    step = min(0.18, 0.8 / max(1, len(others)))  # of an approach from the next, in places
    beside = step * (others.index(key) - 0.5 * (len(others) - 1)) if key in others else 0.0
    places = {pair: n + beside for n, pair in enumerate(shown.places)}
    steps = [pair for pair in shown.places if _is_step(pair)]
    alone = [pair for pair in shown.places if pair not in steps]
    for phase in (COMMON, INDIVIDUAL):
        for names, joined in ((steps, True), (alone, False)):
            axes.plot(
                [places[name] for name in names],
                [errors.get((key, phase, name), math.nan) for name in names],
                label=f"{key} {phase}",
                gid=named(key, phase if takes_phase(key) else ""),
                **_drawing(key, phase, joined),
            )


def _drawing(key: str, phase: str, joined: bool) -> dict[str, Any]:
    """Filled and solid for common features and for approaches that know no choice of them; else open and dashed."""
    look = look_of(key)
    filled = phase == COMMON or not takes_phase(key)
    marks = {"marker": look.marker, "ms": 3.2 if look.marker in "Ds" else 3.8, "mew": 0.7}
    marks |= {"color": look.colour, "mfc": look.colour if filled else "white"}
    line = "none" if key == "direct" or not joined else "-" if filled else DASHED
    return marks | {"lw": 0.7, "ls": line}


def _legend(panels: Grid, shown: ErrorsByLevel) -> None:
    """The approaches by colour and marker, common and individual features by filling."""

    def handle(key: str, phase: str) -> Line2D:
        return Line2D([], [], **_drawing(key, phase, joined=True))

    choosing = [key for key in shown.approaches if takes_phase(key)]
    handles: list[Any] = [handle(key, COMMON) for key in shown.approaches]
    handles += [tuple(handle(key, phase) for key in choosing) for phase in (COMMON, INDIVIDUAL)]
    labels = [_name(key, shown.exact) for key in shown.approaches]
    panels.legend_below(
        handles,
        labels=[*labels, r"common $\varphi$, $t_s$", r"individual $\varphi_i$, $t_{is}$"],
        handler_map={tuple: HandlerTuple(ndivide=None, pad=0.2)},
        columnspacing=0.9,
        handlelength=2.0,
        handletextpad=0.5,
    )


def _name(key: str, exact: Mapping[str, float]) -> str:
    """An approach, and the power of ten that an exact one stays below."""
    bound = rf" (${{<}}10^{{{math.ceil(math.log10(exact[key]))}}}$ %)" if key in exact else ""
    return in_maths(label_of(key)) + bound


def _is_step(pair: str) -> bool:
    """Whether a pair "i-j" is one of neighbouring levels."""
    i, _, j = pair.partition("-")
    return bool(j) and abs(int(j) - int(i)) == 1
