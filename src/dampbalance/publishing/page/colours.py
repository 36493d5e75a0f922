"""The colours of the page, light and dark: one place for style sheet, charts and pictures.

Text keeps a contrast of at least 4.5 : 1 to what it stands on, lines, marks and bars 3 : 1 (WCAG 2.2 AA: criteria 1.4.3
and 1.4.11). Colour never stands alone: verdicts have a symbol and a word, approaches a shape, a dash or a label.
"""

from __future__ import annotations

from ...replication import verdicts

LIGHT = {
    "paper": "#ffffff",  # the page
    "raised": "#f4f6f8",  # what lies on it: table heads, boxes
    "ink": "#1a2027",
    "muted": "#4f5966",  # notes, axis labels
    "rule": "#d4dae1",  # decorative lines
    "edge": "#7b8694",  # outlines of inputs and buttons
    "link": "#0b4f8a",
    "focus": "#b3450a",
    "reproduced": "#1d7546",
    "reconstructed": "#2166ac",
    "last-digit": "#8f5f00",
    "reading": "#8243a6",
    "differs": "#b42318",
    "on-verdict": "#ffffff",  # text on the five above
    "reproduced-tint": "#e0f3e7",
    "reconstructed-tint": "#e2eefa",
    "last-digit-tint": "#fbf0d4",
    "reading-tint": "#f3e7f9",
    "differs-tint": "#fde6e3",
    "reproduced-text": "#0f5531",
    "reconstructed-text": "#0d4a85",
    "last-digit-text": "#664300",
    "reading-text": "#652c86",
    "differs-text": "#8f1a12",
    "direct": "#1a2027",
    "X-s": "#0b5fa5",
    "t-s": "#c75000",
    "V-s": "#1f8468",
    "fourier": "#946a00",
    "other": "#8e4fc0",  # an approach that has no colour of its own yet
    "slip": "#2c5a8a",
    "stick": "#c75000",
}
DARK = {
    "paper": "#14181d",
    "raised": "#1d232b",
    "ink": "#e7ebf0",
    "muted": "#aab4c0",
    "rule": "#353e49",
    "edge": "#7c8896",
    "link": "#86bdf5",
    "focus": "#ffb066",
    "reproduced": "#5ec892",
    "reconstructed": "#72b2f0",
    "last-digit": "#dcae4c",
    "reading": "#c894e6",
    "differs": "#ff9084",
    "on-verdict": "#0f1317",
    "reproduced-tint": "#123524",
    "reconstructed-tint": "#132f4b",
    "last-digit-tint": "#3a2d0d",
    "reading-tint": "#362143",
    "differs-tint": "#4a1a16",
    "reproduced-text": "#93e2b5",
    "reconstructed-text": "#a6d0fb",
    "last-digit-text": "#f2d386",
    "reading-text": "#dfbcf3",
    "differs-text": "#ffb7af",
    "direct": "#e7ebf0",
    "X-s": "#6fb1f2",
    "t-s": "#ff9a4d",
    "V-s": "#56cfac",
    "fourier": "#f2c14e",
    "other": "#cf9ff0",
    "slip": "#8fbcec",
    "stick": "#ff9a4d",
}

VERDICTS = tuple(verdict.css for verdict in verdicts.VERDICTS.values())
SERIES = ("direct", "X-s", "t-s", "V-s", "fourier", "other", "slip", "stick")


def css_variables(colours: dict[str, str]) -> str:
    """The colours as declarations of custom properties, `--ink: #1a2027; …`."""
    return " ".join(f"--{name}: {colour};" for name, colour in colours.items())


def variable(name: str) -> str:
    """How a style or an SVG attribute refers to a colour, so that it follows light and dark by itself."""
    return f"var(--{name})"


def series_colour(key: str) -> str:
    """The reference to the colour of an approach, by its key in `balance.APPROACHES`."""
    name = key.replace("_", "-")
    return variable(name if name in SERIES else "other")
