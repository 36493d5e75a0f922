"""Pictures of forced records, with averaged cycles and fit, friction loops and rows of the balance, and of free decays,
with fitted motion, rows and damping. Up to three panels share the width of the page.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from ..arguments import one_of
from ..arrays import Array
from ..figures.cycle import branches, whole_cycle
from ..figures.looks import in_maths, label_of, look_of
from ..figures.style import (
    DASHED,
    DOUBLE_COLUMN,
    FAINT,
    SLIP,
    STICK,
    drawn_in,
    explained,
    page,
    place,
    styled,
)
from ..fit.decay import DecayFit, offset_of
from ..fit.waveforms import WaveformFit
from ..project.wording import cut
from ..records.channel import ORDERS
from ..records.coordinate import Coordinate
from ..records.record import Record
from ..signals.log_decrement import SwingDamping
from ..signals.mean_harmonics import Reading
from ..solver import NORMAL_95
from .answer import Answer
from .loading import excerpt

if TYPE_CHECKING:
    from .result import Result

DPI = 200  # pictures to look at: in print they are SVG

_POINTS = 6000  # samples drawn at most
_SHOWN = {  # quantity → (symbol, factor, unit, column of the averaged cycle)
    "displacement": ("x", 1e3, "mm", "x"),
    "velocity": (r"\dot x", 1.0, "m/s", "v"),
    "acceleration": (r"\ddot x", 1.0, "m/s²", "acceleration"),
}
_SHOWN |= {
    f"relative_{q}": (rf"{x} - {x.replace('x', 'y')}", factor, unit, column)
    for q, (x, factor, unit, column) in _SHOWN.items()
}
_BOTTOM, _TOP = 18.0, 7.0  # mm
_HIGHER = {1: 1.6, 2: 1.3, 3: 1.0}  # panels abreast → how much higher each is
_FINE = 2880  # points of a cycle: its corners are between two of them
_DOTS: dict[str, Any] = {"color": FAINT, "markersize": 1.0, "rasterized": True}


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
        drawn = pictures[name].drawn(found.coordinate)
    axes = held or drawn.axes
    for one in held:  # panels of a picture share a label; axes of a caller each get it
        shared = [panel.get_xlabel() for panel in drawn.axes if panel.get_xlabel()]
        one.set_xlabel(one.get_xlabel() or next(iter(shared), ""))
        one.tick_params(labelbottom=True)
    for line in (line for one in axes for line in one.get_lines() if line not in before):
        line.set(**style)
    return np.array(axes) if several else ax


@styled()
def cycles(
    records: Sequence[Record], readings: Sequence[Reading], fit: WaveformFit | None, of: Coordinate
) -> Figure:
    """Return each record folded onto one cycle of the drive (dots), its averaged cycle (line) and that of the fitted
    oscillator (dashes), a panel per record; below, the residuals of the fit or, without one, of the averaged cycle, in
    standard deviations of the noise.

    Of several response channels the highest derivative is shown. The phase is zero at the peak of the base.
    """
    figure, panels = _panels_of_records(records, "phase of the drive (°)", below=11.0)
    for i, (record, reading, (axes, below)) in enumerate(
        zip(records, readings, panels, strict=True)
    ):
        steady = reading.steady
        quantity = next(q for q in reversed(_SHOWN) if q in record.quantities)
        symbol, factor, unit, column = _SHOWN[quantity]
        label = of.label(symbol, unit)
        samples = excerpt(record, quantity, steady)
        t, values = (a[:: max(1, a.size // _POINTS)] for a in samples)
        base = float(np.angle(steady.mean(steady.Y)[1]))
        theta = (steady.omega * (t - steady.start) + base) % (2.0 * math.pi)
        axes.plot(np.degrees(theta), factor * values, ".", label="samples", **_DOTS)
        averaged = reading.averaged_cycle(_FINE)
        # an averaged cycle has no mean, but a transducer has an offset
        channel = steady.channels[quantity]
        level = float(np.average(channel.coefficients[:, 0].real, weights=channel.weights))
        if of_base := steady.of_base[quantity]:
            y = of_base * steady.mean(steady.Y)[1] * (1j * steady.omega) ** ORDERS[quantity]
            turned = np.exp(1j * (averaged["phase"] - base))
            level = level - (y * turned).real
        degrees, model = np.degrees(averaged["phase"]), averaged
        axes.plot(degrees, factor * (averaged[column] + level), color=STICK, label="averaged cycle")
        if fit is not None:
            model = reading.fitted_cycle(fit.waveforms[i], _FINE)
            line = factor * (model[column] + level)
            axes.plot(degrees, line, color=SLIP, linestyle=DASHED, label="fitted oscillator")
        expected = np.interp(theta, averaged["phase"], model[column] + level, period=2.0 * math.pi)
        left = (values - expected) / (steady.noise_rms[quantity] or math.nan)
        _with_residual(axes, below, np.degrees(theta), left, (0.0, 360.0), label)
        for frame in (axes, below):
            frame.set_xticks([0, 90, 180, 270, 360])
    return explained(figure, scale=2.0)


@styled()
def friction(
    records: Sequence[Record],
    loops: Sequence[Mapping[str, Array]],
    fit: WaveformFit | None,
    of: Coordinate,
) -> Figure:
    """Return the friction force against displacement, a panel per record: the averaged cycle less the other forces
    (line), the loop K_z z of the fitted oscillator (dashes) and its onset of slip (dots).

    loops : columns of `friction_loops` of the records.
    """
    figure, panels = _panels_of_records(records, of.label("x", "mm"))
    for i, (loop, (axes, _)) in enumerate(zip(loops, panels, strict=True)):
        x, f = (np.append(loop[name], loop[name][0]) for name in ("x_m", "f_N"))
        axes.plot(1e3 * x, f, color=SLIP, label="from the record")
        if fit is not None:
            orbit = fit.responses[i].orbit
            state = whole_cycle(branches(orbit))
            look: dict[str, Any] = {"color": STICK, "linestyle": DASHED}
            K_z, F_k = orbit.oscillator.K_z, orbit.oscillator.F_k
            axes.plot(1e3 * state.x, K_z * state.z, label="fitted oscillator", **look)
            ends = 1e3 * orbit.X_s * np.array([1.0, -1.0])
            axes.plot(ends, [F_k, -F_k], "o", color=STICK, markersize=3.0, label="onset of slip")
        axes.set_ylabel(of.label("f", "N"), labelpad=1.0)
        # long numbers would push the label off the page
        axes.ticklabel_format(axis="y", scilimits=(-2, 4), useMathText=True)
        axes.margins(0.08)
    return explained(figure, scale=2.0)


@styled()
def balance(answers: Mapping[str, Answer], two: bool, of: Coordinate) -> Figure:
    """Return the rows of the balance, and their residuals.

    (a) W/b against a/b: a F_k + b c = W is a straight line of slope F_k and intercept c; it is drawn for the first
    answer. For another law, the loss by its terms, Σ g_j p_j, against W, with the line of equality.
    (b) the residual of each row, in standard deviations.

    two : whether the law has the terms F_k and c alone.
    """
    figure = page(DOUBLE_COLUMN, 74.0)
    left, right = place(figure, 17.0, 20.0, 68.0, 50.0), place(figure, 107.0, 20.0, 70.0, 50.0)
    best, first = next(iter(answers.items()))
    name, check = next(one for one in answers.items() if one[1].balance is not None)
    assert check.balance is not None
    rows, off = check.balance.rows, check.row_misfit
    usable, look = rows.usable, look_of(name)
    marks: dict[str, Any] = {"color": look.colour, "fillstyle": "none"}
    marks["label"] = in_maths(label_of(name))
    with np.errstate(divide="ignore", invalid="ignore"):
        along, height = (
            (rows.terms["F_k"] / rows.terms["c"], rows.W / rows.terms["c"])
            if two
            else (rows.W, rows.W + off)
        )
        scaled = off / check.balance.errors
    left.plot(along[usable], height[usable], look.marker, **marks)
    values = {**rows.given, **first.values}
    if all(math.isfinite(values[symbol]) for symbol in rows.terms):
        ends = np.array([0.0, 1.06 * float(np.max(along[usable]))])
        line = values["F_k"] * ends + values["c"] if two else ends
        words = f"line: {in_maths(label_of(best))}" if two else None
        left.plot(ends, line, color=FAINT, zorder=0, label=words)
    bars: dict[str, Any] = {"yerr": 1.0, "fmt": look.marker, "elinewidth": 0.6, **marks}
    right.errorbar(np.arange(1, len(scaled) + 1)[usable], scaled[usable], **bars)
    left.set_xlim(left=0.0)
    left.xaxis.set_major_locator(MaxNLocator(6))
    left.set_xlabel(of.label("a/b", "s/m") if two else "$W$ (J)")
    left.set_ylabel(of.label("W/b", "N s/m") if two else "energy lost by the fitted law (J)")
    right.axhline(0.0, color=FAINT, linewidth=0.6, zorder=0)
    right.set_xlabel("row")
    right.set_ylabel(r"residual/$\sigma$")
    right.xaxis.set_major_locator(MaxNLocator(integer=True))
    largest = max((abs(v) for v in right.get_ylim()), default=1.0)
    if largest > 20.0:
        right.set_yscale("symlog", linthresh=3.0)
    return explained(figure)


@styled()
def decays(fit: DecayFit, turns: Sequence[tuple[Array, Array]], of: Coordinate) -> Figure:
    """Return each decay (dots), the fitted motion (line) and the turning points that the balance uses (rings), a panel
    for each of the first 24 decays; below, the residuals in standard deviations of the noise.

    turns : of each decay, rows (t, x), s and m, and their errors.
    """
    shown = fit.decays[:24]
    last_channel = {i: (signal, residual) for i, signal, residual in fit.residuals(of_samples=True)}
    figure, panels = _panels([one.source for one in shown], 30.0, 12.0, below=11.0)
    for i, one in enumerate(shown):
        (axes, below), (signal, residual) = panels[i], last_channel[i]
        symbol, factor, unit, _ = _SHOWN[signal.quantity]
        # 1.5 periods of rest are shown after the motion
        end = min(one.end, one.start + fit.sticks_from(i) + 1.5 * one.period)
        seen = np.flatnonzero(signal.t <= end)
        seen = seen[:: max(1, seen.size // _POINTS)]
        t, values, residual = (a[seen] for a in (signal.t, signal.values, residual))
        axes.plot(t, factor * values, ".", label="samples", **_DOTS)
        look: dict[str, Any] = {"color": SLIP, "linewidth": 0.6, "label": "fitted oscillator"}
        axes.plot(t, factor * (values + residual * signal.noise), **look)
        if signal.order == 0:
            t_turn, x_turn = turns[i][0].T
            x = factor * (x_turn + fit.value(offset_of(signal)))
            rings: dict[str, Any] = {"markersize": 2.5, "fillstyle": "none", "label": "turns"}
            axes.plot(t_turn, x, "o", color=STICK, **rings)
        _with_residual(axes, below, t, residual, (one.start, end), of.label(symbol, unit))
        below.set_xlabel("$t$ (s)", labelpad=1.0)
    return explained(figure, scale=2.0)


@styled()
def damping(rows: Sequence[SwingDamping], of: Coordinate) -> Figure:
    """Return damping ratio and frequency over the amplitude, with their 95 % intervals, a colour for each mode."""
    figure = page(DOUBLE_COLUMN, 74.0)
    left, right = place(figure, 17.0, 20.0, 68.0, 50.0), place(figure, 107.0, 20.0, 70.0, 50.0)
    for mode, colour in zip(sorted({one.mode for one in rows}), (STICK, SLIP, FAINT), strict=False):
        own = [one for one in rows if one.mode == mode]
        X = [1e3 * one.X for one in own]
        look: dict[str, Any] = {"fmt": "o-", "color": colour, "markersize": 3.0, "linewidth": 0.6}
        zeta = 100.0 * np.array([(one.ratio, NORMAL_95 * one.ratio_error) for one in own])
        left.errorbar(X, *zeta.T, label=f"mode {mode}", **look)
        f = np.array([(one.hertz, NORMAL_95 * one.hertz_error) for one in own]) / own[0].hertz
        right.errorbar(X, *f.T, **look)
    left.set_ylabel(r"$\zeta$ (%)")
    left.set_ylim(bottom=0.0)
    right.set_ylabel("$f$ / $f$ of the largest amplitude")
    right.ticklabel_format(axis="y", useOffset=False)
    for axes in (left, right):
        axes.set_xlim(left=0.0)
        axes.set_xlabel(of.label("X", "mm"))
    return explained(figure) if rows[-1].mode > 1 else figure


def _with_residual(
    axes: Axes, below: Axes, along: Array, left: Array, ends: tuple[float, float], label: str
) -> None:
    """Draw the residuals of a fit below a panel of samples, in standard deviations of the noise."""
    below.plot(along, left, ".", **_DOTS)
    below.axhline(0.0, color=SLIP, linewidth=0.6)
    below.set_ylabel(r"residual/$\sigma$", labelpad=4.0, fontsize=7.0)
    below.yaxis.set_major_locator(MaxNLocator(3, integer=True, prune="upper"))
    for frame in (axes, below):
        frame.set_xlim(*ends)
    axes.tick_params(labelbottom=False)
    axes.set_ylabel(label, labelpad=1.0)


def _panels_of_records(
    records: Sequence[Record], xlabel: str, below: float = 0.0
) -> tuple[Figure, list[tuple[Axes, Axes]]]:
    """Return a panel for each record; only the lowest panels have a label along x."""
    figure, panels = _panels([record.label for record in records], 34.0, 9.0, below)
    for _, lowest in panels[-_across(len(panels)) :]:
        lowest.set_xlabel(xlabel)
    return figure, panels


def _across(count: int) -> int:
    """Return the number of panels in a row."""
    return 2 if count == 4 else min(count, 3)


def _panels(
    titles: Sequence[str], height: float, gap: float, below: float = 0.0
) -> tuple[Figure, list[tuple[Axes, Axes]]]:
    """Return a panel for each title, with a lower one where it has a height, mm; else that is the panel.

    height : of a panel, mm, where three stand abreast; fewer are wider and higher.   gap : between rows of them, mm.
    """
    across = _across(len(titles))
    height, pitch = height * _HIGHER[across], DOUBLE_COLUMN / across
    rows, step = math.ceil(len(titles) / across), height + below + gap
    top = _BOTTOM + rows * step - gap
    figure = page(DOUBLE_COLUMN, top + _TOP)
    panels = []
    for i, title in enumerate(titles):
        row, column = divmod(i, across)
        left, bottom = 13.0 + pitch * column, top - height - row * step
        axes = place(figure, left, bottom, pitch - 16.0, height)
        # mm, of a panel from its lower one, so that their labels along y do not touch
        size = pitch - 16.0, below - 2.0
        lower = place(figure, left, bottom - below, *size) if below else axes
        # a name is no mathematics, whatever it holds
        axes.set_title(cut(title, 60), pad=3.0, y=1.0, parse_math=False)
        panels.append((axes, lower))
    return figure, panels
