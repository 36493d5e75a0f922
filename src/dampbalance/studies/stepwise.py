"""Responses read off records, one after the other: fixed-step simulations, and exact orbits sampled at f_s.

Reading a record costs milliseconds where an exact orbit costs a microsecond: studies of these routes have thousands of
responses, not millions.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..features import COLUMNS, Features, single
from ..model import BaseMotion, Oscillator
from ..motion.fixed_step import StepTooCoarse, simulate
from ..motion.orbit import NoSteadyOrbit, steady_orbit
from ..motion.regime import Regime
from ..reading.clean import CYCLES_TO_READ, Reading, of_record
from ..record import Record
from .responses import NOT_READ, STEP_TOO_COARSE, Responses

Array = NDArray[np.float64]


def fixed_step_responses(
    si: Mapping[str, Array], Y: Array, numerics: Mapping[str, Any], cycles: int, reading: Reading
) -> Responses:
    """The responses that a fixed-step scheme gives, read off their last three cycles.

    si : m, c, k, K_z, F_k, omega, each (n,).   Y : m, (L, n).   numerics : scheme and step_s or steps_per_cycle,
    each (n,).   cycles : simulated from rest.
    """

    def read(osc: Oscillator, motion: BaseMotion, case: int) -> tuple[Features, int]:
        if "step_s" in numerics:
            step = float(numerics["step_s"][case])
        else:
            step = motion.period / float(numerics["steps_per_cycle"][case])
        if not 0.0 < step < motion.period:
            return single(motion.omega, ""), STEP_TOO_COARSE
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
            return single(motion.omega, ""), STEP_TOO_COARSE
        return _read(record, osc, motion, reading)

    return _one_by_one(si, Y, read)


def sampled_responses(
    si: Mapping[str, Array], Y: Array, numerics: Mapping[str, Any], cycles: int, reading: Reading
) -> Responses:
    """The exact responses, sampled at sampling_hz (Hz, (n,)) for `cycles` cycles from ωt = 0 on, and read."""

    def read(osc: Oscillator, motion: BaseMotion, case: int) -> tuple[Features, int]:
        try:
            orbit = steady_orbit(osc, motion)
        except NoSteadyOrbit:
            return single(motion.omega, ""), int(Regime.NOT_FOUND)
        rate = float(numerics["sampling_hz"][case])
        t = np.arange(int(cycles * motion.period * rate) + 1) / rate
        if len(t) < 2:
            return single(motion.omega, ""), NOT_READ
        state = orbit.state(t)
        record = Record(t, motion.y(t), state.x, state.v, state.acceleration)
        return _read(record, osc, motion, reading)

    return _one_by_one(si, Y, read)


def _read(
    record: Record, osc: Oscillator, motion: BaseMotion, reading: Reading
) -> tuple[Features, int]:
    try:
        features = of_record(record, motion.omega, osc.k, reading)
    except ValueError:  # too short, or too coarse to hold a reversal
        return single(motion.omega, ""), NOT_READ
    found = features.regime[0] == str(Regime.ONE_SLIP)
    return features, int(Regime.ONE_SLIP) if found else NOT_READ


def _one_by_one(si: Mapping[str, Array], Y: Array, read: Any) -> Responses:
    arrays = {name: np.full(Y.shape, np.nan) for name in COLUMNS}
    regime = np.zeros(Y.shape, dtype=np.uint8)
    for case in range(Y.shape[1]):
        osc = Oscillator(*(float(si[name][case]) for name in ("m", "c", "k", "K_z", "F_k")))
        for level, amplitude in enumerate(Y[:, case]):
            motion = BaseMotion(Y=float(amplitude), omega=float(si["omega"][case]))
            features, regime[level, case] = read(osc, motion, case)
            for name in COLUMNS:
                arrays[name][level, case] = getattr(features, name)[0]
    return Responses(omega=si["omega"][None, :], regime=regime, **(arrays | {"Y": Y}))
