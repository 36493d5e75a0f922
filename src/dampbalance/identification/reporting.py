"""An identification in words and numbers: a table for the screen, a document for programs, tables for spreadsheets."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from ..balance import TERMS, named_with_unit
from ..features import COLUMNS
from ..likelihood.result import ReferenceFit
from ..reading.noisy import Reading
from .limits import REFERENCE, limits, shown
from .result import CONFIDENCE, ApproachResult, Identification, Interval, ParameterEstimate
from .verdicts import Verdict, in_one, judged_by_notes, verdicts_of


def document(
    result: Identification,
    reference: ReferenceFit | None = None,
    version: str = "",
    options: Mapping[str, Any] | None = None,
    files: Sequence[Mapping[str, Any]] = (),
) -> dict[str, Any]:
    """Everything that was identified, for JSON; SI units, named in the keys; what is not known is null.

    reference : a maximum-likelihood fit of the same records, to go beside the approaches.   options : as given.
    files : what is known of the file of each record, in their order.
    """
    of_files = files or [{}] * len(result.readings)
    return {
        "dampbalance": version,
        "options": dict(options or {}),
        "k_N_per_m": result.k,
        "phase": result.phase,
        "confidence": CONFIDENCE,
        "bootstrap": {"replicates": result.replicates, "seed": result.seed},
        "approaches": {name: _approach(e, result) for name, e in result.estimates.items()},
        "maximum_likelihood": None if reference is None else _reference(reference),
        "microstick": {
            "length_m": _number(result.microstick.length),
            "standard_error_m": _number(result.microstick.standard_error),
            "resolved": result.microstick.resolved,
            "upper_bound_m": _number(result.microstick.bound),
            "F_k_bias_of_rigid_contact": _number(result.microstick.rigid_bias),
        },
        "records": [
            {**_record(reading, result, i), **of_files[i]}
            for i, reading in enumerate(result.readings)
        ],
        "limits": [asdict(limit) for limit in limits(result, reference)],
        "warnings": [*result.warnings, *(reference.warnings if reference is not None else ())],
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
        row |= {"residual": estimated.residual, "misfit": estimated.misfit}
        row |= {
            f"{symbol}_verdict": verdict
            for symbol, (verdict, _) in verdicts_of(estimated, result.microstick).items()
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


def text_table(result: Identification, reference: ReferenceFit | None = None) -> str:
    """Estimates with their 95 % intervals and what they are worth, a line per approach, then what limits them, each
    thing once; for a screen."""
    symbols = list(dict.fromkeys(s for e in result.estimates.values() for s in e.coefficients))
    symbols.append("K_z")
    table = [["", *(f"{symbol} ({_unit(symbol)})" for symbol in symbols), "verdict"]]
    lines: list[tuple[str, Mapping[str, ParameterEstimate], Mapping[str, Verdict]]] = [
        (name + (" *" if e.notes else ""), e.parameters, verdicts_of(e, result.microstick))
        for name, e in result.estimates.items()
    ]
    if reference is not None:
        of_fit = _of_reference(reference)
        lines.append((REFERENCE, of_fit, judged_by_notes(of_fit, reference.warnings)))
    for name, parameters, verdicts in lines:
        cells = (_with_interval(parameters[s]) if s in parameters else "" for s in symbols)
        table.append([name, *cells, in_one(verdicts)])
    widths = [max(len(line[i]) for line in table) for i in range(len(table[0]))]
    shown_lines = [
        "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip()
        for line in table
    ]
    hz = sorted({round(r.steady.frequency_hz, 4) for r in result.readings})
    head = (
        f"{len(result.readings)} records at {', '.join(f'{f:g}' for f in hz)} Hz; values with 95 % intervals from "
        f"{result.replicates} bootstrap replicates"
    )
    sources = [reading.steady.source for reading in result.readings]
    said = [
        f"{'* ' if limit.kind == 'approaches' else 'warning: '}{shown(limit, sources)}"
        for limit in limits(result, reference)
    ]
    told = ["", "What limits the answer:", *said] if said else []
    return "\n".join([head, "", *shown_lines, *told]) + "\n"


def _approach(estimated: ApproachResult, result: Identification) -> dict[str, Any]:
    entries = _parameters(estimated.parameters)
    entries |= {
        f"correlation_of_{one}_and_{other}": _number(
            estimated.correlations.get((one, other), math.nan)
        )
        for one, other in itertools.combinations(estimated.coefficients, 2)
    }
    columns = {TERMS[s].integral_column: values for s, values in estimated.rows.terms.items()}
    columns |= {"W_J": estimated.rows.W, "standard_error_J": estimated.row_errors}
    return entries | {
        "verdicts": _verdicts(verdicts_of(estimated, result.microstick)),
        "residual": _number(estimated.residual),
        "misfit": _number(estimated.misfit),
        "rows": {key: [_number(v) for v in values] for key, values in columns.items()},
        "notes": list(estimated.notes),
    }


def _reference(fit: ReferenceFit) -> dict[str, Any]:
    parameters = _of_reference(fit)
    entries = _parameters(parameters, leave_out="_propagated_error")
    entries["verdicts"] = _verdicts(judged_by_notes(parameters, fit.warnings))
    return entries | {"m_kg": fit.m, "warnings": list(fit.warnings)}


def _verdicts(verdicts: Mapping[str, Verdict]) -> dict[str, dict[str, str]]:
    return {symbol: verdict._asdict() for symbol, verdict in verdicts.items()}


def _of_reference(fit: ReferenceFit) -> dict[str, ParameterEstimate]:
    """What the maximum-likelihood fit identifies; it has no propagated errors."""
    parameters = {}
    for symbol, error in zip(("F_k", "c", "K_z"), fit.standard_errors, strict=True):
        value = float(getattr(fit, symbol))
        ends = (value - 1.96 * error, value + 1.96 * error)
        interval = Interval(*(fit.K_z_interval if symbol == "K_z" else ends))
        parameters[symbol] = ParameterEstimate(value, error, math.nan, interval)
    return parameters


def _parameters(
    parameters: Mapping[str, ParameterEstimate], leave_out: str | None = None
) -> dict[str, Any]:
    entries: dict[str, Any] = {}
    for symbol, parameter in parameters.items():
        for what, number in _with_errors(parameter).items():
            if what != leave_out:
                entries[_key(symbol, what)] = _number(number)
        entries[_key(symbol, "_interval")] = [_number(end) for end in parameter.interval]
    return entries


def _with_errors(parameter: ParameterEstimate) -> dict[str, float]:
    """The value and its standard errors by the ends of their keys."""
    return {
        "": parameter.value,
        "_standard_error": parameter.standard_error,
        "_propagated_error": parameter.propagated_error,
    }


def _unit(symbol: str) -> str:
    return "N/m" if symbol == "K_z" else TERMS[symbol].unit


def _key(symbol: str, what: str = "") -> str:
    """F_k_standard_error_N: what is said of a parameter, and its unit."""
    return named_with_unit(f"{symbol}{what}", _unit(symbol))


def _record(reading: Reading, result: Identification, index: int) -> dict[str, Any]:
    steady, features = reading.steady, result.features
    return {
        "record": steady.source,
        "frequency_Hz": steady.frequency_hz,
        "frequency_standard_error_Hz": _number(steady.omega_standard_error / (2.0 * math.pi)),
        "cycles": steady.cycles,
        "highest_harmonic": steady.bandwidth,
        "noise_rms": dict(steady.noise_rms),
        "slip_onset_resolved_alone": bool(reading.onset_resolved),
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
