"""The numbers of a study's paragraph: each computed from the table of cases, none written by hand."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...project.wording import percent
from ..settings import SPREADS, Fit, Study, chosen
from ..stretches import Sizes, stretches
from .groups import spread_of

Array = NDArray[np.float64]


def paragraph(study: Study, cases: str | Path) -> str:
    """What the study shows: its text with the facts filled in."""
    words = {name: fact(study, cases, spec) for name, spec in study.facts.items()}
    return study.shows.format(cases=f"{study.cases:,}", **words)


def fact(study: Study, cases: str | Path, spec: Mapping[str, Any]) -> str:
    """One number in words: a percentage, or for a band the values of the axis between which it lies."""
    nearest = _nearest(cases, spec)
    if spec["take"] in SPREADS:
        return _of_runs(study, cases, spec, nearest)
    names = [*error_columns(study, spec), *nearest, *spec.get("between", {})]
    names += [spec["along"]] if spec["take"] == "band" else []
    sizes = Sizes(spec.get("within", math.inf))
    signed = math.nan
    worst_at: dict[float, float] = {}  # place on the axis of a band → the worst error there
    for stretch in stretches(cases, names):
        kept = _cases_of(stretch, spec, nearest)
        errors = worst(study, stretch, spec)[kept]
        sizes.add(errors)
        if math.isnan(signed) and np.isfinite(errors).any():
            signed = float(errors[np.isfinite(errors)][0])
        if spec["take"] == "band":
            for place, error in zip(stretch[spec["along"]][kept], np.abs(errors), strict=True):
                worst_at[place] = max(worst_at.get(place, 0.0), _or_infinite(error))
    if spec["take"] == "band":
        return _band(worst_at, spec)
    if not sizes.known:
        return "nothing (it cannot be identified there)"
    if spec["take"] == "share":
        return percent(sizes.share)
    if spec["take"] == "signed":
        return f"{'−' if signed < 0.0 else '+'}{percent(signed)}"
    values = {
        "max": sizes.largest,
        "min": sizes.smallest,
        "median": sizes.quantile(0.5),
        "p95": sizes.quantile(0.95),
    }
    return percent(values[spec["take"]])


def _of_runs(
    study: Study, cases: str | Path, spec: Mapping[str, Any], nearest: Mapping[str, float]
) -> str:
    """A number of many runs: of the one fit and over the cases that the fact is about."""
    axes = [*nearest, *spec.get("between", {})] or [study.axis_names[0]]
    kept = np.concatenate([_cases_of(part, spec, nearest) for part in stretches(cases, axes)])
    (fit,) = fits_of(study, spec)
    share = float(getattr(spread_of(study, cases, spec["of"], fit, kept), spec["take"]))
    if not math.isfinite(share):
        return "nothing (it cannot be identified there)"
    sign = ("−" if share < 0.0 else "+") if spec["take"] == "bias" else ""
    return f"{sign}{percent(share)}"


def fits_of(study: Study, spec: Mapping[str, Any]) -> list[Fit]:
    """The fits that a fact or a figure speaks of; those of least squares if it names none."""
    return chosen(study.fits, {"fit": "least_squares"} | dict(spec)) or chosen(study.fits, spec)


def error_columns(study: Study, spec: Mapping[str, Any]) -> list[str]:
    """The columns of the errors that a fact or a figure speaks of."""
    return [f"{spec['of']}_relative_error__{fit.label}" for fit in fits_of(study, spec)]


def worst(study: Study, stretch: Mapping[str, NDArray[Any]], spec: Mapping[str, Any]) -> Array:
    """The error in each case of a stretch; with several fits (all pairs) the largest among them."""
    errors = [stretch[name] for name in error_columns(study, spec)]
    found: Array = errors[0]
    for error in errors[1:]:
        larger = ~(np.abs(error) <= np.abs(found)) & np.isfinite(error)
        found = np.where(larger | ~np.isfinite(found), error, found)
    return found


def worst_errors(study: Study, cases: str | Path, spec: Mapping[str, Any]) -> Array:
    """`worst` in all cases: 8 bytes a case."""
    names = error_columns(study, spec)
    return np.concatenate([worst(study, part, spec) for part in stretches(cases, names)])


def _nearest(cases: str | Path, spec: Mapping[str, Any]) -> dict[str, float]:
    """For each axis of `at`, the smallest distance of a case from the place named; NaN for a word."""
    found = {}
    for name, wanted in spec.get("at", {}).items():
        if isinstance(wanted, str):
            found[name] = math.nan
        else:
            parts = stretches(cases, [name])
            found[name] = min(float(np.abs(part[name] - wanted).min()) for part in parts)
    return found


def _cases_of(
    stretch: Mapping[str, NDArray[Any]], spec: Mapping[str, Any], nearest: Mapping[str, float]
) -> NDArray[np.bool_]:
    """Which cases of a stretch a fact is about."""
    kept: NDArray[np.bool_] = np.ones(len(next(iter(stretch.values()))), dtype=bool)
    for name, wanted in spec.get("at", {}).items():
        values = stretch[name]
        if isinstance(wanted, str):
            kept &= values == wanted
        else:
            kept &= np.abs(values - wanted) == nearest[name]
    for name, (low, high) in spec.get("between", {}).items():
        kept &= (stretch[name] >= low) & (stretch[name] <= high)
    return kept


def _or_infinite(error: float) -> float:
    return error if math.isfinite(error) else math.inf


def _band(worst_at: Mapping[float, float], spec: Mapping[str, Any]) -> str:
    """The stretch of the axis around a place along which the error stays within the bound."""
    places = sorted(worst_at)
    if not places:
        return "nowhere"
    good = [worst_at[place] <= spec["within"] for place in places]
    around = spec.get("around", places[-1])
    middle = min(range(len(places)), key=lambda i: abs(places[i] - around))
    if not good[middle]:
        return "nowhere"
    low = high = middle
    while low > 0 and good[low - 1]:
        low -= 1
    while high < len(places) - 1 and good[high + 1]:
        high += 1
    return f"{places[low]:.3g} to {places[high]:.3g}"
