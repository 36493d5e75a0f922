"""Answers of `identify` to the sets: one row for each set, approach and parameter, and the table of aims."""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import binomtest

from dampbalance.identification.answer import REFERENCE, ParameterEstimate
from dampbalance.identification.balance_rows import estimate_of
from dampbalance.identification.forced import ForcedBasis, identify_readings
from dampbalance.identification.result import Result
from dampbalance.project.wording import markdown_table
from dampbalance.signals.mean_harmonics import read_features

from .records import levels, records
from .truths import Truth, draw

FIRST = "first answer"
# answers that are held against the aims: the first, the balance of energy, and the fit to all records
HELD = (FIRST, "direct", REFERENCE)
# findings on records that the waveform of no oscillator meets, and for those in which nothing is seen to slip
MISSED = "far from all"
NO_ONSET = "stuck|loose|linear|no oscillator"
VISIBLE = 5.0  # standard errors above which a third harmonic is there to be seen
SYMBOLS = ("F_k", "c", "K_z")
MISSED_WAVEFORM = "waveform missed (χ²)"
STARRED = "starred, though sound"
NOTHING_SEEN = f"no onset seen, third harmonic above {VISIBLE:g} standard errors"
F_K_OF_NOTHING = "nothing slips, F_k given"
SILENT = "beyond 5 standard errors, not a word"

GROUPS = ("noise", "answers", "drive")


def outcome(index: int) -> list[dict[str, object]]:
    """Return rows of one set: what was drawn, what came out, what was said."""
    truth = draw(index)
    drawn = levels(truth)
    of_set: dict[str, object] = {
        "set": truth.index,
        "kind": truth.kind,
        "noise": truth.noise,
        "equal": truth.equal,
        "drive": truth.drive,
        "answers": "+".join(truth.answers),
        "levels": len(truth.Y),
        "slips": "/".join(str(level.cycle.slips) for level in drawn),
        "sticking": max(level.cycle.sticking for level in drawn),
        "third": max(level.third(answer) for level in drawn for answer in truth.answers),
        "zeta": truth.zeta,
        "r": truth.omega / truth.omega_n,
        "K": truth.K_z / truth.k,
        "F": truth.F_k / (truth.k * truth.Y[-1]),
    }
    measurements = records(truth)
    began = time.process_time()
    try:
        readings = [read_features(measurement, truth.k) for measurement in measurements]
        result = identify_readings(readings, truth.k)
    except (ValueError, ArithmeticError) as error:  # a refusal is an outcome, too
        return [of_set | {"approach": "refused", "symbol": "", "warnings": str(error)}]
    of_set["seconds"] = time.process_time() - began
    return [of_set | row for row in numbers(result, truth)]


def numbers(result: Result[ForcedBasis], truth: Truth) -> Iterator[dict[str, object]]:
    """Yield approach, symbol, truth, value, its error and interval, and the words: the one place that knows a
    result."""
    first = next(iter(result.approaches.values()))
    found = [(FIRST, first.parameters, first.notes)]
    found += [
        (name, e.parameters if e.balance is None else e.coefficients, e.notes)
        for name, e in result.estimates.items()
    ]
    found.append((REFERENCE, _of_fit(result), result.basis.common.notes))
    for name, parameters, notes in found:
        for symbol, parameter in parameters.items():
            yield {
                "approach": name,
                "symbol": symbol,
                "true": truth.parameter(symbol),
                "value": parameter.value,
                "standard_error": parameter.standard_error,
                "low": parameter.interval.low,
                "high": parameter.interval.high,
                "notes": " | ".join(one.code for one in notes),
                "warnings": " | ".join(one.code for one in result.findings),
            }


def _of_fit(result: Result[ForcedBasis]) -> dict[str, ParameterEstimate]:
    """Return what the fit to all records identifies, the mass m, kg, among it."""
    fit = result.basis.common.fit
    if fit is None or result.reference is None:
        return {}
    m = estimate_of(fit.m, np.array([fit.error("m") ** 2]), [math.inf])
    return {**result.reference.parameters, "m": m}


def in_errors(symbol: Any, value: Any, true: Any, error: Any) -> Any:
    """Return the error of a value in standard errors; of K_z that of K_z^{−1/2}, in which it is nearly normal."""
    with np.errstate(divide="ignore", invalid="ignore"):
        plain, root = value - true, 2.0 * value * (np.sqrt(np.maximum(value / true, 0.0)) - 1.0)
        return np.where((symbol == "K_z") & (value > 0.0), root, plain) / error


def judged(rows: pd.DataFrame) -> pd.DataFrame:
    """Return rows of `outcome` with their errors, these in standard errors (sizes), and whether anything was said."""
    rows = rows.fillna({"notes": "", "warnings": ""})
    rows["error"] = rows["value"] - rows["true"]
    columns = (rows[name] for name in ("symbol", "value", "true", "standard_error"))
    rows["sizes"] = np.abs(in_errors(*columns))
    rows["starred"] = rows["notes"] != ""
    rows["remarked"] = rows["starred"] | (rows["warnings"] != "")
    return rows


def table(rows: pd.DataFrame) -> str:
    """Return the table of aims, in markdown.   rows : of `outcome`."""
    rows = judged(rows)
    kinds = rows.groupby("set")["kind"].first().value_counts()
    parts = [f"{kinds.sum()} sets: {', '.join(f'{n} {kind}' for kind, n in kinds.items())}"]
    slipping = rows[rows["kind"] != "nothing slips"]
    parts += [_coverage(slipping[slipping["approach"] == name], name) for name in HELD]
    parts += [_errors(slipping), _counted(faults(rows))]
    return "\n\n".join(parts) + "\n"


def _coverage(own: pd.DataFrame, name: str) -> str:
    """Return coverage of the intervals by group, all sets and those where nothing was remarked."""
    known = own[np.isfinite(own["value"]) & np.isfinite(own["standard_error"])]
    heads = [f"{name}: coverage, %", "", *SYMBOLS, "F_k, nothing remarked", *SYMBOLS[1:]]
    groups = [("all", "", known)]
    for column in (*GROUPS, "equal", "kind"):
        groups += [(column, str(key), group) for key, group in known.groupby(column)]
    lines = []
    for column, key, group in groups:
        parts = itertools.product((group, group[~group["remarked"]]), SYMBOLS)
        cells = (share(held(part[part["symbol"] == symbol])) for part, symbol in parts)
        lines.append([column, key, *cells])
    return markdown_table(heads, lines)


def share(held: pd.Series) -> str:
    """Return the percentage of what is true, with its 95 % interval, and of how many."""
    if held.empty:
        return "–"
    count, of = int(held.sum()), len(held)
    test = binomtest(count, of).proportion_ci()
    return f"{100 * count / of:.0f} ({100 * test.low:.0f}–{100 * test.high:.0f}) of {of}"


def held(rows: pd.DataFrame) -> pd.Series:
    """Return whether the interval of each row holds the truth."""
    return (rows["low"] <= rows["true"]) & (rows["true"] <= rows["high"])


def _errors(rows: pd.DataFrame) -> str:
    """Return median and 90 % quantile of the relative error by approach, and the largest in standard errors."""
    known = rows[np.isfinite(rows["value"])].copy()
    known["relative"] = 100.0 * known["error"].abs() / known["true"]
    heads = ["abs. error, %", "", "0.1 % noise: median, 90 %", "1 %", "5 %"]
    heads += ["starred", "beyond 3 standard errors, no star"]
    lines = []
    for (approach, symbol), group in known.groupby(["approach", "symbol"], sort=False):
        cells = []
        for noise in sorted(rows["noise"].unique()):
            relative = group.loc[group["noise"] == noise, "relative"]
            median, most = relative.quantile([0.5, 0.9]) if len(relative) else (math.nan,) * 2
            cells.append(f"{median:.2g}, {most:.2g}")
        silent = group[~group["starred"] & (group["sizes"] > 3.0)]
        starred = int(group["starred"].sum())
        cells += [f"{starred} of {len(group)}", f"{len(silent)} of {len(group) - starred}"]
        lines.append([approach, symbol, *cells])
    return markdown_table(heads, lines)


def faults(rows: pd.DataFrame) -> dict[str, tuple[list[int], int]]:
    """Return what should not be there at all: the sets in which it is, and how many it could be in.   rows :
    `judged`."""
    sets = rows.groupby("set").first()
    slips = rows["kind"] != "nothing slips"
    sound = rows[rows["approach"].isin(HELD) & slips]
    F_k, K_z = (sound[sound["symbol"] == symbol] for symbol in ("F_k", "K_z"))
    limit = K_z[np.isinf(K_z["value"])]
    visible = sets["third"] > VISIBLE
    unseen = sets["warnings"].str.contains(NO_ONSET)
    silent = rows[~rows["remarked"] & (rows["sizes"] > 5.0) & slips]
    of_nothing = ~slips & (rows["symbol"] == "F_k") & np.isfinite(rows["value"])
    nothing = rows[of_nothing & ~rows["starred"]]
    without = F_k[(F_k["approach"] == FIRST) & ~np.isfinite(F_k["value"])]
    slipping = int((sets["kind"] != "nothing slips").sum())
    found = {
        "refused": (sets.index[sets["approach"] == "refused"], len(sets)),
        "something slips, no F_k": (without["set"], slipping),
        MISSED_WAVEFORM: (sets.index[sets["warnings"].str.contains(MISSED)], len(sets)),
        STARRED: (sound.loc[sound["starred"], "set"], slipping),
        NOTHING_SEEN: (sets.index[visible & unseen], int(visible.sum())),
        "lower limit of K_z above the truth": (
            limit.loc[limit["low"] > limit["true"], "set"],
            limit["set"].nunique(),
        ),
        F_K_OF_NOTHING: (nothing["set"], len(sets) - slipping),
        SILENT: (silent["set"], slipping),
    }
    return {words: (sorted({int(n) for n in which}), of) for words, (which, of) in found.items()}


def _counted(found: dict[str, tuple[list[int], int]]) -> str:
    lines = []
    for words, (which, of) in found.items():
        listed = ", ".join(map(str, which[:25])) + " …" * (len(which) > 25)
        lines.append([words, str(len(which)), str(of), listed])
    return markdown_table(["", "sets", "of", "which"], lines)
