"""The look of each approach, in print and on the page.

An approach without an entry in `LOOKS` gets a spare look; labels come from `balance.APPROACHES`.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from ..balance import APPROACHES, Approach


@dataclass(frozen=True, slots=True)
class Look:
    """Colours and marks of one approach.

    colour, marker : in print, as matplotlib names them.
    series : what the page's style sheet calls its colour, which is `light` or `dark` as the reader has it.
    shape : of its marks in the page's instruments.
    """

    colour: str
    marker: str
    series: str
    light: str
    dark: str
    shape: str


LOOKS = {
    "direct": Look("#000000", "D", "direct", "#1a2027", "#e7ebf0", "diamond"),
    "X_s": Look("#0B4F8A", "o", "X-s", "#0b5fa5", "#6fb1f2", "circle"),
    "t_s": Look("#D55E00", "s", "t-s", "#c75000", "#ff9a4d", "square"),
    "V_s": Look("#3DAA8B", "^", "V-s", "#1f8468", "#56cfac", "triangle-up"),
    "fourier": Look("#EDA900", "P", "fourier", "#946a00", "#f2c14e", "cross"),
    "simpson": Look("#C51B7D", "s", "other-3", "#b3126b", "#f58cc0", "square"),
    "fit": Look("#8A5A2B", "*", "other-2", "#7a4a21", "#d9a679", "triangle-left"),
}
SPARE = (
    Look("#B57EDC", "v", "other", "#8e4fc0", "#cf9ff0", "triangle-down"),
    Look("#8A5A2B", "<", "other-2", "#7a4a21", "#d9a679", "triangle-left"),
    Look("#C51B7D", ">", "other-3", "#b3126b", "#f58cc0", "triangle-right"),
)
HARMONIC_LOOK = Look("#6A4C93", "p", "other", "#8e4fc0", "#cf9ff0", "circle")
"""One curve for all harmonic approaches, where they agree."""


def look_of(approach: str) -> Look:
    """Return the look of an approach: its own, or a spare one by its place among the approaches that have none."""
    if approach in LOOKS:
        return LOOKS[approach]
    others = [name for name in APPROACHES if name not in LOOKS]
    place = others.index(approach) if approach in others else len(others)
    return SPARE[place % len(SPARE)]


def label_of(approach: str) -> str:
    """Return the label of an approach, or its name if it has none."""
    known = approach if isinstance(approach, Approach) else APPROACHES.get(approach)
    return known.label if known else approach


def in_maths(text: str) -> str:
    """Return text with its symbols set as matplotlib's mathematics, X_s as $X_s$.

    The page has `words.rich_markup` and `wording.plain_text`.
    """
    return re.sub(r"\b([A-Za-z]_\w)\b", r"$\1$", text)


def bounded_label(approach: str, bound: float) -> str:
    """Return the label of an exact approach with the power of ten that its errors stay below.   bound : of them, %."""
    power = math.ceil(math.log10(max(bound, 1e-14)))
    return rf"{in_maths(label_of(approach))} (below $10^{{{power}}}$ %)"
