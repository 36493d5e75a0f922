"""The pages of the real rigs: what their records say, in words, tables and figures, every number from the findings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from statistics import median
from typing import Any

from ..identification.answer import USABLE
from ..project.wording import in_words, listed, minus, number, percent, sentence
from ..project.wording import signed as with_sign
from .words import templates

_UNITS = {"K_z": "N/m", "F_k": "N", "c": "N s/m", "k": "N/m", "k_3": "N/m³", "m": "kg"}
_UNITS |= {"R": "m/N"}
_ADDITIONS = {"residual": "residual receptance of other modes", "hardening": "hardening"}


def frame_page(
    document: Mapping[str, Any], measured: Mapping[str, Any], limits: Sequence[str]
) -> str:
    """The page of the frame, in Markdown.

    document : of the findings.   measured : the set of records in the configuration.   limits : what limits the
    identification, by its own account, a sentence each.
    """
    rows = document["loads"]
    given = measured.get("given") or {}
    laws = list(document["speed_laws"])
    best = min(laws, key=document["speed_laws"].__getitem__)
    return _page(
        "frame.md.j2",
        document=document,
        rows=rows,
        line=document["line"],
        k=measured["stiffness_N_per_m"],
        given=listed([f"{symbol} = {value:g} N s/m" for symbol, value in given.items()]),
        ripples_mN=[1e3 * row["loop"]["ripple"] * row["F_k_N"] for row in rows],
        lower_um=[1e6 * row["loop"]["given_way_m"][0] for row in rows],
        upper_um=[1e6 * row["loop"]["given_way_m"][1] for row in rows],
        doubtful=[row for row in rows if row["verdict"] != USABLE],
        drifting=[row for row in rows if row["drift"]["significant"]],
        conventions=[1.0 - row["F_k_by_series_N"] / row["F_k_N"] for row in rows],
        laws=laws,
        best=best,
        better=[
            row["record"]
            for row, rms in ((row, row["speed_laws"]) for row in rows)
            if rms[best]["rms"] < rms["constant"]["rms"]
        ],
        limits=limits,
    )


def beam_page(document: Mapping[str, Any], limits: Sequence[str]) -> str:
    """The page of the bolted joint, in Markdown.   document, limits : as for `frame_page`."""
    resonances = [row["resonance_hz"] for row in document["levels"]]
    return _page(
        "beam.md.j2",
        document=document,
        limits=limits,
        units=_UNITS,
        names=_ADDITIONS,
        um=lambda X: number(1e6 * X, 3),
        spread_hz=max(resonances) - min(resonances),
    )


def _page(template: str, **values: Any) -> str:
    environment = templates()
    filters = (percent, number, in_words, signed, minus, listed, shares)
    environment.filters |= {function.__name__: function for function in filters} | {
        "median": median,
        "interval": lambda ends, digits: " to ".join(number(end, digits) for end in ends),
        "span": lambda values: minus(" to ".join(f"{f(values):.0f}" for f in (min, max))),
        "sentence": sentence,
    }
    return environment.get_template(template).render(**values)


def signed(share: float) -> str:
    """A share in percent with its sign and one digit."""
    return f"{with_sign(100.0 * share, 1)} %"


def shares(values: Sequence[float]) -> str:
    """The least and the greatest of shares as percentages of two digits, with signs where they differ in it."""
    low, high = min(values), max(values)
    if low < 0.0 < high:
        return f"{signed(low)} to {signed(high)}"
    return f"{number(100.0 * low, 2)} to {number(100.0 * high, 2)} %"
