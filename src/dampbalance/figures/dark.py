"""How figures, drawn for white paper, look on a dark screen: every colour that they use has a dark partner."""

from __future__ import annotations

import re

from .looks import LOOKS, SPARE
from .style import COOL, FAINT, GREY, GRID, INK, PAPER, SLIP, STICK, WARM

DARK: dict[str, str] = {
    INK: "#E7EBF0",
    PAPER: "#14181D",
    FAINT: "#AAB4C0",
    GRID: "#353E49",
    SLIP: "#8FBCEC",
    STICK: "#FF9A4D",
    GREY: "#4A525C",
    COOL: "#242C36",
    WARM: "#43301F",
    **{look.colour: look.dark for look in (*LOOKS.values(), *SPARE)},
}
"""Colour on white paper → colour on a dark screen, as #RRGGBB. Colour maps of errors are the same on both."""


def follows_the_screen(svg: str) -> str:
    """An SVG file of matplotlib that is drawn in the dark colours where the reader prefers them."""
    rules = "".join(dark_rules(svg))
    style = f"<style>@media (prefers-color-scheme: dark) {{ :root {{ fill: {DARK[INK]} }} {rules} }}</style>"
    return re.sub(r"<svg\b[^>]*>", lambda tag: tag[0] + style, svg, count=1)


def dark_rules(svg: str) -> list[str]:
    """Rules of CSS that replace the colours of an SVG of matplotlib, which writes them into `style` of each element.

    Text in the ink has no colour of its own: it takes the `fill` of what is around it.
    """
    partners = {colour.lower(): dark.lower() for colour, dark in DARK.items()}
    found = sorted(set(re.findall(r"\b(fill|stroke): (#[0-9a-f]{6})", svg)))
    return [
        f'[style*="{what}: {colour}"] {{ {what}: {partners[colour]} !important }}'
        for what, colour in found
        if colour in partners
    ]
