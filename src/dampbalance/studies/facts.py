"""The numbers of a study's paragraph: each computed from the table of cases, none written by hand."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .settings import Study, chosen
from .summary import column_of, errors_of, percent

Array = NDArray[np.float64]


def paragraph(study: Study, cases: str | Path) -> str:
    """What the study shows: its text with the facts filled in."""
    words = {name: fact(study, cases, spec) for name, spec in study.facts.items()}
    return study.shows.format(cases=f"{study.cases:,}", **words)


def fact(study: Study, cases: str | Path, spec: Mapping[str, Any]) -> str:
    """One number in words: a percentage, or for a band the values of the axis between which it lies."""
    kept = _meant(cases, spec)
    error = worst_errors(study, cases, spec)[kept]
    size = np.abs(error)
    known = np.isfinite(size)
    if spec["take"] == "band":
        return _band(column_of(cases, spec["along"])[kept], size, spec)
    if not known.any():
        return "nothing (it cannot be identified there)"
    if spec["take"] == "share":
        return percent(np.count_nonzero(size[known] <= spec["within"]) / size.size)
    if spec["take"] == "signed":
        value = float(error[known][0])
        return f"{'−' if value < 0.0 else '+'}{percent(value)}"
    share_below = {"min": 0.0, "median": 0.5, "max": 1.0}[spec["take"]]
    return percent(float(np.quantile(size[known], share_below)))


def worst_errors(study: Study, cases: str | Path, spec: Mapping[str, Any]) -> Array:
    """The error in each case; where several fits are meant (all pairs, all phases) the largest among them."""
    wanted = {"fit": "least_squares"} | dict(spec)
    fits = chosen(study.fits, wanted) or chosen(study.fits, spec)
    worst = errors_of(cases, fits[0], spec["of"])
    for fit in fits[1:]:
        error = errors_of(cases, fit, spec["of"])
        larger = ~(np.abs(error) <= np.abs(worst)) & np.isfinite(error)
        worst = np.where(larger | ~np.isfinite(worst), error, worst)
    return worst


def _meant(cases: str | Path, spec: Mapping[str, Any]) -> NDArray[np.bool_]:
    """Which cases a fact is about."""
    kept: NDArray[np.bool_] = np.ones(len(column_of(cases, "case")), dtype=bool)
    for name, wanted in spec.get("at", {}).items():
        values = column_of(cases, name)
        if isinstance(wanted, str):
            kept &= values == wanted
        else:
            distance = np.abs(values - wanted)
            kept &= distance == distance.min()
    for name, (low, high) in spec.get("between", {}).items():
        values = column_of(cases, name)
        kept &= (values >= low) & (values <= high)
    return kept


def _band(axis: Array, size: Array, spec: Mapping[str, Any]) -> str:
    """The stretch of the axis around a place along which the error stays within the bound."""
    places = np.unique(axis)
    good = np.array([bool(np.all(size[axis == place] <= spec["within"])) for place in places])
    middle = int(np.argmin(np.abs(places - spec.get("around", places[-1]))))
    if not good[middle]:
        return "nowhere"
    low = high = middle
    while low > 0 and good[low - 1]:
        low -= 1
    while high < len(places) - 1 and good[high + 1]:
        high += 1
    return f"{places[low]:.3g} to {places[high]:.3g}"
