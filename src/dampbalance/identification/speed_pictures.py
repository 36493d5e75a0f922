"""The picture of friction at steady speeds: forces, law and residual."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from ..figures.style import DOUBLE_COLUMN, SLIP, STICK, explained, page, place, styled
from ..fit.friction_speed import SpeedFit, SteadySpeeds, law
from ..records.coordinate import Coordinate


@styled()
def speeds(data: SteadySpeeds, fit: SpeedFit, of: Coordinate) -> Figure:
    """Return the force over the speed, and the friction (the force without its offset, in the direction of the motion)
    over the size of the speed: measured (dots, open for negative speeds) and by the law; below, the residuals."""
    figure = page(DOUBLE_COLUMN, 104.0)
    T_0, sizes = fit.value("T_0"), np.geomspace(data.sizes[0], data.sizes[-1], 200)
    left = data.F - law(fit.point, data.v)[0]
    speed, unit = of.noun("velocity"), of.unit("m/s")
    panels = []
    for at, sign, label in ((18.0, 1.0, of.noun("force")), (108.0, np.sign(data.v), "friction")):
        axes, lower = place(figure, at, 46.0, 68.0, 52.0), place(figure, at, 20.0, 68.0, 20.0)
        offset, x = (T_0, np.abs(data.v)) if label == "friction" else (0.0, data.v)
        for way, filled in ((1.0, SLIP), (-1.0, "none")):
            own = np.sign(data.v) == way
            if own.any():
                look = {"color": SLIP, "markerfacecolor": filled, "ms": 3.0, "mew": 0.6, "ls": "none"}
                shown = (sign * (data.F - offset))[own] if offset or label == "friction" else data.F[own]
                axes.plot(x[own], shown, marker="o", **look)
                lower.plot(x[own], (sign * left)[own], marker="o", **look)
                v = way * sizes
                force = law(fit.point, v)[0]
                force = way * (force - T_0) if label == "friction" else force
                axes.plot(np.abs(v) if label == "friction" else v, force, color=STICK)
        lower.axhline(0.0, color=STICK)
        axes.tick_params(labelbottom=False)
        axes.set(ylabel=f"{label} ({of.unit('N')})")
        lower.set(ylabel=f"residual ({of.unit('N')})", xlabel=f"{speed} ({unit})")
        if label == "friction":
            axes.set(xscale="log")
            lower.set(xscale="log", xlabel=f"size of the {speed} ({unit})")
        panels.append((axes, axes))
    return explained(figure, panels[:1], scale=1.0)
