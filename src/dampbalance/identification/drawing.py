"""What an identification looks like: the records with their averaged cycle, the loops with the fitted lines, and the
rows of the balance with what is left of them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from ..figures.looks import in_maths, label_of, look_of
from ..figures.style import DOUBLE_COLUMN, FAINT, SLIP, STICK, page, place, styled
from ..project.wording import cut
from .loading import Loaded
from .result import Identification

DPI = 200  # pictures to look at: in print they are SVG

_POINTS = 6000  # samples drawn at most
_SHOWN = {  # quantity → (symbol, factor, unit, column of the averaged cycle)
    "displacement": ("x", 1e3, "mm", "x"),
    "velocity": (r"\dot x", 1.0, "m/s", "v"),
    "acceleration": (r"\ddot x", 1.0, "m/s²", "acceleration"),
}
_LONGEST_TITLE = 60  # characters
_HEIGHT, _GAP, _BOTTOM, _TOP = 34.0, 9.0, 11.0, 7.0  # mm


@styled()
def cycles(loaded: Sequence[Loaded], result: Identification) -> Figure:
    """Each record folded onto one cycle of the drive (dots), and its averaged cycle (line), a panel per record.

    Of several response channels the sharpest is shown. The phase is that of the base, whose peak is at 0.
    """
    figure, panels = _panels(loaded, "phase of the drive (°)")
    for one, reading, axes in zip(loaded, result.readings, panels, strict=True):
        steady = reading.steady
        quantity = next(q for q in reversed(_SHOWN) if q in one.excerpt)
        symbol, factor, unit, column = _SHOWN[quantity]
        t, values = one.excerpt[quantity]
        kept = slice(None, None, max(1, t.size // _POINTS))
        base = float(np.angle(steady.mean(steady.Y)[1]))
        theta = (steady.omega * (t[kept] - steady.start) + base) % (2.0 * math.pi)
        dots: dict[str, Any] = {"color": FAINT, "markersize": 1.0, "rasterized": True}
        axes.plot(np.degrees(theta), factor * values[kept], ".", **dots)
        averaged = reading.averaged_cycle()
        channel = steady.channels[
            quantity
        ]  # an averaged cycle has no mean, a transducer's zero has
        level = float(np.average(channel.coefficients[:, 0].real, weights=channel.weights))
        line = factor * (averaged[column] + level)
        axes.plot(np.degrees(averaged["phase"]), line, color=STICK)
        axes.set_xlim(0.0, 360.0)
        axes.set_xticks([0, 90, 180, 270, 360])
        axes.set_ylabel(f"${symbol}$ ({unit})", labelpad=1.0)
    return figure


@styled()
def loops(loaded: Sequence[Loaded], result: Identification) -> Figure:
    """Acceleration against displacement, a panel per record: the averaged cycle, and the lines fitted to it.

    The steep line from a reversal is the microstick line, of slope −(k + K_z)/m; where it ends slip begins (dot). It
    has the length that all records share. Where that is not resolved, there is none.
    """
    figure, panels = _panels(loaded, "$x$ (mm)")
    shared = result.microstick
    for reading, axes in zip(result.readings, panels, strict=True):
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
def balance(result: Identification) -> Figure:
    """The rows of the balance, and their residuals.

    (a) W/b against a/b: a F_k + b c = W is a straight line of slope F_k that meets the axis at c. The line is that of
    the direct balance. Of another law, what its terms take, Σ g_j p_j, against W; the line is where they are equal.
    (b) what each row leaves, over its standard deviation, for every approach.
    """
    figure = page(DOUBLE_COLUMN, 78.0)
    left, right = place(figure, 17.0, 20.0, 68.0, 50.0), place(figure, 107.0, 20.0, 70.0, 50.0)
    for axes in (left, right):
        axes.set_title("", y=1.0)
    two = set(result.law.keys) == {"F_k", "c"}
    for index, (name, estimated) in enumerate(result.estimates.items()):
        rows, usable = estimated.rows, estimated.rows.usable
        look = look_of(name)
        marks: dict[str, Any] = {"color": look.colour, "fillstyle": "none"}
        marks["label"] = in_maths(label_of(name))
        values = {symbol: p.value for symbol, p in estimated.coefficients.items()}
        with np.errstate(divide="ignore", invalid="ignore"):
            if two:
                along, height = rows.terms["F_k"] / rows.terms["c"], rows.W / rows.terms["c"]
            else:
                along, height = rows.W, rows.W + rows.misfit({**rows.given, **values})
        left.plot(along[usable], height[usable], look.marker, **marks)
        if index == 0 and np.isfinite(list(values.values())).all():
            ends = np.array([0.0, 1.06 * float(np.max(along[usable]))])
            line = values["F_k"] * ends + values["c"] if two else ends
            left.plot(ends, line, color=FAINT, zorder=0)
        off = rows.misfit({**rows.given, **values})
        with np.errstate(divide="ignore", invalid="ignore"):
            scaled = off / estimated.row_errors
        places = np.arange(len(scaled)) + 1 + 0.12 * (index - 0.5 * (len(result.estimates) - 1))
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


def alternative_texts(result: Identification) -> Mapping[str, str]:
    """What each figure shows, in words."""
    count = len(result.readings)
    two = set(result.law.keys) == {"F_k", "c"}
    line = "on a line of slope F_k" if two else "on the line where the law takes the input work"
    return {
        "cycles": f"{count} records folded onto one cycle of the drive, with their averaged cycle",
        "loops": f"acceleration against displacement of {count} records, with the fitted microstick lines",
        "balance": f"rows of the energy balance {line}, and the residual of each row by approach",
    }


def _panels(loaded: Sequence[Loaded], xlabel: str) -> tuple[Figure, list[Axes]]:
    """A panel for each record, three abreast; the lowest of each column has the label of the abscissa."""
    rows = math.ceil(len(loaded) / 3)
    height = _BOTTOM + rows * (_HEIGHT + _GAP) - _GAP + _TOP
    figure = page(DOUBLE_COLUMN, height)
    panels = []
    for i, one in enumerate(loaded):
        row, column = divmod(i, 3)
        bottom = height - _TOP - _HEIGHT - row * (_HEIGHT + _GAP)
        panels.append(place(figure, 13.0 + 60.0 * column, bottom, 44.0, _HEIGHT))
        # a name is no mathematics, whatever it holds
        panels[-1].set_title(
            cut(one.record.label, _LONGEST_TITLE), pad=3.0, y=1.0, parse_math=False
        )
    for axes in panels[-3:]:
        axes.set_xlabel(xlabel)
    return figure, panels
