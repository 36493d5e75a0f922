"""An identification in words and numbers: a table for the screen, a document for programs, tables for spreadsheets."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from ..features import COLUMNS
from ..law.terms import named_with_unit, term
from ..reading.noisy import Reading
from .lawtable import aligned, laws_document, laws_in_lines
from .limits import REFERENCE, limits, shown
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
from .verdicts import Verdict, in_one, judged_by_notes, verdicts_of


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
        "approaches": {name: _approach(e) for name, e in result.estimates.items()},
        "maximum_likelihood": _yardstick(result.whole),
        **({} if result.laws is None else {"laws": laws_document(result.laws)}),
        "microstick": {
            "length_m": _number(result.microstick.length),
            "standard_error_m": _number(result.microstick.standard_error),
            "resolved": result.microstick.resolved,
            "upper_bound_m": _number(result.microstick.bound),
        },
        "records": [
            {**_record(reading, result, i), **of_files[i]}
            for i, reading in enumerate(result.readings)
        ],
        "sensitivities": {
            name: {"fault": FAULTS[name].words}
            | {f"{symbol}_percent": _number(100.0 * change) for symbol, change in changes.items()}
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
            numbers = _with_errors(parameter) | ends
            row |= {_key(symbol, what): number for what, number in numbers.items()}
        for symbol, parameter in estimated.equal.items():
            row[f"equal_weights_{_key(symbol)}"] = parameter.value
            row[f"equal_weights_{_key(symbol, '_standard_error')}"] = parameter.standard_error
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


def text_table(result: Identification) -> str:
    """Estimates with their 95 % intervals and what they are worth, a line per approach, then what limits them, each
    thing once; for a screen."""
    symbols = list(dict.fromkeys(s for e in result.estimates.values() for s in e.coefficients))
    symbols.append("K_z")
    table = [["", *map(_headed, symbols), "verdict"]]
    lines: list[tuple[str, Mapping[str, ParameterEstimate], Mapping[str, Verdict]]] = [
        (name + (" *" if e.notes else ""), e.parameters, verdicts_of(e))
        for name, e in result.estimates.items()
    ]
    of_fit, notes = parameters_of(result.whole), notes_of(result.whole)
    if of_fit:
        name = REFERENCE + (" *" if notes else "")
        lines.append((name, of_fit, judged_by_notes(of_fit, notes)))
    for name, parameters, verdicts in lines:
        cells = (_with_interval(parameters[s]) if s in parameters else "" for s in symbols)
        table.append([name, *cells, in_one(verdicts)])
    shown_lines = aligned(table)
    hz = sorted({round(r.steady.frequency_hz, 4) for r in result.readings})
    head = (
        f"{len(result.readings)} records at {', '.join(f'{f:g}' for f in hz)} Hz; values with 95 % intervals from "
        f"{result.replicates} bootstrap replicates"
    )
    shown_lines += ["", *_implied(result.whole)]
    sources = [reading.steady.source for reading in result.readings]
    said = [
        f"{'* ' if limit.kind == 'approaches' else 'warning: '}{shown(limit, sources)}"
        for limit in limits(result)
    ]
    told = ["", "What limits the answer:", *said] if said else []
    laws = [] if result.laws is None else ["", *laws_in_lines(result.laws)]
    return "\n".join([head, "", *shown_lines, *laws, *told]) + "\n"


def _implied(whole: Whole) -> list[str]:
    """What the part of the motion in phase with the drive says of the rig, which its owner knows better."""
    fit = whole.fit
    if fit is None or whole.linear:
        return []
    mass = "the mass given" if whole.mass_given else f"m = {_value(fit.m, fit.error('m'))} kg"
    said = [
        f"The oscillator of largest likelihood has {mass} and a natural frequency of {fit.natural_frequency_hz:.4g} Hz "
        "with the contact loose.",
        "If that is not your rig, a gain, a unit or the stiffness is wrong.",
    ]
    if fit.adequate and whole.delayed is not None:
        delay, error = 1e6 * whole.delayed.delay, 1e6 * whole.delayed.error("delay")
        said.append(f"Left free, a delay of the response is {_value(delay, error)} µs.")
    return said


def _value(value: float, error: float) -> str:
    """2.4197 ± 0.0003"""
    return f"{_rounded(value, error)} ± {_rounded(error, error)}"


def _approach(estimated: ApproachResult) -> dict[str, Any]:
    entries = _parameters(estimated.parameters)
    entries |= _parameters(estimated.equal, of="equal_weights_")
    entries |= {
        f"correlation_of_{one}_and_{other}": _number(
            estimated.correlations.get((one, other), math.nan)
        )
        for one, other in itertools.combinations(estimated.coefficients, 2)
    }
    columns = {term(key).integral_column: g for key, g in estimated.rows.terms.items()}
    columns |= {"W_J": estimated.rows.W, "standard_error_J": estimated.row_errors}
    return entries | {
        "verdicts": _verdicts(verdicts_of(estimated)),
        "residual": _number(estimated.residual),
        "misfit": _number(estimated.misfit),
        "rows": {key: [_number(v) for v in values] for key, values in columns.items()},
        "notes": list(estimated.notes),
    }


def _yardstick(whole: Whole) -> dict[str, Any] | None:
    """The fit of the whole oscillator; None where there is none."""
    fit, parameters, notes = whole.fit, parameters_of(whole), notes_of(whole)
    delayed = whole.delayed
    if fit is None or not parameters:
        return None
    return _parameters(parameters, leave_out="_propagated_error") | {
        "verdicts": _verdicts(judged_by_notes(parameters, notes)),
        "m_kg": fit.m,
        "m_standard_error_kg": fit.error("m"),
        "natural_frequency_Hz": fit.natural_frequency_hz,
        "misfit": _number(fit.misfit),
        "misfit_of_records": [_number(misfit) for misfit in fit.misfits],
        "delay_s": None if delayed is None else delayed.delay,
        "delay_standard_error_s": None if delayed is None else delayed.error("delay"),
        "notes": list(notes),
    }


def _verdicts(verdicts: Mapping[str, Verdict]) -> dict[str, dict[str, str]]:
    return {symbol: verdict._asdict() for symbol, verdict in verdicts.items()}


def _parameters(
    parameters: Mapping[str, ParameterEstimate], leave_out: str | None = None, of: str = ""
) -> dict[str, Any]:
    entries: dict[str, Any] = {}
    for symbol, parameter in parameters.items():
        for what, number in _with_errors(parameter).items():
            if what != leave_out:
                entries[of + _key(symbol, what)] = _number(number)
        entries[of + _key(symbol, "_interval")] = [_number(end) for end in parameter.interval]
    return entries


def _with_errors(parameter: ParameterEstimate) -> dict[str, float]:
    """The value and its standard errors by the ends of their keys."""
    return {
        "": parameter.value,
        "_standard_error": parameter.standard_error,
        "_propagated_error": parameter.propagated_error,
    }


def _headed(symbol: str) -> str:
    """F_k (N): the head of a column of a table."""
    unit = unit_of(symbol)
    return f"{symbol} ({unit})" if unit else symbol


def _key(symbol: str, what: str = "") -> str:
    """F_k_standard_error_N: what is said of a parameter, and its unit."""
    return named_with_unit(f"{symbol}{what}", unit_of(symbol))


def _record(reading: Reading, result: Identification, index: int) -> dict[str, Any]:
    steady, features = reading.steady, result.features
    return {
        "record": steady.source,
        "frequency_Hz": steady.frequency_hz,
        "frequency_standard_error_Hz": _number(steady.omega_standard_error / (2.0 * math.pi)),
        "cycles": steady.cycles,
        "highest_harmonic": steady.bandwidth,
        "noise_rms": dict(steady.noise_rms),
        "slips": reading.slips,
        "features": {
            column: _number(float(getattr(features, name)[index]))
            for name, column in COLUMNS.items()
        },
        "standard_errors": {
            column: _number(reading.standard_errors[name]) for name, column in COLUMNS.items()
        },
        "warnings": list(reading.warnings),
    }


def _number(value: float) -> float | None:
    """A number of JSON: null for what is not known or has no bound."""
    return float(value) if math.isfinite(value) else None


def _with_interval(parameter: ParameterEstimate) -> str:
    """1.2807 [1.2784, 1.2831]: digits down to a tenth of the interval's half width."""
    value, (low, high) = parameter.value, parameter.interval
    if math.isfinite(low) and not math.isfinite(high):
        return f"> {_rounded(low, low)}"
    if not all(map(math.isfinite, (value, low, high))):
        return "–"
    half = 0.5 * (high - low)
    return f"{_rounded(value, half)} [{_rounded(low, half)}, {_rounded(high, half)}]"


def _rounded(value: float, spread: float) -> str:
    """The value with two digits of the spread."""
    if not spread > 0.0:
        return f"{value:.6g}"
    decimals = 1 - math.floor(math.log10(spread))
    return f"{round(value, decimals):.{max(0, decimals)}f}"
