"""The paragraph of a study, NAME.md.j2 next to its YAML file: a template that asks the cases for each number where it
uses it, so that none is written by hand."""

from __future__ import annotations

import math
import traceback
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import jinja2
import numpy as np
import pandas as pd
from jinja2 import meta, sandbox

from ...arrays import Array, Integers
from ...project.documents import ConfigurationError
from ...project.wording import minus, number_text, percent, signed_percent
from ..case_files import column_of
from ..cases import case_columns
from ..reading_study import wrong_selection
from ..study_file import Fit, Study, is_value, selected
from .statistics import Sizes, spread_of, worst_errors

CROSSING, BEGINS, ENDS = "", " (where the axis begins)", " (where the axis ends)"
NOT_IDENTIFIED_BEYOND = " (beyond it there are cases that cannot be identified)"
CHOICES = {"approach", "phase", "sharing", "contact", "weights", "terms", "fit"}
"""Keys by which `errors` selects fits, with the meaning that they have in a figure."""


@dataclass(frozen=True)
class ErrorsOfCases:
    """Relative errors of one coefficient, by a fit or by the worst of several, in the cases that `at` and `between`
    leave.

    spec : coefficient (of), keys that select the fits, and conditions on the axes (at, between).
    """

    study: Study = field(repr=False)
    cases: str | Path
    spec: Mapping[str, Any]

    def at(self, **values: Any) -> ErrorsOfCases:
        """Keep the cases with these values of axes. Raises ValueError, with the nearest ones, for a value that an axis
        does not have."""
        return self._where("at", values)

    def between(self, **bounds: Sequence[float]) -> ErrorsOfCases:
        """Keep the cases in which these axes lie within two bounds, such as zeta=[0.1, 0.2]."""
        return self._where("between", bounds)

    def _where(self, how: str, given: Mapping[str, Any]) -> ErrorsOfCases:
        spec = {**self.spec, how: {**self.spec.get(how, {}), **given}}
        for key, text in wrong_selection(self.study, (), spec):
            raise ValueError(f"{': '.join(map(str, (*key[1:], text)))}")
        return replace(self, spec=spec)

    @property
    def _kept(self) -> Integers:
        """The numbers of the cases that are left."""
        names = ("case", *self.spec.get("at", ()), *self.spec.get("between", ()))
        return np.flatnonzero(
            selected({name: column_of(self.cases, name) for name in names}, self.spec)
        )

    @property
    def _errors(self) -> Array:
        return worst_errors(self.study, self.cases, self.spec)[self._kept]

    def _sizes(self, within: float = math.inf) -> Sizes:
        sizes = Sizes(within)
        sizes.add(self._errors)
        return sizes

    @property
    def signed(self) -> float:
        """The error of the one case that is left, with its sign."""
        if len(errors := self._errors) != 1:
            raise ValueError(
                f"signed is the error of one case, and {len(errors):,} are left: give a value of each axis to at"
            )
        return float(errors[0])

    @property
    def largest(self) -> float:
        """The largest size."""
        return self._sizes().largest

    @property
    def smallest(self) -> float:
        """The smallest size."""
        return self._sizes().smallest

    @property
    def median(self) -> float:
        """The size that half of the errors do not exceed."""
        return self._sizes().quantile(0.5)

    @property
    def p95(self) -> float:
        """The size that 95 % of the errors do not exceed."""
        return self._sizes().quantile(0.95)

    def within(self, bound: float) -> float:
        """Return the share of the cases whose error is within a bound."""
        return self._sizes(bound).share

    @property
    def spread(self) -> dict[str, float]:
        """Statistics over the cases that are left, of one fit, as `statistics.spread` has them."""
        return spread_of(self.study, self.cases, self.spec["of"], self._fit, self._kept)

    @property
    def _fit(self) -> Fit:
        fits = self.study.fits_of(self.spec)
        if len(fits) > 1:
            labels = ", ".join(fit.label for fit in fits)
            raise ValueError(f"spread refers to one fit, but {labels} are selected")
        return fits[0]

    def band(self, along: str, within: float, around: float) -> str:
        """Return the values of an axis, around one of them, between which the errors stay within a bound, to a
        thousandth of their distance; with the reason for an end that is not a crossing."""
        if (ends := self._ends(along, within, around)) is None:
            return "nowhere"
        (low, why_low), (high, why_high) = ends
        decimals = max(0, 2 - math.floor(math.log10(high - low or 1.0)))
        return minus(f"{low:.{decimals}f}{why_low} to {high:.{decimals}f}{why_high}")

    def start(self, along: str, within: float, around: float) -> str:
        """Return the lower end of `band`, to three digits."""
        ends = self._ends(along, within, around)
        return "nowhere" if ends is None else number_text(ends[0][0], 3) + ends[0][1]

    def _ends(
        self, along: str, within: float, around: float
    ) -> tuple[tuple[float, str], tuple[float, str]] | None:
        """Return the ends of a band, each with what it is."""
        if not self.study.values_of(along):
            raise ValueError(f"{along} is not an axis of this study whose values are listed")
        self.at(**{along: around})
        table = pd.DataFrame(
            {"place": column_of(self.cases, along)[self._kept], "error": self._errors}
        )
        by_place = table.groupby("place")["error"].agg(["min", "max", "count", "size"])
        known = (by_place["count"] == by_place["size"]).to_numpy(bool)
        errors = np.where(known, by_place[["min", "max"]].to_numpy().T, np.nan)
        places = by_place.index.to_numpy(float)
        good = known & (np.abs(errors) <= within).all(axis=0)
        middle = int(np.flatnonzero(is_value(places, around))[0])
        if not good[middle]:
            return None
        bad = np.flatnonzero(~good)
        first = int(bad[bad < middle].max(initial=-1)) + 1
        last = int(bad[bad > middle].min(initial=len(places))) - 1
        return _end(places, errors, within, first, -1), _end(places, errors, within, last, 1)


def _end(places: Array, errors: Array, within: float, last: int, step: int) -> tuple[float, str]:
    """Return where a band ends, and what that place is.

    Between its last place and the next, the least and the largest error are taken to be straight lines; the band
    ends where the first of them crosses the bound.
    errors : the least and the largest at each place, (2, n).   last : the last place within.   step : ±1, outwards.
    """
    if not 0 <= last + step < len(places):
        return float(places[last]), BEGINS if step < 0 else ENDS
    here, beyond = errors[:, last], errors[:, last + step]
    if np.isnan(beyond).any():
        return float(places[last]), NOT_IDENTIFIED_BEYOND
    crossed = np.abs(beyond) > within
    bound = np.copysign(within, beyond[crossed])
    share = float(np.min((bound - here[crossed]) / (beyond - here)[crossed]))
    low, high = places[[last, last + step]]
    return float(low + share * (high - low)), CROSSING


# --- the template ------------------------------------------------------------------------------------


def template_of(study: Study) -> jinja2.Template | None:
    """Return the template of a study's paragraph; None if its YAML file has none next to it.

    Raises ConfigurationError for what is no template, or asks for a name that does not exist.
    """
    if study.text is None:
        return None
    environment = sandbox.ImmutableSandboxedEnvironment(  # no code of a study runs
        undefined=jinja2.StrictUndefined, loader=jinja2.FileSystemLoader(study.text.parent)
    )
    environment.filters |= {"percent": _words(percent), "signed": _words(signed_percent)}
    try:
        parsed = environment.parse(study.text.read_text(encoding="utf-8"))
        unknown = meta.find_undeclared_variables(parsed) - {"errors", "cases", *environment.globals}
        if unknown:
            raise ConfigurationError(
                f"{study.text}: {', '.join(sorted(unknown))}: unknown name; a template has errors(coefficient, "
                "approach, …), cases, and the names that it sets"
            )
        return environment.get_template(study.text.name)
    except jinja2.TemplateSyntaxError as error:
        raise ConfigurationError(f"{study.text}: line {error.lineno}: {error.message}") from None
    except UnicodeDecodeError:
        raise ConfigurationError(f"{study.text}: is not text in UTF-8") from None


def paragraph(study: Study, cases: str | Path) -> tuple[str, dict[str, str | float]]:
    """Return the text of a study as one line, and the numbers and words that its template sets, by name, which article
    and page quote.

    Raises ConfigurationError, with the line of the template, for a number that the study does not have.
    """

    def errors(of: str, approach: str = "", **choices: Any) -> ErrorsOfCases:
        spec = {"of": of, **({"approach": approach} if approach else {}), **choices}
        if wrong := choices.keys() - CHOICES:
            raise ValueError(
                f"errors takes {', '.join(sorted(CHOICES))}, not {', '.join(sorted(wrong))}"
            )
        if not (fits := study.fits_of(spec)):
            raise ValueError(f"{spec} selects no fit of this study: see estimation")
        if any(f"{of}_relative_error__{fit.label}" not in columns for fit in fits):
            raise ValueError(
                f"{of} is not identified, or the oscillator has none: see estimation.terms"
            )
        return ErrorsOfCases(study, cases, spec)

    if (template := template_of(study)) is None:
        return "", {}
    columns = {column.name for column in case_columns(study)}
    try:
        module = template.make_module({"errors": errors, "cases": f"{study.cases:,}"})
    except Exception as error:  # whatever its expressions raise is a fault of the template
        frames = traceback.extract_tb(error.__traceback__)
        lines = [frame.lineno for frame in frames if frame.filename == template.filename]
        line = template.get_corresponding_lineno(lines[-1] or 1)
        raise ConfigurationError(f"{study.text}: line {line}: {error}") from error
    # Jinja hands names on as a set, whose order differs from process to process.
    numbers = {
        name: " ".join(value.split()) if isinstance(value, str) else value
        for name, value in sorted(vars(module).items())
        if not name.startswith("_") and isinstance(value, str | int | float)
    }
    return " ".join(str(module).split()), numbers


def _words(form: Any) -> Any:
    """Return a percentage in this form, or a note that there is none."""

    def words(share: float) -> str:
        return form(share) if math.isfinite(share) else "nothing (it cannot be identified there)"

    return words
