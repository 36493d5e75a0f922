"""How each symptom looks: synthetic records with one fault each, their pictures, and what is identified from them.

The records are those of one oscillator on a base that moves at 6 Hz, at four levels; its numbers are `TRUTH`. A
fault is put into the motion or into the channels, and `identify` is asked for an answer. For each symptom the folder
then holds a picture (NAME.svg) and what was said (NAME.txt).
"""

from __future__ import annotations

import itertools
import math
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from scipy.signal import lfilter

from dampbalance import BaseMotion, Oscillator, identify, sliders_orbit, steady_orbit, transient
from dampbalance.figures.style import (
    DASHED,
    DOUBLE_COLUMN,
    FAINT,
    SLIP,
    STICK,
    page,
    place,
    save_svg,
    styled,
)
from dampbalance.identification.result import Result
from dampbalance.identification.screen import in_one, limiting
from dampbalance.motion.distorted import distorted_harmonics
from dampbalance.motion.law_steady import Further, steady_response
from dampbalance.motion.sliders import spread_contact
from dampbalance.project.wording import signed
from dampbalance.records.channel import Channel
from dampbalance.records.record import Record

TRUTH = Oscillator(m=3.0, c=9.0, k=5200.0, K_z=80_000.0, F_k=2.0)
HZ, RATE, CYCLES = (
    6.0,
    600.0,
    30,
)  # a hundred samples a cycle: whole cycles, as the pictures average them
OMEGA, DT = 2.0 * math.pi * HZ, 1.0 / RATE
LEVELS = np.array([1.0, 1.6, 2.5, 4.0]) * 1e-3  # m, of the base
NOISE = 0.002  # of the rms of a channel
PER_CYCLE = round(RATE / HZ)
BEFORE = 20 * PER_CYCLE  # samples before a record, in which filters settle
SHOWN = 31  # harmonics of a loop: more would show the noise of a second derivative


def _motion(Y: float) -> BaseMotion:
    return BaseMotion(Y=Y, omega=OMEGA)


@dataclass(frozen=True)
class Fault:
    """A fault of records, and of what is stated with them.

    motion : (Y) → the response, which has `state`.   channels : (t, y, x) → (y, x) as they are recorded, before noise;
    the first samples, `BEFORE` of them, are cut off then.   recorder : the response with its noise → as it is stored.
    size : the fault in words.   noise, levels : if others.   stated : arguments of `identify`.   span : cycles that a
    picture shows.
    """

    size: str
    motion: Callable[[float], object] = lambda Y: steady_orbit(TRUTH, _motion(Y))
    channels: Callable[[np.ndarray, np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]] = (
        lambda t, y, x: (y, x)
    )
    recorder: Callable[[np.ndarray], np.ndarray] = lambda x: x
    noise: float = NOISE
    levels: np.ndarray | None = None
    stated: dict[str, float] | None = None
    span: int = 2


def _late(by: float) -> Callable[..., tuple[np.ndarray, np.ndarray]]:
    return lambda t, y, x: (y, np.interp(t - by, t, x))


def _high_pass(t: np.ndarray, y: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    half = math.pi * 0.3 * DT
    gain, pole = 1.0 / (1.0 + half), (half - 1.0) / (1.0 + half)
    return y, lfilter([gain, -gain], [1.0, pole], x)


def _spiky(t: np.ndarray, y: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    x = x.copy()
    x[BEFORE + 37 :: 7 * PER_CYCLE + 13] += 0.8 * np.ptp(x)
    return y, x


def _stepped(x: np.ndarray) -> np.ndarray:
    step = np.ptp(x) / 2**6
    return np.asarray(step * np.round(x / step))


def _clipped(x: np.ndarray) -> np.ndarray:
    return np.clip(x, 0.8 * x.min(), 0.8 * x.max())


def _shifted_level(Y: float) -> object:
    share = 1.0 + 0.25 * math.log(Y / float(np.exp(np.log(LEVELS).mean())))
    return steady_orbit(replace(TRUTH, F_k=TRUTH.F_k * share), _motion(Y))


def _with(further: Callable[[float], Further]) -> Callable[[float], object]:
    return lambda Y: steady_response(TRUTH, _motion(Y), {}, further=further(Y))


def _gradual(Y: float) -> object:
    r, kappa = spread_contact(TRUTH, 20.0, 12)
    return sliders_orbit(replace(TRUTH, F_k=0.0), _motion(Y), r, kappa)


def _from_rest(Y: float) -> object:
    return transient(TRUTH, _motion(Y), CYCLES / HZ + 1.0)


class _Distorted:
    """The motion under a base whose third harmonic is a part of its fundamental."""

    def __init__(self, Y: float, third: float) -> None:
        base = np.array([Y, 0.0, third * Y], dtype=np.complex128)
        self.x_n = distorted_harmonics(steady_orbit(TRUTH, _motion(Y)), base, 127)

    def state(self, t: np.ndarray) -> SimpleNamespace:
        """Return its displacement, m, at times, s."""
        turns = np.exp(1j * OMEGA * np.outer(t, np.arange(1, self.x_n.size + 1)))
        return SimpleNamespace(x=(turns @ self.x_n).real)


def _sided(t: np.ndarray, y: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return y, x + 0.02 * np.max(x) * np.cos(2.0 * OMEGA * t)


FAULTS = {
    "delay": Fault("the response is 2 ms late", channels=_late(2e-3)),
    "corner": Fault("the response passed a high-pass of 0.3 Hz", channels=_high_pass),
    "gain": Fault("the drive reads 3 % too much", channels=lambda t, y, x: (1.03 * y, x)),
    "frame": Fault(
        "the response is relative to the base, and is called absolute",
        channels=lambda t, y, x: (y, x - y),
    ),
    "friction_level": Fault(
        "the friction force grows by 25 % where the level grows by e", _shifted_level
    ),
    "friction_speed": Fault(
        "friction is 30 % larger at rest", _with(lambda Y: Further(falling=0.3, speed=0.02))
    ),
    "c_2": Fault(
        "damping of 60 N s²/m² on top", lambda Y: steady_response(TRUTH, _motion(Y), {"c_2": 60.0})
    ),
    "k_3": Fault("the spring has k_3 = 2·10⁶ N/m³", _with(lambda Y: Further(k_3=2e6))),
    "gradual": Fault("twelve contacts yield one after the other", _gradual, noise=1e-3),
    "unsettled": Fault("the record begins when the shaker is switched on", _from_rest, span=CYCLES),
    "clipped": Fault("the amplifier ends at 80 % of the motion", recorder=_clipped),
    "spikes": Fault("a spike every seventh cycle", channels=_spiky, span=12),
    "bits": Fault("six bits for the response", recorder=_stepped, noise=1e-5),
    "base": Fault(
        "the base moves at its third harmonic, too, by 4 %",
        lambda Y: _Distorted(Y, 0.04),
        channels=lambda t, y, x: (y + 0.04 * y.max() * np.cos(3.0 * OMEGA * t), x),
    ),
    "asymmetric": Fault("the response has 2 % of a second harmonic", channels=_sided),
    "frequency": Fault("6.02 Hz is stated for 6 Hz", stated={"frequency": 6.02}),
    "exchanged": Fault("the two channels are exchanged", channels=lambda t, y, x: (x, y)),
    "mass": Fault("3.3 kg is stated for 3 kg", stated={"mass": 3.3}),
    "stuck": Fault("the levels are too low for the contact to slip", levels=LEVELS / 500.0),
    "alike": Fault("all levels lie within 1 %", levels=4e-3 * np.linspace(0.99, 1.0, 4)),
    "unresolved": Fault("60 % of noise", noise=0.6),
}
"""A fault for each of the symptoms."""


def channels(fault: Fault, Y: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return t, s, and the channels of base and response, m, with the fault and without noise."""
    starts = isinstance(motion := fault.motion(Y), type(_from_rest(1e-3)))
    t = (np.arange(CYCLES * PER_CYCLE + (0 if starts else BEFORE))) * DT
    y = Y * np.cos(OMEGA * t)
    y, x = fault.channels(t, y, np.asarray(motion.state(t).x))  # type: ignore[attr-defined]
    first = 0 if starts else BEFORE
    return t[: t.size - first], y[first:], x[first:]


def levels(fault: Fault) -> np.ndarray:
    """Return the amplitudes of the base, m."""
    return LEVELS if fault.levels is None else fault.levels


def records(fault: Fault) -> list[Record]:
    """Return the records of all levels."""
    random, measured = np.random.default_rng(45), []
    for i, Y in enumerate(levels(fault), start=1):
        t, *clean = channels(fault, float(Y))
        noisy = [one + fault.noise * one.std() * random.standard_normal(t.size) for one in clean]
        noisy[1] = fault.recorder(noisy[1])
        parts = zip(("base_displacement", "displacement"), noisy, strict=True)
        measured.append(Record.of(f"level {i}", [Channel(q, t, of) for q, of in parts]))
    return measured


def identified(fault: Fault) -> Result[Any]:
    """Return what is identified; ValueError where the records are refused."""
    return identify(records(fault), stiffness=TRUTH.k, **{"mass": TRUTH.m, **(fault.stated or {})})


def _loop(y: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """x, mm, and the force that spring, inertia and viscous damping leave of the averaged cycle, N."""
    size = 512
    mean = [np.median(one.reshape(-1, PER_CYCLE), axis=0) for one in (y, x)]  # no spike counts
    n = np.arange(SHOWN + 1)
    Y, X = (np.fft.rfft(one)[: SHOWN + 1] / PER_CYCLE for one in mean)
    rate = 1j * n * OMEGA
    fading = np.sinc(n / (SHOWN + 1))  # of Lanczos: an end of the sum shows no ripples
    force = TRUTH.k * (Y - X) - TRUTH.m * rate**2 * X - TRUTH.c * rate * X
    full = [
        np.fft.irfft(np.pad(of * size, (0, size // 2 - SHOWN)), size) for of in (X, fading * force)
    ]
    return 1e3 * np.append(full[0], full[0][0]), np.append(full[1], full[1][0])


@styled()
def draw(name: str, path: Path) -> None:
    """Draw a symptom: the response with and without the fault, their difference, and the loop of the friction force."""
    fault, Y = FAULTS[name], float(levels(FAULTS[name])[1])
    t, y, x = channels(fault, Y)
    random = np.random.default_rng(45)
    x = fault.recorder(
        x + fault.noise * (fault.noise > NOISE) * x.std() * random.standard_normal(x.size)
    )
    _, y_sound, x_sound = channels(replace(FAULTS["mass"], levels=fault.levels), Y)
    rows = slice(0, fault.span * PER_CYCLE)
    cycles, top = t[rows] * HZ, float(np.abs(x_sound).max())
    figure = page(DOUBLE_COLUMN, 62.0)
    response = place(figure, 14.0, 28.0, 88.0, 25.0)
    rest = place(figure, 14.0, 11.0, 88.0, 14.0)
    loop = place(figure, 120.0, 11.0, 56.0, 42.0)
    shown, sound = {"color": STICK, "label": "with it"}, {"color": FAINT, "linestyle": DASHED}
    for axes, sound_pair, pair in (
        (response, (cycles, 1e3 * x_sound[rows]), (cycles, 1e3 * x[rows])),
        (loop, _loop(y_sound, x_sound), _loop(y, x)),
    ):
        axes.plot(*sound_pair, label="without", **sound)
        axes.plot(*pair, **shown)
    rest.plot(cycles, 100.0 * (x[rows] - x_sound[rows]) / top, color=SLIP, label="response")
    if not np.allclose(y, y_sound):
        drive = 100.0 * (y[rows] - y_sound[rows]) / float(np.abs(y_sound).max())
        rest.plot(cycles, drive, color=FAINT, label="drive")
        rest.legend(loc="upper right", ncols=2, fontsize=7.0, borderaxespad=0.2)
    response.set(ylabel="$x$ (mm)", xlim=(0.0, fault.span), xticklabels=[])
    rest.set(xlabel="cycles", ylabel="difference (%)", xlim=(0.0, fault.span))
    loop.set(xlabel="$x$ (mm)", ylabel="$f$ (N)")
    loop.legend(loc="upper center", ncols=2, bbox_to_anchor=(0.5, 1.2))
    save_svg(figure, path, f"The response with and without the fault ({fault.size}), and its loop.")


def sentences(name: str) -> tuple[list[str], Result[Any] | None]:
    """Return what is said of the records of a symptom that names it, and what is identified; None where they are
    refused."""
    page = name.replace("_", "-")
    try:
        result = identified(FAULTS[name])
    except ValueError as error:
        finding = getattr(error.__cause__, "finding", None)
        return [str(error)] if finding and page in finding.pages else [], None
    groups = [*result.limits, *([one] for one in result.rig)]
    said = [*limiting(result), *result.in_sentences(result.rig)]
    named = [any(page in one.pages for one in group) for group in groups]
    return [*itertools.compress(said, named)], result


def said(name: str) -> str:
    """Return the fault, what is said of it, and by how much the numbers of the balance, which takes the records as they
    are, and of the answer are off."""
    about, result = sentences(name)
    lines = [f"Fault: {FAULTS[name].size}.", *(f"Said: {one}" for one in about)]
    if result is None:
        return "\n".join([*lines, "Answer: none, the record is refused."]) + "\n"
    for label, answer in (("Balance", result.approaches["direct"]), ("Answer", result.answer)):
        off = [
            (s, answer.values.get(s, math.nan) / getattr(TRUTH, s) - 1.0)
            for s in ("F_k", "c", "K_z")
        ]
        parts = [
            f"{s} {signed(100.0 * by, 1)} %" if math.isfinite(by) else f"{s} none" for s, by in off
        ]
        lines.append(f"{label}, off the truth by: {', '.join(parts)}")
    lines.append(f"Verdict: {in_one(result.answer.verdicts, result.coordinate)}.")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    for symptom in sys.argv[1:] or FAULTS:
        draw(symptom, Path(f"{symptom}.svg"))
        Path(f"{symptom}.txt").write_text(said(symptom), encoding="utf-8")
