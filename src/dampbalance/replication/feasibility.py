"""Checks, before anything runs, whether a configuration can be simulated: those that need the mechanics."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from pathlib import Path

from ..motion.orbit import MOST_EVENTS, RANGES, NoSteadyOrbit, steady_orbit
from ..project.case import Case
from ..project.documents import Problem, refuse
from .authors_route import printed_coefficients
from .clean import CYCLES_TO_READ
from .fixed_step import MIN_STICK_SAMPLES, MOST_STEPS, largest_growth

MOST_SAMPLES_KEPT = 5_000_000
"""Most samples kept of all levels at one frequency, 0.5 GB of memory; the paper's case has up to 0.9 million."""

FEWEST_PER_CYCLE = 100
"""Steps in a period below which neither a reversal nor a slip onset is resolved."""


def check_feasible(case: Case, files: Iterable[str | Path]) -> list[str]:
    """Check the numbers of a case, then each of its exact orbits.

    files : of the configuration, so that a message can name the line of a key.

    Returns a notice for each response without slip: it has no slip features, and is left out of the estimates.
    Raises ConfigurationError for numbers outside of RANGES, more steps than can be simulated, a step that is too coarse
    for its scheme or for the shortest stick phase, or a response that has no steady orbit.
    """
    for key, text in (*_out_of_range(case), *_wrong_steps(case)):
        refuse(key, text, files)
    notices = []
    shortest, where = math.inf, ""
    for i, (frequency, hz) in enumerate(case.frequencies_hz.items()):
        for motion in case.motions(frequency):
            place = f"{frequency} ({hz:g} Hz), Y = {motion.Y:g} m"
            try:
                orbit = steady_orbit(case.oscillator, motion)
            except NoSteadyOrbit as error:
                refuse(("excitation", "frequencies", i, "hz"), f"{place}: {error}", files)
            spent = orbit.a * case.oscillator.F_k + orbit.b * case.oscillator.c
            if math.isnan(orbit.t_s):
                notices.append(
                    f"{place}: {orbit.regime}. It has no slip features; estimates leave it out."
                )
            elif abs(spent - orbit.W) > 1e-6 * spent:  # rounding
                text = f"{place}: rounding spoils the energy balance; take more damping or friction"
                refuse(("oscillator",), text, files)
            elif orbit.t_s < shortest:
                shortest, where = orbit.t_s, place
    step, most = case.numerics.step_s, shortest / MIN_STICK_SAMPLES
    if step > most:
        text = f"{step:g} s is too coarse: the stick phase at {where} lasts {shortest:.3g} s and needs "
        text += f"{MIN_STICK_SAMPLES} steps; take at most {0.95 * most:.2g}"
        refuse(("as_published", "step_s"), text, files)
    return notices


def _out_of_range(case: Case) -> Iterator[Problem]:
    """Yield the numbers that are outside the ranges in which the exact solution is known to hold."""
    osc = case.oscillator
    ratios = [case.omega(name) / osc.omega_n for name in case.frequencies_hz]
    K_z: tuple[str, ...] = ("oscillator", "K_z_N_per_m")
    for name, key, values in (
        ("zeta", ("oscillator", "c_N_s_per_m"), [osc.zeta]),
        ("K_z_over_k", K_z, [osc.K_z / osc.k]),
        ("omega_over_omega_n", ("excitation", "frequencies"), ratios),
        ("F_k_over_kY", ("oscillator", "F_k_N"), [osc.F_k / (osc.k * Y) for Y in case.levels_m]),
    ):
        low, high = RANGES[name]
        for value in (value for value in values if not low <= value <= high):
            bounds = f"the exact solution holds from {low:g} to {high:g}"
            yield key, f"makes {name} {value:.3g}; {bounds}"
    events = math.sqrt(1.0 + osc.K_z / osc.k) / min(ratios)
    if events > MOST_EVENTS:
        text = f"sets the natural frequency on the contact at {events:.3g} times that of the drive"
        yield K_z, f"{text}; {MOST_EVENTS:g} at most can be solved"


def _wrong_steps(case: Case) -> Iterator[Problem]:
    """Yield the settings with which the fixed-step simulation would take too long, or fail."""
    numerics, osc, levels = case.numerics, case.oscillator, len(case.levels_m)
    step = ("as_published", "step_s")
    coarsest = 1.0 / (max(case.frequencies_hz.values()) * FEWEST_PER_CYCLE)
    if numerics.step_s > coarsest:
        text = f"{numerics.step_s:g} s leaves fewer than {FEWEST_PER_CYCLE} steps in a period"
        yield step, f"{text}; take at most {coarsest:.2g}"
    per_cycle = 1.0 / (min(case.frequencies_hz.values()) * numerics.step_s)
    for what, key, cycles, most in (
        ("samples", step, CYCLES_TO_READ, MOST_SAMPLES_KEPT),
        ("steps", ("as_published", "cycles"), numerics.cycles, MOST_STEPS),
    ):
        if levels * cycles * per_cycle > most:
            text = f"asks for {levels * cycles * per_cycle:.3g} {what} at the lowest frequency"
            remedy = f"{most:.0e} at most can be held: fewer cycles or levels, or a longer step"
            yield key, f"{text}; {remedy}"
    for name, value in printed_coefficients(case).items():
        if value <= 0.0:
            text = f"rounds {name} to zero; keep more decimals, or all (null)"
            yield ("as_published", f"{name}_decimals"), text
    # A scheme is unstable if it lets a decaying motion grow: in slip over all cycles, in stick over one at most.
    for phase, K_z, cycles in (("slip", 0.0, numerics.cycles), ("stick", osc.K_z, 1)):
        growth = largest_growth(
            numerics.scheme,
            numerics.step_s,
            **printed_coefficients(case),
            contact_over_m=K_z / osc.m,
        )
        # a scheme may let an oscillation grow tenfold that the equations let decay
        if cycles * per_cycle * math.log(growth) > math.log(10.0):
            text = f"{numerics.step_s:g} s makes {numerics.scheme} unstable in {phase}"
            yield step, f"{text}; take a smaller step, or backward-euler"
            return
