"""Why the harmonic approaches fail off resonance: what each of the two causes costs, and what mends them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import pandas as pd

from ...project.wording import percent

RECIPES = {
    "one phase of the reversal for all levels, as in the paper": ("X_s", "reversal", "common"),
    "each level’s phase of the reversal": ("X_s", "reversal", "individual"),
    "each level’s phase of the zero crossing": ("X_s", "zero_crossing", "individual"),
    "one phase of the fundamental for all levels": ("X_s", "fundamental", "common"),
    "each level’s phase of the fundamental": ("X_s", "fundamental", "individual"),
    "Fourier balance": ("fourier", "", ""),
}
"""A recipe in words → approach, phase and sharing, as in `comparison.approaches_table`: the paper's, then each mend."""


class Costs(NamedTuple):
    """Size of the error of F_k by least squares at one frequency, as text, by what is wrong with the phase."""

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

    def size(phase: str, sharing: str, frequency: str) -> str:
        return percent(0.01 * errors["X_s", phase, sharing, frequency])

    return [
        Costs(
            f"{hz:g} Hz",
            which=size("reversal", "individual", name),
            shared=size("fundamental", "common", name),
            both=size("reversal", "common", name),
            neither=size("fundamental", "individual", name),
        )
        for name, hz in list(frequencies_hz.items())[1:]
    ]


def mends(approaches: pd.DataFrame, frequencies_hz: Mapping[str, float]) -> dict[str, list[float]]:
    """Error of F_k, %, by least squares: every recipe of RECIPES in words → one for each frequency."""
    errors = _errors(approaches)
    return {
        words: [errors[*recipe, name] for name in frequencies_hz]
        for words, recipe in RECIPES.items()
    }


def _errors(approaches: pd.DataFrame) -> dict[tuple[str, str, str, str], float]:
    """Error of F_k by least squares, %, by approach, phase, sharing and frequency."""
    keys = zip(*(approaches[n] for n in ("approach", "phase", "sharing", "frequency")), strict=True)
    return dict(zip(keys, approaches["F_k_error_percent"], strict=True))
