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
from jinja2 import meta, sandbox

from ...arrays import Array, Integers
from ...project.documents import ConfigurationError
from ...project.wording import percent, signed_percent
from ..case_files import column_of
from ..cases import case_columns
from ..reading_study import wrong_selection
from ..study_file import Study, selected
from .statistics import spread_of, worst_errors

CHOICES = {"approach", "phase", "sharing", "contact", "weights", "terms", "fit"}
"""Keys by which `errors` selects fits, with the meaning that they have in a figure."""


@dataclass(frozen=True)
class ErrorsOfCases:
    """Relative errors of one coefficient in selected cases, by a fit or by the worst of several.

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
        values = {name: column_of(self.cases, name) for name in names}
        if not (kept := np.flatnonzero(selected(values, self.spec))).size:
            raise ValueError("no case is left: a sampled axis has no value between these bounds")
        return kept

    @property
    def _errors(self) -> Array:
        return worst_errors(self.study, self.cases, self.spec)[self._kept]

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
        """The largest size; NaN where nothing is identified."""
        return float(np.fmax.reduce(np.abs(self._errors)))

    def within(self, bound: float) -> float:
        """Return the share of the cases whose error is within a bound."""
        return float(np.mean(np.abs(self._errors) <= bound))

    def __getitem__(self, statistic: str) -> float:
        """Return a statistic over the cases that are left, of one fit, by its name in `statistics.spread`.

        A template may write it with a dot, errors("F_k", "direct").p95.
        """
        if len(fits := self.study.fits_of(self.spec)) > 1:
            labels = ", ".join(fit.label for fit in fits)
            raise ValueError(f"{statistic} refers to one fit, but {labels} are selected")
        return spread_of(self.study, self.cases, self.spec["of"], fits[0], self._kept)[statistic]


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
