"""The figure the paper lacks: the error of F_k by each approach, for each pair of levels and each frequency."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ..balance import TERMS, takes_phase
from ..model import Oscillator
from ..solver import levels_of
from .grid import grid, signed_axis
from .looks import HARMONIC_LOOK, bounded_label, in_maths, label_of, look_of
from .series import COMMON, EXACT, INDIVIDUAL, SHARINGS, signed_scale
from .style import DASHED, FAINT, omega_of, styled

if TYPE_CHECKING:
    import pandas as pd

ALL = "all"  # what the tables name in place of a pair: least squares over all levels
ROUNDING = 1e-11  # %: the least bound stated for rounding; below it the errors are chance
SMALLEST = 0.01  # %: smaller errors are drawn on the linear part of the axis
ALIKE = 0.1  # decades, 0.3 mm: marks whose errors differ by less would hide each other
_TERM = TERMS["F_k"]
_BELOW = "excitation levels $Y_i$–$Y_j$ of the pair (mm); all: least squares over all levels"

Errors = dict[tuple[str, str, str, str], float]
"""(frequency, approach, phase, pair or ALL) → relative error, %, with its sign."""


@styled()
def estimation_error(
    estimates: Mapping[str, pd.DataFrame],
    oscillator: Oscillator,
    frequencies_hz: Mapping[str, float],
    levels_m: Sequence[float],
) -> Figure:
    """Draw the relative error of F_k, %, of every pair of levels and of all levels together, a panel per frequency.

    Small filled marks: φ and t_s common to all levels; larger open ones: those of each level. Approaches that know no
    such choice (`balance.takes_phase`) have filled marks. Approaches that take a phase and agree everywhere share
    their marks. Errors have their sign; an approach that is exact to rounding lies on zero, and the legend states the
    bound that it keeps.

    estimates : frequency → table of `estimates.estimate_table`.
    oscillator : with the true coefficients.
    frequencies_hz : frequency → f, Hz, in the order of the panels.
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
    errors: Errors = {}
    for name in frequencies_hz:
        errors |= _relative(name, estimates[name], oscillator.F_k)
    groups = _alike(errors, approaches)
    sizes = {key: [abs(e) for of, e in errors.items() if of[1] == key] for key in approaches}
    bounds = {key: max(of, default=math.inf) for key, of in sizes.items()}
    exact = {key: max(bound, ROUNDING) for key, bound in bounds.items() if bound < EXACT}
    others = [np.array([error for key, error in errors.items() if key[1] not in exact])]
    scale = signed_scale(others, SMALLEST, math.inf)
    panels = grid(1, len(frequencies_hz), left=17.0, bottom=18.5, height=33.0)
    for column, (name, hz) in enumerate(frequencies_hz.items()):
        axes = panels.panel(0, column)
        axes.set_label(name)
        # a place for each pair and, behind a thin line, one for the least squares
        axes.set_xlim(-0.6, len(pairs) + 0.6)
        axes.set_xticks(range(len(pairs) + 1), [*names, ALL], size=7.5)
        axes.tick_params(axis="x", length=0)
        axes.axvline(len(pairs) - 0.5, color=FAINT, lw=0.4)
        signed_axis(axes, scale)
        axes.tick_params(labelleft=column == 0)
        for group in groups:
            _draw(axes, errors, name, group, [*pairs, ALL])
        if column == 0:
            panels.name_row(axes, f"error of ${_TERM.symbol}$ (%)")
        omega = omega_of(name)  # ω_1/2π = 4.92 Hz
        symbol = rf"{omega}/2\pi" if omega else "f"
        axes.set_title(rf"${symbol}$ = {hz:g} Hz", pad=4.0)
    panels.text_below(_BELOW)
    handles = [entry for group in groups for entry in _entries(group, exact)]
    panels.legend_below(handles, columnspacing=1.2, handlelength=2.0, handletextpad=0.5)
    return panels.figure


def _relative(frequency: str, table: pd.DataFrame, true: float) -> Errors:
    """Return estimate/true − 1 in %, of the pairs and of the least squares, those that exist."""
    errors: Errors = {}
    for row in table[table["kind"].isin(["pair", "least_squares"])].to_dict("records"):
        error = 100.0 * (float(row[_TERM.column]) / true - 1.0)
        if math.isfinite(error):
            errors[frequency, row["approach"], row["phase"], row["pair"]] = error
    return errors


def _alike(errors: Errors, approaches: Sequence[str]) -> list[tuple[str, ...]]:
    """Return the approaches in groups: those that take a phase together, where all their errors have the same sign and
    sizes within ALIKE; every other one alone."""
    harmonic = tuple(key for key in approaches if takes_phase(key))
    places = {(f, phase, pair) for f, key, phase, pair in errors if key in harmonic}
    for f, phase, pair in places:
        here = np.array([errors.get((f, key, phase, pair), math.nan) for key in harmonic])
        spread = np.ptp(np.log10(np.maximum(np.abs(here), EXACT)))
        # also where one of them is missing: NaN
        if not (spread < ALIKE and np.ptp(np.sign(here)) == 0.0):
            return [(key,) for key in approaches]
    groups = [harmonic if key in harmonic else (key,) for key in approaches]
    return list(dict.fromkeys(groups))


def _phases(group: Sequence[str]) -> list[str]:
    """Return the choices of φ and t_s that approaches know, as the tables name them."""
    return [COMMON, INDIVIDUAL] if takes_phase(group[0]) else [INDIVIDUAL]


def _draw(
    axes: Axes, errors: Errors, frequency: str, group: Sequence[str], pairs: Sequence[str]
) -> None:
    """Draw approaches that agree, by the first: pairs of neighbouring levels joined by a line, all else by itself."""
    for phase in _phases(group):
        of = [errors.get((frequency, group[0], phase, pair), math.nan) for pair in pairs]
        for joined in (True, False):
            places = [n for n, pair in enumerate(pairs) if _is_step(pair) is joined]
            shown = [of[n] for n in places]
            label = f"{group[0]} {phase}"
            axes.plot(places, shown, label=label, **_drawing(group, phase, joined))


def _drawing(group: Sequence[str], phase: str, joined: bool = True) -> dict[str, Any]:
    """Return the look of approaches: small, filled and solid for common features and where there is no choice of
    them; else open, dashed, and so large that a filled mark shows inside."""
    look = HARMONIC_LOOK if len(group) > 1 else look_of(group[0])
    filled = phase == COMMON or not takes_phase(group[0])
    marks = {"marker": look.marker, "color": look.colour, "mew": 0.7}
    marks |= {"ms": 3.4} if filled else {"ms": 6.0, "mfc": "none"}
    line = "none" if group[0] == "direct" or not joined else "-" if filled else DASHED
    return marks | {"lw": 0.7, "ls": line}


def _entries(group: Sequence[str], exact: Mapping[str, float]) -> list[Line2D]:
    """Return the entries of approaches in the legend, one for each choice of φ and t_s; an exact one with the power of
    ten that it stays below."""
    label = ", ".join(
        bounded_label(key, exact[key]) if key in exact else in_maths(label_of(key)) for key in group
    )
    names = {
        phase: f"{label}: {SHARINGS[phase]}" if takes_phase(group[0]) else label
        for phase in _phases(group)
    }
    return [Line2D([], [], label=name, **_drawing(group, of)) for of, name in names.items()]


def _is_step(pair: str) -> bool:
    """Return whether a pair "i-j" is one of neighbouring levels."""
    return pair != ALL and abs(int(np.diff(levels_of(pair))[0])) == 1
