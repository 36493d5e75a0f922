"""How well the colours of the page stand out from one another, as WCAG 2.2 measures it, and which must."""

from __future__ import annotations

from dampbalance.publishing import colours
from dampbalance.replication.claims import verdicts

VERDICTS = tuple(verdict.css for verdict in verdicts.VERDICTS.values())
SERIES = tuple(colours.series())

TEXT_ON = [
    *((text, ground) for text in ("ink", "muted", "link") for ground in ("paper", "raised")),
    *(("on-verdict", verdict) for verdict in VERDICTS),
    *((f"{verdict}-text", f"{verdict}-tint") for verdict in VERDICTS),
    *((f"{verdict}-text", "paper") for verdict in VERDICTS),
    *((text, "target") for text in ("ink", "muted", "link")),
    *((series, "paper") for series in ("slip", "stick")),  # names of branches stand in their colour
]
"""(text, ground) of everything that is read."""

GRAPHICS_ON = [
    *((name, "paper") for name in (*VERDICTS, *SERIES, "edge", "focus", "muted")),
    *((name, "raised") for name in (*SERIES, "edge", "focus")),
]
"""(line, mark or outline, ground) of everything that is looked at."""


def contrast(one: str, other: str) -> float:
    """Contrast ratio of two colours #rrggbb, from 1 to 21, as WCAG 2.2 defines it."""
    low, high = sorted((_luminance(one), _luminance(other)))
    return (high + 0.05) / (low + 0.05)


def _luminance(colour: str) -> float:
    """Relative luminance of an sRGB colour."""
    channels = (int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
