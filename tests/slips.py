"""Words that slip out of a program: numbers and signs that no person would write in a sentence."""

from __future__ import annotations

import re

KINDS = {
    "a power of ten of a program": r"\d[eE]\+\d",
    "a number that is none": r"\b(?:nan|inf)\b",
    "a share of more than four digits": r"(?<![\d.])(?:0\.0*)?[1-9](?:\.?\d){4,} %",
    "a minus of zero": r"(?<![\w.·])[-−]0+(?:\.0+)?(?![\d.])",
    "two signs": r"[-−+]{2}\d|[-−+]–",
    "rounding": r"\d\.\d*(?:0{8,}|9{8,})\d",
    "an internal name": r"\b(?:rho|psi)\b",
    "no unit": r"\(\s*\)",
    "two marks": r"[?!.]\.(?!\.)|[?!;,]\s*[;,]",
    "a gap": r"\d ,|= [−\d.]+ {2,}\w",
    "a negative lag": r"\b(?:lags|leads)\b[^;:]* by [-−]",
}
"""What each is, and how it looks."""


def slips(text: str) -> list[tuple[str, str]]:
    """Every slip in a text, with the words about it."""
    return [
        (kind, text[max(0, at.start() - 40) : at.end() + 20])
        for kind, pattern in KINDS.items()
        for at in re.finditer(pattern, text)
    ]
