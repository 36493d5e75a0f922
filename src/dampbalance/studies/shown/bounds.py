"""How much of the information in noisy records an approach uses: its errors against the Cramér–Rao bound."""

from __future__ import annotations

import math

import numpy as np

from ...arrays import Integers
from ...balance import TERMS
from ...likelihood.information import cramer_rao, noise_of_rms
from ...model import BaseMotion
from ...motion.orbit import NoSteadyOrbit
from ..evaluate import case_parameters
from ..parameters import MECHANICAL, in_si, oscillator_of
from ..settings import Study


def bounds_of(study: Study, cases: Integers) -> dict[str, float]:
    """Least relative standard error, by term, that an unbiased estimate from the records of a case can have.

    cases : numbers of cases that differ only by their noise (the axis `run`). The bound takes m, k and the drive
    frequency as known and K_z as unknown. NaN where the records are not noisy ones, the cases differ in more,
    nothing slips, or the likelihood has no such term.
    """
    nothing = dict.fromkeys(TERMS, math.nan)
    if not study.route.has_intervals or not cases.size:
        return nothing
    values = case_parameters(study, int(cases.min()), int(cases.max()) + 1)
    here = {name: array[cases - cases.min()] for name, array in values.items() if name != "run"}
    if any(len(set(array.tolist())) > 1 for array in here.values()):
        return nothing
    noise = float(here["noise"][0])
    if noise == 0.0:
        return nothing
    si = in_si({name: here[name][:1].astype(float) for name in MECHANICAL if name in here})
    osc = oscillator_of(si, 0)
    Y = np.array(study.levels) * (float(si["Y"][0]) if study.levels_relative else 1.0)
    motions = [BaseMotion(Y=float(level), omega=float(si["omega"][0])) for level in Y]
    try:
        bound = cramer_rao(
            osc,
            motions,
            rate_hz=float(here["sampling_hz"][0]),
            cycles=study.cycles,
            noise=noise_of_rms(osc, motions, noise),
        )
    except (ValueError, NoSteadyOrbit, ArithmeticError):
        return nothing
    F_k, c, _ = bound.relative  # the third is K_z
    return nothing | {"F_k": F_k, "c": c}
