"""A picture of the match: for every part of the paper, which share of its printed numbers earns which verdict."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..figures.style import DOUBLE_COLUMN, page, place, styled
from ..replication.claims.verdicts import VERDICTS, Count
from .colours import palette

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@styled()
def match_figure(counts: Sequence[Count]) -> Figure:
    """Draw a bar for each part of the paper, with a stretch for each verdict and how many numbers earn it.

    counts : `replication.claims.verdicts.counts`, the last one of all parts.
    """
    colours, shown = palette("light"), [count for count in counts if count.computed]
    figure = page(DOUBLE_COLUMN, 26.0 + 7.0 * len(shown))
    axes = place(figure, 20.0, 18.0, DOUBLE_COLUMN - 34.0, 7.0 * len(shown))
    left = np.zeros(len(shown))
    for name, verdict in VERDICTS.items():
        n = np.array([count.of_verdict[name] for count in shown])
        share = n / [count.computed for count in shown]
        label = f"{verdict.mark} {name}"
        look: dict[str, Any] = {
            "color": colours[verdict.css],
            "edgecolor": colours["paper"],
            "label": label,
        }
        bars = axes.barh([count.part for count in shown], share, 0.75, left, **look)
        # a narrower stretch of a bar has no room for its count
        texts = [str(of) if part > 0.025 else "" for of, part in zip(n, share, strict=True)]
        axes.bar_label(bars, texts, label_type="center", color=colours["on-verdict"], weight="bold")
        left += share
    axes.bar_label(bars, [str(count.computed) for count in shown], padding=4.0)
    axes.set(xlim=(0.0, 1.0), xticks=[], title="Computed numbers, by the verdict of the rebuild")
    axes.invert_yaxis()
    axes.tick_params(left=False, right=False)
    axes.spines[:].set_visible(False)
    figure.legend(loc="lower center", ncols=5, prop={"family": "DejaVu Sans", "size": 7.0})
    return figure


def match_words(counts: Sequence[Count]) -> str:
    """Return what the picture shows, in a sentence."""
    numbers = ", ".join(f"{n} {name}" for name, n in counts[-1].of_verdict.items())
    return f"Of {counts[-1].computed} computed numbers: {numbers}."
