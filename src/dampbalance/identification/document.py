"""An identification in numbers: a document for programs, and a table of the estimates for spreadsheets."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from .answer import REFERENCE, Answer, ParameterEstimate, column
from .outcome import Outcome

_IN_TABLE = ("residual", "misfit")  # of the merit of an answer


def document(
    outcome: Outcome,
    version: str = "",
    options: Mapping[str, Any] | None = None,
    files: Sequence[Mapping[str, Any]] = (),
) -> dict[str, Any]:
    """Everything that was identified, for JSON; SI units, named in the keys; what is not known is null.

    options : as given.   files : what is known of the file of each record, in their order.
    """
    answers, findings = {n: _entries(a) for n, a in outcome.answers.items()}, outcome.findings()
    for record, file in zip(findings["records"], files, strict=bool(files)):
        record |= file
    everything = {
        "dampbalance": version,
        **outcome.kind,
        "options": dict(options or {}),
        "k_N_per_m": outcome.k,
        **outcome.settings,
        "answer": next(iter(answers)),
        "approaches": {name: answers[name] for name in outcome.estimates},
        "maximum_likelihood": answers.get(REFERENCE),
        **findings,
        "warnings": list(outcome.warnings),
    }
    return _plain(everything)


def estimates_table(outcome: Outcome) -> list[dict[str, Any]]:
    """A row for each answer, the one to use first: value, standard errors and interval of each parameter, in columns
    named with units, and the verdict on each; None where an answer has no such number."""
    rows = []
    for name, answer in outcome.answers.items():
        row: dict[str, Any] = {"approach": name}
        for symbol, parameter in answer.parameters.items():
            ends = {f"_{end}": number for end, number in parameter.interval._asdict().items()}
            numbers = _with_errors(answer, parameter) | ends
            row |= {column(symbol, what): number for what, number in numbers.items()}
        for symbol, parameter in answer.equal.items():
            row[f"equal_weights_{column(symbol)}"] = parameter.value
            row[f"equal_weights_{column(symbol, '_standard_error')}"] = parameter.standard_error
        row |= {key: answer.merit[key] for key in _IN_TABLE if key in answer.merit}
        row |= {f"{symbol}_verdict": verdict for symbol, (verdict, _) in answer.verdicts.items()}
        rows.append(row | {"note": "; ".join(answer.notes)})
    columns = dict.fromkeys(name for row in sorted(rows, key=len, reverse=True) for name in row)
    return [{name: row.get(name) for name in columns} for row in rows]


def _entries(answer: Answer) -> dict[str, Any]:
    """An answer for the document."""
    entries: dict[str, Any] = {}
    for beginning, parameters in (("", answer.parameters), ("equal_weights_", answer.equal)):
        for symbol, parameter in parameters.items():
            numbers = _with_errors(answer, parameter) | {"_interval": parameter.interval}
            entries |= {beginning + column(symbol, what): of for what, of in numbers.items()}
    if answer.balance is not None:
        entries |= {
            f"correlation_of_{one}_and_{other}": answer.correlations.get((one, other))
            for one, other in itertools.combinations(answer.coefficients, 2)
        }
    entries["verdicts"] = {symbol: v._asdict() for symbol, v in answer.verdicts.items()}
    entries |= answer.merit
    if answer.balance is not None:
        entries["rows"] = {**answer.rows, **answer.balance.labels}
    return entries | {"notes": answer.notes}


def _with_errors(answer: Answer, parameter: ParameterEstimate) -> dict[str, Any]:
    """The value and its standard errors by the ends of their keys; the error by propagation where it is computed."""
    numbers = {"": parameter.value, "_standard_error": parameter.standard_error}
    return numbers | ({"_propagated_error": parameter.propagated_error} if answer.equal else {})


def _plain(value: Any) -> Any:
    """A value as JSON knows it: null for a number that is not known or has no bound."""
    if isinstance(value, Mapping):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    if isinstance(value, str):
        return str(value)  # of a remark, its sentence
    return None if isinstance(value, float) and not math.isfinite(value) else value
