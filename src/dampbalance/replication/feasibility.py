"""Whether a configuration can be simulated as it stands: what only the mechanics can tell, before anything runs."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path

from ..model import BaseMotion, Oscillator
from ..motion.fixed_step import MIN_STICK_SAMPLES
from ..motion.jit import interpreted
from ..motion.orbit import NoSteadyOrbit, Orbit, steady_orbit
from ..project.case import Case
from ..project.documents import refuse


def check_feasible(case: Case, files: Iterable[str | Path]) -> list[str]:
    """Look at every exact orbit of a case.   files : the configuration's, to say where a key stands.

    Returns a notice for each response without slip: it has no slip features, and is left out of the estimates.
    Raises ConfigurationError for a step that is too coarse for the shortest stick phase, or a response that has no
    steady orbit.
    """
    notices = []
    shortest, where = math.inf, ""
    for i, (frequency, hz) in enumerate(case.frequencies_hz.items()):
        for motion in case.motions(frequency):
            place = f"{frequency} ({hz:g} Hz), Y = {motion.Y:g} m"
            try:
                orbit = _orbit(case.oscillator, motion)
            except NoSteadyOrbit as error:
                refuse(("excitation", "frequencies", i, "hz"), f"{place}: {error}", files)
            if math.isnan(orbit.t_s):
                notices.append(
                    f"{place}: {orbit.regime}. It has no slip features; estimates leave it out."
                )
            elif orbit.t_s < shortest:
                shortest, where = orbit.t_s, place
    step = case.numerics.step_s
    if shortest < MIN_STICK_SAMPLES * step:
        refuse(
            ("as_published", "step_s"),
            f"{step:g} s is too coarse: the stick phase at {where} lasts {shortest:.3g} s "
            f"and needs {MIN_STICK_SAMPLES} steps; take at most {0.95 * shortest / MIN_STICK_SAMPLES:.2g}",
            files,
        )
    return notices


def _orbit(osc: Oscillator, motion: BaseMotion) -> Orbit:
    """The exact orbit, by Python as far as that goes: a handful takes less time than loading what is compiled."""
    try:
        with interpreted():
            orbit = steady_orbit(osc, motion)
            if math.isfinite(orbit.X):  # the features are computed with it
                return orbit
    except (ArithmeticError, ValueError):  # an overflow, say, where machine code goes on with ∞
        pass
    return steady_orbit(osc, motion)
