"""The page of the real rig: what its records say, in words, tables and figures, every number from the findings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..identification.answer import USABLE
from ..project.wording import in_words, listed, minus, number, percent
from .words import templates


def frame_page(
    document: Mapping[str, Any], measured: Mapping[str, Any], limits: Sequence[str]
) -> str:
    """The page, in Markdown.

    document : of the findings.   measured : the set of records in the configuration.   limits : what limits the
    identification, by its own account, a sentence each.
    """
    environment = templates()
    filters = (percent, number, in_words, signed, minus, listed, shares)
    environment.filters |= {function.__name__: function for function in filters} | {
        "interval": lambda ends, digits: " to ".join(number(end, digits) for end in ends),
        "span": lambda values: minus(" to ".join(f"{f(values):.0f}" for f in (min, max))),
    }
    rows = document["loads"]
    given = measured.get("given") or {}
    laws = list(document["speed_laws"])
    best = min(laws, key=document["speed_laws"].__getitem__)
    return environment.get_template("frame.md.j2").render(
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
        left=[row for row in rows if row["clocks"]["drift_left_significant"]],
        delayed=[row["clocks"]["F_k_as_recorded_N"] / row["F_k_N"] - 1.0 for row in rows],
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


def signed(share: float) -> str:
    """A share in percent with its sign and one digit."""
    return minus(f"{100.0 * share:+.1f} %")


def shares(values: Sequence[float]) -> str:
    """The least and the greatest of shares as percentages of two digits, with signs where they differ in it."""
    low, high = min(values), max(values)
    if low < 0.0 < high:
        return f"{signed(low)} to {signed(high)}"
    return f"{number(100.0 * low, 2)} to {number(100.0 * high, 2)} %"
