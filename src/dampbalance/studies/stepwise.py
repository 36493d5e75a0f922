"""Features of records, one after the other: fixed-step simulations, and exact orbits sampled at f_s.

Reading a record costs milliseconds where an exact orbit costs a microsecond: studies of these routes have thousands of
responses, not millions.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..features import Features, of_numbers
from ..model import BaseMotion, Oscillator
from ..motion.fixed_step import StepTooCoarse, simulate
from ..motion.orbit import NoSteadyOrbit, steady_orbit
from ..motion.regime import Regime
from ..reading.clean import CYCLES_TO_READ, of_record
from ..record import Record
from .responses import NOT_READ, STEP_TOO_COARSE, Cases, one_by_one


def fixed_step_responses(cases: Cases) -> Features:
    """The responses that a fixed-step scheme gives in the cycles of the study, read off the last three of them."""
    values = cases.values

    def simulated(osc: Oscillator, motion: BaseMotion, case: int) -> Record:
        if "step_s" in values:
            step = float(values["step_s"][case])
        else:
            step = motion.period / float(values["steps_per_cycle"][case])
        if not 0.0 < step < motion.period:
            raise StepTooCoarse
        kept = {"cycles": cases.study.cycles, "keep_cycles": CYCLES_TO_READ}
        return simulate(osc, motion, scheme=str(values["scheme"][case]), step=step, **kept)

    return _read_each(cases, simulated)


def sampled_responses(cases: Cases) -> Features:
    """The exact responses, sampled at sampling_hz for the cycles of the study, from ωt = 0 on, and read."""

    def sampled(osc: Oscillator, motion: BaseMotion, case: int) -> Record | None:
        orbit = steady_orbit(osc, motion)
        rate = float(cases.values["sampling_hz"][case])
        t = np.arange(int(cases.study.cycles * motion.period * rate) + 1) / rate
        if len(t) < 2:
            return None
        state = orbit.state(t)
        return Record(t, motion.y(t), state.x, state.v, state.acceleration)

    return _read_each(cases, sampled)


def _read_each(
    cases: Cases, record_of: Callable[[Oscillator, BaseMotion, int], Record | None]
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
                return of_record(record, motion.omega, osc.k, cases.study.reading)
        except ValueError:  # too short, or too coarse to contain a reversal
            pass
        return of_numbers(motion.omega, NOT_READ)

    return one_by_one(cases, read).replaced(Y=cases.Y)
