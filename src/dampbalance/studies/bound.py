"""The smallest standard errors that records allow: the Cramér–Rao bound of the harmonics of an oscillator."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from ..fit.steady_search import fit_from
from ..fit.waveforms import HarmonicProblem, WaveformFit
from ..law.law import Law
from ..model import BaseMotion, Oscillator
from ..motion.orbit import steady_orbit
from ..signals.one_thread import one_thread
from ..signals.record_harmonics import RecordHarmonics

_HARMONICS_OF_TRUTH = 64  # odd ones: the derivatives of the response by ρ fall as n⁻³


@one_thread
def fit_at_truth(
    osc: Oscillator,
    motions: Sequence[BaseMotion],
    errors: Sequence[tuple[float, float]],
    given: Collection[str] = ("m",),
) -> WaveformFit | None:
    """Return the fit to the exact harmonics of an oscillator, at its own values; None where nothing slips.

    Use its standard errors to judge how much of the information in records of base displacement and displacement an
    estimate uses: no unbiased estimate has a smaller covariance (the Cramér–Rao bound; Kay, *Fundamentals of
    Statistical Signal Processing: Estimation Theory*, 1993, chapter 3), as harmonics hold all the information on a
    steady motion. Unknown offsets and an unknown noise do not change it: their information is orthogonal.

    motions : one per record; frequencies may differ.
    errors : standard errors of |Y| and of the real and the imaginary part of each harmonic of x, m, for each record:
    σ√(2/n) of n samples with white noise σ, over whole cycles or many.
    given : names of common unknowns that are known.
    """
    n = np.arange(1, 2 * _HARMONICS_OF_TRUTH, 2)
    lines = []
    for motion, (Y_error, x_error) in zip(motions, errors, strict=True):
        x = steady_orbit(osc, motion).harmonics(_HARMONICS_OF_TRUTH)
        lines.append(
            RecordHarmonics(motion.omega, motion.Y, Y_error, n, x, np.full(n.size, x_error), 1)
        )
    law = Law(given={s: getattr(osc, s) for s in ("F_k", "c") if s in given})
    problem = HarmonicProblem(law, tuple(lines), osc.k)
    truth = problem.start(np.array([osc.F_k, osc.c, osc.K_z, osc.m]))
    return fit_from(problem, truth.held(*given), most=1)
