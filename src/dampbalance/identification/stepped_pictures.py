"""Pictures of a stepped sine: loss and stiffness against the amplitude, and the sliders of each contact."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from ..arrays import Array, Complexes
from ..figures.style import DOUBLE_COLUMN, SLIP, STICK, explained, page, place, styled
from ..fit.contacts import ContactFit
from ..fit.stiffness_lines import StiffnessLines
from ..records.coordinate import Coordinate


@styled()
def loss(lines: StiffnessLines, fits: Mapping[str, ContactFit], coordinate: Coordinate) -> Figure:
    """Return the energy lost per cycle against the amplitude: each line of a table (dots, darker at higher levels), and
    the law of each contact with its band of 95 %, at the median frequency."""
    look = {"yscale": "log", "ylabel": "energy lost per cycle, $W$ (mJ)"}

    def of(X: Array, omega: Array | float, Z: Complexes) -> Array:
        return np.asarray(1e3 * math.pi * X**2 * Z.imag)

    return _against_amplitude(lines, fits, of, coordinate, look)


@styled()
def stiffness(
    lines: StiffnessLines, fits: Mapping[str, ContactFit], coordinate: Coordinate
) -> Figure:
    """Return the stiffness against the amplitude: (F/X) cos φ + mω² of each line (dots, darker at higher levels), with
    the mass m of the first contact, and the law of each contact at the median frequency, with its band of 95 %."""
    m = next(iter(fits.values())).value("m")
    look = {"ylabel": f"stiffness ({coordinate.unit('N/mm')})"}

    def of(X: Array, omega: Array | float, Z: Complexes) -> Array:
        return np.asarray(1e-3 * (Z.real + m * omega**2))

    return _against_amplitude(lines, fits, of, coordinate, look)


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
    return explained(figure)


def _against_amplitude(
    lines: StiffnessLines,
    fits: Mapping[str, ContactFit],
    of: Callable[[Array, Array | float, Complexes], Array],
    coordinate: Coordinate,
    look: Mapping[str, str],
) -> Figure:
    """Return a quantity of the lines, and of the laws with their bands.   of : amplitude, m, angular frequency, rad/s,
    and dynamic stiffness, N/m.   look : of the axes."""
    figure = page(DOUBLE_COLUMN, 92.0)
    axes = place(figure, 22.0, 20.0, 150.0, 66.0)
    largest = [lines.X[lines.level == i].max() for i in range(len(lines.names))]
    values, omega = of(lines.X, lines.omega, lines.Z), float(np.median(lines.omega))
    shades = np.linspace(0.75, 0.15, len(largest))
    for shade, i in zip(shades, np.argsort(largest), strict=True):
        own = lines.level == i
        axes.plot(1e3 * lines.X[own], values[own], ".", color=str(shade), markersize=2.5)
    for (name, fit), colour in zip(fits.items(), (SLIP, STICK), strict=False):
        X = np.geomspace(*fit.X_range, 200)
        Z, reach = fit.law(X, omega)
        low, value, high = (of(X, omega, one) for one in (Z - reach, Z, Z + reach))
        axes.fill_between(1e3 * X, low, high, color=colour, alpha=0.25, lw=0)
        axes.plot(1e3 * X, value, color=colour, label=name)
    axes.set(xscale="log", xlabel=f"amplitude, {coordinate.label('X', 'mm')}", **look)
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    return explained(figure)
