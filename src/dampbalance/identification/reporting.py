"""An identification in words and numbers: a table for the screen, a document for programs, tables for spreadsheets."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from ..features import COLUMNS
from ..law.terms import named_with_unit
from ..reading.noisy import Reading
from .answers import Answer, answers_of_forced
from .lawtable import laws_document, laws_in_lines
from .limits import limits
from .limits import shown as in_a_sentence
from .notes import notes_of
from .oscillator import Whole
from .result import (
    CONFIDENCE,
    ApproachResult,
    Identification,
    ParameterEstimate,
    parameters_of,
    unit_of,
)
from .sensitivities import FAULTS, sensitivities
from .showing import Shown, implied, marked, table_of, with_error
from .verdicts import Verdict, judged_by_notes, verdicts_of


def document(
    result: Identification,
    version: str = "",
    options: Mapping[str, Any] | None = None,
    files: Sequence[Mapping[str, Any]] = (),
) -> dict[str, Any]:
    """Everything that was identified, for JSON; SI units, named in the keys; what is not known is null.

    options : as given.   files : what is known of the file of each record, in their order.
    """
    of_files = files or [{}] * len(result.readings)
    told = answers_of_forced(result)
    return {
        "dampbalance": version,
        "options": dict(options or {}),
        "k_N_per_m": result.k,
        "law": {
            "terms": list(result.law.terms),
            "given": dict(result.law.given),
            "groups": {symbol: list(labels) for symbol, labels in result.law.groups.items()},
        },
        "phase": result.phase,
        "confidence": CONFIDENCE,
        "bootstrap": {"replicates": result.replicates, "seed": result.seed},
        "approaches": {name: _approach(e, told[name]) for name, e in result.estimates.items()},
        "maximum_likelihood": _yardstick(result.whole),
        **({} if result.laws is None else {"laws": laws_document(result.laws)}),
        "microstick": {
            "length_m": finite(result.microstick.length),
            "standard_error_m": finite(result.microstick.standard_error),
            "resolved": result.microstick.resolved,
            "upper_bound_m": finite(result.microstick.bound),
        },
        "records": [
            {**_record(reading, result, i), **of_files[i]}
            for i, reading in enumerate(result.readings)
        ],
        "sensitivities": {
            name: {"fault": FAULTS[name].words}
            | {f"{symbol}_percent": finite(100.0 * change) for symbol, change in changes.items()}
            for name, changes in sensitivities(result).items()
        },
        "limits": [asdict(limit) for limit in limits(result)],
        "warnings": list(result.warnings),
    }


def estimates_table(result: Identification) -> list[dict[str, Any]]:
    """A row for each approach: value, standard errors and interval of each parameter, in columns named with units, and
    the verdict on each."""
    rows = []
    for name, estimated in result.estimates.items():
        row: dict[str, Any] = {"approach": name}
        for symbol, parameter in estimated.parameters.items():
            ends = {f"_{end}": number for end, number in parameter.interval._asdict().items()}
            numbers = with_errors(parameter) | ends
            row |= {key_of(symbol, what): number for what, number in numbers.items()}
        for symbol, parameter in estimated.equal.items():
            row[f"equal_weights_{key_of(symbol)}"] = parameter.value
            row[f"equal_weights_{key_of(symbol, '_standard_error')}"] = parameter.standard_error
        row |= {"residual": estimated.residual, "misfit": estimated.misfit}
        row |= {
            f"{symbol}_verdict": verdict for symbol, (verdict, _) in verdicts_of(estimated).items()
        }
        rows.append(row | {"note": "; ".join(estimated.notes)})
    return rows


def features_table(result: Identification) -> list[dict[str, Any]]:
    """A row for each record: its features, and the standard error of each, in columns named with units."""
    columns = result.features.to_columns()
    return [
        {"record": reading.steady.source}
        | {column: values[i] for column, values in columns.items()}
        | {
            column.replace(name, f"{name}_standard_error", 1): reading.standard_errors[name]
            for name, column in COLUMNS.items()
        }
        for i, reading in enumerate(result.readings)
    ]


def shown(result: Identification) -> Shown:
    """Estimates with their 95 % intervals and what they are worth, a line per approach, then what limits them, each
    thing once."""
    hz = sorted({round(r.steady.frequency_hz, 4) for r in result.readings})
    head = (
        f"{len(result.readings)} records at {', '.join(f'{f:g}' for f in hz)} Hz; values with 95 % intervals from "
        f"{result.replicates} bootstrap replicates"
    )
    whole = result.whole
    fit, of_rig = whole.fit, []
    if fit is not None and not whole.linear:
        of_rig = implied(fit, whole.mass_given)
        if fit.adequate and whole.delayed is not None:
            delay, error = 1e6 * whole.delayed.delay, 1e6 * whole.delayed.error("delay")
            of_rig.append(f"Left free, a delay of the response is {with_error(delay, error)} µs.")
    sources = [reading.steady.source for reading in result.readings]
    said = [marked(limit.kind, in_a_sentence(limit, sources)) for limit in limits(result)]
    laws = [] if result.laws is None else laws_in_lines(result.laws)
    table = table_of(answers_of_forced(result))
    return Shown(head, table, tuple(of_rig), tuple(laws), tuple(said))


def _approach(estimated: ApproachResult, answer: Answer) -> dict[str, Any]:
    entries = entries_of(estimated.parameters)
    entries |= entries_of(estimated.equal, of="equal_weights_")
    entries |= {
        f"correlation_of_{one}_and_{other}": finite(
            estimated.correlations.get((one, other), math.nan)
        )
        for one, other in itertools.combinations(estimated.coefficients, 2)
    }
    return entries | {
        "verdicts": judgements(verdicts_of(estimated)),
        "residual": finite(estimated.residual),
        "misfit": finite(estimated.misfit),
        "rows": {key: [finite(v) for v in values] for key, values in answer.rows.items()},
        "notes": list(estimated.notes),
    }


def _yardstick(whole: Whole) -> dict[str, Any] | None:
    """The fit of the whole oscillator; None where there is none."""
    fit, parameters, notes = whole.fit, parameters_of(whole), notes_of(whole)
    delayed = whole.delayed
    if fit is None or not parameters:
        return None
    return entries_of(parameters, leave_out="_propagated_error") | {
        "verdicts": judgements(judged_by_notes(parameters, notes)),
        "m_kg": fit.m,
        "m_standard_error_kg": fit.error("m"),
        "natural_frequency_Hz": fit.natural_frequency_hz,
        "misfit": finite(fit.misfit),
        "misfit_of_records": [finite(misfit) for misfit in fit.misfits],
        "delay_s": None if delayed is None else delayed.delay,
        "delay_standard_error_s": None if delayed is None else delayed.error("delay"),
        "notes": list(notes),
    }


def judgements(verdicts: Mapping[str, Verdict]) -> dict[str, dict[str, str]]:
    """Verdicts for JSON."""
    return {symbol: verdict._asdict() for symbol, verdict in verdicts.items()}


def entries_of(
    parameters: Mapping[str, ParameterEstimate], leave_out: str | None = None, of: str = ""
) -> dict[str, Any]:
    """Parameters with their errors and intervals for JSON.   of : how each key begins."""
    entries: dict[str, Any] = {}
    for symbol, parameter in parameters.items():
        for what, number in with_errors(parameter).items():
            if what != leave_out:
                entries[of + key_of(symbol, what)] = finite(number)
        entries[of + key_of(symbol, "_interval")] = [finite(end) for end in parameter.interval]
    return entries


def with_errors(parameter: ParameterEstimate) -> dict[str, float]:
    """The value and its standard errors by the ends of their keys."""
    return {
        "": parameter.value,
        "_standard_error": parameter.standard_error,
        "_propagated_error": parameter.propagated_error,
    }


def key_of(symbol: str, what: str = "") -> str:
    """F_k_standard_error_N: what is said of a parameter, and its unit."""
    return named_with_unit(f"{symbol}{what}", unit_of(symbol))


def _record(reading: Reading, result: Identification, index: int) -> dict[str, Any]:
    steady, features = reading.steady, result.features
    return {
        "record": steady.source,
        "frequency_Hz": steady.frequency_hz,
        "frequency_standard_error_Hz": finite(steady.omega_standard_error / (2.0 * math.pi)),
        "cycles": steady.cycles,
        "highest_harmonic": steady.bandwidth,
        "noise_rms": dict(steady.noise_rms),
        "slips": reading.slips,
        "features": {
            column: finite(float(getattr(features, name)[index]))
            for name, column in COLUMNS.items()
        },
        "standard_errors": {
            column: finite(reading.standard_errors[name]) for name, column in COLUMNS.items()
        },
        "warnings": list(reading.warnings),
    }


def finite(value: float) -> float | None:
    """A number of JSON: null for what is not known or has no bound."""
    return float(value) if math.isfinite(value) else None
