"""Inputs of the page's instruments from the case; they compute everything else themselves."""

from __future__ import annotations

import math
from typing import Any

from ...figures.looks import label_of, look_of
from ...project.case import Case
from ...replication.comparison import RECIPES, WAY, WAYS_TO_COMPARE
from ..colours import variable
from ..typesetting import titled

IN_THE_BROWSER = ("direct", "X_s", "t_s", "V_s", "fourier")  # the approaches that kit.js knows
STEPS = 200  # of a slider, at least


def instruments_data(case: Case) -> dict[str, Any]:
    """Return the case in SI units, and what else the instruments need, as data that the page holds for `kit.js`.

    case : m, c, k, K_z, F_k, levels (m), frequencies (name → Hz) and pairs of levels (counted from 0).
    approaches : key → its label, colour and shape.
    steps : ways to correct the balance off resonance, the paper's two first.
    """
    return {
        "case": {
            **{name: getattr(case.oscillator, name) for name in ("m", "c", "k", "K_z", "F_k")},
            "levels": list(case.levels_m),
            "frequencies": dict(case.frequencies_hz),
            "pairs": [list(pair) for pair in case.pairs],
        },
        "approaches": {
            name: {"label": label_of(name), "colour": variable(look.series), "shape": look.shape}
            for name, look in zip(IN_THE_BROWSER, map(look_of, IN_THE_BROWSER), strict=True)
        },
        "steps": [
            dict(zip(WAY, WAYS_TO_COMPARE[way], strict=True)) | {"name": way, "words": words}
            for way, words in RECIPES.items()
        ],
    }


def slider_controls(case: Case) -> dict[str, dict[str, Any]]:
    """Return the sliders of the oscillator and its drive by name; their ranges include the case and its surroundings.

    Y, mm : up to a third above the highest level.   f, Hz : from below the lowest frequency to above the highest.
    c : up to twice its value.   F_k : up to the force kY of the lowest level, with which nothing slips any more.
    K_z : logarithmic, from the stiffness k of the spring to ten times its value.
    """
    osc, levels, hz = case.oscillator, case.levels_m, list(case.frequencies_hz.values())
    most_c = 2.0 * osc.c or 0.2 * math.sqrt(osc.k * osc.m)  # a tenth of the critical damping
    most_F_k = max(1.1 * osc.k * levels[0], 2.0 * osc.F_k)
    return {
        "Y": _slider("Drive *Y*", "mm", 1e3 * levels[0], 0.0, 1.3e3 * max(levels), least=1),
        "f": _slider("Frequency *f*", "Hz", hz[0], 0.6 * min(hz), 1.25 * max(hz), least=1),
        "c": _slider("Damping *c*", "N s/m", osc.c, 0.0, most_c),
        "F_k": _slider("Friction F_k", "N", osc.F_k, 0.0, most_F_k),
        "K_z": {
            **{"label": titled("Contact K_z"), "unit": "N/m", "log": True, "value": osc.K_z},
            **{"min": min(osc.k, 0.1 * osc.K_z), "max": 10.0 * osc.K_z},
        },
    }


def _slider(
    label: str, unit: str, value: float, low: float, high: float, least: int = 0
) -> dict[str, Any]:
    """Return a slider with round ends and 200 or more round steps, 10ⁿ.   least : the smallest value, in steps."""
    step = 10.0 ** math.floor(math.log10(high / STEPS))
    places = max(0, -math.floor(math.log10(step)))
    shown = float(f"{value:.15g}")  # without the rounding of the change of units
    first, last = (
        round(end * step, places)
        for end in (max(least, math.floor(low / step)), math.ceil(high / step))
    )
    return {
        **{"label": titled(label), "unit": unit, "value": shown},
        **{"min": min(first, shown), "max": last, "step": round(step, places)},
    }
