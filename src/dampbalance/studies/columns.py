"""The columns of a study's table of cases."""

from __future__ import annotations

from typing import NamedTuple

from ..law.terms import KNOWN_TERMS
from .parameters import OF_LAW, PARAMETERS, SI_COLUMNS
from .responses import REGIME_NAMES
from .settings import Study


class Column(NamedTuple):
    """A column of the table of cases: name with unit, unit, meaning, and whether it holds words."""

    name: str
    unit: str
    meaning: str
    words: bool = False


_OF_TERMS = {
    "errors": [("{0.symbol}_relative_error", "1", "{0.symbol} identified / true − 1")],
    "estimates": [("{0.column}", "{0.unit}", "{0.symbol} identified")],
    "intervals": [
        (
            "{0.symbol}_relative_standard_error",
            "1",
            "standard error of {0.symbol} (bootstrap over cycles; of the fit, its covariance) / true {0.symbol}",
        ),
        (
            "{0.symbol}_covered",
            "1",
            "1 if the 95 % interval of {0.symbol} holds its true value, else 0",
        ),
    ],
}
"""Columns of a fit for each term, by the word that asks for them: name, unit and meaning, as formats of the term."""


def columns_of(study: Study) -> list[Column]:
    """The columns of the table of cases, in their order."""
    columns = [Column("case", "1", "number of the case, counted from 0")]
    columns += map(_of_parameter, study.axis_names)
    if "parameters" in study.columns:
        columns += [
            Column(*described)
            for described in SI_COLUMNS.values()
            if described[0] not in study.axis_names
            and (described[0] != "Y_m" or study.levels_relative)
        ]
        columns += [_of_parameter(name) for name in OF_LAW if name in study.fixed]
    kinds = ", ".join(REGIME_NAMES.values())
    regimes = f"kind of response at each level, one word if all are alike: {kinds}"
    columns.append(Column("regime", "", regimes, words=True))
    if study.route.chooses_law:
        columns.append(Column("chosen", "", "law that the records support, or none", words=True))
    true = {*SI_COLUMNS, *(OF_LAW[name] for name in OF_LAW if name in study.parameters)}
    for fit in study.fits:
        how = " ".join(part.replace("_", " ") for part in fit.label.split("__"))
        for kind, described in _OF_TERMS.items():
            columns += [
                Column(
                    f"{name}__{fit.label}".format(term),
                    unit.format(term),
                    f"{meaning.format(term)}; {how}",
                )
                for term in map(KNOWN_TERMS.__getitem__, fit.identified)
                for name, unit, meaning in described
                if kind in study.columns and (kind == "estimates" or term.symbol in true)
            ]
        if "residuals" in study.columns:
            columns.append(Column(f"residual__{fit.label}", "1", f"‖A p − W‖/‖W‖; {how}"))
    return columns


def _of_parameter(name: str) -> Column:
    parameter = PARAMETERS[name]
    return Column(name, parameter.unit, parameter.meaning, words=parameter.is_word)
