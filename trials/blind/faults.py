"""Faults of records, one at a time: what each does to F_k, c and K_z, and what is said of it. Oscillators that depart
from the model are in `departures.py`.

The records are those of the paper's oscillator near resonance and far above it, at five levels: displacements of base
and mass, 1 % noise, 100 cycles of 100 samples.
"""

from __future__ import annotations

import itertools
import math
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from scipy import signal
from scipy.interpolate import CubicSpline

from dampbalance.identification.answer import REFERENCE
from dampbalance.identification.forced import identify_readings
from dampbalance.project.wording import cut, markdown_table
from dampbalance.records.channel import Channel
from dampbalance.records.record import Record
from dampbalance.signals.mean_harmonics import read_features

from . import efficiency
from .other_motion import from_rest
from .records import Level, levels
from .score import FIRST, SYMBOLS, in_errors, numbers
from .truths import SEED, Truth

TRUTHS = [
    truth
    for truth in efficiency.TRUTHS
    if truth.noise == 0.01 and not truth.equal and truth.omega > truth.omega_n
]
DRAWINGS = 3  # of the noise: errors are their medians
Values = np.ndarray
_DRIVE, _ANSWER = TRUTHS[0].drive, TRUTHS[0].answers[0]
_POINTS = 8192  # of a cycle that is filtered


def _exact(level: Level, quantity: str, t: Values) -> Values:
    return level.signal(quantity, level.truth.omega * t)


def _as_it_is(quantity: str, t: Values, values: Values) -> tuple[Values, Values]:
    return t, values


@dataclass(frozen=True)
class Fault:
    """One fault.

    levels : of the truth.   signal : a channel of a level at times t, without noise.   after : times and values of a
    channel from those with noise.   k : as given, over the true one.   stated : drive frequency as given, over the true
    one; None, not given.
    """

    name: str
    levels: Callable[[Truth], list[Level]] = levels
    signal: Callable[[Level, str, Values], Values] = _exact
    after: Callable[[str, Values, Values], tuple[Values, Values]] = _as_it_is
    k: float = 1.0
    stated: float | None = None

    def records(self, truth: Truth, drawing: int) -> list[Record]:
        """Return the records with this fault; the noise is the same for all faults."""
        return [self._record(level, i, drawing) for i, level in enumerate(self.levels(truth))]

    def _record(self, level: Level, place: int, drawing: int) -> Record:
        t = np.arange(level.samples) / level.truth.rate_hz
        channels = []
        for i, quantity in enumerate((_DRIVE, _ANSWER)):
            noise = np.random.default_rng((SEED, drawing, place, i)).standard_normal(t.size)
            values = self.signal(level, quantity, t) + level.sigma(quantity) * noise
            channels.append(Channel(quantity, *self.after(quantity, t, values)))
        return Record.of(f"level {place + 1}", channels)


# — channels —————————————————————————————————————————————————————————————————————————————————————————————————————————


def _delayed(quantity: str, delay: float, stretch: float = 0.0) -> Any:
    """Return the channel late by `delay` seconds, and sampled by a clock that is slow by a part `stretch`."""

    def late(level: Level, channel: str, t: Values) -> Values:
        return _exact(level, channel, t * (1.0 - stretch) - delay if channel == quantity else t)

    return late


def _filtered(quantity: str, order: int, hertz: float, kind: str) -> Any:
    """Return the channel behind an analogue Butterworth filter that has settled."""
    poles = signal.butter(order, 2.0 * math.pi * hertz, kind, analog=True)

    def behind(level: Level, channel: str, t: Values) -> Values:
        if channel != quantity:
            return _exact(level, channel, t)
        omega = level.truth.omega
        phases = np.linspace(0.0, 2.0 * math.pi, _POINTS + 1)
        harmonics = np.fft.rfft(level.signal(channel, phases[:-1]))
        _, response = signal.freqs(*poles, omega * np.arange(harmonics.size))
        cycle = np.fft.irfft(harmonics * response, _POINTS)
        whole = CubicSpline(phases, np.append(cycle, cycle[0]), bc_type="periodic")
        return whole(np.mod(omega * t, 2.0 * math.pi))

    return behind


def _with(quantity: str, change: Callable[[Level, Values, Values], Values]) -> Any:
    """Return the channel changed: change(level, t, values)."""

    def changed(level: Level, channel: str, t: Values) -> Values:
        values = _exact(level, channel, t)
        return change(level, t, values) if channel == quantity else values

    return changed


def _gain(part: float) -> Any:
    return lambda level, t, values: part * values


def _drift(level: Level, t: Values, values: Values) -> Values:
    return values + 0.2 * values.std() * t / t[-1]


def _wander(level: Level, t: Values, values: Values) -> Values:
    return values + 0.2 * values.std() * np.sin(0.05 * level.truth.omega * t)


def _hum(level: Level, t: Values, values: Values) -> Values:
    return values + 0.02 * values.std() * np.sin(2.0 * math.pi * 50.0 * t)


def _clipped(level: Level, t: Values, values: Values) -> Values:
    top = 0.97 * np.abs(values).max()
    return np.clip(values, -top, top)


def _crosstalk(level: Level, t: Values, values: Values) -> Values:
    return values + 0.01 * level.signal(_DRIVE, level.truth.omega * t)


def _relative(level: Level, t: Values, values: Values) -> Values:
    return values - level.signal(_DRIVE, level.truth.omega * t)


# — what the recorder does ———————————————————————————————————————————————————————————————————————————————————————————


def _converter(span: float | None) -> Any:
    """Return 12 bits over ±span (m), or over 1.25 times the largest value."""

    def converted(channel: str, t: Values, values: Values) -> tuple[Values, Values]:
        step = (span or 1.25 * np.abs(values).max()) / 2**11
        return t, np.round(values / step) * step

    return converted


def _dropped(kind: str) -> Any:
    """Return twenty stretches of ten samples: zero, held, or missing."""

    def dropped(channel: str, t: Values, values: Values) -> tuple[Values, Values]:
        begins = (np.arange(20) * values.size) // 20 + 137
        which = (begins[:, None] + np.arange(10)).ravel()
        if kind == "missing":
            return np.delete(t, which), np.delete(values, which)
        if channel == _ANSWER:
            values = values.copy()
            values[which] = 0.0 if kind == "zero" else np.repeat(values[begins], 10)
        return t, values

    return dropped


def _spikes(channel: str, t: Values, values: Values) -> tuple[Values, Values]:
    values = values.copy()
    if channel == _ANSWER:
        values[np.arange(50, values.size, 997)] += 3.0 * values.std()
    return t, values


def _coloured(channel: str, t: Values, values: Values) -> tuple[Values, Values]:
    """Return noise of 1 % more, whose power falls with 1/f."""
    random = np.random.default_rng((SEED, values.size, len(channel)))
    spectrum = np.fft.rfft(random.standard_normal(values.size))
    spectrum[1:] /= np.sqrt(np.arange(1, spectrum.size))
    noise = np.fft.irfft(spectrum, values.size)
    return t, values + 0.01 * values.std() * noise / noise.std()


def _slow(channel: str, t: Values, values: Values) -> tuple[Values, Values]:
    return t[::9], values[::9]


def _clock(part: float) -> Any:
    return lambda channel, t, values: (t * (1.0 + part), values)


# — the oscillator ———————————————————————————————————————————————————————————————————————————————————————————————————


def _starting(level: Level, channel: str, t: Values) -> Values:
    if channel == _DRIVE:
        return _exact(level, channel, t)
    phase = level.truth.omega * t
    return from_rest(level.truth, level.level, int(phase[-1] / (2.0 * math.pi)) + 2)(phase)[0]


def _each(**factors: Sequence[float]) -> Any:
    """Return levels whose oscillators differ: factors of a parameter, one per level."""

    def unequal(truth: Truth) -> list[Level]:
        changed = [
            replace(truth, **{name: getattr(truth, name) * f[i] for name, f in factors.items()})
            for i in range(len(truth.Y))
        ]
        return [Level(one, i) for i, one in enumerate(changed)]

    return unequal


def _low(truth: Truth) -> list[Level]:
    """Return the lowest level so low that the contact holds."""
    return levels(replace(truth, Y=(4e-4, *truth.Y[1:])))


FAULTS = (
    Fault("none"),
    *(
        Fault(f"response late by {1e6 * delay:g} µs", signal=_delayed(_ANSWER, delay))
        for delay in (5e-5, 2e-4, 1e-3)
    ),
    Fault("drive late by 200 µs", signal=_delayed(_DRIVE, 2e-4)),
    Fault("response sampled by a clock 50 ppm slow", signal=_delayed(_ANSWER, 0.0, 5e-5)),
    Fault("both sampled by a clock 50 ppm slow, frequency given", after=_clock(5e-5), stated=1.0),
    Fault("drive frequency given 50 ppm high", stated=1.0 + 5e-5),
    Fault("drive frequency given 0.4 % high", stated=1.004),
    Fault("response AC-coupled, 1 pole, 0.1 Hz", signal=_filtered(_ANSWER, 1, 0.1, "high")),
    Fault("response AC-coupled, 1 pole, 0.5 Hz", signal=_filtered(_ANSWER, 1, 0.5, "high")),
    Fault("response AC-coupled, 2 poles, 0.5 Hz", signal=_filtered(_ANSWER, 2, 0.5, "high")),
    Fault("drive AC-coupled, 1 pole, 0.5 Hz", signal=_filtered(_DRIVE, 1, 0.5, "high")),
    Fault("response low-passed, 4 poles, 200 Hz", signal=_filtered(_ANSWER, 4, 200.0, "low")),
    Fault("response low-passed, 8 poles, 200 Hz", signal=_filtered(_ANSWER, 8, 200.0, "low")),
    Fault("drive low-passed, 4 poles, 200 Hz", signal=_filtered(_DRIVE, 4, 200.0, "low")),
    Fault("gain of the response +2 %", signal=_with(_ANSWER, _gain(1.02))),
    Fault("gain of the drive +2 %", signal=_with(_DRIVE, _gain(1.02))),
    Fault("response inverted", signal=_with(_ANSWER, _gain(-1.0))),
    Fault("response in mm taken as m", signal=_with(_ANSWER, _gain(1000.0))),
    Fault("response relative to the base", signal=_with(_ANSWER, _relative)),
    Fault("1 % of the drive in the response", signal=_with(_ANSWER, _crosstalk)),
    Fault("response clipped at 97 %", signal=_with(_ANSWER, _clipped)),
    Fault("response drifts by 20 % of its rms", signal=_with(_ANSWER, _drift)),
    Fault("response wanders by 20 % of its rms", signal=_with(_ANSWER, _wander)),
    Fault("hum of 50 Hz, 2 %", signal=_with(_ANSWER, _hum)),
    Fault("12 bits, range set for each level", after=_converter(None)),
    Fault("12 bits, one range of ±50 mm", after=_converter(0.05)),
    Fault("20 drop-outs of 10 samples, zero", after=_dropped("zero")),
    Fault("20 drop-outs of 10 samples, held", after=_dropped("held")),
    Fault("20 gaps of 10 samples", after=_dropped("missing")),
    Fault("spikes of 3 rms, one in 997 samples", after=_spikes),
    Fault("1/f noise of 1 % besides", after=_coloured),
    Fault("11 samples a cycle", after=_slow),
    Fault("k 1 % too high", k=1.01),
    Fault("k 10 % too low", k=0.9),
    Fault("k 1000 times too small", k=1e-3),
    Fault("start from rest in the record", signal=_starting),
    Fault("lowest level does not slip", levels=_low),
    Fault("K_z 0.6 to 1.4 times, by level", levels=_each(K_z=(0.6, 0.8, 1.0, 1.2, 1.4))),
    Fault("F_k 0.9 to 1.1 times, by level", levels=_each(F_k=(0.9, 0.95, 1.0, 1.05, 1.1))),
)


class Run(NamedTuple):
    """One drawing of the noise of one of FAULTS on one of TRUTHS."""

    truth: int
    fault: int
    drawing: int


_RANGES = range(DRAWINGS), range(len(TRUTHS)), range(len(FAULTS))
RUNS = [Run(truth, fault, drawing) for drawing, truth, fault in itertools.product(*_RANGES)]


def tried(run: Run) -> list[dict[str, object]]:
    """Return rows of one drawing, as of `score.outcome`."""
    fault, truth = FAULTS[run.fault], TRUTHS[run.truth]
    own: dict[str, object] = {"name": fault.name} | run._asdict()
    k = fault.k * truth.k
    hertz = None if fault.stated is None else fault.stated * truth.omega / (2.0 * math.pi)
    began = time.process_time()
    try:
        measurements = fault.records(truth, run.drawing)
        readings = [read_features(one, k, frequency_hz=hertz) for one in measurements]
        result = identify_readings(readings, k)
    except (ValueError, ArithmeticError) as error:
        return [own | {"approach": "refused", "symbol": "", "warnings": str(error)}]
    own["seconds"] = time.process_time() - began
    return [own | row for row in numbers(result, truth)]


def table(rows: pd.DataFrame) -> str:
    """Return the error of each parameter in % and in standard errors, and what is said, in markdown."""
    rows = rows.fillna({"notes": "", "warnings": ""})
    lines = [
        f"Errors of the {FIRST} in % (in standard errors), medians of {rows['drawing'].nunique()} drawings of the "
        "noise; what is said in the first, after a star of this answer.",
    ]
    for place, of_truth in rows.groupby("truth"):
        truth = TRUTHS[int(place)]
        heads = ["fault", *SYMBOLS, "m, by maximum likelihood", "what is said"]
        groups = (group for _, group in of_truth.groupby("fault"))
        cells = [[group["name"].iloc[0], *_cells(group)] for group in groups]
        lines += [
            f"At {truth.omega / (2.0 * math.pi):.4g} Hz, ω/ω_n = {truth.omega / truth.omega_n:.2f}:",
            markdown_table(heads, cells),
        ]
    return "\n\n".join(lines) + "\n"


def _cells(group: pd.DataFrame) -> list[str]:
    """Return errors and words of one fault."""
    own = group[group["approach"] == FIRST]
    if own.empty:
        return ["–"] * 4 + [f"refused: {cut(group['warnings'].iloc[0], 110)}"]
    cells = [_error(own[own["symbol"] == symbol]) for symbol in SYMBOLS]
    mass = group[(group["approach"] == REFERENCE) & (group["symbol"] == "m")]
    cells.append("none" if mass.empty else _error(mass))
    first = own.iloc[0]
    words = [f"* {note}" for note in first["notes"].split(" | ") if note]
    words += [warning for warning in first["warnings"].split(" | ") if warning]
    counted = [f"{word} ({n}×)" if n > 1 else word for word, n in Counter(words).items()]
    return [*cells, "; ".join(counted) or "nothing"]


def _error(drawn: pd.DataFrame) -> str:
    """Return median error of the drawings; a limit or nothing where most of them have no value."""
    value, true = drawn["value"].median(), drawn["true"].iloc[0]
    if drawn["value"].isna().mean() > 0.5:
        return "none"
    if math.isinf(value):
        return f"> {drawn['low'].median() / true:.2g} of it"
    symbol, error = drawn["symbol"].iloc[0], drawn["standard_error"].median()
    sizes = in_errors(symbol, value, true, error)
    return f"{100 * (value / true - 1.0):+.2g} ({sizes:+.1f})"
