"""The page of the real joint: what its tables say, in words, tables and figures, every number from the findings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from statistics import median
from typing import Any

from ..project.wording import in_words, minus, number, percent
from .frame import signed
from .words import templates

_UNITS = {
    **{"K_z": "N/m", "F_k": "N", "c": "N s/m", "k": "N/m", "k_3": "N/m³", "m": "kg", "R": "m/N"},
}
_ADDITIONS = {"residual": "residual receptance of other modes", "hardening": "hardening"}


def beam_page(document: Mapping[str, Any], limits: Sequence[str]) -> str:
    """The page, in Markdown.

    document : of the findings.   limits : what limits the identification, by its own account, a sentence each.
    """
    environment = templates()
    filters = (percent, number, in_words, signed, minus, median)
    environment.filters |= {function.__name__: function for function in filters} | {
        "interval": lambda ends, digits: " to ".join(number(end, digits) for end in ends),
        "sentence": lambda words: words[0].upper() + words[1:].rstrip(".") + ".",
    }
    resonances = [row["resonance_hz"] for row in document["levels"]]
    return environment.get_template("beam.md.j2").render(
        document=document,
        limits=limits,
        units=_UNITS,
        names=_ADDITIONS,
        um=lambda X: number(1e6 * X, 3),
        spread_hz=max(resonances) - min(resonances),
    )
