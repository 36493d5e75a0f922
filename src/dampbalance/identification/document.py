"""A result as plain data, which `identification.json` holds, as rows of its table, and as the files of a folder."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import __version__
from ..arguments import flag, path
from ..findings.words import sentence, unit_of
from ..model import named_with_unit
from ..project.files import plain, write_json, write_rows, write_text
from ..records.coordinate import TRANSLATION, Coordinate
from .answer import CONFIDENCE, REFERENCE, Answer, ParameterEstimate
from .law_comparison import LawComparison, LawWeight
from .outputs import (
    ALL_PICTURES,
    ESTIMATES,
    REPORT,
    SUMMARY,
    TABLES,
    pictures_of,
    require_room,
    written_together,
)
from .sensitivities import FAULTS, told

if TYPE_CHECKING:
    from .result import Result

_IN_TABLE = ("residual", "misfit")  # of the merit of an answer


def document(found: Result[Any]) -> dict[str, Any]:
    """Return the document: see `Result.document`."""
    coordinate = found.coordinate
    answers = {name: _entries(answer, coordinate) for name, answer in found.approaches.items()}
    of_kind = found.basis.document(found)
    for entry, record in zip(of_kind["records"], found.records, strict=bool(found.records)):
        entry |= record.files or {}
    of, effects = found.sensitivities()
    everything = {
        "dampbalance": __version__,
        "kind": found.basis.kind,
        **({} if coordinate == TRANSLATION else {"coordinate": coordinate.name}),
        "options": dict(found.options),
        "k_N_per_m": found.k,
        "confidence": CONFIDENCE,
        **found.settings,
        "answer": found.answer.name,
        "no_answer": found.no_answer or None,
        "approaches": {name: answers[name] for name in found.estimates},
        "maximum_likelihood": answers.get(REFERENCE),
        **({"weights": [one._asdict() for one in found.weighed]} if found.weighed else {}),
        **({} if found.laws is None else {"laws": _of_laws(found.laws, coordinate)}),
        **of_kind,
        "oscillator": _columns(found.oscillator),
        "damping": {"damping_ratio": found.damping_ratio, "levels": found.level_documents},
        "sensitivities_of": of,
        "sensitivities": {
            name: {"fault": told(found, FAULTS[name].words)}
            | {f"{symbol}_percent": 100.0 * change for symbol, change in changes.items()}
            for name, changes in effects.items()
        },
        "findings": [
            one.document() | {"sentence": sentence(one, coordinate)} for one in found.findings
        ],
    }
    names = {*found.sources, *(record.label for record in found.records)}  # keys, too
    keyed: dict[str, Any] = coordinate.document(plain(everything), names)
    return keyed


def table(found: Result[Any]) -> list[dict[str, Any]]:
    """Return a row for each answer, the one to use first: value, standard error, interval and verdict of each parameter
    in columns named with units, and the findings on it; None if an answer has no such number."""
    rows = []
    for name, answer in found.approaches.items():
        row = {"approach": name} | _columns(answer.parameters, table=True)
        row |= {key: answer.merit[key] for key in _IN_TABLE if key in answer.merit}
        for symbol, v in answer.verdicts.items():
            row |= {f"{symbol}_verdict": v.verdict, f"{symbol}_within_percent": 100.0 * v.within}
        notes = (f"{one.code}: {sentence(one, found.coordinate)}" for one in answer.notes)
        rows.append(row | {"note": "; ".join(notes)})
    rows[0]["no_answer"] = found.no_answer
    columns = dict.fromkeys(name for row in sorted(rows, key=len, reverse=True) for name in row)
    return [{found.coordinate.key(name): row.get(name) for name in columns} for row in rows]


def save(
    found: Result[Any], folder: str | Path, *, figures: bool = True, overwrite: bool = False
) -> list[Path]:
    """Write a result to a folder: see `Result.save`."""
    folder = path("folder", folder, "the path of a folder")
    remedy = "" if flag("overwrite", overwrite) else "overwrite=True"
    require_room(folder, (*TABLES, *ALL_PICTURES), remedy)
    pictures = (*pictures_of(found.figures), REPORT) if flag("figures", figures) else ()
    with written_together(folder, (*pictures, *reversed(TABLES))) as new:
        if figures:
            from .report import report  # slow to import

            write_text(new / REPORT, report(found, new))
        write_rows(new / ESTIMATES, table(found))
        write_text(new / SUMMARY, found.text())
        write_json(new / TABLES[0], found.document())
    return [folder / name for name in (*TABLES, *pictures)]


def _entries(answer: Answer, coordinate: Coordinate) -> dict[str, Any]:
    """Return an answer by the keys of the document."""
    document = _columns(answer.parameters)
    if answer.balance is not None:
        sizes = np.sqrt(np.diag(answer.covariance))
        with np.errstate(invalid="ignore"):  # exact rows have no errors
            correlations = answer.covariance / np.outer(sizes, sizes)
        document |= {
            f"correlation_of_{one}_and_{other}": correlations[i, j]
            for (i, one), (j, other) in itertools.combinations(enumerate(answer.coefficients), 2)
        }
    document["verdicts"] = {
        symbol: v.worded(coordinate).document() for symbol, v in answer.verdicts.items()
    }
    document |= answer.merit
    if answer.balance is not None:
        document["rows"] = {**answer.rows, **answer.balance.labels}
    return document


def _columns(of: Mapping[str, ParameterEstimate], *, table: bool = False) -> dict[str, Any]:
    """Return numbers in columns named with their units; in a table each end of an interval has a column."""
    columns: dict[str, Any] = {}
    for symbol, p in of.items():
        numbers: dict[str, Any] = {"": p.value, "_standard_error": p.standard_error}
        ends = {"_low": p.interval.low, "_high": p.interval.high}
        numbers |= ends if table else {"_interval": p.interval}
        columns |= {_column(symbol, what): n for what, n in numbers.items()}
    return columns


def _column(symbol: str, what: str = "") -> str:
    """Return the name of a column with its unit, F_k_standard_error_N."""
    return named_with_unit(f"{symbol}{what}", unit_of(symbol))


def _of_laws(laws: LawComparison, coordinate: Coordinate) -> dict[str, Any]:
    return {
        "chosen": laws.chosen,
        "not_told_apart": laws.alike,
        "noise": laws.noise,
        "words": [sentence(one, coordinate) for one in laws.findings],
        "weighed": [_of_law(law) for law in laws.laws],
    }


def _of_law(law: LawWeight) -> dict[str, Any]:
    numbers = {
        _column(key, what): number
        for key, pair in law.coefficients.items()
        for what, number in zip(("", "_standard_error"), pair, strict=True)
    }
    fit = law.fit and {"chi_square": law.fit.chi_square, "degrees_of_freedom": law.fit.freedom}
    return {"terms": law.terms, "weight": law.weight, **numbers, **(fit or {})}
