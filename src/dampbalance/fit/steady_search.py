"""The search for the oscillator of largest likelihood in steady records, by climbs from several starts."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..arrays import Array
from ..law.law import Law
from ..law.terms import FRICTION
from ..signals.record_harmonics import RecordHarmonics
from .climb import MOST_EVALUATIONS
from .multistart import Trail, climb_on, multistart
from .parameters import Parameters
from .starts import equivalent_coefficient, starts
from .waveforms import SHARED, STIFFEST, HarmonicProblem, WaveformFit

_STARTS = (4, 12)  # of the candidates, the closest first, and of those of more masses
_SOFTENING = (1e-2, 1e-3)  # parts of the amplitudes added to their errors: a smooth way down
_HOPELESS = 4.0  # χ² per datum, softened
_EFFORT = 600.0  # evaluations after which no other start is tried: to end where the records are takes about 40
_REFINED = 3  # of the climbs that ended far from the records, those whose ends are nearest to them
_TO_THE_END = 300  # for the nearest of all, so that its place hangs on no other start
_RINGING_SWINGS = 1.0  # swings in a stick, from which on a fit that holds is not the only one
# Of the fundamental: the residual of higher harmonics that no oscillator explains.
_FAINT = 0.01
_RESCALED, _SETTLED = 4, 0.05  # fits at most, and the change of ln of the scales of the last
# What a minimum must be lower by, in χ² and as a part of it, for a scan from there.
_LOWER, _NEARER = 0.05, 0.02


def fit_records(
    lines: Sequence[RecordHarmonics],
    k: float,
    law: Law | None = None,
    *,
    thorough: bool = True,
    near: WaveformFit | None = None,
) -> WaveformFit | None:
    """Return the oscillator of largest likelihood; None where no oscillator that slips responds like the records.

    lines : harmonics of one or more records.   k : stiffness, N/m.
    law : whose coefficients are fitted; default, F_k and c.
    thorough : whether to try more starts until a fit explains the records or the budget of evaluations is spent, then
    to search all K_z (`of_all_stiffnesses`), along which χ² oscillates where the stuck mass rings, and to climb on to
    the optimum. Choose False to learn quickly whether a fit is near.
    near : the result of a search that was not thorough, whose starts are not repeated.
    """
    problem = HarmonicProblem(law or Law(), tuple(lines), k)
    wide = (True,) if thorough and not problem.law.nonlinear else ()  # else each climb takes long
    points = (
        problem.start(candidate)
        for search in (*(False,) * (near is None), *wide)
        for candidate in starts(lines, k, problem.shares, wide=search)[: _STARTS[search]]
    )
    found = multistart(
        problem,
        points if near is None else (near.parameters, *points),
        softening=_SOFTENING,
        hopeless=_HOPELESS,
        refined=_REFINED,
        budget=_EFFORT,
        most=MOST_EVALUATIONS,
        enough=problem.explains,
    )
    best = _nearest(near, *found[:1])
    if wide and best is not None:
        best = of_all_stiffnesses(best)
    if thorough and best is not None and not (best.adequate and best.converged):
        best = _nearest(best, fit_from(problem, best.parameters, _TO_THE_END))
    return best


def fit_fundamentals(
    lines: Sequence[RecordHarmonics],
    k: float,
    law: Law | None = None,
    near: WaveformFit | None = None,
) -> WaveformFit | None:
    """Return the oscillator of largest likelihood for records whose higher harmonics no oscillator explains: their
    errors are scaled up to their residual. None where no oscillator moves like the fundamentals, or where the levels
    are too few to show whether one does.

    A second mode, or a sensor or spring that is not linear, shows first in the higher harmonics and hardly in the
    fundamental, which carries nearly all of the energy: the search starts with errors of the higher harmonics so large
    that they hardly count.   near : a fit to start from as well.
    """
    problem = HarmonicProblem(law or Law(), tuple(lines), k)
    if len(lines) <= len(problem.law.unknowns):  # their losses are then met by any law
        return None
    clear = float(np.median([abs(one.x[0]) / one.x_error[0] for one in lines]))
    problem = replace(problem, scales=(1.0, max(1.0, _FAINT * clear)))
    points = [problem.start(one) for one in starts(lines, k, problem.shares)[: _STARTS[False]]]
    found = multistart(
        problem,
        points if near is None else (near.parameters, *points),
        softening=_SOFTENING,
        hopeless=_HOPELESS,
        budget=_EFFORT,
        most=MOST_EVALUATIONS,
    )
    fit = _nearest(*found[:1])
    return fit and rescaled(fit, fundamentals=False)


def rescaled(fit: WaveformFit, *, fundamentals: bool = True) -> WaveformFit | None:
    """Return the fit with the errors of the data scaled up to its residual; None where the levels are too few to
    estimate the scales.

    fundamentals : whether the errors of the fundamentals are scaled by their own residual, too.
    """
    for _ in range(_RESCALED):
        if fit.freedoms[0] < 1.0:
            return None
        scales = fit.scales
        if not fundamentals:
            scales = (max(1.0, SHARED * scales[1]), scales[1])
        change = np.log(np.array(scales) / fit.problem.scales)
        end = fit_from(replace(fit.problem, scales=scales), fit.parameters, _TO_THE_END)
        if end is None or np.abs(change).max() < _SETTLED:
            return end
        fit = end
    return fit


def of_all_stiffnesses(fit: WaveformFit) -> WaveformFit:
    """Return the best fit along K_z, searched from a fifth to five times the K_z of a fit in steps that miss no
    minimum, and again from each fit that is closer; the fit itself where none is closer, or where the mass hardly
    swings while it sticks."""
    chi_square, left = math.inf, _EFFORT
    while fit.chi_square < (1.0 - _NEARER) * chi_square - _LOWER:
        if max(one.swings for one in fit.responses) < _RINGING_SWINGS and fit.adequate:
            break
        chi_square = fit.chi_square
        found = multistart(fit.problem, [fit.parameters], scan="rho", budget=left)
        left -= found[0].evaluations if found else 0.0
        fit = _nearest(fit, *found[:1]) or fit
    return fit


def fit_quickly(problem: HarmonicProblem, near: WaveformFit | None) -> WaveformFit | None:
    """Return the fit of a law, fast enough to compare many: from the fit of another law where that explains the
    records; else from the closest candidate of `starts`, and from the other fit, too, where that is closer.

    near : the fit of the other law, if there is one.
    """
    if near is not None and near.adequate and near.law.given == problem.law.given:
        start = problem.like(near)
        return fit_from(problem, start if near.parameters["m"].free else start.held("m"))
    candidates = starts(problem.lines, problem.k, problem.shares)[:1]
    found = multistart(
        problem,
        map(problem.start, [*candidates, *([_as_candidate(near)] if near else [])]),
        softening=_SOFTENING,
        hopeless=_HOPELESS,
        budget=_EFFORT,
        enough=lambda end: (
            problem.explains(end) or (near is not None and end.chi_square < near.chi_square)
        ),
    )
    return _nearest(*found[:1])


def _nearest(*fits: WaveformFit | None) -> WaveformFit | None:
    """Return the fit with the smallest χ², with the evaluations of all."""
    some = [one for one in fits if one is not None]
    best = min(some, key=lambda one: one.chi_square, default=None)
    return best and replace(best, evaluations=sum(one.evaluations for one in some))


def _as_candidate(fit: WaveformFit) -> Array:
    """Return (F_k, c, K_z, m) of an oscillator that loses about as much."""
    damping = math.fsum(
        fit.value(key) / equivalent_coefficient(key, fit.lines[0], fit.k)
        for key in fit.law.keys
        if key.symbol != FRICTION
    )
    rho = max(fit.rho, (STIFFEST * fit.k) ** -0.5)
    return np.array([fit.F_k, damping, rho**-2, fit.m])


def refit(
    fit: WaveformFit, free: Collection[str] = (), given: Mapping[str, float] | None = None
) -> WaveformFit | None:
    """Refit from the optimum of a fit with nuisances free, or with unknowns given; None where the oscillator has no
    motion or nothing slips.

    Use it to ask what a departure would explain: `fit.chi_square` falls by its share of χ², `value(name)` and
    `error(name)` are its size, and F_k, c and K_z those without it. What was fitted or given before stays so.

    free : names of `nuisances`, or rho and m.   given : values of common unknowns to keep from now on, by name.
    """
    given = given or {}
    start = fit.parameters.freed(*free).moved(**given).held(*given)
    if not given:
        end = fit_from(fit.problem, start)
    else:  # what is moved away from its optimum starts on a smooth way down
        most = MOST_EVALUATIONS * (1.0 + len(_SOFTENING))
        end = next(iter(multistart(fit.problem, [start], softening=_SOFTENING, budget=most)), None)
    return end and replace(end, evaluations=fit.evaluations + end.evaluations)


def fit_from(
    problem: HarmonicProblem, start: Parameters, most: int = MOST_EVALUATIONS
) -> WaveformFit | None:
    """Return the fit that a climb from a point ends in; None where it has no motion, or nothing slips.

    most : evaluations.
    """
    end = climb_on(problem, start, Trail(most), most=most)
    return None if end is None else problem.fit(end)
