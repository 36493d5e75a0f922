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
from .parameters import oscillator_of
from .responses import NOT_READ, STEP_TOO_COARSE


def fixed_step_responses(
    si: Mapping[str, Array], Y: Array, numerics: Mapping[str, Any], cycles: int, reading: ReadAt
) -> Features:
    """The responses that a fixed-step scheme gives, read off their last three cycles.

    si : m, c, k, K_z, F_k, omega, each (n,).   Y : m, (L, n).   numerics : scheme and step_s or steps_per_cycle,
    each (n,).   cycles : simulated from rest.
    """

    def simulated(osc: Oscillator, motion: BaseMotion, case: int) -> Record:
        if "step_s" in numerics:
            step = float(numerics["step_s"][case])
        else:
            step = motion.period / float(numerics["steps_per_cycle"][case])
        if not 0.0 < step < motion.period:
            raise StepTooCoarse
        kept = {"cycles": cycles, "keep_cycles": CYCLES_TO_READ}
        return simulate(osc, motion, scheme=str(numerics["scheme"][case]), step=step, **kept)

    return _read_each(si, Y, simulated, reading)


def sampled_responses(
    si: Mapping[str, Array], Y: Array, numerics: Mapping[str, Any], cycles: int, reading: ReadAt
) -> Features:
    """The exact responses, sampled at sampling_hz (Hz, (n,)) for `cycles` cycles from ωt = 0 on, and read."""

    def sampled(osc: Oscillator, motion: BaseMotion, case: int) -> Record | None:
        orbit = steady_orbit(osc, motion)
        rate = float(numerics["sampling_hz"][case])
        t = np.arange(int(cycles * motion.period * rate) + 1) / rate
        if len(t) < 2:
            return None
        state = orbit.state(t)
        return Record(t, motion.y(t), state.x, state.v, state.acceleration)

    return _read_each(si, Y, sampled, reading)


def _read_each(
    si: Mapping[str, Array],
    Y: Array,
    record_of: Callable[[Oscillator, BaseMotion, int], Record | None],
    reading: ReadAt,
) -> Features:
    """The responses (L, n) read off the record of each oscillator, base motion and number of the case."""

    def read(osc: Oscillator, motion: BaseMotion, case: int) -> Features:
        try:
            record = record_of(osc, motion, case)
        except StepTooCoarse:
            return of_numbers(motion.omega, STEP_TOO_COARSE)
        except NoSteadyOrbit:
            return of_numbers(motion.omega, str(Regime.NOT_FOUND))
        try:
            if record:
                return of_record(record, motion.omega, osc.k, reading)
        except ValueError:  # too short, or too coarse to hold a reversal
            pass
        return of_numbers(motion.omega, NOT_READ)

    cases = []
    for case, omega in enumerate(si["omega"].tolist()):
        osc = oscillator_of(si, case)
        cases.append(
            stack([read(osc, BaseMotion(level, omega), case) for level in Y[:, case].tolist()])
        )
    return beside(cases).replaced(Y=Y)
