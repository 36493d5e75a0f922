"""Pictures of a stepped sine: loss and stiffness against the amplitude, and the sliders of each contact."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from ..arrays import Array
from ..figures.style import DOUBLE_COLUMN, SLIP, STICK, explained, page, place, styled
from ..fit.contacts import Band, ContactFit
from ..fit.stiffness_lines import StiffnessLines
from ..records.coordinate import Coordinate


@styled()
def loss(lines: StiffnessLines, fits: Mapping[str, ContactFit], coordinate: Coordinate) -> Figure:
    """Return the energy lost per cycle against the amplitude: each line of a table (dots, darker at higher levels), and
    the law of each contact with its band of 95 %, at the median frequency."""
    omega = float(np.median(lines.omega))
    laws = {name: partial(fit.loss, omega=omega) for name, fit in fits.items()}
    look = {"yscale": "log", "ylabel": "energy lost per cycle, $W$ (mJ)"}
    look["xlabel"] = f"amplitude, {coordinate.label('X', 'mm')}"
    return _against_amplitude(lines, math.pi * lines.X**2 * lines.Z.imag, fits, laws, 1e3, look)


@styled()
def stiffness(
    lines: StiffnessLines, fits: Mapping[str, ContactFit], coordinate: Coordinate
) -> Figure:
    """Return the stiffness against the amplitude: (F/X) cos φ + mω² of each line (dots, darker at higher levels), with
    the mass m of the first contact, and the law of each contact at the median frequency, with its band of 95 %."""
    m, omega = next(iter(fits.values())).values["m"], float(np.median(lines.omega))

    def law(fit: ContactFit, X: Array) -> Band:
        return Band(*(of + m * omega**2 for of in fit.stiffness(X, omega)))

    laws = {name: partial(law, fit) for name, fit in fits.items()}
    of_lines = lines.Z.real + m * lines.omega**2
    look = {"ylabel": f"stiffness ({coordinate.unit('N/mm')})"}
    look["xlabel"] = f"amplitude, {coordinate.label('X', 'mm')}"
    return _against_amplitude(lines, of_lines, fits, laws, 1e-3, look)


@styled()
def distribution(fits: Mapping[str, ContactFit], coordinate: Coordinate) -> Figure:
    """Return the stiffness of the sliders of each contact against the amplitude at which each begins to slip."""
    figure = page(DOUBLE_COLUMN, 82.0)
    axes = place(figure, 22.0, 20.0, 150.0, 56.0)
    for (name, fit), colour in zip(fits.items(), (SLIP, STICK), strict=False):
        r, kappa = 1e3 * fit.all_sliders.r, 1e-3 * fit.all_sliders.kappa
        axes.vlines(r, 0.0, kappa, color=colour, linewidth=0.8)
        axes.plot(r, kappa, "o", color=colour, markersize=3.0, label=name)
    axes.set(xscale="log", xlabel=f"slip onset {coordinate.label('r', 'mm')}")
    label = coordinate.label(r"\kappa", "N/mm")
    axes.set_ylabel(f"stiffness {label}")
    axes.set_ylim(bottom=0.0)
    return explained(figure, [(axes, axes)], scale=1.0)


def _against_amplitude(
    lines: StiffnessLines,
    values: Array,
    fits: Mapping[str, ContactFit],
    laws: Mapping[str, Callable[[Array], Band]],
    factor: float,
    look: Mapping[str, str],
) -> Figure:
    """Return values of the lines, and laws with their bands, all a factor times as large.   look : of the axes."""
    figure = page(DOUBLE_COLUMN, 92.0)
    axes = place(figure, 22.0, 20.0, 150.0, 66.0)
    largest = [lines.X[lines.level == i].max() for i in range(len(lines.names))]
    shades = np.linspace(0.75, 0.15, len(largest))
    for shade, i in zip(shades, np.argsort(largest), strict=True):
        own = lines.level == i
        axes.plot(1e3 * lines.X[own], factor * values[own], ".", color=str(shade), markersize=2.5)
    for (name, law), colour in zip(laws.items(), (SLIP, STICK), strict=False):
        low, high = fits[name].X_range
        X = np.geomspace(low, high, 200)
        of = law(X)
        axes.fill_between(
            1e3 * X, factor * of.low, factor * of.high, color=colour, alpha=0.25, lw=0
        )
        axes.plot(1e3 * X, factor * of.value, color=colour, label=name)
    axes.set(xscale="log", **look)
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    return explained(figure, [(axes, axes)], scale=1.0)
