"""Free decays in words and numbers: a table for the screen, a document for programs, tables for spreadsheets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..reading.ringdown_motion import COMMON
from ..reading.ringdown_rows import at_rest
from .answers import answers_of_decays
from .reporting import entries_of, finite, judgements, key_of, with_errors
from .result import CONFIDENCE
from .ringdown import BALANCE, RingDown
from .showing import Shown, implied, marked, table_of
from .verdicts import judged_by_notes


def document(
    result: RingDown,
    version: str = "",
    options: Mapping[str, Any] | None = None,
    files: Sequence[Mapping[str, Any]] = (),
) -> dict[str, Any]:
    """Everything that was identified, for JSON; SI units, named in the keys; what is not known is null.

    options : as given.   files : what is known of the file of each record, in their order.
    """
    fit = result.fit
    of_files = files or [{}] * len(result.sources)
    return {
        "dampbalance": version,
        "kind": "ring-down",
        "options": dict(options or {}),
        "k_N_per_m": result.k,
        "confidence": CONFIDENCE,
        "approaches": {BALANCE: _balance(result)},
        "maximum_likelihood": entries_of(result.of_fit, leave_out="_propagated_error")
        | {
            "verdicts": judgements(judged_by_notes(result.of_fit, result.fit_notes)),
            "m_kg": fit.m,
            "m_standard_error_kg": fit.error("m"),
            "natural_frequency_Hz": fit.natural_frequency_hz,
            "misfit": finite(fit.misfit),
            "notes": list(result.fit_notes),
        },
        "records": [
            {"record": source, "decays": _decays(result, source), **of_file}
            for source, of_file in zip(result.sources, of_files, strict=True)
        ],
        "warnings": list(result.warnings),
    }


def estimates_table(result: RingDown) -> list[dict[str, Any]]:
    """A row for the balance: value, standard error and interval of each parameter, in columns named with units, and the
    verdict on each."""
    row: dict[str, Any] = {"approach": BALANCE}
    for symbol, parameter in result.coefficients.items():
        ends = {f"_{end}": number for end, number in parameter.interval._asdict().items()}
        numbers = {k: v for k, v in with_errors(parameter).items() if k != "_propagated_error"}
        row |= {key_of(symbol, what): number for what, number in (numbers | ends).items()}
    row["misfit"] = result.misfit
    verdicts = judged_by_notes(result.coefficients, result.notes)
    row |= {f"{symbol}_verdict": verdict for symbol, (verdict, _) in verdicts.items()}
    return [row | {"note": "; ".join(result.notes)}]


def features_table(result: RingDown) -> list[dict[str, Any]]:
    """A row for each turn of each decay: when, where, and the standard error, in columns named with units."""
    return [
        {
            "record": one.source,
            "decay": i + 1,
            "time_s": float(t),
            "x_m": float(x),
            "x_standard_error_m": float(error),
        }
        for i, (one, (turns, errors)) in enumerate(
            zip(result.fit.stretches, result.rows.turns, strict=True)
        )
        for (t, x), error in zip(turns, errors, strict=True)
    ]


def shown(result: RingDown) -> Shown:
    """The estimates with their 95 % intervals and what they are worth, then what limits them."""
    records, decays, halves = len(result.sources), len(result.fit.stretches), result.rows.halves
    head = (
        f"{_counted(records, 'record')} with {_counted(decays, 'free decay')}, {_counted(halves, 'half cycle')} that "
        f"slip{'s' * (halves == 1)}; values with 95 % intervals"
    )
    notes = dict.fromkeys((*result.notes, *result.fit_notes))
    said = [marked("approaches", f"{words}.") for words in notes]
    said += [marked("records", words) for words in result.warnings]
    table = table_of(answers_of_decays(result))
    return Shown(head, table, tuple(implied(result.fit, result.mass_given)), (), tuple(said))


def _balance(result: RingDown) -> dict[str, Any]:
    answer = answers_of_decays(result)[BALANCE]
    rows = {key: [finite(v) for v in values] for key, values in answer.rows.items()}
    decays = [int(i) + 1 if i >= 0 else None for i in result.rows.stretch]
    return entries_of(result.coefficients, leave_out="_propagated_error") | {
        "correlation_of_F_k_and_c": finite(result.correlation),
        "verdicts": judgements(judged_by_notes(result.coefficients, result.notes)),
        "misfit": finite(result.misfit),
        "degrees_of_freedom": result.freedom,
        "rows": rows | {"decay": decays},
        "notes": list(result.notes),
    }


def _decays(result: RingDown, source: str) -> list[dict[str, Any]]:
    """The decays of a record."""
    found = []
    for i, one in enumerate(result.fit.stretches):
        if one.source != source:
            continue
        turns, errors = result.rows.turns[i]
        still = at_rest(result.fit, i)
        found.append(
            {
                "decay": i + 1,
                "start_s": one.start,
                "end_s": one.end,
                "sticks_from_s": None if still is None else one.start + still,
                "rest_m": _rest(result, i),
                "noise_rms": {signal.quantity: signal.noise for signal in one.signals},
                "turns_s": [float(t) for t in turns[:, 0]],
                "turns_m": [float(x) for x in turns[:, 1]],
                "turns_standard_error_m": [float(e) for e in errors],
            }
        )
    return found


def _rest(result: RingDown, i: int) -> float | None:
    """Where the spring of a decay is slack in its displacement channel; None where there is none."""
    one = result.fit.stretches[i]
    offsets = zip(one.signals, one.offsets, strict=True)
    at = next((number for signal, number in offsets if signal.order == 0), None)
    return None if at is None else float(result.fit.point[len(COMMON) + at])


def _counted(n: int, what: str) -> str:
    return f"{n} {what}{'s' * (n != 1)}"
