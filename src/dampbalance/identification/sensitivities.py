"""Effect of faults of calibration and timing, which a record hardly shows, on an identification, by its own rows.

A gain of the drive multiplies Y, one of the response all x_n; a response that is late by τ has x_n e^{−inωτ}; a phase
error at the drive frequency is a delay of that part of a cycle. The rows are read again from harmonics changed in that
way and solved with the same weights, the waveforms following to first order. The stiffness k is a factor of the whole
equation of motion, and so of every coefficient.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from ..arrays import Array
from ..fit.fundamentals import FundamentalFit
from ..fit.steady_search import refit
from ..fit.waveforms import WaveformFit
from ..signals.mean_harmonics import Means, Reading
from ..signals.one_thread import one_thread
from ..solver import solve
from .answer import Answer
from .oscillator import LawRows, sample_of

_STEP = 1e-3  # of each fault: small enough for first order, large compared with rounding


@lru_cache(maxsize=1)  # asked for by the report and by its remarks
def _with_mass(fit: WaveformFit, m: float) -> WaveformFit | None:
    """Return the fit with the mass given, kg."""
    return refit(fit, given={"m": m})


@dataclass(frozen=True, slots=True)
class Fault:
    """A fault, alike in all records.

    words : what is wrong, and by how much.   drive, response : relative errors of gain.   late : delay of the response,
    s.   angle : lag of the response at the drive frequency, rad.   stiffness, mass : relative errors of k and of m, if
    it is given.
    """

    words: str
    drive: float = 0.0
    response: float = 0.0
    late: float = 0.0
    angle: float = 0.0
    stiffness: float = 0.0
    mass: float = 0.0


FAULTS: Mapping[str, Fault] = {
    "drive_gain_1_percent": Fault("the drive reads 1 % too large", drive=0.01),
    "response_gain_1_percent": Fault("the response reads 1 % too large", response=0.01),
    "response_phase_1_degree": Fault("the response lags by 1° too much", angle=math.radians(1.0)),
    "response_late_100_us": Fault("the response is 100 µs late", late=1e-4),
    "stiffness_1_percent": Fault("k is given 1 % too large", stiffness=0.01),
}


@one_thread
def sensitivities(
    readings: Sequence[Reading],
    rows_of: LawRows,
    answer: Answer,
    faults: Mapping[str, Fault] = FAULTS,
) -> dict[str, dict[str, float]]:
    """Return by how much each fault changes what a balance identifies, relative to it: fault → symbol → number.

    NaN where rows or waveforms do not determine it.

    readings : of the records.   rows_of : the balance.   answer : what it identifies.
    """
    assert answer.balance is not None
    each = list(faults.values())
    sample = sample_of(readings, [_faulty(reading, each) for reading in readings])
    stiffer = 1.0 + _STEP * np.array([0.0, *(fault.stiffness for fault in each)])
    rows, errors = rows_of(sample.features), answer.balance.errors
    rows = replace(rows, W=rows.W * stiffer)
    weights = np.where(errors > 0.0, errors, 1.0) ** -2.0
    solved = solve(replace(rows, weights=np.broadcast_to(weights[:, None], rows.W.shape)))
    values = {symbol: solved[symbol] for symbol in answer.coefficients if symbol in solved.values}
    with np.errstate(divide="ignore", invalid="ignore"):
        return _by_fault(faults, {s: (of[1:] / of[0] - 1.0) / _STEP for s, of in values.items()})


@one_thread
def shifts_of_fit(
    readings: Sequence[Reading], fit: WaveformFit, faults: Mapping[str, Fault]
) -> dict[str, dict[str, float]]:
    """Return by how much each fault changes what the fit to all records identifies, relative to it: fault → symbol →
    number, "m" for the mass.

    m, c, k, K_z and F_k times a number are an oscillator of the same motion: with the mass left free all of them follow
    an error of k, and with the mass given that of an error of the mass the other way.
    """
    each = list(faults.values())
    moved = np.sum([r.moved(_faulty(r, each)) for r in readings], axis=0)[:, 1:] / _STEP
    changes = dict(zip(fit.parameters.keys, moved, strict=True))
    stiffness = np.array([fault.stiffness for fault in each])
    # a mass that is given too large acts like a stiffness too small, but scales nothing
    lightened = stiffness - np.array([fault.mass for fault in each])
    heavy = fit.error("m") == 0.0
    lighter = _with_mass(fit, fit.m * (1.0 - _STEP)) if heavy and lightened.any() else None
    shifts: dict[str, Array] = {}
    for key in (*fit.law.unknowns, "rho", "m"):
        value, follows = fit.value(key), 0.0 if getattr(key, "symbol", key) == "eta" else 1.0
        scaled = stiffness * (-0.5 if key == "rho" else follows)
        if heavy and key != "m":
            by_mass = 0.0 if lighter is None else (lighter.value(key) / value - 1.0) / _STEP
            scaled = scaled + lightened * by_mass
        if heavy and key == "m":
            scaled = stiffness - lightened
        with np.errstate(divide="ignore", invalid="ignore"):
            shifts[key] = changes[key] / value + scaled
    shifts["K_z"] = -2.0 * shifts.pop("rho")  # K_z = ρ^{−2}
    return _by_fault(faults, shifts)


def shifts_of_fundamentals(
    readings: Sequence[Reading], fit: FundamentalFit, faults: Mapping[str, Fault]
) -> dict[str, dict[str, float]]:
    """Return by how much each fault changes what the fit to the fundamentals identifies; as `shifts_of_fit`."""
    means = [_faulty(reading, list(faults.values())) for reading in readings]
    stiffness = np.array([mean.Y / mean.x[:, 0] for mean in means])
    moved = fit.moved(stiffness[:, 1:] / stiffness[:, :1] - 1.0) / _STEP
    scaled = np.array([fault.stiffness for fault in faults.values()])
    changes = dict(zip(fit.names, moved, strict=True))
    shifts: dict[str, Array] = {key: changes[key] + scaled for key in (*fit.law.unknowns, "m")}
    return _by_fault(faults, shifts | {"K_z": scaled - 2.0 * changes["rho"]})


def _by_fault(names: Iterable[str], of: Mapping[str, Array]) -> dict[str, dict[str, float]]:
    """Return what each fault does, from what all of them do to each number, (faults,)."""
    return {name: {s: float(by[i]) for s, by in of.items()} for i, name in enumerate(names)}


def _faulty(reading: Reading, faults: list[Fault]) -> Means:
    """Return the means of a record as read, and with each of the faults, a thousandth of each.

    A force f moves the mass like the base motion f/k: an error of k is one of that motion; and so is one of the mass m
    that stands on a base which moves, where f is −mÿ.
    """
    drive, response, late, angle, stiffness, mass = (
        _STEP * np.array([0.0, *(getattr(fault, what) for fault in faults)])
        for what in ("drive", "response", "late", "angle", "stiffness", "mass")
    )
    steady = reading.steady
    on_base = steady.base_mass is not None
    lever = mass * on_base - stiffness * (on_base or "force" in steady.channels)
    turn = late * steady.omega + angle
    return reading.mean.changed(drive, response, turn, lever, steady.added)
