"""Features of responses computed one after the other: under any damping law, by fixed steps, or sampled at f_s.

An exact orbit takes a microsecond, one of these milliseconds: such studies have thousands of responses, not millions.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.optimize import brentq

from ..arrays import Array, Complexes
from ..features import Features, beside, of_numbers, of_orbit, stack, wrapped
from ..law.steady import Response, steady_response
from ..law.terms import of_harmonics
from ..model import BaseMotion, Oscillator
from ..motion.fixed_step import StepTooCoarse, simulate
from ..motion.orbit import NoSteadyOrbit, steady_orbit
from ..motion.regime import Regime
from ..project.progress import followed
from ..reading.clean import CYCLES_TO_READ, of_record
from ..record import Record
from .parameters import OF_LAW, oscillator_of
from .responses import NOT_READ, STEP_TOO_COARSE, Cases

_HARMONICS = 128  # odd ones: what lies beyond takes 1e-9 of the work or less


def _one_by_one(
    cases: Cases, response: Callable[[Oscillator, BaseMotion, int], Features]
) -> Features:
    """Features (L, n).   response : of an oscillator under a base motion, with the number of the case among these."""
    columns = []
    for case, omega in enumerate(followed(cases.si["omega"].tolist(), len(cases.numbers), "cases")):
        osc, levels = oscillator_of(cases.si, case), cases.Y[:, case].tolist()
        columns.append(stack([response(osc, BaseMotion(Y, omega), case) for Y in levels]))
    return beside(columns)


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

    return _one_by_one(cases, read).replaced(Y=cases.Y)


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


def law_responses(cases: Cases, terms: Iterable[str]) -> Features:
    """The steady responses of n cases at L levels, as features of shape (L, n).

    terms : symbols of the further terms to integrate.
    """
    si, terms = cases.si, list(terms)

    def response(osc: Oscillator, motion: BaseMotion, case: int) -> Features:
        law = {symbol: float(si[symbol][case]) for symbol in OF_LAW.values() if symbol in si}
        try:
            return of_response(steady_response(osc, motion, law), motion, osc.k, terms)
        except NoSteadyOrbit:
            nothing = {symbol: np.full(1, np.nan) for symbol in terms}
            return of_numbers(motion.omega, str(Regime.NOT_FOUND), integrals=nothing)

    return _one_by_one(cases, response)


def of_response(
    response: Response, motion: BaseMotion, k: float, terms: Iterable[str] = ()
) -> Features:
    """Features of one steady response under any law, (1,).

    motion : of the base.   k : spring to the base, N/m.   terms : symbols of the further terms to integrate.
    """
    omega, n = motion.omega, np.arange(1.0, 2.0 * _HARMONICS, 2.0)
    x = response.harmonics(_HARMONICS)
    base = np.ones(1), np.full((1, 1), complex(motion.Y))
    integrals = {s: of_harmonics(s, n, x[None], *base, omega, k) for s in ("c", *terms)}
    reversal = float(wrapped(response.orbit.theta - response.advance - math.pi))
    changed: dict[str, Any] = {
        "Y": np.array([motion.Y]),
        "X": response.X,
        "phi": reversal,
        "phi_reversal": reversal,
        "phi_zero_crossing": float(wrapped(_upward_crossing(n, x, reversal) + 0.5 * math.pi)),
        "phi_fundamental": float(wrapped(-np.angle(x[0]))),
        "b": integrals.pop("c"),
        "W": -math.pi * k * motion.Y * x[0].imag,
        **{f"X_{order}": abs(x[i]) for i, order in enumerate((1, 3, 5))},
    }
    if response.change is not None and response.slips:
        X_s = 2.0 * response.orbit.oscillator.Z_m - response.X
        changed |= {"X_s": X_s, "V_s": response.V_s, "t_s": response.t_s}
        changed |= {"X_r": -X_s, "V_r": -response.V_s, "t_r": response.t_s}
        changed |= {"a": 4.0 * response.X - response.taken}
    return replace(of_orbit(response.orbit), **changed, integrals=integrals)


def _upward_crossing(n: Array, x: Complexes, reversal: float) -> float:
    """Phase ωt of the upward zero crossing that precedes the reversal at +X, rad."""

    def displacement(theta: float) -> float:
        return float((x * np.exp(1j * n * theta)).real.sum())

    return float(brentq(displacement, reversal - math.pi, reversal, xtol=1e-14))
