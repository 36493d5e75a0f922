"""The numbers of a study's paragraph: each computed from the table of cases, none written by hand."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from string import Formatter
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from ...arrays import Array, Mask, Words
from ...project.wording import minus, number, percent, signed_percent
from ..axes import is_value
from ..settings import BANDS, CHOICES, SPREADS, Study
from ..stretches import Sizes, stretches
from .confusion import choice_fact
from .groups import spread_of

CROSSING, BEGINS, ENDS = "", " (where the axis begins)", " (where the axis ends)"
UNKNOWN = " (beyond it there are cases that cannot be identified)"
INTERPOLATED = (
    "Where an error crosses its bound, the value is interpolated between neighbouring cases."
)


def paragraph(study: Study, cases: str | Path) -> str:
    """The text of a study with its facts filled in, and a note on interpolation where it names the end of a stretch."""
    words = {name: fact(study, cases, spec) for name, spec in study.facts.items()}
    text = study.shows.format(cases=f"{study.cases:,}", **words)
    named = {name for _, name, _, _ in Formatter().parse(study.shows)}
    stretches_named = any(
        spec["take"] in BANDS and name in named for name, spec in study.facts.items()
    )
    return f"{text} {INTERPOLATED}" if stretches_named else text


def fact(study: Study, cases: str | Path, spec: Mapping[str, Any]) -> str:
    """One number in words: a percentage, or for a band the values of the axis between which, or from which on, it
    lies, interpolated between cases."""
    take = spec["take"]
    if take in CHOICES:
        return choice_fact(cases, spec)
    if take in SPREADS:
        (fit,) = study.fits_of(spec)
        kept = np.concatenate([part["case"] for part in _cases_of(cases, spec, ["case"])])
        spread = spread_of(study, cases, spec["of"], fit, kept)
        return _in_words(float(getattr(spread, take)), signed=take == "bias")
    if take in BANDS:
        stretch = _stretch(study, cases, spec)
        return stretch.in_words(take) if stretch else "nowhere"
    sizes, signed = Sizes(spec.get("within", math.inf)), math.nan
    for part in _cases_of(cases, spec, error_columns(study, spec)):
        errors = worst(study, part, spec)
        sizes.add(errors)
        signed = next(iter(errors), signed)  # of the one case
    if not sizes.known:
        return _in_words(math.nan)
    values = {
        "share": sizes.share,
        "signed": signed,
        "max": sizes.largest,
        "min": sizes.smallest,
        "median": sizes.quantile(0.5),
        "p95": sizes.quantile(0.95),
    }
    return _in_words(values[take], signed=take == "signed")


def error_columns(study: Study, spec: Mapping[str, Any]) -> list[str]:
    """The columns of the errors to which a fact or a figure refers."""
    return [f"{spec['of']}_relative_error__{fit.label}" for fit in study.fits_of(spec)]


def worst(study: Study, stretch: Mapping[str, Words], spec: Mapping[str, Any]) -> Array:
    """The error in each case of a stretch; with several fits (all pairs) the largest among them."""
    errors = np.array([stretch[name] for name in error_columns(study, spec)])
    sizes = np.where(np.isfinite(errors), np.abs(errors), -1.0)
    largest: Array = np.take_along_axis(errors, sizes.argmax(axis=0)[None], axis=0)[0]
    return largest


def worst_errors(study: Study, cases: str | Path, spec: Mapping[str, Any]) -> Array:
    """`worst` in all cases, held in memory as a whole."""
    names = error_columns(study, spec)
    return np.concatenate([worst(study, part, spec) for part in stretches(cases, names)])


def _in_words(share: float, signed: bool = False) -> str:
    """A percentage, or a note that there is none."""
    if not math.isfinite(share):
        return "nothing (it cannot be identified there)"
    return signed_percent(share) if signed else percent(share)


def _cases_of(
    cases: str | Path, spec: Mapping[str, Any], names: Sequence[str]
) -> Iterator[dict[str, Words]]:
    """The columns named, a stretch at a time, of the cases that a fact is about."""
    at, between = spec.get("at", {}), spec.get("between", {})
    for part in stretches(cases, [*names, *at, *between]):
        kept = cases_at(part, at)
        for name, (low, high) in between.items():
            kept &= (part[name] >= low) & (part[name] <= high)
        yield {name: column[kept] for name, column in part.items()}


class Stretch(NamedTuple):
    """The part of an axis along which an error stays within a bound.

    low, high : its ends.   low_how, high_how : why it ends there; CROSSING where the error crosses the bound.
    """

    low: float
    low_how: str
    high: float
    high_how: str

    def in_words(self, take: str) -> str:
        """Its lower end to three digits, or both ends to a thousandth of its width; with the reason for an end that is
        not a crossing."""
        if take == "from":
            return number(self.low, 3) + self.low_how
        decimals = max(0, 2 - math.floor(math.log10(self.high - self.low or 1.0)))
        ends = (self.low, self.low_how), (self.high, self.high_how)
        return " to ".join(f"{minus(f'{end:.{decimals}f}')}{how}" for end, how in ends)


def cases_at(part: Mapping[str, Words], at: Mapping[str, float | str]) -> Mask:
    """Which cases of a stretch have these values of axes; all where none are given."""
    kept = np.ones(len(next(iter(part.values()))), dtype=bool)
    for name, wanted in at.items():
        values = part[name]
        kept &= values == wanted if isinstance(wanted, str) else is_value(values, wanted)
    return kept


def _stretch(study: Study, cases: str | Path, spec: Mapping[str, Any]) -> Stretch | None:
    """The stretch of an axis, around a value of it, along which the error stays within the bound; None if it does not
    at that value."""
    parts = []
    for part in _cases_of(cases, spec, [spec["along"], *error_columns(study, spec)]):
        errors = np.array([part[name] for name in error_columns(study, spec)])
        known = np.isfinite(errors).all(axis=0)
        ends = {"least": errors.min(axis=0), "largest": errors.max(axis=0)}
        rows = pd.DataFrame(ends | {"known": known}).groupby(part[spec["along"]])
        parts.append(rows.agg({"least": "min", "largest": "max", "known": "all"}))
    rows = pd.concat(parts).groupby(level=0)
    table = rows.agg({"least": "min", "largest": "max", "known": "all"})
    places, within = table.index.to_numpy(float), spec["within"]
    errors = table[["least", "largest"]].to_numpy().T
    good = table["known"].to_numpy(bool) & (np.abs(errors) <= within).all(axis=0)
    middle = np.flatnonzero(is_value(places, spec.get("around", places[-1])))
    if not middle.size or not good[middle[0]]:
        return None
    bad = np.flatnonzero(~good)
    first = int(bad[bad < middle[0]].max(initial=-1)) + 1
    last = int(bad[bad > middle[0]].min(initial=len(places))) - 1
    errors[:, ~table["known"].to_numpy(bool)] = np.nan
    return Stretch(*_end(places, errors, within, first, -1), *_end(places, errors, within, last, 1))


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
