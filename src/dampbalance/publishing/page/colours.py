"""The colours of the page, light and dark: one place for style sheet, charts and pictures.

Text keeps a contrast of at least 4.5 : 1 to what it stands on, lines, marks and bars 3 : 1 (WCAG 2.2 AA: criteria 1.4.3
and 1.4.11). Colour never stands alone: verdicts have a symbol and a word, approaches a shape, a dash or a label.
"""

from __future__ import annotations

from typing import Literal

from markupsafe import Markup

from ...balance import APPROACHES
from ...figures.looks import SPARE, look_of

Mode = Literal["light", "dark"]

_GENERAL = {
    "paper": ("#ffffff", "#14181d"),  # the page
    "raised": ("#f4f6f8", "#1d232b"),  # what lies on it: table heads, boxes
    "ink": ("#1a2027", "#e7ebf0"),
    "muted": ("#4f5966", "#aab4c0"),  # notes, axis labels
    "rule": ("#d4dae1", "#353e49"),  # decorative lines
    "edge": ("#7b8694", "#7c8896"),  # outlines of inputs and buttons
    "link": ("#0b4f8a", "#86bdf5"),
    "focus": ("#b3450a", "#ffb066"),
    "reproduced": ("#1d7546", "#5ec892"),
    "reconstructed": ("#2166ac", "#72b2f0"),
    "last-digit": ("#8f5f00", "#dcae4c"),
    "reading": ("#8243a6", "#c894e6"),
    "differs": ("#b42318", "#ff9084"),
    "on-verdict": ("#ffffff", "#0f1317"),  # text on the five above
    "reproduced-tint": ("#e0f3e7", "#123524"),
    "reconstructed-tint": ("#e2eefa", "#132f4b"),
    "last-digit-tint": ("#fbf0d4", "#3a2d0d"),
    "reading-tint": ("#f3e7f9", "#362143"),
    "differs-tint": ("#fde6e3", "#4a1a16"),
    "reproduced-text": ("#0f5531", "#93e2b5"),
    "reconstructed-text": ("#0d4a85", "#a6d0fb"),
    "last-digit-text": ("#664300", "#f2d386"),
    "reading-text": ("#652c86", "#dfbcf3"),
    "differs-text": ("#8f1a12", "#ffb7af"),
}
_MOTION = {"slip": ("#2c5a8a", "#8fbcec"), "stick": ("#c75000", "#ff9a4d")}

_SHAPES = {
    "circle": '<circle cx="17" cy="7" r="4.5" {0}/>',
    "square": '<rect x="12.5" y="2.5" width="9" height="9" {0}/>',
    "triangle-up": '<path d="M17 1.5L22.5 12H11.5Z" {0}/>',
    "cross": '<path d="M15 2h4v3h3v4h-3v3h-4v-3h-3V5h3Z" {0}/>',
    "diamond": '<path d="M17 1L23 7L17 13L11 7Z" {0}/>',
    "triangle-down": '<path d="M17 12.5L11.5 2H22.5Z" {0}/>',
    "triangle-left": '<path d="M11.5 7L22 1.5V12.5Z" {0}/>',
    "triangle-right": '<path d="M22.5 7L12 1.5V12.5Z" {0}/>',
}


def series() -> dict[str, tuple[str, str]]:
    """The colours of what charts draw, (light, dark) each: every approach, a spare one, the phases of the motion."""
    looks = [*(look_of(name) for name in APPROACHES), SPARE[0]]
    return {look.series: (look.light, look.dark) for look in looks} | _MOTION


def palette(mode: Mode) -> dict[str, str]:
    """All colours of the page by name, as #rrggbb."""
    which = ("light", "dark").index(mode)
    return {name: colours[which] for name, colours in (_GENERAL | series()).items()}


def css_variables(mode: Mode) -> str:
    """The colours as declarations of custom properties, `--ink: #1a2027; …`."""
    return " ".join(f"--{name}: {colour};" for name, colour in palette(mode).items())


def variable(name: str) -> str:
    """How a style or an SVG attribute refers to a colour, so that it follows light and dark by itself."""
    return f"var(--{name})"


def series_colour(approach: str) -> str:
    """The reference to the colour of an approach, by its key in `balance.APPROACHES`."""
    return variable(look_of(approach).series)


def shape(approach: str) -> Markup:
    """The mark of an approach in a legend, as an element of SVG."""
    return Markup(_SHAPES[look_of(approach).shape].format(f'fill="{series_colour(approach)}"'))
