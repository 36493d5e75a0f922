"""The numbers of a study's paragraph: each computed from the table of cases, none written by hand."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from string import Formatter
from typing import Any

import numpy as np
import pandas as pd

from ...arrays import Array, Integers, Words
from ...project.wording import minus, number, percent, signed_percent
from ..case_files import stretches
from ..settings import BANDS, COVERAGE_RANGE, SPREADS, Fit, Study, is_value, selected
from .statistics import Sizes, groups, spread_of

CROSSING, BEGINS, ENDS = "", " (where the axis begins)", " (where the axis ends)"
UNKNOWN = " (beyond it there are cases that cannot be identified)"
INTERPOLATED = (
    "Where an error crosses its bound, the value is interpolated between neighbouring cases."
)


def paragraph(study: Study, cases: str | Path) -> str:
    """The text of a study with its facts filled in, and a note on interpolation where it names the end of a stretch."""
    return filled(study, {name: fact(study, cases, spec) for name, spec in study.facts.items()})


def filled(study: Study, words: Mapping[str, str]) -> str:
    """The text of a study with these facts in words filled in."""
    text = study.shows.format(cases=f"{study.cases:,}", **words)
    named = {name for _, name, _, _ in Formatter().parse(study.shows)}
    takes = {spec["take"] for name, spec in study.facts.items() if name in named}
    return text if takes.isdisjoint(BANDS) else f"{text} {INTERPOLATED}"


def fact(study: Study, cases: str | Path, spec: Mapping[str, Any]) -> str:
    """One number in words: a percentage, or for a band the values of the axis between which, or from which on, it
    lies, interpolated between cases."""
    take = spec["take"]
    if take in SPREADS:
        (fit,) = study.fits_of(spec)
        kept = np.concatenate([part["case"] for part in _cases_of(cases, spec, ["case"])])
        if take == COVERAGE_RANGE:
            return _coverage_range(study, cases, spec["of"], fit, kept)
        spread = spread_of(study, cases, spec["of"], fit, kept)
        return _in_words(float(spread[take]), signed=take == "bias")
    if take in BANDS:
        return _stretch(study, cases, spec)
    sizes, signed = Sizes(spec.get("within", math.inf)), math.nan
    for part in _cases_of(cases, spec, error_columns(study, spec)):
        errors = worst(study, part, spec)
        sizes.add(errors)
        signed = next(iter(errors), signed)  # of the one case
    if not sizes.known:
        return _in_words(math.nan)
    values = {"share": sizes.share, "signed": signed, "max": sizes.largest, "min": sizes.smallest}
    values |= {"median": sizes.quantile(0.5), "p95": sizes.quantile(0.95)}
    return _in_words(values[take], signed=take == "signed")


def error_columns(study: Study, spec: Mapping[str, Any]) -> list[str]:
    """The columns of the errors to which a fact or a figure refers."""
    return [f"{spec['of']}_relative_error__{fit.label}" for fit in study.fits_of(spec)]


def worst(study: Study, stretch: Mapping[str, Words], spec: Mapping[str, Any]) -> Array:
    """The error in each case of a stretch; with several fits (all pairs) the largest among them."""
    errors = np.array([stretch[name] for name in error_columns(study, spec)])
    sizes = np.where(np.isfinite(errors), np.abs(errors), -1.0)
    return np.take_along_axis(errors, sizes.argmax(axis=0)[None], axis=0)[0]


def worst_errors(study: Study, cases: str | Path, spec: Mapping[str, Any]) -> Array:
    """`worst` in all cases, held in memory as a whole."""
    names = error_columns(study, spec)
    return np.concatenate([worst(study, part, spec) for part in stretches(cases, names)])


def _coverage_range(
    study: Study, cases: str | Path, quantity: str, fit: Fit, kept: Integers
) -> str:
    """The least coverage, with its 95 % bounds, and the largest, among the combinations of values of the axes
    `summary_by`.   kept : numbers of the cases that count."""
    spreads = (
        spread_of(study, cases, quantity, fit, np.intersect1d(numbers, kept))
        for _, numbers in groups(cases, study.summary_by)
    )
    known = [of for of in spreads if math.isfinite(of["coverage"])]
    if not known:
        return _in_words(math.nan)
    least = min(known, key=lambda of: of["coverage"])
    names = ("coverage", "coverage_low", "coverage_high")
    share, low, high = (percent(least[name]) for name in names)
    most = percent(max(of["coverage"] for of in known))
    return f"{share} (95 % bounds: {low} to {high}) to {most}"


def _in_words(share: float, signed: bool = False) -> str:
    """A percentage, or a note that there is none."""
    if not math.isfinite(share):
        return "nothing (it cannot be identified there)"
    return signed_percent(share) if signed else percent(share)


def _cases_of(
    cases: str | Path, spec: Mapping[str, Any], names: Sequence[str]
) -> Iterator[dict[str, Words]]:
    """The columns named, a stretch at a time, of the cases that a fact is about."""
    for part in stretches(cases, [*names, *spec.get("at", ()), *spec.get("between", ())]):
        kept = selected(part, spec)
        yield {name: column[kept] for name, column in part.items()}


def _stretch(study: Study, cases: str | Path, spec: Mapping[str, Any]) -> str:
    """The stretch of an axis, around a value of it, along which the error stays within the bound: its lower end to
    three digits, or both ends to a thousandth of its width; with the reason for an end that is not a crossing."""
    parts, how = [], {"least": "min", "largest": "max", "known": "all"}
    for part in _cases_of(cases, spec, [spec["along"], *error_columns(study, spec)]):
        errors = np.array([part[name] for name in error_columns(study, spec)])
        known = np.isfinite(errors).all(axis=0)
        ends = {"least": errors.min(axis=0), "largest": errors.max(axis=0), "known": known}
        parts.append(pd.DataFrame(ends).groupby(part[spec["along"]]).agg(how))
    table = pd.concat(parts).groupby(level=0).agg(how)
    places, within = table.index.to_numpy(float), spec["within"]
    known, errors = table.pop("known").to_numpy(bool), table.to_numpy().T
    good = known & (np.abs(errors) <= within).all(axis=0)
    middle = np.flatnonzero(is_value(places, spec.get("around", places[-1])))
    if not middle.size or not good[middle[0]]:
        return "nowhere"
    bad = np.flatnonzero(~good)
    first = int(bad[bad < middle[0]].max(initial=-1)) + 1
    last = int(bad[bad > middle[0]].min(initial=len(places))) - 1
    errors = np.where(known, errors, np.nan)
    low, why_low = _end(places, errors, within, first, -1)
    if spec["take"] == "from":
        return number(low, 3) + why_low
    high, why_high = _end(places, errors, within, last, 1)
    decimals = max(0, 2 - math.floor(math.log10(high - low or 1.0)))
    return minus(f"{low:.{decimals}f}{why_low} to {high:.{decimals}f}{why_high}")


def _end(places: Array, errors: Array, within: float, last: int, step: int) -> tuple[float, str]:
    """Where a stretch ends, and what that place is.

    Between its last place and the next, the least and the largest error are taken to be straight lines; the stretch
    ends where the first of them crosses the bound.
    errors : the least and the largest at each place, (2, n).   last : the last place within.   step : ±1, outwards.
    """
    if not 0 <= last + step < len(places):
        return float(places[last]), BEGINS if step < 0 else ENDS
    here, beyond = errors[:, last], errors[:, last + step]
    if np.isnan(beyond).any():
        return float(places[last]), UNKNOWN
    crossed = np.abs(beyond) > within
    bound = np.copysign(within, beyond[crossed])
    share = float(np.min((bound - here[crossed]) / (beyond - here)[crossed]))
    low, high = places[[last, last + step]]
    return float(low + share * (high - low)), CROSSING
