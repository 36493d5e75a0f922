"""Inputs of the page's instruments from the case and its print; they compute everything else themselves."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import pandas as pd

from ...figures.looks import SCHEME_LOOKS, label_of, look_of
from ...motion.fixed_step import SCHEMES
from ...project.case import Case
from ...project.wording import plain_text
from ...replication.authors_route import printed_coefficients
from ...replication.claims.verdicts import PARTS_OF_THE_PAPER, VERDICTS, ClaimId, of_cell
from ...replication.comparison import RECIPES, WAYS_TO_COMPARE
from ...replication.rebuilt_tables import IDENTIFIED_QUANTITIES, TABLE_2
from ...solver import levels_of
from ..colours import variable
from ..words import titled

IN_THE_BROWSER = ("direct", "X_s", "t_s", "V_s", "fourier")  # the approaches that kit.js knows
STEPS = 200  # of a slider, at least
STOPS_US = (1, 1.5, 2, 2.5, 3, 4, 4.5, 5, 5.5, 6, 7, 8, 10, 15, 20, 30, 50)
"""Steps that "Guess the integrator" offers, µs; the configured one is among them in any case."""


def instruments_data(
    case: Case, claims: pd.DataFrame | None, digits: Mapping[str, Any] | None
) -> dict[str, Any]:
    """Return the case in SI units and what the instruments need besides, for `kit.js`; to stand in the page as JSON.

    case : m, c, k, K_z, F_k, levels (m), frequencies (name → Hz) and pairs of levels (counted from 0).
    approaches : key → its label, colour and shape.   steps : ways to mend the balance off resonance, the paper's two
    first.
    integrator, where something is printed : the schemes, the recipe of the configuration, Table 2 as printed (the
    text), its pairs of levels.
    digits, where there are any : `changed_digits.packed` with names for the numbers and the looks of the verdicts.

    claims : `claims.csv` as text, or None for a case with nothing printed.   digits : as packed, if on record.
    """
    data: dict[str, Any] = {
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
            dict(zip(("approach", "phase", "sharing"), WAYS_TO_COMPARE[way], strict=True))
            | {"name": way, "words": words}
            for way, words in RECIPES.items()
        ],
    }
    if claims is not None:
        data["integrator"] = _integrator(case, claims)
    if claims is not None and digits:
        rows = claims.set_index("id").loc[list(digits["was"]), ["where", "quantity"]]
        names = {name: _name(*row) for name, *row in rows.itertuples()}
        looks = [(verdict.css, verdict.mark) for verdict in VERDICTS.values()]
        data["digits"] = {**digits, "looks": looks, "names": names, "parts": PARTS_OF_THE_PAPER}
    return data


def _integrator(case: Case, claims: pd.DataFrame) -> dict[str, Any]:
    """Return the data of `integrator.js`."""
    numerics = case.numerics
    symbols = [quantity.symbol for quantity in (*TABLE_2, *IDENTIFIED_QUANTITIES)]
    rows = {s: claims[claims["id"].str.startswith(of_cell("table2", s))] for s in symbols}
    pairs = [levels_of(ClaimId(claim).line) for claim in rows["F_k"]["id"]]
    step = float(f"{1e6 * numerics.step_s:.12g}")
    return {
        "schemes": [
            {"name": name, "label": SCHEME_LOOKS[name][0], "dissipation": scheme.dissipation}
            for name, scheme in SCHEMES.items()
        ],
        "recipe": {
            "scheme": numerics.scheme,
            "step": step,
            "cycles": numerics.cycles,
            "slip_samples": [numerics.after_slip(i) for i in range(len(case.levels_m))],
            "decimals": [numerics.c_over_m_decimals, numerics.k_over_m_decimals],
        },
        "rounded": printed_coefficients(case),
        "stops": sorted({*STOPS_US, step}),
        "omega": case.omega(next(iter(case.frequencies_hz))),
        "printed": {symbol: of["printed"].tolist() for symbol, of in rows.items()},
        "pairs": [[level - 1 for level in pair] for pair in pairs],
    }


def _name(where: str, quantity: str) -> str:
    """Return a printed number in a few words: "level 2: X_s", "pair 1-2: F_k by X_s"; of the running text what it
    is."""
    table, _, line = where.partition(", ")
    if not table.startswith("Table"):
        return plain_text(quantity)
    return plain_text(f"{line}: {quantity.partition(':')[0].partition(', ')[0]}")


def of_run(record: Mapping[str, Any], claims: pd.DataFrame) -> bool:
    """Return whether a record by `changed_digits.packed` is of a run's print and verdicts.   claims : claims.csv as
    text."""
    computed = claims[claims["kind"] == "computed"].set_index("id")
    was = {name: record["verdicts"][place] for name, place in record["was"].items()}
    printed = {name: text for name, (text, _) in record["numbers"].items()}
    same = printed.items() <= computed["printed"].to_dict().items()
    return same and was == computed["verdict"].to_dict()


def slider_controls(case: Case) -> dict[str, dict[str, Any]]:
    """Return the sliders of the oscillator and its drive by name; their ranges hold the case and what lies around it.

    Y, mm : up to a third above the highest level.   f, Hz : from below the lowest frequency to above the highest.
    c : up to twice its value.   F_k : up to the force of the spring at the lowest level, which moves nothing any more.
    K_z : logarithmic, from the softness of the spring k to ten times its value.
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
    """Return a slider with round ends and a round step, 10ⁿ, of which there are 200 or more.   least : steps of the
    lowest."""
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
