"""What the fit of one oscillator to all forced records shows: departures, a wrong mass or stiffness, a contact that
sticks, records that no oscillator explains."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy import special

from ..findings.finding import Finding
from ..fit.fit import OscillatorFit
from ..fit.fundamentals import FundamentalFit
from ..fit.goodness import LinearFit
from ..fit.waveforms import WaveformFit
from ..signals.mean_harmonics import Reading
from ..signals.thresholds import P_CAUSE, SHOWS
from .answer import Answer
from .balance_check import alike, contradiction
from .causes import departure, doubts_of, hint_of, likeliest, shown_by
from .oscillator import CommonFit

_STUCK = {True: "stuck", False: "loose", None: "linear"}


def on_records(readings: Sequence[Reading], common: CommonFit) -> list[Finding]:
    """Return the findings on single records. A drive that is not harmonic spares the fit to the fundamentals where that
    leaves no more than noise, and no unit is asked for where an oscillator explains a rare ratio of amplitudes."""
    alone = common.fundamentals
    holds = alone is not None and special.chdtrc(alone.freedom, alone.chi_square) > P_CAUSE
    found = [one.about(reading.steady.source) for reading in readings for one in reading.warnings]
    explained = common.stuck is not None or common.waveforms_hold
    found = [one for one in found if not (explained and one.numbers.get("rare"))]
    harmless = {"base": "base within noise"} if holds else {}
    return [replace(one, code=harmless.get(one.code, one.code)) for one in found]


def agreement(
    readings: Sequence[Reading],
    common: CommonFit,
    direct: Answer,
) -> Iterator[Finding]:
    """Yield findings on all records together: what the common fit shows, which levels fail, where the balance by direct
    integration contradicts."""
    yield from _on_the_oscillator(readings, common)
    if still := [str(i) for i, of in enumerate(readings, 1) if of.slips is False]:
        yield Finding("only sticks", {"records": ", ".join(still)})
    fit = common.fit if common.waveforms_hold else None
    if fit is not None and not fit.interval("rho")[0] > 0.0:
        yield Finding("unresolved", effect={"K_z": math.inf})
    if {"c", "c_r"} <= {*direct.coefficients}:
        by = 1e-6 * readings[0].steady.k
        yield Finding("skewed", {"by": by}, {"c": math.inf, "c_r": math.inf})
    if fit is not None and not common.in_rows:
        yield from contradiction(direct, fit)
    yield from alike(direct)


def _on_the_oscillator(readings: Sequence[Reading], common: CommonFit) -> Iterator[Finding]:
    """Yield findings from the common fit."""
    if common.stuck is not None:
        yield Finding(_STUCK[common.stuck.sticks])
        yield from _too_stiff(readings, common.stuck, common.mass)
        return
    fit, alone = common.fit, common.fundamentals
    if common.explained:
        yield shown_by(common.explained, common.fall)
    if common.hinted and fit is not None:
        yield hint_of(common.hinted, common.fall, fit)
    if common.mass is not None and not common.mass_fits:
        by_force = any("force" in reading.steady.channels for reading in readings)
        yield on_mass(common.closest, common.mass, by_force)
    if fit is None:
        yield Finding("no oscillator")
    elif not fit.adequate and not common.explained:
        yield _none_fits(readings, fit, alone)


def _too_stiff(
    readings: Sequence[Reading], stuck: LinearFit, mass: float | None
) -> Iterator[Finding]:
    """Yield a finding where a contact that only sticks would have a stiffness below zero: the stiffness that is given
    is too high by as much at least, as a contact adds to that of the spring."""
    if stuck.contact >= -math.sqrt(SHOWS) * stuck.contact_error:
        return
    steady = readings[0].steady
    of_base = "force" not in steady.channels and steady.base_mass is None and mass is not None
    # a base that moves tells k/m, a force k itself
    left = (mass or 0.0) * stuck.by_mass if of_base else stuck.k + stuck.contact
    too_high = -stuck.contact / left if left > 0.0 else 0.0
    yield Finding("too stiff", {"too_high": too_high}, {"": too_high or math.inf})


def _none_fits(
    readings: Sequence[Reading], fit: WaveformFit, alone: FundamentalFit | None
) -> Finding:
    """Return the finding on records that no oscillator explains, whatever departure it has.

    alone : the fit to their fundamentals, whose numbers the likeliest departure moves to first order.
    """
    likely: dict[str, Any] = {}
    doubts: Mapping[str, float] = {}
    if cause := likeliest(fit):
        share = min(1.0, cause.size**2 / (fit.chi_square - fit.freedom))
        likely = {"likely": departure(cause.symbol, cause.value, cause.error), "share": share}
        # the numbers are off by the cause of most of it
        if share > 0.5 and alone is not None and not alone.has(cause.symbol):
            doubts = doubts_of(cause, fit)
    worst = readings[int(np.argmax(fit.misfits))].steady.source
    of = {"trials": fit.evaluations, "times": math.sqrt(fit.misfit), "worst": worst}
    return Finding("far from all", {**of, **likely}, doubts)


def on_mass(fit: OscillatorFit, mass: float, by_force: bool = False) -> Finding:
    """Return the finding that a mass is not that of the records, and that each number may be off by as much.

    m, c, k, K_z and F_k times a number are an oscillator of the same motion: where the mass is right, the stiffness is
    likely wrong, and all numbers by as much.

    mass : kg, as given.   by_force : whether a load cell measures what drives, and feels what is between.
    """
    ratio = mass / fit.m
    meant = tuple(
        (symbol, fit.k if symbol == "k" else mass, unit)
        for (symbol, unit), factor in _MISTAKEN.items()
        if abs(ratio / factor - 1.0) < _CLOSE
    )
    fixture = by_force and 0.5 < ratio < 1.0
    numbers = {"masses": (fit.m, mass), "fixture": fixture, "meant": meant}
    return Finding("mass", numbers, {"": abs(ratio - 1.0)})


_CLOSE = 0.03  # relative: what a gain and a mass that nobody weighed leave between two units
_MISTAKEN = {  # quantity and its unit → how many times the given number is too large a mass, or too small a stiffness
    ("k", "N/mm"): 1000.0,
    ("m", "g"): 1000.0,
    ("k", "N/cm"): 100.0,
    ("k", "kgf/m"): 9.80665,
    ("m", "N"): 9.80665,
    ("k", "kgf/mm"): 9806.65,
    ("k", "lbf/in"): 175.127,
    ("k", "lbf/ft"): 14.5939,
    ("m", "lb"): 2.20462,
    ("m", "oz"): 35.274,
}
