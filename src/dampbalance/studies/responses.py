"""Responses of cases that are computed one after the other, by route.

`exact` under any damping law; `fixed_step` and `sampled`: records of a scheme, or of the exact orbit; `measured`: noisy
records, as from a measurement. An exact orbit takes a microsecond, one of these milliseconds: such studies have
thousands of responses, not millions.

Noise and bootstrap come from generators seeded by (seed, number of the case, level): a case does not depend on the
chunk in which it is computed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.optimize import brentq

from ..arrays import Array
from ..balance import TERMS
from ..features import Features, of_numbers, of_orbit, side_by_side, stack, wrapped_phase
from ..identification.balance_rows import features_of
from ..identification.oscillator import CommonFit, common_fit, with_common_fit
from ..law.terms import of_harmonics
from ..model import BaseMotion, Oscillator
from ..motion.law_steady import Response, steady_response
from ..motion.orbit import NoSteadyOrbit, Orbit, steady_orbit
from ..motion.regime import Regime
from ..motion.sliders import SlidersOrbit, sliders_orbit, spread_contact
from ..records.record import Record
from ..records.synthetic import measured_orbit
from ..replication.clean import CYCLES_TO_READ, of_record
from ..replication.fixed_step import StepTooCoarse, simulate
from ..replication.record import SimulatedRecord
from ..signals.mean_harmonics import Reading, read_features
from .cases import NOT_READ, STEP_TOO_COARSE, Cases, Responses
from .parameters import of_law, oscillator_of
from .simpson import cycle_integrals, replicates_of
from .study_file import CONTACT, SIMPSON

_OF_FIT = (*TERMS, CONTACT)  # identified by the maximum-likelihood oscillator
_HARMONICS = 128  # odd ones: those beyond take 1e-9 of the work or less


def _one_by_one(
    cases: Cases, response: Callable[[Oscillator, BaseMotion, int], Features]
) -> Features:
    """Return features (L, n).   response : of an oscillator under a base motion, with the number of the case."""
    columns = []
    for case, omega in enumerate(cases.si["omega"].tolist()):
        osc, levels = oscillator_of(cases.si, case), cases.Y[:, case].tolist()
        columns.append(stack([response(osc, BaseMotion(Y, omega), case) for Y in levels]))
    return side_by_side(columns)


# --- under any damping law ---------------------------------------------------------------------------


def law_responses(cases: Cases, terms: Iterable[str]) -> Responses:
    """Return the steady responses under the damping law of each case.   terms : further terms to integrate."""
    si, terms = cases.si, list(terms)

    def response(osc: Oscillator, motion: BaseMotion, case: int) -> Features:
        law: dict[str, float] = {
            symbol: float(si[symbol][case]) for symbol in of_law(cases.values).values()
        }
        try:
            return of_response(steady_response(osc, motion, law), motion, osc.k, terms)
        except NoSteadyOrbit:
            nothing = {symbol: np.full(1, np.nan) for symbol in terms}
            return of_numbers(motion.omega, str(Regime.NOT_FOUND), integrals=nothing)

    return Responses(_one_by_one(cases, response))


def of_response(
    response: Response, motion: BaseMotion, k: float, terms: Iterable[str] = ()
) -> Features:
    """Return the features of one steady response under any law, (1,).

    motion : of the base.   k : spring to the base, N/m.   terms : symbols of the further terms to integrate.
    """
    omega, n = motion.omega, np.arange(1.0, 2.0 * _HARMONICS, 2.0)
    x = response.harmonics(_HARMONICS)
    base = np.ones(1), np.full((1, 1), complex(motion.Y))
    integrals = {s: of_harmonics(s, n, x[None], *base, omega, k) for s in ("c", *terms)}
    reversal = float(wrapped_phase(response.orbit.theta - response.advance - math.pi))

    def displacement(theta: float) -> float:
        return float((x * np.exp(1j * n * theta)).real.sum())

    # zero crossing before the reversal at +X
    upward = float(brentq(displacement, reversal - math.pi, reversal, xtol=1e-14))
    changed: dict[str, Any] = {
        "Y": np.array([motion.Y]),
        "X": response.X,
        "phi": reversal,
        "phi_reversal": reversal,
        "phi_zero_crossing": float(wrapped_phase(upward + 0.5 * math.pi)),
        "phi_fundamental": float(wrapped_phase(-np.angle(x[0]))),
        "b": integrals.pop("c"),
        "W": -math.pi * k * motion.Y * x[0].imag,
        **{f"X_{order}": abs(x[i]) for i, order in enumerate((1, 3, 5))},
    }
    if response.solution is not None and response.slips:
        X_s = 2.0 * response.orbit.oscillator.Z_m - response.X
        changed |= {"X_s": X_s, "V_s": response.V_s, "t_s": response.t_s}
        changed |= {"X_r": -X_s, "V_r": -response.V_s, "t_r": response.t_s}
        changed |= {"a": 4.0 * response.X - response.stick_travel}
    return replace(of_orbit(response.orbit), **changed, integrals=integrals)


# --- records without noise ---------------------------------------------------------------------------


def record_responses(cases: Cases, _: Iterable[str]) -> Responses:
    """Return the responses read off the records of the routes fixed_step and sampled."""
    record_of = _simulated if cases.study.route.kind == "fixed_step" else _sampled

    def read(osc: Oscillator, motion: BaseMotion, case: int) -> Features:
        try:
            record = record_of(cases, osc, motion, case)
            return of_record(record, motion.omega, osc.k, cases.study.reading)
        except StepTooCoarse:
            return of_numbers(motion.omega, STEP_TOO_COARSE)
        except NoSteadyOrbit:
            return of_numbers(motion.omega, str(Regime.NOT_FOUND))
        except ValueError:  # too short, or too coarse to contain a reversal
            return of_numbers(motion.omega, NOT_READ)

    return Responses(_one_by_one(cases, read).replaced(Y=cases.Y))


def _simulated(cases: Cases, osc: Oscillator, motion: BaseMotion, case: int) -> SimulatedRecord:
    """Return the last three cycles of those that a fixed-step scheme computes."""
    values = cases.values
    if "step_s" in values:
        step = float(values["step_s"][case])
    else:
        step = motion.period / float(values["steps_per_cycle"][case])
    if not 0.0 < step < motion.period:
        raise StepTooCoarse
    lengths = {"cycles": cases.study.cycles, "keep_cycles": CYCLES_TO_READ}
    return simulate(osc, motion, scheme=str(values["scheme"][case]), step=step, **lengths)


def _sampled(cases: Cases, osc: Oscillator, motion: BaseMotion, case: int) -> SimulatedRecord:
    """Return the exact response, sampled at sampling_hz for the cycles of the study, from ωt = 0 on."""
    orbit = steady_orbit(osc, motion)
    rate = float(cases.values["sampling_hz"][case])
    t = np.arange(int(cases.study.cycles * motion.period * rate) + 1) / rate
    state = orbit.state(t)
    return SimulatedRecord(t, motion.y(t), state.x, state.v, state.acceleration)


# --- noisy records -----------------------------------------------------------------------------------


def measured_responses(cases: Cases, _: Iterable[str]) -> Responses:
    """Return the responses, measured over the cycles of the study at sampling_hz with noise in each channel, and read.

    Each case is a separate experiment. The reader is given the stiffness k alone: frequency, amplitudes and phases are
    identified. Where a fit of the study asks for it, the signals are integrated as they are, by Simpson's rule; that
    changes no other number.
    """
    study = cases.study
    by_simpson = any(fit.approach == SIMPSON for fit in study.fits)
    seen, plain = [], []
    fitted = np.full((2, len(_OF_FIT), len(cases.numbers)), np.nan)
    for case, number in enumerate(cases.numbers.tolist()):
        osc = oscillator_of(cases.si, case)
        records = [_measured(cases, osc, case, level) for level in range(len(cases.Y))]
        random = np.random.default_rng([study.seed, number, len(cases.Y)])
        read = [record if isinstance(record, str) else record[0] for record in records]
        features, common = _with_one_oscillator(read, osc.k, study.replicates, random)
        seen.append(features)
        if common is not None and (fit := common.fit) is not None:
            fitted[0, :, case] = [*map(fit.value, TERMS), fit.K_z]
            fitted[1, :, case] = [*map(fit.error, TERMS), fit.K_z_error]
        if by_simpson:
            a, b, W = _by_simpson(records, osc.k, study.replicates, random)
            plain.append(features.replaced(a=a, b=b, W=W))
    values, errors = (dict(zip(_OF_FIT, numbers, strict=True)) for numbers in fitted)
    whole, as_they_are = side_by_side(seen), side_by_side(plain) if plain else None
    simpson = (as_they_are[..., 0], as_they_are[..., 1:]) if as_they_are else ()
    return Responses(whole[..., 0], whole[..., 1:], simpson, (values, errors))


def _measured(cases: Cases, osc: Oscillator, case: int, level: int) -> tuple[Reading, Record] | str:
    """Return the reading of one record, and the record; the reason, in words, where it cannot be read."""
    study = cases.study
    motion = BaseMotion(float(cases.Y[level, case]), float(cases.si["omega"][case]))
    random = np.random.default_rng([study.seed, int(cases.numbers[case]), level])
    rate_hz, noise = (float(cases.values[name][case]) for name in ("sampling_hz", "noise"))
    try:
        if "slip_range" in cases.values:
            slip_range = float(cases.values["slip_range"][case])
            elements = spread_contact(osc, slip_range)
            orbit: Orbit | SlidersOrbit = sliders_orbit(replace(osc, F_k=0.0), motion, *elements)
        else:
            orbit = steady_orbit(osc, motion)
    except NoSteadyOrbit:
        return str(Regime.NOT_FOUND)
    start = random.random() * motion.period  # a record begins anywhere in the cycle
    measurement = measured_orbit(
        orbit, rate_hz=rate_hz, cycles=study.cycles, noise=noise, seed=random, start=start
    )
    try:
        return read_features(measurement, osc.k), measurement
    except ValueError:  # too few samples or cycles, or nothing but noise
        return NOT_READ


def _with_one_oscillator(
    read: Sequence[Reading | str], k: float, count: int, random: np.random.Generator
) -> tuple[Features, CommonFit | None]:
    """Return features of the levels of a case and their replicates, (L, 1 + count), and the oscillator fitted to all of
    them.

    The onsets of slip are those of that oscillator, as in `identification`. A level that was not read has NaN and the
    reason; where no oscillator fits the records, no level has a friction travel.
    """
    readings = [reading for reading in read if isinstance(reading, Reading)]
    reasons = [of_numbers(np.nan, reason)[:, None] for reason in read if isinstance(reason, str)]
    parts, whole = [nothing[:, [0] * (1 + count)] for nothing in reasons], None
    if readings:
        whole = common_fit([reading.lines for reading in readings], k, departures=False)
        shared = with_common_fit(readings, whole)
        means = [each.mean.followed_by(each.resampled(count, random)) for each in shared]
        features = features_of(shared, means)
        if not whole.waveforms_hold:
            features = features.replaced(a=np.nan)
        parts = [features, *parts]
    last = [isinstance(reading, str) for reading in read]
    levels = np.argsort(np.argsort(last, kind="stable"))
    return stack(parts)[levels], whole


def _by_simpson(
    records: Sequence[tuple[Reading, Record] | str],
    k: float,
    count: int,
    random: np.random.Generator,
) -> Array:
    """Return a, b and W of the levels of a case by `studies.simpson` and their replicates, (3, L, 1 + count).

    They are NaN where the record was not read.
    """
    numbers = np.full((3, len(records), 1 + count), np.nan)
    for level, record in enumerate(records):
        if not isinstance(record, str):
            reading, measurement = record
            y, x = measurement.excitation, measurement["displacement"]
            dt = float(x.t[-1] - x.t[0]) / (len(x) - 1)
            of_cycles = cycle_integrals(y.values, x.values, dt, reading.steady.omega, k)
            numbers[:, level, 0] = of_cycles.mean(axis=-1)
            numbers[:, level, 1:] = replicates_of(of_cycles, count, random)
    return numbers


ROUTES_TO_RESPONSES = {
    "exact": law_responses,
    "fixed_step": record_responses,
    "sampled": record_responses,
    "measured": measured_responses,
}
"""Route → the responses of cases, with the further terms of the balance to integrate."""
