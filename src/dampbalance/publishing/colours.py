"""The colours of the page, light and dark: one place for style sheet, drawings and pictures.

Text keeps a contrast of at least 4.5 : 1 to what it stands on, lines, marks and bars 3 : 1 (WCAG 2.2 AA: criteria 1.4.3
and 1.4.11). Colour never stands alone: verdicts have a symbol and a word, approaches a shape, a dash or a label.
"""

from __future__ import annotations

import math
from typing import Literal

from ..figures.looks import LOOKS, SPARE
from ..replication.claim_verdicts import VERDICTS

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
    "target": ("#e2eefa", "#132f4b"),  # the row that a link leads to
    "on-verdict": ("#ffffff", "#0f1317"),  # text on the colour of a verdict
}
# Lightness and chroma (OKLCH) of the three colours of a verdict, light and dark: their contrasts follow from the
# lightness alone, so that any hue will do.
_OF_VERDICT = {
    "": ((0.49, 0.14), (0.76, 0.12)),
    "-tint": ((0.95, 0.035), (0.30, 0.055)),
    "-text": ((0.40, 0.11), (0.87, 0.08)),
}
_BEST, _WORST = 138.0, 27.0  # hues of the first and the last verdict, degrees: green and red
_MOTION = {"slip": ("#2c5a8a", "#8fbcec"), "stick": ("#c75000", "#ff9a4d")}


def series() -> dict[str, tuple[str, str]]:
    """The colours of what is drawn, (light, dark) each: the approaches, spare ones, the phases of the motion."""
    looks = [*LOOKS.values(), *SPARE]
    return {look.series: (look.light, look.dark) for look in looks} | _MOTION


def verdicts() -> dict[str, tuple[str, str]]:
    """The colours of every verdict of `VERDICTS`, (light, dark) each: as a surface, as a tint under text, as text.

    The first is green, the last red; between them the hue goes once and a half around, so that neighbours differ.
    """
    step = (720.0 + _WORST - _BEST) / max(1, len(VERDICTS) - 1)
    return {
        f"{verdict.css}{use}": (_rgb(*light, _BEST + n * step), _rgb(*dark, _BEST + n * step))
        for n, verdict in enumerate(VERDICTS.values())
        for use, (light, dark) in _OF_VERDICT.items()
    }


def verdict_styles() -> str:
    """A rule of CSS per verdict: `.v-reproduced` has --fill, --tint and --text in its colours."""
    return "\n".join(
        f".v-{v.css} {{ --fill: {variable(v.css)}; --tint: {variable(f'{v.css}-tint')}; "
        f"--text: {variable(f'{v.css}-text')}; }}"
        for v in VERDICTS.values()
    )


def palette(mode: Mode) -> dict[str, str]:
    """All colours of the page by name, as #rrggbb."""
    which = ("light", "dark").index(mode)
    return {name: colours[which] for name, colours in (_GENERAL | verdicts() | series()).items()}


def css_variables(mode: Mode) -> str:
    """The colours as declarations of custom properties, `--ink: #1a2027; …`."""
    return " ".join(f"--{name}: {colour};" for name, colour in palette(mode).items())


def variable(name: str) -> str:
    """How a style or an SVG attribute refers to a colour, so that it follows light and dark by itself."""
    return f"var(--{name})"


def _rgb(lightness: float, chroma: float, hue: float) -> str:
    """A colour of OKLCH as #rrggbb; one outside sRGB loses chroma until it fits. hue : degrees."""
    while min(linear := _linear_rgb(lightness, chroma, hue)) < 0.0 or max(linear) > 1.0:
        chroma -= 0.002
    coded = (12.92 * c if c <= 0.0031308 else 1.055 * c ** (1 / 2.4) - 0.055 for c in linear)
    return "#" + "".join(f"{round(255.0 * c):02x}" for c in coded)


def _linear_rgb(lightness: float, chroma: float, hue: float) -> tuple[float, float, float]:
    """Linear red, green, blue of a colour of OKLCH, by Ottosson's matrices (2020)."""
    a, b = chroma * math.cos(math.radians(hue)), chroma * math.sin(math.radians(hue))
    long = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3
    medium = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3
    short = (lightness - 0.0894841775 * a - 1.2914855480 * b) ** 3
    return (
        4.0767416621 * long - 3.3077115913 * medium + 0.2309699292 * short,
        -1.2684380046 * long + 2.6097574011 * medium - 0.3413193965 * short,
        -0.0041960863 * long - 0.7034186147 * medium + 1.7076147010 * short,
    )
