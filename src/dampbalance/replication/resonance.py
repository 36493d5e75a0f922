"""Why the harmonic approaches fail off resonance: what each of the two causes costs, and what mends them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import pandas as pd

from ..project.wording import signed_percent
from .comparison import WAY, WAYS

RECIPES = {
    "mean": "one phase of the reversal for all levels, as in the paper",
    "reversal": "each level’s phase of the reversal",
    "crossing": "each level’s phase of the zero crossing",
    "shared": "one phase of the fundamental for all levels",
    "fundamental": "each level’s phase of the fundamental",
    "fourier": "Fourier balance",
}
"""A way of comparison.WAYS → in words: the paper's, then each mend."""


class Costs(NamedTuple):
    """The error of F_k by least squares at one frequency, as text, by what is wrong with the phase."""

    hz: str
    which: str  # the phase of the reversal, of each level
    shared: str  # one phase for all levels, but of the fundamental
    both: str
    neither: str


def off_resonance(approaches: pd.DataFrame, frequencies_hz: Mapping[str, float]) -> list[Costs]:
    """What the causes cost at each frequency but the first.

    approaches : as `comparison.approaches_table` gives it.
    """
    errors = _errors(approaches)

    def error(way: str, frequency: str) -> str:
        return signed_percent(0.01 * errors[*WAYS[way], frequency])

    return [
        Costs(
            f"{hz:g} Hz",
            which=error("reversal", name),
            shared=error("shared", name),
            both=error("mean", name),
            neither=error("fundamental", name),
        )
        for name, hz in list(frequencies_hz.items())[1:]
    ]


def mends(approaches: pd.DataFrame, frequencies_hz: Mapping[str, float]) -> dict[str, list[float]]:
    """Error of F_k, %, by least squares: every way of RECIPES in words → one for each frequency."""
    errors = _errors(approaches)
    return {
        words: [errors[*WAYS[way], name] for name in frequencies_hz]
        for way, words in RECIPES.items()
    }


def _errors(approaches: pd.DataFrame) -> dict[tuple[str, str, str, str], float]:
    """Error of F_k by least squares, %, by approach, phase, sharing and frequency."""
    keys = zip(*(approaches[name] for name in (*WAY, "frequency")), strict=True)
    return dict(zip(keys, approaches["F_k_error_percent"], strict=True))
