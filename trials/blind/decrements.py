"""The decrements of successive peaks, by which laboratories evaluate free decays, for comparison with `identify`.

Peaks are read off each decay from a smoothed record; of a velocity or an acceleration they are divided by ω or ω², as
for a harmonic motion. The decrements use what the record does not show: when the mass came free, and the offset of
the channel, that is, where the spring is at rest. Peaks that come quicker than the motion, as of a mass that sticks and
rings, end the decay.

    logarithmic decrement    ln X_i falls by βπ: all damping is viscous
    envelope                 X(t) = X_0 e^{−δt} − (2/π) ω (F_k/k) t, exponential and linear decay added
    two decrements           X_{i+1} = e^{−βπ} X_i − (1 + e^{−βπ}) F_k/k (Liang and Feeny), a line through the pairs
"""

from __future__ import annotations

import itertools
import math
import time

import numpy as np
import pandas as pd
from scipy.optimize import curve_fit
from scipy.signal import find_peaks, savgol_filter

from dampbalance.fit.decay import DecayFit
from dampbalance.identification.answer import USABLE
from dampbalance.identification.decays import identify_decay_records
from dampbalance.project.wording import markdown_table
from dampbalance.records.record import Record

from .decays import Decay, clean, draw, record
from .score import held, share
from .truths import ANSWERS

Found = dict[str, float]
"""Value by symbol, SI; NaN for what a way cannot tell."""

Peaks = list[tuple[np.ndarray, np.ndarray]]
"""Of each decay: times, s, and sizes, m."""

_CLEAR = 5.0  # standard deviations of the noise
_QUICK = 0.7  # of the first time between peaks
_STUCK = 2.0  # times the last peak that may be one of a mass that sticks


def peaks_of(decay: Decay, measured: Record, free: list[float]) -> tuple[Peaks, float]:
    """Return the peaks of each decay in the first channel, and the mean frequency between them, rad/s."""
    channel = measured.responses[0]
    order = ANSWERS.index(channel.quantity)
    width = max(5, round(0.1 * decay.rate_hz * 2.0 * math.pi / decay.omega_n) | 1)
    found: Peaks = []
    halves: list[float] = []
    largest = float(np.abs(clean(decay)[0][order]).max())
    for i, start in enumerate(free):
        first = round(start * decay.rate_hz)
        last = first + round(decay.lasts[i] * decay.rate_hz) - 1
        part = channel.values[first:last]
        level = decay.offset * largest
        smooth = savgol_filter(part - level, width, 2)
        sigma = decay.noise * largest
        clear = {"height": _CLEAR * sigma, "distance": 2 * width}
        tops = [find_peaks(s * smooth, **clear)[0] for s in (1.0, -1.0)]
        places = np.sort(np.concatenate(tops))
        # peaks of alternating sign only
        turns = smooth[places[:-1]] * smooth[places[1:]] < 0.0
        places = places[np.append(turns, True)] if places.size else places
        quick = np.flatnonzero(np.diff(places) < _QUICK * np.diff(places)[:1])
        places = places[: quick[0] + 1] if quick.size else places
        if decay.starts[i][0] == "pluck" and order == 0:
            places = np.insert(places, 0, 0)
        if places.size < 2:
            continue
        halves += np.diff(places[places > 0]).tolist()
        found.append((places / decay.rate_hz, np.abs(smooth[places])))
    omega = math.pi * decay.rate_hz / float(np.median(halves)) if halves else math.nan
    return [(t, size / omega**order) for t, size in found], omega


def _damping(ratio: float, omega: float, k: float) -> float:
    """Return c of a decay by `ratio` from peak to peak, ω_d = omega."""
    beta = -math.log(min(max(ratio, 1e-9), 1.0)) / math.pi
    zeta = beta / math.hypot(1.0, beta)
    return 2.0 * zeta * k / (omega / math.sqrt(1.0 - zeta * zeta))


def logarithmic(peaks: Peaks, omega: float, k: float) -> Found:
    """Return the logarithmic decrement."""
    slopes = [np.polyfit(np.arange(x.size), np.log(x), 1)[0] for _, x in peaks if x.size > 1]
    c = _damping(math.exp(float(np.mean(slopes))), omega, k) if slopes else math.nan
    return {"F_k": math.nan, "c": c}


def envelope(peaks: Peaks, omega: float, k: float) -> Found:
    """Return exponential and linear decay added, fitted to the peaks of each decay; the mean of them."""
    found = []
    for t, x in peaks:
        if x.size < 4:
            continue

        def model(t: np.ndarray, top: float, delta: float, dry: float) -> np.ndarray:
            return top * np.exp(-delta * t) - 2.0 / math.pi * omega * dry * t

        start = (x[0], 0.01 * omega, 0.1 * (x[0] - x[1]))
        options = {"bounds": (0.0, np.inf), "max_nfev": 2000}
        try:
            (_, delta, dry), _ = curve_fit(model, t - t[0], x, p0=start, **options)
        except (RuntimeError, ValueError):
            continue
        found.append((k * dry, _damping(math.exp(-math.pi * delta / omega), omega, k)))
    F_k, c = np.mean(found, axis=0) if found else (math.nan, math.nan)
    return {"F_k": float(F_k), "c": float(c)}


def two_decrements(peaks: Peaks, omega: float, k: float) -> Found:
    """Return the line through the pairs of successive peaks that the contact slips between."""
    pairs = [pair for _, x in peaks for pair in itertools.pairwise(x) if pair[1] > _STUCK * x[-1]]
    if len(pairs) < 2:
        return {"F_k": math.nan, "c": math.nan}
    before, after = np.array(pairs).T
    ratio, offset = np.polyfit(before, after, 1)
    return {"F_k": -k * offset / (1.0 + ratio), "c": _damping(float(ratio), omega, k)}


WAYS = {
    "logarithmic decrement": logarithmic,
    "envelope": envelope,
    "two decrements": two_decrements,
}


def above_the_optimum(fit: DecayFit, decay: Decay) -> float:
    """Return χ² of a fit above the lowest that climbs from the truth reach, on the same samples with the same noise."""
    problem, ends = fit.problem, []
    for load in (None, 0.0, 1.0, 2.0):
        truth = {"c": decay.c, "rho": decay.K_z**-0.5, "m": decay.m}
        truth |= {one.key("F_k"): decay.F_k for one in fit.decays}
        loads = [one.key("w") for one in fit.decays]
        truth |= {} if load is None else dict.fromkeys(loads, load)
        start = fit.parameters.moved(**truth)
        states = problem.climb(start.held(*truth, *loads))
        for point in (start.values, *([] if states is None else [states.point])):
            end = problem.climb(start.at(point), most=60)
            ends += [] if end is None else [end.chi_square]
    return fit.chi_square - min(ends, default=math.nan)


def tried(run: tuple[int, int]) -> list[dict[str, object]]:
    """Return rows of all ways on one set, by its number and the seed: value, standard error, interval and verdict of
    F_k, c and K_z."""
    index, seed = run
    decay = draw(index, seed)
    measured, free = record(decay, seed)
    of_set: dict[str, object] = {
        "set": index,
        "answer": "+".join(decay.answers),
        "noise": decay.noise,
        "zeta": decay.zeta,
        "stiffness": decay.K_z / decay.k,
        "height": decay.height,
        "samples": sum(len(channel) for channel in measured.responses),
        "decays": len(free),
    }
    rows: list[dict[str, object]] = []
    began = time.process_time()
    try:
        result = identify_decay_records([measured], decay.k)
    except ValueError as error:
        rows.append(of_set | {"way": "balance", "refused": str(error)})
    else:
        lasted = time.process_time() - began
        of_set |= {
            "seconds": lasted,
            "used": len(result.basis.fit.decays),
            "above": above_the_optimum(result.basis.fit, decay),
        }
        for way, answer in result.approaches.items():
            for symbol, p in answer.parameters.items():
                row = {"way": way, "symbol": symbol, "true": getattr(decay, symbol)}
                row |= {"value": p.value, "standard_error": p.standard_error}
                row |= {"low": p.interval.low, "high": p.interval.high}
                noted = symbol in answer.verdicts and answer.verdicts[symbol].verdict != USABLE
                rows.append(of_set | row | {"noted": noted})
    peaks, omega = peaks_of(decay, measured, free)
    for way, method in WAYS.items():
        for symbol, value in method(peaks, omega, decay.k).items():
            row = {"way": way, "symbol": symbol, "true": getattr(decay, symbol), "value": value}
            rows.append(of_set | row)
    return rows


def table(rows: pd.DataFrame) -> str:
    """Return errors by way, coverage and efficiency by channel, in markdown."""
    known = rows.dropna(subset=["symbol", "value"]).copy()
    known["error"] = 100.0 * (known["value"] / known["true"] - 1.0).abs()
    sets, lines = rows["set"].nunique(), []
    for (way, symbol), some in known.groupby(["way", "symbol"], sort=False):
        median, worst = some["error"].quantile([0.5, 0.9])
        cells = [f"{100 * len(some) / sets:.0f} %", f"{median:.2g} %", f"{worst:.2g} %"]
        if "low" in some and some["low"].notna().any():
            plain = some[~some["noted"].astype(bool)]
            cells += [share(held(some)), share(held(plain))]
            far = (plain["value"] - plain["true"]).abs() > 5.0 * plain["standard_error"]
            cells.append(str((far & ~held(plain)).sum()))
        lines.append([str(way), str(symbol), *cells, *[""] * (6 - len(cells))])
    heads = ["way", "", "sets with a value", "median error", "worst tenth", "intervals hold, %"]
    heads += ["those of usable values, %", "usable, and more than 5 standard errors off"]
    one, other = (
        known[known["way"] == way].set_index(["set", "symbol"])["standard_error"]
        for way in ("balance", "maximum likelihood")
    )
    part = ((other / one) ** 2).drop("K_z", level="symbol").dropna()
    seconds = known[known["way"] == "balance"].groupby("set").first()
    fewer, more = seconds["used"] < seconds["decays"], seconds["used"] > seconds["decays"]
    per_sample = 2e4 * seconds["seconds"] / seconds["samples"].clip(lower=5000)
    refused = rows["refused"].notna().sum() if "refused" in rows else 0
    return (
        f"{markdown_table(heads, lines)}\n\n{sets} sets, {refused} of them refused. The balance uses "
        f"{100 * part.median():.0f} % of the bound of the fit (median; {100 * part.quantile(0.1):.0f} % in the worst "
        f"tenth). Processor time for 20,000 samples: {per_sample.median():.1f} s (median), {per_sample.max():.1f} s at "
        f"the most.\n\nIn {(seconds['above'] > 0.5).sum()} of {len(seconds)} sets χ² lies more than 0.5 above the "
        f"lowest that climbs from the truth reach. In {fewer.sum()} sets the answer has fewer decays than the record, "
        f"in {more.sum()} more.\n"
    )
