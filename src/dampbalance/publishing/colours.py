"""The colours of the page, light and dark: one place for style sheet, drawings and pictures.

Text keeps a contrast of at least 4.5 : 1 to what it stands on, lines, marks and bars 3 : 1 (WCAG 2.2 AA: criteria 1.4.3
and 1.4.11). Colour never stands alone: verdicts have a symbol and a word, approaches a shape, a dash or a label.
"""

from __future__ import annotations

from typing import Literal

from ..figures.looks import LOOKS, SPARE
from ..replication.claims.verdicts import VERDICTS

Mode = Literal["light", "dark"]

_GENERAL = {
    "paper": ("#ffffff", "#14181d"),  # the page
    "raised": ("#f4f6f8", "#1d232b"),  # surfaces on the page: table heads, boxes
    "ink": ("#1a2027", "#e7ebf0"),
    "muted": ("#4f5966", "#aab4c0"),  # notes, axis labels
    "rule": ("#d4dae1", "#353e49"),  # decorative lines
    "edge": ("#7b8694", "#7c8896"),  # outlines of inputs and buttons
    "link": ("#0b4f8a", "#86bdf5"),
    "focus": ("#b3450a", "#ffb066"),
    "target": ("#e2eefa", "#132f4b"),  # the row that a link leads to
    "on-verdict": ("#ffffff", "#0f1317"),  # text on the colour of a verdict
}
# Colours of a verdict as a surface, as a tint under text, as text: light, then dark. Each column has one lightness of
# OKLCH, from which contrasts follow; hues differ from one verdict to the next.
_OF_VERDICT = {
    "reproduced": ("#327213", "#e3f5de", "#265511", "#8bc377", "#1f3418", "#bbe1ae"),
    "simulated": ("#046798", "#e0f1fe", "#024d73", "#62bbf5", "#0f3146", "#aadbfe"),
    "from-print": ("#954804", "#ffeade", "#713400", "#ed9b67", "#432512", "#fec6a5"),
    "last-digit": ("#923a78", "#ffe6f5", "#6d2b59", "#e592c8", "#402236", "#fac0e4"),
    "reading": ("#7c5a02", "#faedd5", "#5d4301", "#d6a94f", "#3b2b07", "#eed098"),
    "propagated": ("#037066", "#d6f7f1", "#02544c", "#3ccaba", "#003631", "#96e6da"),
    "unexplained": ("#5b50ab", "#ecedfe", "#443c7f", "#aaa6fa", "#2b2948", "#cfcfff"),
    "undecided": ("#626602", "#eff1d8", "#494c02", "#b3b959", "#2e300b", "#d5da9d"),
    "differs": ("#a13832", "#fee9e6", "#782a25", "#f49287", "#46221e", "#fec4bc"),
}
_MOTION = {"slip": ("#2c5a8a", "#8fbcec"), "stick": ("#c75000", "#ff9a4d")}


def series() -> dict[str, tuple[str, str]]:
    """Return the colours of what is drawn, (light, dark) each: the approaches, spare ones, the phases of the motion."""
    looks = [*LOOKS.values(), *SPARE]
    return {look.series: (look.light, look.dark) for look in looks} | _MOTION


def verdicts() -> dict[str, tuple[str, str]]:
    """Return the colours of every verdict, (light, dark) each: as a surface, as a tint under text, as text."""
    return {
        f"{verdict.css}{use}": (_OF_VERDICT[verdict.css][n], _OF_VERDICT[verdict.css][n + 3])
        for verdict in VERDICTS.values()
        for n, use in enumerate(("", "-tint", "-text"))
    }


def palette(mode: Mode) -> dict[str, str]:
    """Return all colours of the page by name, as #rrggbb."""
    which = ("light", "dark").index(mode)
    return {name: colours[which] for name, colours in (_GENERAL | verdicts() | series()).items()}


def css_variables(mode: Mode) -> str:
    """Return the colours as declarations of custom properties, `--ink: #1a2027; …`."""
    return " ".join(f"--{name}: {colour};" for name, colour in palette(mode).items())


def variable(name: str) -> str:
    """Return how a style or an SVG attribute refers to a colour, so that it follows light and dark mode."""
    return f"var(--{name})"
