"""Answers of `identify` to records as laboratories have them (`field.py`), and an afternoon's analysis beside it.

The simple analysis of a decay filters the record between half and twice the natural frequency (Butterworth, forwards
and back), divides by ωⁿ for the displacement, and fits D_{i+1} = e^{−βπ} D_i − g to the distances D_i of successive
turns: g = 2(1 + e^{−βπ}) F_k/k. That of a forced test takes the fundamental of the second half of each record at the
frequency of the generator, W = πkYX sin φ, and solves 4(X − Z)F_k + πωX² c = W by least squares with weights 1/W,
Z ≥ 0 left free where there are more than three levels, and 0 otherwise. It has no intervals: it is right where F_k and
c are both within 10 %.

An answer of `identify` helps where F_k and c are both usable and right: within 10 % of the truth, or the truth in the
interval of 95 %. It is silent where both are usable and one of them is not right.
"""

from __future__ import annotations

import math
import time

import numpy as np
import pandas as pd
from scipy.optimize import nnls
from scipy.signal import butter, sosfiltfilt

from dampbalance import identify
from dampbalance.identification.answer import USABLE
from dampbalance.identification.screen import limiting
from dampbalance.project.wording import markdown_table
from dampbalance.records.channel import Channel
from dampbalance.records.record import Record

from .field import draw, records, stiffness_given
from .truths import ANSWERS

WITHIN = 0.1
"""Relative error of a number that is right."""

SYMBOLS = ("F_k", "c")
_BAND, _ORDER = (
    (0.5, 2.0),
    1,
)  # of the natural frequency; of higher order it reaches further over the beginning
_TAIL = 5  # the last fifth of a decay is at rest
_PADDED = 8  # times as long, for a finer grid of frequencies
_CONTINUED = 3.0  # periods by which a record is continued to be filtered
_SMALL = 0.2  # of the largest distance between turns: friction may hold the mass below
_FEWEST = 3  # distances, for a line through two pairs

Numbers = tuple[float, float]
"""F_k, N, and c, N s/m; NaN where there is no answer."""


def simple_decay(measured: Record, k: float, m: float | None) -> Numbers:
    """Return the line through the distances of successive turns of the filtered record."""
    channel = measured.responses[0]
    rate = (len(channel) - 1) / float(channel.t[-1] - channel.t[0])
    values = channel.values - channel.values[-len(channel) // _TAIL :].mean()
    size = _PADDED * len(channel)
    lowest = 2 * _PADDED  # two periods in the record
    f_n = (lowest + int(np.argmax(np.abs(np.fft.rfft(values, size))[lowest:]))) * rate / size
    if _BAND[1] * f_n >= 0.5 * rate:
        return math.nan, math.nan
    # an odd continuation is smooth from a zero on
    zeros = np.flatnonzero(values[:-1] * values[1:] <= 0.0)
    values = values[zeros[0] + 1 :] if zeros.size else values
    band = butter(_ORDER, [part * f_n for part in _BAND], "band", fs=rate, output="sos")
    pad = min(values.size - 1, round(_CONTINUED * rate / f_n))
    filtered = sosfiltfilt(band, values, padlen=pad)
    slopes = np.diff(filtered)
    turns = np.flatnonzero(slopes[:-1] * slopes[1:] <= 0.0) + 1
    before, at, after = filtered[turns - 1], filtered[turns], filtered[turns + 1]
    shift = 0.5 * (before - after) / (before - 2.0 * at + after)  # parabola through three samples
    tops, places = at - 0.25 * (before - after) * shift, turns + shift
    distances = np.abs(np.diff(tops))
    if distances.size < _FEWEST:
        return math.nan, math.nan
    largest = int(np.argmax(distances))
    small = np.flatnonzero(distances[largest:] < _SMALL * distances[largest])
    last = largest + int(small[0]) if small.size else distances.size
    first = largest + 1  # the filter reaches over the beginning
    if last - first < _FEWEST:
        return math.nan, math.nan
    omega = math.pi * rate / float(np.mean(np.diff(places[first : last + 1])))
    D = distances[first:last] / omega ** ANSWERS.index(channel.quantity)
    q, minus_g = np.polyfit(D[:-1], D[1:], 1)
    if q <= 0.0:
        return math.nan, math.nan
    beta = -math.log(q) / math.pi
    mass = k / (omega**2 * (1.0 + beta**2)) if m is None else m
    c = 2.0 * beta / math.hypot(1.0, beta) * math.sqrt(k * mass)
    return float(-k * minus_g / (2.0 * (1.0 + q))), c


def _fundamental(channel: Channel, omega: float) -> complex:
    """Return complex amplitude of the displacement that the second half of a channel, which is steadier, shows."""
    t, values = channel.t[len(channel) // 2 :], channel.values[len(channel) // 2 :]
    columns = [np.cos(omega * t), np.sin(omega * t), np.ones(t.size), t - t.mean()]
    a, b, *_ = np.linalg.lstsq(np.column_stack(columns), values, rcond=None)[0]
    quantity = channel.quantity.removeprefix("base_")
    return complex(a, -b) / (1j * omega) ** ANSWERS.index(quantity)


def simple_forced(measured: list[Record], k: float, omega: float) -> Numbers:
    """Return the balance of energy of the fundamentals, weighted by 1/W."""
    rows, works = [], []
    for record in measured:
        x, y = _fundamental(record.responses[0], omega), _fundamental(record.excitation, omega)
        X, W = abs(x), math.pi * k * (y * x.conjugate()).imag
        rows.append([4.0 * X, math.pi * omega * X**2, -4.0][: 3 if len(measured) > 3 else 2])
        works.append(W)
    W = np.array(works)
    if not (W > 0.0).all():
        return math.nan, math.nan
    A = np.array(rows) / W[:, None]
    scale = np.abs(A).max(axis=0)
    (F_k, c, *_), _ = nnls(A / scale, np.ones(W.size))
    return float(F_k / scale[0]), float(c / scale[1])


def warm() -> None:
    """Load and compile what the first identifications of a process would."""
    for forced in (False, True):
        outcome((forced, 0, 0))


def outcome(run: tuple[bool, int, int]) -> list[dict[str, object]]:
    """Return a row for a set: what `identify` and the simple analysis say.   run : forced, number, seed."""
    forced, index, seed = run
    one = draw(index, forced, seed)
    measured, k = records(one), stiffness_given(one)
    m = one.m if one.mass_given else None
    row: dict[str, object] = {"records": "forced" if forced else "decays", "set": index}
    row |= {"kind": one.kind, "answer": one.answer, "noise": one.noise, "zeta": one.zeta}
    row |= {"K": one.K_z / one.k, "r": one.omega / one.omega_n, "mass_given": one.mass_given}
    row["samples"] = sum(len(record.responses[0]) for record in measured)
    simple = simple_forced(measured, k, one.omega) if forced else simple_decay(measured[0], k, m)
    for symbol, value in zip(SYMBOLS, simple, strict=True):
        true = getattr(one, symbol)
        row |= {f"{symbol}_true": true, f"{symbol}_simple": value / true - 1.0}
    began = time.process_time()
    try:
        result = identify(measured, k, mass=m)
    except (ValueError, ArithmeticError) as error:  # a refusal is an outcome, too
        return [row | {"seconds": time.process_time() - began, "refused": str(error)}]
    row |= {"seconds": time.process_time() - began, "refused": ""}
    verdicts = result.verdicts
    for symbol in SYMBOLS:
        true, (low, high) = getattr(one, symbol), result.intervals[symbol]
        verdict, reason, *_ = verdicts[symbol]
        row |= {f"{symbol}_off": result.values[symbol] / true - 1.0, f"{symbol}_low": low}
        row |= {f"{symbol}_high": high, f"{symbol}_verdict": verdict, f"{symbol}_reason": reason}
    return [row | {"words": " | ".join(limiting(result)), "mass": result.mass}]


def table(rows: pd.DataFrame) -> str:
    """Return a table by kind, in sets: whom the answer helps, and how the simple analysis does; errors and times; in
    markdown."""
    parts = [_of_kinds(some) for _, some in rows.groupby("records", sort=False)]
    return "\n\n".join(parts) + "\n"


def _of_kinds(rows: pd.DataFrame) -> str:
    right, simple = {}, {}
    given = pd.Series(True, index=rows.index)
    for symbol in SYMBOLS:
        of = rows.reindex(
            columns=[f"{symbol}_{name}" for name in ("off", "low", "high", "verdict", "true")]
        )
        off, low, high, verdict, true = (of[name] for name in of)
        right[symbol] = (off.abs() <= WITHIN) | ((low <= true) & (true <= high))
        simple[symbol] = rows[f"{symbol}_simple"].abs() <= WITHIN
        given &= verdict == USABLE
    plain = simple["F_k"] & simple["c"]
    helps = given & right["F_k"] & right["c"]
    columns = {
        "sets": pd.Series(True, index=rows.index),
        "helps": helps,
        "no help, simple right": ~given & plain,
        "silent": given & ~helps,
        "refused": rows["refused"].fillna("") != "",
        "simple right": plain,
        "lost": plain & ~helps,
    }
    counts = pd.DataFrame(columns).groupby(rows["kind"], sort=False).sum()
    counts.loc["all"] = counts.sum()
    title = str(rows["records"].iloc[0])
    lines = [[str(kind), *map(str, counts.loc[kind])] for kind in counts.index]
    errors = []
    for symbol in SYMBOLS:
        for who, name in (("identify", "off"), ("simple", "simple")):
            if (column := f"{symbol}_{name}") in rows:
                median = 100.0 * rows[column].abs().median()
                errors.append(f"{symbol} {who} {median:.2g} %")
    seconds = rows["seconds"]
    return (
        f"{markdown_table([title, *counts.columns], lines)}\n\nMedian errors: {', '.join(errors)}. Processor time of "
        f"`identify`: {seconds.median():.2g} s (median), {seconds.max():.2g} s at the most."
    )
