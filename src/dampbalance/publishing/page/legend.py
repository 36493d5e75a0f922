"""What the lines and marks of a chart stand for: entries of a legend, each a small picture and words."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from markupsafe import Markup

from ...figures.looks import Look, label_of, look_of
from ...figures.series import SHARINGS
from .colours import outlined, shape, variable
from .words import titled

_LINE = Markup(
    '<svg class="key" viewBox="0 0 34 14" aria-hidden="true"><path d="M1 7H33" stroke="{}" stroke-width="{}"{}/></svg>'
)
_MARK = Markup('<svg class="key dot" viewBox="10 0 14 14" aria-hidden="true">{}</svg>')


@dataclass(frozen=True, slots=True)
class Entry:
    """One entry of a legend: its picture, as SVG, and its words, as HTML."""

    picture: Markup
    words: Markup


def line(words: str, colour: str, width: float = 2.0, dash: str = "") -> Entry:
    """A curve. words : as for `words.titled`.   colour : for a style.   dash : lengths of strokes and gaps, px."""
    dashes = Markup(' stroke-dasharray="{}"').format(dash) if dash else ""
    return Entry(_LINE.format(colour, width, dashes), titled(words))


def mark(words: str, look: Look, filled: bool = True) -> Entry:
    """A mark of the shape and in the colour of a look."""
    return Entry(_MARK.format(shape(look) if filled else outlined(look)), titled(words))


def of_approaches(approaches: Iterable[str], sharings: Iterable[str], marks: bool) -> list[Entry]:
    """The approaches, as marks or lines, and how filling or dashes tell whether levels share φ and t_s."""
    looks = {key: look_of(key) for key in approaches}
    entries = [
        mark(label_of(key), look)
        if marks
        else line(label_of(key), variable(look.series), look.page_width)
        for key, look in looks.items()
    ]
    shared = list(sharings)
    if len(shared) < 2:
        return entries
    return entries + [_sharing(name, marks) for name in SHARINGS if name in shared]


def _sharing(name: str, marks: bool) -> Entry:
    """A line or a mark in the colour of text: solid or open with φ and t_s of each level, dashed or filled without."""
    words, common = f"phi and t_s {SHARINGS[name]}", name == "common"
    if not marks:
        return line(words, variable("ink"), dash="6 4" if common else "")
    fill = variable("ink" if common else "paper")
    circle = Markup('<circle cx="17" cy="7" r="5" stroke="{}" stroke-width="1.6" fill="{}"/>')
    return Entry(_MARK.format(circle.format(variable("ink"), fill)), titled(words))
