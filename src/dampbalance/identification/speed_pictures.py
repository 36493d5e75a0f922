"""The picture of friction at steady speeds: forces, law and residual."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ..figures.style import DOUBLE_COLUMN, SLIP, STICK, explained, page, place, styled
from ..fit.friction_speed import SpeedFit, law
from ..records.coordinate import Coordinate


@styled()
def speeds(fit: SpeedFit, of: Coordinate) -> Figure:
    """Return the force over the speed, and the friction (the force without its offset, in the direction of the motion)
    over the size of the speed: measured (dots, open for negative speeds) and by the law (lines); below, the
    residual."""
    figure, unit, data = page(DOUBLE_COLUMN, 104.0), of.unit("N"), fit.problem
    sizes = np.geomspace(data.sizes[0], data.sizes[-1], 200)
    for at, folded in ((20.0, False), (108.0, True)):
        axes, lower = place(figure, at, 46.0, 66.0, 52.0), place(figure, at, 20.0, 66.0, 20.0)
        offset = fit.value("T_0") if folded else 0.0
        for way, colour in ((1.0, SLIP), (-1.0, "none")):
            own, sign = np.sign(data.v) == way, way if folded else 1.0
            if not own.any():
                continue
            v, F, left = data.v[own], data.F[own], -fit.left[own]
            look: dict[str, Any] = {"color": SLIP, "markerfacecolor": colour, "markersize": 3.0}
            named = f"measured, {'positive' if way > 0.0 else 'negative'} direction"
            axes.plot(sign * v, sign * (F - offset), "o", label=named, **look)
            lower.plot(sign * v, sign * left, "o", **look)
            line = sign * (law(fit.point, way * sizes)[0] - offset)
            axes.plot(sign * way * sizes, line, color=STICK, label="law")
        lower.axhline(0.0, color=STICK)
        lower.margins(y=0.15)
        axes.tick_params(labelbottom=False)
        axes.set_ylabel(f"friction ({unit})" if folded else f"{of.noun('force')} ({unit})")
        lower.set_ylabel(f"residual ({unit})")
        speed = f"{of.noun('velocity')} ({of.unit('m/s')})"
        lower.set_xlabel(f"size of the {speed}" if folded else speed)
        for one in (axes, lower) if folded else ():
            one.set_xscale("log")
    return explained(figure)
