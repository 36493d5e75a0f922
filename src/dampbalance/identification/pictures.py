"""Pictures of an identification: of forced records the averaged cycles, the loops with the microstick lines, and the
rows of the balance; of free decays each decay with the motion fitted to it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from ..arrays import Array
from ..figures.looks import in_maths, label_of, look_of
from ..figures.style import DOUBLE_COLUMN, FAINT, SLIP, STICK, page, place, styled
from ..project.wording import cut
from ..reading.mean_harmonics import Reading
from ..reading.ringdown_fit import COMMON, RingFit
from ..records.measurement import ORDERS, RELATIVE
from .answer import Answer
from .loading import Loaded
from .microstick import Microstick

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
_LONGEST_TITLE = 60  # characters
_MOST_DECAYS = 24  # panels
_BOTTOM, _TOP = 11.0, 7.0  # mm
_DOTS: dict[str, Any] = {"color": FAINT, "markersize": 1.0, "rasterized": True}


@styled()
def cycles(loaded: Sequence[Loaded], readings: Sequence[Reading]) -> Figure:
    """Each record folded onto one cycle of the drive (dots), and its averaged cycle (line), a panel per record.

    Of several response channels the sharpest is shown. The phase is that of the base, whose peak is at 0.
    """
    figure, panels = _panels_of_records(loaded, "phase of the drive (°)")
    for one, reading, axes in zip(loaded, readings, panels, strict=True):
        steady = reading.steady
        quantity = next(q for q in reversed(_SHOWN) if q in one.excerpt)
        symbol, factor, unit, column = _SHOWN[quantity]
        t, values = one.excerpt[quantity]
        kept = _thinned(t.size)
        base = float(np.angle(steady.mean(steady.Y)[1]))
        theta = (steady.omega * (t[kept] - steady.start) + base) % (2.0 * math.pi)
        axes.plot(np.degrees(theta), factor * values[kept], ".", **_DOTS)
        averaged = reading.averaged_cycle()
        # an averaged cycle has no mean, the zero of a transducer has
        channel = steady.channels[quantity]
        level = float(np.average(channel.coefficients[:, 0].real, weights=channel.weights))
        if quantity in RELATIVE and "force" not in steady.channels:
            y = steady.mean(steady.Y)[1] * (1j * steady.omega) ** ORDERS[quantity]
            turned = np.exp(1j * (averaged["phase"] - base))
            level = level - (y * turned).real
        line = factor * (averaged[column] + level)
        axes.plot(np.degrees(averaged["phase"]), line, color=STICK)
        axes.set_xlim(0.0, 360.0)
        axes.set_xticks([0, 90, 180, 270, 360])
        axes.set_ylabel(f"${symbol}$ ({unit})", labelpad=1.0)
    return figure


@styled()
def loops(loaded: Sequence[Loaded], readings: Sequence[Reading], shared: Microstick) -> Figure:
    """Acceleration against displacement, a panel per record: the averaged cycle, and the lines fitted to it.

    The steep line from a reversal is the microstick line, of slope −(k + K_z)/m; where it ends slip begins (dot). It
    has the length `shared` by all records; where that is not resolved, no line is drawn.
    """
    figure, panels = _panels_of_records(loaded, "$x$ (mm)")
    for reading, axes in zip(readings, panels, strict=True):
        cycle = reading.averaged_cycle()
        x, acceleration = 1e3 * cycle["x"], cycle["acceleration"]
        axes.plot(np.append(x, x[0]), np.append(acceleration, acceleration[0]), color=SLIP)
        waveform = reading.waveform
        if shared.resolved and waveform is not None:
            osc, X = waveform.response.orbit.oscillator, 1e3 * waveform.response.X
            length = 1e3 * shared.length
            drop = (osc.k * shared.length + 2.0 * osc.F_k) / osc.m
            start = float(acceleration[int(np.argmin(x))])  # at the reversal
            for sign in (1.0, -1.0):
                line = sign * np.array([[-X, length - X], [start, start - drop]])
                axes.plot(*line, color=STICK)
                axes.plot(*line[:, 1], "o", color=STICK, markersize=2.5)
        axes.set_ylabel(r"$\ddot x$ (m/s²)", labelpad=1.0)
        axes.margins(0.08)
    return figure


@styled()
def balance(answers: Mapping[str, Answer], two: bool) -> Figure:
    """The rows of the balance, and their residuals.

    (a) W/b against a/b: a F_k + b c = W is a straight line of slope F_k that meets the axis at c. The line is that of
    the first answer. Of another law, what its terms take, Σ g_j p_j, against W; the line is where they are equal.
    (b) what each row leaves, over its standard deviation, for every approach.

    two : whether the law has F_k and c, and nothing else.
    """
    figure = page(DOUBLE_COLUMN, 78.0)
    left, right = place(figure, 17.0, 20.0, 68.0, 50.0), place(figure, 107.0, 20.0, 70.0, 50.0)
    for axes in (left, right):
        axes.set_title("", y=1.0)
    checks = {name: answer for name, answer in answers.items() if answer.balance is not None}
    (best, first), check = next(iter(answers.items())), next(iter(checks.values()))
    for index, (name, answer) in enumerate(checks.items()):
        assert answer.balance is not None
        rows, usable, off = answer.balance.rows, answer.balance.rows.usable, answer.row_misfit
        look = look_of(name)
        marks: dict[str, Any] = {"color": look.colour, "fillstyle": "none"}
        marks["label"] = in_maths(label_of(name))
        with np.errstate(divide="ignore", invalid="ignore"):
            along, height = (
                (rows.terms["F_k"] / rows.terms["c"], rows.W / rows.terms["c"])
                if two
                else (rows.W, rows.W + off)
            )
            scaled = off / answer.balance.errors
        left.plot(along[usable], height[usable], look.marker, **marks)
        values = {**rows.given, **first.values}
        if answer is check and all(math.isfinite(values[symbol]) for symbol in rows.terms):
            ends = np.array([0.0, 1.06 * float(np.max(along[usable]))])
            line = values["F_k"] * ends + values["c"] if two else ends
            words = f"line: {in_maths(label_of(best))}" if two else None
            left.plot(ends, line, color=FAINT, zorder=0, label=words)
        places = np.arange(len(scaled)) + 1 + 0.12 * (index - 0.5 * (len(checks) - 1))
        bars: dict[str, Any] = {"yerr": 1.0, "fmt": look.marker, "elinewidth": 0.6, **marks}
        right.errorbar(places[usable], scaled[usable], **bars)
    left.set_xlim(left=0.0)
    left.set_xlabel("$a/b$ (s/m)" if two else "$W$ (J)")
    left.set_ylabel("$W/b$ (N s/m)" if two else "energy lost, by the law (J)")
    right.axhline(0.0, color=FAINT, linewidth=0.6, zorder=0)
    right.set_xlabel("record")
    right.set_ylabel("residual / standard deviation")
    right.xaxis.set_major_locator(MaxNLocator(integer=True))
    largest = max((abs(v) for v in right.get_ylim()), default=1.0)
    if largest > 20.0:
        right.set_yscale("symlog", linthresh=3.0)
    handles, labels = left.get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=max(1, len(labels)), borderaxespad=0.3)
    return figure


@styled()
def decays(fit: RingFit, turns: Sequence[tuple[Array, Array]]) -> Figure:
    """Each decay (dots), the motion of the oscillator of largest likelihood (line) and the turns read for the balance
    (rings); below, what the fit leaves, over the standard deviation of the noise. A panel per decay, the first 24.

    turns : of each decay, rows (t, x), s and m, and their errors.
    """
    shown = fit.decays[:_MOST_DECAYS]
    last_channel = {i: (signal, residual) for i, signal, residual in fit.residuals()}
    figure, panels = _panels([one.source for one in shown], 30.0, 12.0, below=9.0)
    for i, one in enumerate(shown):
        (axes, below), (signal, residual) = panels[i], last_channel[i]
        symbol, factor, unit, _ = _SHOWN[signal.quantity]
        kept = _thinned(signal.t.size)
        t = signal.t[kept]
        axes.plot(t, factor * signal.values[kept], ".", **_DOTS)
        model = signal.values + residual * signal.noise
        axes.plot(t, factor * model[kept], color=SLIP, linewidth=0.6)
        if signal.order == 0:
            t_turn, x_turn = turns[i][0].T
            x = factor * (x_turn + float(fit.point[len(COMMON) + signal.offset]))
            axes.plot(t_turn, x, "o", color=STICK, markersize=2.5, fillstyle="none")
        below.plot(t, residual[kept], ".", **_DOTS)
        below.axhline(0.0, color=SLIP, linewidth=0.6)
        for frame in (axes, below):
            frame.set_xlim(one.start, one.end)
        axes.set_xticklabels([])
        axes.set_ylabel(f"${symbol}$ ({unit})", labelpad=1.0)
        below.set_xlabel("$t$ (s)", labelpad=1.0)
    return figure


def _thinned(size: int) -> slice:
    """The samples that are drawn of so many."""
    return slice(None, None, max(1, size // _POINTS))


def _panels_of_records(loaded: Sequence[Loaded], xlabel: str) -> tuple[Figure, list[Axes]]:
    """A panel for each record; the lowest of each column has the label of the abscissa."""
    figure, panels = _panels([one.record.label for one in loaded], 34.0, 9.0)
    for axes, _ in panels[-3:]:
        axes.set_xlabel(xlabel)
    return figure, [axes for axes, _ in panels]


def _panels(
    titles: Sequence[str], height: float, gap: float, below: float = 0.0
) -> tuple[Figure, list[tuple[Axes, Axes]]]:
    """A panel for each title, three abreast, with a lower one where it has a height, mm; else that is the panel."""
    rows, pitch = math.ceil(len(titles) / 3), height + below + gap
    top = _BOTTOM + rows * pitch - gap
    figure = page(DOUBLE_COLUMN, top + _TOP)
    panels = []
    for i, title in enumerate(titles):
        row, column = divmod(i, 3)
        left, bottom = 13.0 + 60.0 * column, top - height - row * pitch
        axes = place(figure, left, bottom, 44.0, height)
        lower = place(figure, left, bottom - below, 44.0, below) if below else axes
        # a name is no mathematics, whatever it holds
        axes.set_title(cut(title, _LONGEST_TITLE), pad=3.0, y=1.0, parse_math=False)
        panels.append((axes, lower))
    return figure, panels
