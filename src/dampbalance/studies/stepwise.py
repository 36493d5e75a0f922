"""Responses read off records, one after the other: fixed-step simulations, and exact orbits sampled at f_s.

Reading a record costs milliseconds where an exact orbit costs a microsecond: studies of these routes have thousands of
responses, not millions.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ..arrays import Array
from ..features import Features, beside, of_numbers, stack
from ..model import BaseMotion, Oscillator
from ..motion.fixed_step import StepTooCoarse, simulate
from ..motion.orbit import NoSteadyOrbit, steady_orbit
from ..motion.regime import Regime
from ..reading.clean import CYCLES_TO_READ, ReadAt, of_record
from ..record import Record
from .responses import NOT_READ, STEP_TOO_COARSE


def fixed_step_responses(
    si: Mapping[str, Array], Y: Array, numerics: Mapping[str, Any], cycles: int, reading: ReadAt
) -> Features:
    """The responses that a fixed-step scheme gives, read off their last three cycles.

    si : m, c, k, K_z, F_k, omega, each (n,).   Y : m, (L, n).   numerics : scheme and step_s or steps_per_cycle,
    each (n,).   cycles : simulated from rest.
    """

    def read(osc: Oscillator, motion: BaseMotion, case: int) -> Features:
        if "step_s" in numerics:
            step = float(numerics["step_s"][case])
        else:
            step = motion.period / float(numerics["steps_per_cycle"][case])
        if not 0.0 < step < motion.period:
            return of_numbers(motion.omega, STEP_TOO_COARSE)
        try:
            record = simulate(
                osc,
                motion,
                scheme=str(numerics["scheme"][case]),
                step=step,
                cycles=cycles,
                keep_cycles=CYCLES_TO_READ,
            )
        except StepTooCoarse:
            return of_numbers(motion.omega, STEP_TOO_COARSE)
        return _read(record, osc, motion, reading)

    return _one_by_one(si, Y, read)


def sampled_responses(
    si: Mapping[str, Array], Y: Array, numerics: Mapping[str, Any], cycles: int, reading: ReadAt
) -> Features:
    """The exact responses, sampled at sampling_hz (Hz, (n,)) for `cycles` cycles from ωt = 0 on, and read."""

    def read(osc: Oscillator, motion: BaseMotion, case: int) -> Features:
        try:
            orbit = steady_orbit(osc, motion)
        except NoSteadyOrbit:
            return of_numbers(motion.omega, str(Regime.NOT_FOUND))
        rate = float(numerics["sampling_hz"][case])
        t = np.arange(int(cycles * motion.period * rate) + 1) / rate
        if len(t) < 2:
            return of_numbers(motion.omega, NOT_READ)
        state = orbit.state(t)
        record = Record(t, motion.y(t), state.x, state.v, state.acceleration)
        return _read(record, osc, motion, reading)

    return _one_by_one(si, Y, read)


def _read(record: Record, osc: Oscillator, motion: BaseMotion, reading: ReadAt) -> Features:
    try:
        return of_record(record, motion.omega, osc.k, reading)
    except ValueError:  # too short, or too coarse to hold a reversal
        return of_numbers(motion.omega, NOT_READ)


def _one_by_one(
    si: Mapping[str, Array], Y: Array, read: Callable[[Oscillator, BaseMotion, int], Features]
) -> Features:
    """The responses (L, n) that `read` gives for each oscillator, base motion and number of the case."""
    cases = []
    for case in range(Y.shape[1]):
        osc = Oscillator(*(float(si[name][case]) for name in ("m", "c", "k", "K_z", "F_k")))
        omega = float(si["omega"][case])
        levels = [read(osc, BaseMotion(Y=float(level), omega=omega), case) for level in Y[:, case]]
        cases.append(stack(levels))
    return beside(cases).replaced(Y=Y)
