"""Features of records, one after the other: fixed-step simulations, and exact orbits sampled at f_s.

Reading a record costs milliseconds where an exact orbit costs a microsecond: studies of these routes have thousands of
responses, not millions.
"""

from __future__ import annotations

import numpy as np

from ..features import Features, of_numbers
from ..model import BaseMotion, Oscillator
from ..motion.fixed_step import StepTooCoarse, simulate
from ..motion.orbit import NoSteadyOrbit, steady_orbit
from ..motion.regime import Regime
from ..reading.clean import CYCLES_TO_READ, of_record
from ..record import Record
from .responses import NOT_READ, STEP_TOO_COARSE, Cases, one_by_one


def record_responses(cases: Cases) -> Features:
    """The responses (L, n) read off the records of the routes fixed_step and sampled."""
    record_of = _simulated if cases.study.route.kind == "fixed_step" else _sampled

    def read(osc: Oscillator, motion: BaseMotion, case: int) -> Features:
        try:
            record = record_of(cases, osc, motion, case)
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


def _simulated(cases: Cases, osc: Oscillator, motion: BaseMotion, case: int) -> Record:
    """The last three cycles of those that a fixed-step scheme computes."""
    values = cases.values
    if "step_s" in values:
        step = float(values["step_s"][case])
    else:
        step = motion.period / float(values["steps_per_cycle"][case])
    if not 0.0 < step < motion.period:
        raise StepTooCoarse
    kept = {"cycles": cases.study.cycles, "keep_cycles": CYCLES_TO_READ}
    return simulate(osc, motion, scheme=str(values["scheme"][case]), step=step, **kept)


def _sampled(cases: Cases, osc: Oscillator, motion: BaseMotion, case: int) -> Record | None:
    """The exact response, sampled at sampling_hz for the cycles of the study, from ωt = 0 on."""
    orbit = steady_orbit(osc, motion)
    rate = float(cases.values["sampling_hz"][case])
    t = np.arange(int(cases.study.cycles * motion.period * rate) + 1) / rate
    if len(t) < 2:
        return None
    state = orbit.state(t)
    return Record(t, motion.y(t), state.x, state.v, state.acceleration)
