"""The numbers of a study's paragraph: each computed from the table of cases, none written by hand."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from ...arrays import Array, Words
from ...project.wording import percent
from ..settings import BANDS, CHOICES, SPREADS, Study
from ..stretches import Sizes, stretches
from .confusion import choice_fact
from .groups import spread_of


def paragraph(study: Study, cases: str | Path) -> str:
    """What the study shows: its text with the facts filled in."""
    words = {name: fact(study, cases, spec) for name, spec in study.facts.items()}
    return study.shows.format(cases=f"{study.cases:,}", **words)


def fact(study: Study, cases: str | Path, spec: Mapping[str, Any]) -> str:
    """One number in words: a percentage, or for a band the values of the axis between which, or from which on, it
    lies."""
    take = spec["take"]
    if take in CHOICES:
        return choice_fact(cases, spec)
    if take in SPREADS:
        (fit,) = study.fits_of(spec)
        kept = np.concatenate([part["case"] for part in _cases_of(cases, spec, ["case"])])
        spread = spread_of(study, cases, spec["of"], fit, kept)
        return _in_words(float(getattr(spread, take)), signed=take == "bias")
    if take in BANDS:
        ends = _band(study, cases, spec)
        if ends is None:
            return "nowhere"
        return f"{ends[0]:.3g}" + (f" to {ends[1]:.3g}" if take == "band" else "")
    sizes, first = Sizes(spec.get("within", math.inf)), math.nan
    for part in _cases_of(cases, spec, error_columns(study, spec)):
        errors = worst(study, part, spec)
        sizes.add(errors)
        if math.isnan(first):
            first = next(iter(errors[np.isfinite(errors)]), math.nan)
    if not sizes.known:
        return _in_words(math.nan)
    values = {
        "share": sizes.share,
        "signed": first,
        "max": sizes.largest,
        "min": sizes.smallest,
        "median": sizes.quantile(0.5),
        "p95": sizes.quantile(0.95),
    }
    return _in_words(values[take], signed=take == "signed")


def error_columns(study: Study, spec: Mapping[str, Any]) -> list[str]:
    """The columns of the errors that a fact or a figure speaks of."""
    return [f"{spec['of']}_relative_error__{fit.label}" for fit in study.fits_of(spec)]


def worst(study: Study, stretch: Mapping[str, Words], spec: Mapping[str, Any]) -> Array:
    """The error in each case of a stretch; with several fits (all pairs) the largest among them."""
    errors = np.array([stretch[name] for name in error_columns(study, spec)])
    sizes = np.where(np.isfinite(errors), np.abs(errors), -1.0)
    found: Array = np.take_along_axis(errors, sizes.argmax(axis=0)[None], axis=0)[0]
    return found


def worst_errors(study: Study, cases: str | Path, spec: Mapping[str, Any]) -> Array:
    """`worst` in all cases: 8 bytes a case."""
    names = error_columns(study, spec)
    return np.concatenate([worst(study, part, spec) for part in stretches(cases, names)])


def _in_words(share: float, signed: bool = False) -> str:
    """A percentage, or that there is none."""
    if not math.isfinite(share):
        return "nothing (it cannot be identified there)"
    sign = ("−" if share < 0.0 else "+") if signed else ""
    return f"{sign}{percent(share)}"


def _cases_of(
    cases: str | Path, spec: Mapping[str, Any], names: Sequence[str]
) -> Iterator[dict[str, Words]]:
    """The columns named, a stretch at a time, of the cases that a fact is about: those nearest to `at`."""
    at, between = spec.get("at", {}), spec.get("between", {})
    nearest = {
        name: min(np.abs(part[name] - wanted).min() for part in stretches(cases, [name]))
        for name, wanted in at.items()
        if not isinstance(wanted, str)
    }
    for part in stretches(cases, [*names, *at, *between]):
        kept = np.ones(len(part[names[0]]), dtype=bool)
        for name, wanted in at.items():
            values = part[name]
            kept &= (
                np.abs(values - wanted) == nearest[name] if name in nearest else values == wanted
            )
        for name, (low, high) in between.items():
            kept &= (part[name] >= low) & (part[name] <= high)
        yield {name: column[kept] for name, column in part.items()}


def _band(study: Study, cases: str | Path, spec: Mapping[str, Any]) -> tuple[float, float] | None:
    """The ends of the stretch of an axis, around a place on it, along which the error stays within the bound; None if
    it does not at that place."""
    parts = []
    for part in _cases_of(cases, spec, [spec["along"], *error_columns(study, spec)]):
        size = np.abs(worst(study, part, spec))
        errors = pd.Series(np.where(np.isfinite(size), size, np.inf))
        parts.append(errors.groupby(part[spec["along"]]).max())
    largest = pd.concat(parts).groupby(level=0).max()  # place on the axis → error there
    places, bad = largest.index.to_numpy(), np.flatnonzero(largest > spec["within"])
    if not len(places):
        return None
    middle = int(np.argmin(np.abs(places - spec.get("around", places[-1]))))
    if middle in bad:
        return None
    low = bad[bad < middle].max(initial=-1) + 1
    high = bad[bad > middle].min(initial=len(places)) - 1
    return float(places[low]), float(places[high])
