"""An identification in words and numbers: a table for the screen, a document for programs, tables for spreadsheets."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from ..features import COLUMNS
from ..likelihood.result import ReferenceFit
from ..reading.noisy import Reading
from .result import CONFIDENCE, Estimated, Identification, Parameter

if TYPE_CHECKING:
    import pandas as pd

UNITS = {"F_k": "N", "c": "N_s_per_m", "K_z": "N_per_m"}
_SHOWN = {"F_k": "F_k (N)", "c": "c (N s/m)", "K_z": "K_z (N/m)"}

REFERENCE = "maximum likelihood"


def document(
    found: Identification, reference: ReferenceFit | None = None, version: str = ""
) -> dict[str, Any]:
    """Everything that was identified, for JSON; SI units, named in the keys; what is not known is null.

    reference : a maximum-likelihood fit of the same records, to go beside the approaches.
    """
    return {
        "dampbalance": version,
        "k_N_per_m": found.k,
        "phase": found.phase,
        "confidence": CONFIDENCE,
        "bootstrap": {"replicates": found.replicates, "seed": found.seed},
        "approaches": {name: _approach(e) for name, e in found.estimates.items()},
        "maximum_likelihood": None if reference is None else _reference(reference),
        "microstick": {
            "length_m": _number(found.microstick.length),
            "standard_error_m": _number(found.microstick.standard_error),
            "resolved": found.microstick.resolved,
            "upper_bound_m": _number(found.microstick.bound),
            "F_k_bias_of_rigid_contact": _number(found.microstick.rigid_bias),
        },
        "records": [_record(reading, found, i) for i, reading in enumerate(found.readings)],
        "warnings": [*found.warnings, *(reference.warnings if reference is not None else ())],
    }


def frame(found: Identification) -> pd.DataFrame:
    """One row per approach: value, standard errors and interval of F_k, c and K_z, in columns named with units."""
    records = []
    for name, estimated in found.estimates.items():
        line: dict[str, Any] = {"approach": name}
        for symbol, unit in UNITS.items():
            parameter: Parameter = getattr(estimated, symbol)
            line |= {
                f"{symbol}_{unit}": parameter.value,
                f"{symbol}_standard_error_{unit}": parameter.standard_error,
                f"{symbol}_propagated_error_{unit}": parameter.propagated_error,
                f"{symbol}_low_{unit}": parameter.interval.low,
                f"{symbol}_high_{unit}": parameter.interval.high,
            }
        line |= {"residual": estimated.residual, "misfit": estimated.misfit}
        records.append(line | {"note": "; ".join(estimated.notes)})
    import pandas as pd  # slow to import, and needed for tables only

    return pd.DataFrame.from_records(records)


def features_frame(found: Identification) -> pd.DataFrame:
    """One row per record: its features, and the standard error of each, in columns named with units."""
    parts = []
    for reading, features in zip(found.readings, found.features, strict=True):
        line = features.to_frame()
        line.insert(0, "record", reading.steady.source)
        for name, column in COLUMNS.items():
            line[_error_column(name, column)] = reading.standard_errors[name]
        parts.append(line)
    import pandas as pd  # slow to import, and needed for tables only

    return pd.concat(parts, ignore_index=True)


def text_table(found: Identification, reference: ReferenceFit | None = None) -> str:
    """Estimates with their 95 % intervals, a line per approach, then what must be known of them; for a screen."""
    lines = [["", *_SHOWN.values()]]
    for name, estimated in found.estimates.items():
        mark = " *" if estimated.notes else ""
        lines.append(
            [name + mark, *(_with_interval(getattr(estimated, symbol)) for symbol in UNITS)]
        )
    if reference is not None:
        numbers = _reference(reference)
        lines.append(
            [
                REFERENCE,
                *(
                    _interval_text(numbers[f"{s}_{unit}"], *numbers[f"{s}_interval_{unit}"])
                    for s, unit in UNITS.items()
                ),
            ]
        )
    widths = [max(len(line[i]) for line in lines) for i in range(4)]
    shown = [
        "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip()
        for line in lines
    ]
    said = [f"* {name}: {note}" for name, e in found.estimates.items() for note in e.notes]
    said += [f"warning: {words}" for words in found.warnings]
    said += [f"warning: {REFERENCE}: {w}" for w in (reference.warnings if reference else ())]
    hz = sorted({round(r.steady.frequency_hz, 4) for r in found.readings})
    head = (
        f"{len(found.readings)} records at {', '.join(f'{f:g}' for f in hz)} Hz; values with 95 % intervals from "
        f"{found.replicates} bootstrap replicates"
    )
    return "\n".join([head, "", *shown, *([""] if said else []), *said]) + "\n"


def _approach(estimated: Estimated) -> dict[str, Any]:
    made: dict[str, Any] = {}
    for symbol, unit in UNITS.items():
        parameter: Parameter = getattr(estimated, symbol)
        made |= {
            f"{symbol}_{unit}": _number(parameter.value),
            f"{symbol}_standard_error_{unit}": _number(parameter.standard_error),
            f"{symbol}_propagated_error_{unit}": _number(parameter.propagated_error),
            f"{symbol}_interval_{unit}": [_number(end) for end in parameter.interval],
        }
    return made | {
        "correlation_of_F_k_and_c": _number(estimated.correlation),
        "residual": _number(estimated.residual),
        "misfit": _number(estimated.misfit),
        "rows": {
            "a_m": [_number(v) for v in estimated.rows.a],
            "b_m2_per_s": [_number(v) for v in estimated.rows.b],
            "W_J": [_number(v) for v in estimated.rows.W],
            "standard_error_J": [_number(v) for v in estimated.row_errors],
        },
        "notes": list(estimated.notes),
    }


def _reference(fit: ReferenceFit) -> dict[str, Any]:
    errors = dict(zip(UNITS, fit.standard_errors, strict=True))
    made: dict[str, Any] = {}
    for symbol, unit in UNITS.items():
        value = float(getattr(fit, symbol))
        ends = (
            fit.K_z_interval
            if symbol == "K_z"
            else (value - 1.96 * errors[symbol], value + 1.96 * errors[symbol])
        )
        made |= {
            f"{symbol}_{unit}": _number(value),
            f"{symbol}_standard_error_{unit}": _number(errors[symbol]),
            f"{symbol}_interval_{unit}": [_number(end) for end in ends],
        }
    return made | {"m_kg": fit.m, "warnings": list(fit.warnings)}


def _record(reading: Reading, found: Identification, index: int) -> dict[str, Any]:
    steady, features = reading.steady, found.features[index]
    return {
        "record": steady.source,
        "frequency_Hz": steady.frequency_hz,
        "frequency_standard_error_Hz": _number(steady.omega_standard_error / (2.0 * math.pi)),
        "cycles": steady.cycles,
        "highest_harmonic": steady.bandwidth,
        "noise_rms": dict(steady.noise_rms),
        "slip_onset_resolved_alone": bool(reading.onset_resolved),
        "features": {
            column: _number(float(getattr(features, name)[0])) for name, column in COLUMNS.items()
        },
        "standard_errors": {
            column: _number(reading.standard_errors[name]) for name, column in COLUMNS.items()
        },
        "warnings": list(reading.warnings),
    }


def _number(value: float) -> float | None:
    """A number of JSON: null for what is not known or has no bound."""
    return float(value) if math.isfinite(value) else None


def _error_column(name: str, column: str) -> str:
    return column.replace(name, f"{name}_standard_error", 1)


def _with_interval(parameter: Parameter) -> str:
    return _interval_text(parameter.value, *parameter.interval)


def _interval_text(value: float | None, low: float | None, high: float | None) -> str:
    """1.2807 [1.2784, 1.2831]: digits down to a tenth of the interval's half width."""
    ends = [math.nan if v is None else v for v in (value, low, high)]
    value, low, high = ends
    if math.isfinite(low) and not math.isfinite(high):
        return f"> {_rounded(low, low)}"
    if not all(map(math.isfinite, ends)):
        return "–"
    half = 0.5 * (high - low)
    return f"{_rounded(value, half)} [{_rounded(low, half)}, {_rounded(high, half)}]"


def _rounded(value: float, spread: float) -> str:
    """The value with two digits of the spread."""
    if not spread > 0.0:
        return f"{value:.6g}"
    decimals = 1 - math.floor(math.log10(spread))
    return f"{round(value, decimals):.{max(0, decimals)}f}"
