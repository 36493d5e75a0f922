"""The figures of the beam: what a cycle loses and how stiff it is against the amplitude, and the decay foretold."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ...figures import style
from ...figures.style import DASHED, FAINT, SLIP, STICK, page, place, styled
from .findings import Findings

_POINTS = 60
_LOOKS: dict[str, dict[str, Any]] = {
    "gradual": {"color": SLIP},
    "one slider": {"color": STICK, "ls": DASHED},
}

ALTERNATIVE_TEXTS = {
    "joint": "energy lost in a cycle over the square of the amplitude, and stiffness, against amplitude: lines of all "
    "levels, and the laws of a contact that yields gradually and of one slider",
    "blow": "damping ratio against amplitude: of the decay after a blow in each channel, and as the lines "
    "of the stepped sine foretell it; and the frequency of the decay",
}


@styled()
def joint(findings: Findings) -> Figure:
    """Im Z = W/(πX²) and Re Z + mω² of each line at its amplitude, with the laws."""
    figure = page(style.DOUBLE_COLUMN, 78.0)
    left, right = (place(figure, at, 20.0, 70.0, 53.0) for at in (14.0, 105.0))
    gradual = findings.fits["gradual"]
    mode = findings.lines.of_mode(gradual.values.get("R", 0.0))
    shades = np.argsort(np.argsort([mode.X[mode.level == i].max() for i in range(len(mode.names))]))
    m = gradual.values["m"]
    stiff = mode.Z.real + m * mode.omega**2
    look: dict[str, Any] = {"ls": "none", "marker": ".", "ms": 2.0, "zorder": 1}
    for i, shade in enumerate(shades):
        of = mode.level == i
        grey = f"{0.75 - 0.6 * shade / max(len(shades) - 1, 1):.3f}"
        left.plot(1e6 * mode.X[of], 1e-3 * mode.Z.imag[of], color=grey, **look)
        right.plot(1e6 * mode.X[of], 1e-3 * stiff[of], color=grey, **look)
    # the amplitude of the mode itself depends on R, which each law has of its own
    low, high = zip(*(findings.fits[name].X_range for name in _LOOKS), strict=True)
    X = np.geomspace(max(low), min(high), _POINTS)
    omega = float(mode.omega.mean())
    for name, of in _LOOKS.items():
        fit = findings.fits[name]
        loss, scale = fit.loss(X, omega), 1e-3 / (math.pi * X**2)
        left.plot(1e6 * X, scale * loss.value, label=name, zorder=3, **of)
        left.fill_between(
            1e6 * X, scale * loss.low, scale * loss.high, color=of["color"], alpha=0.2, lw=0.0
        )
        value, *ends = (1e-3 * (part + m * omega**2) for part in fit.stiffness(X, omega))
        right.plot(1e6 * X, value, zorder=3, **of)
        right.fill_between(1e6 * X, ends[0], ends[1], color=of["color"], alpha=0.2, lw=0.0)
    left.set_ylabel("$W/(\\pi X^2)$ (kN/m)", labelpad=1.0)
    right.set_ylabel("$\\mathrm{Re}\\,Z + m\\omega^2$ (kN/m)", labelpad=1.0)
    for axes, letter in ((left, "a"), (right, "b")):
        axes.set_xlabel("$X$ (µm)")
        style.panel_letter(axes, letter)
    handles, labels = left.get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=2, borderaxespad=0.2)
    return figure


@styled()
def blow(findings: Findings) -> Figure:
    """ζ(X) of the decay, a mark for each window and channel, and as the lines foretell it; below, its frequency."""
    figure = page(style.SINGLE_COLUMN, 104.0)
    upper, lower = (
        place(figure, 16.0, bottom, 69.0, high) for bottom, high in ((56.0, 42.0), (20.0, 32.0))
    )
    gradual = findings.fits["gradual"]
    of_point = next(iter(findings.decays.values()))
    look: dict[str, Any]
    for marker, (name, decay) in zip("os^vD", findings.decays.items(), strict=False):
        look = {"ls": "none", "marker": marker, "ms": 3.0, "mfc": "white", "mew": 0.6}
        # all channels are of one mode, and are drawn at the amplitude of the first
        X = 1e6 * np.interp(decay.t, of_point.t, of_point.X)
        seen = 1e6 * 0.5 * gradual.X_range[0] < X
        upper.plot(X[seen], 1e3 * decay.zeta[seen], color=FAINT, label=name, **look)
        lower.plot(X[seen], decay.frequency_hz[seen], color=FAINT, **look)
    inside = (gradual.X_range[0] < of_point.X) & (gradual.X_range[1] > of_point.X)
    X, band = 1e6 * of_point.X[inside], findings.foretold
    upper.plot(X, 1e3 * band.value, color=SLIP, label="foretold by the lines")
    upper.fill_between(X, 1e3 * band.low, 1e3 * band.high, color=SLIP, alpha=0.2, lw=0.0)
    upper.set_ylabel("$\\zeta$ (‰)", labelpad=1.0)
    upper.tick_params(labelbottom=False)
    lower.set_ylabel("frequency (Hz)", labelpad=1.0)
    lower.yaxis.set_major_formatter("{x:.2f}")
    lower.set_xlabel("$X$ (µm)")
    for axes in (upper, lower):
        axes.set_xscale("log")
    handles, labels = upper.get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=2, borderaxespad=0.2)
    return figure
