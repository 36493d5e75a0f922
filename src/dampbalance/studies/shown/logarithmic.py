"""Powers of ten in the figures: whether values ask for a logarithmic axis, ticks that can be read on a short one, and
labels of approaches that are exact."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from ...arrays import Array
from ...figures.looks import in_maths, label_of

_SHORT = 12.0  # ratio of the ends of an axis up to which 1, 2, 3, 5 are labelled as well as powers of ten


def is_logarithmic(places: Sequence[float] | Array) -> bool:
    """Whether the logarithms of values, in ascending order, are spread evenly rather than the values themselves."""
    if len(places) < 3 or places[0] <= 0.0 or places[-1] / places[0] < 5.0:
        return False
    return is_even(np.log(places))


def is_even(places: Array) -> bool:
    """Whether most steps between values, in ascending order, are alike; single values in between do not matter."""
    steps = np.diff(places)
    usual = np.median(steps)
    return bool(np.median(np.abs(steps - usual)) < 0.05 * usual)


def logarithmic_ticks(axes: Axes, which: str, low: float, high: float, ends: bool = True) -> None:
    """Make an axis from low to high logarithmic, with labels at powers of ten, or at 1, 2, 3, 5 if it is short.

    ends : whether a tick at the upper end has a label (where no panel follows with which it would collide).
    """
    axes.set(**{f"{which}scale": "log"})
    axis = axes.xaxis if which == "x" else axes.yaxis
    short = high / low <= _SHORT
    subs = (1.0, 2.0, 3.0, 5.0) if short else (1.0,)
    axis.set_major_locator(LogLocator(base=10.0, subs=subs, numticks=20))
    axis.set_minor_locator(LogLocator(base=10.0, subs=np.arange(2.0, 10.0).tolist(), numticks=200))
    axis.set_minor_formatter(NullFormatter())

    def label(value: float, _: int) -> str:
        if not ends and value > 0.97 * high:
            return ""
        return f"{value:g}" if short else f"$10^{{{round(math.log10(value))}}}$"

    axis.set_major_formatter(FuncFormatter(label))


def bounded_label(approach: str, bound: float) -> str:
    """The label of an exact approach with the power of ten that its errors stay below.   bound : of them, %."""
    power = math.ceil(math.log10(max(bound, 1e-14)))
    return rf"{in_maths(label_of(approach))} (below $10^{{{power}}}$ %)"
