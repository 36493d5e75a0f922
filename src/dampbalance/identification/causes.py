"""Departures of records from one oscillator as candidates to be weighed: what they are called, and how large rigs have
them.

A departure is a nuisance of the model (`fit/nuisances.py`), zero unless it is freed, or the other frame: motions
relative to the base that were taken for absolute, or the other way round. A score test (`fit/score.py`) says to first
order what each explains of what a fit leaves, and `fit/select.py` weighs them; those of some weight are fitted.

One departure is special. A contact that yields gradually has nearly the harmonics of one that yields at once, with
another stiffness: of what lies between, little more than the loss while it yields shows in a record. The sum of the
squares of the residuals hardly notices; the one direction in which such a contact differs, and the one sign, tell the
most. All such contacts nearly share it: that of Iwan with a uniform distribution, whose corner is a parabola, stands
for those of Dahl, Bouc–Wen and several sliders.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from ..findings.finding import UNBOUNDED, Finding
from ..fit.fit import OscillatorFit
from ..fit.nuisances import in_other_frame, units_of
from ..fit.score import Departure
from ..fit.select import PRIORS, Candidate, Prior, Selection, bayes_factor
from ..fit.steady_search import fit_from, fit_records, refit
from ..fit.waveforms import WaveformFit
from ..motion.law_decays import ADDED
from ..signals.mean_harmonics import Reading
from .weighing import departure, weighed_of

TURNS = ("corner", "delay")
"""Departures that turn the phase of the response: away from resonance, damping does so, too."""

GRADUAL = ADDED[-1]
"""The departure that hardly shows: see above."""

FRAME = "frame"

NOT_IN_ROWS = frozenset({"k_3", GRADUAL})
"""Departures that rows of the balance, which take the records as they are, do not have."""

_MOST = 3.5
"""Of the size that rigs have: what is larger by its standard error stands for something else."""


def doubts_of(selection: Selection, *names: str) -> Mapping[str, float]:
    """Return relative errors that numbers may have by departures without a trace in the fit: F_k is in proportion to
    the size of the motion, which no gain of a relative response asks for, and a second mass or a flexible support,
    which only the higher harmonics distinguish from the mass, looks like a gain and is none; a contact that yields
    gradually is after a reversal as stiff as that of Iwan only if it is one."""
    fit, doubts = selection.fit, dict[str, float]()
    said = [one for one in weighed_of(selection) if one.name in names]
    sizes, units = {one.name: abs(one.size) for one in said}, sizes_in(fit)
    for one in said:
        if one.name in units and not fit.holds and _too_large(one.size, one.error, one.name, units):
            return UNBOUNDED
    if "gain" in sizes and not any(one.of_base for one in fit.lines):
        doubts = dict.fromkeys(fit.law.unknowns, sizes["gain"])
    if GRADUAL in sizes:
        doubts["K_z"] = min(sizes[GRADUAL], 1.0)
    return doubts


def unseen_turns(selection: Selection) -> Iterator[Finding]:
    """Yield a finding for each turn of the phase that the records rather have, and that may take half of a number or
    more, where the harmonics, which would tell it from damping, are not those of the oscillator."""
    plain, keys = selection.models[0], selection.fit.law.unknowns
    if max(selection.fit.problem.scales) == 1.0:
        return
    for one, weight in zip(selection.models, selection.weights, strict=True):
        by = one.values - plain.values
        spread = np.sqrt(by**2 + np.maximum(np.diag(one.covariance - plain.covariance), 0.0))
        parts = zip(selection.keys, (spread / np.abs(plain.values)).tolist(), strict=False)
        effect = {key: part for key, part in parts if key in keys and part > 0.5}
        if one.name in TURNS and effect and one.evidence > 0.0:
            what = (departure(one.name, *one.size),)
            yield Finding("weighs", {"what": what, "weight": weight, "clear": False}, effect)


def as_damper(selection: Selection, readings: Sequence[Reading]) -> dict[str, Finding]:
    """Return the delay of the response, where that may be a damper which the law lacks, with the size of that damper.

    The force c_r ẏ of a damper between base and mass, next to k y, is that of a base which leads by τ = c_r/k, as
    k y(t + τ) = k y + kτ ẏ + …; where the law has this damper alone, one to the ground is a lag of c/k. On a mount,
    which the force −mÿ moves, a damper to the ground is a lag of c/(mω²).
    """
    fit, steady = selection.fit, readings[0].steady
    terms, mount = fit.law.terms, steady.base_mass is not None
    one = next((one for one in weighed_of(selection) if one.name == "delay"), None)
    ground = mount or "c" not in terms
    if one is None or "force" in steady.channels or (one.size > 0.0) != ground:
        return {}
    factor = fit.m * steady.omega**2 if mount else fit.k
    found = departure(one.name, one.size, one.error)
    law = "" if mount else ",".join((*terms, "c" if ground else "c_r"))
    more = {"damper": (factor * abs(one.size), factor * one.error), "ground": ground, "law": law}
    return {one.name: replace(found, numbers={**found.numbers, **more})}


def sizes_in(fit: WaveformFit) -> dict[str, float]:
    """Return the unit in which `PRIORS` has the size of each departure, in the unit of that departure."""
    lines = fit.lines
    top = max(lines, key=lambda one: abs(one.x[0]))
    X, slowest = float(abs(top.x[0])), min(one.omega for one in lines)
    units = units_of(fit.k, slowest, X, top.Y)
    c = max(fit.c, fit.error("c")) if "c" in fit.parameters else units["c_2"] * top.omega * X
    of_samples = max(one.interval for one in lines)
    return {**units, "delay": of_samples, "c_2": c / (top.omega * X)}


def candidates(
    fit: WaveformFit,
    names: tuple[str, ...] = (),
    *,
    penalty: Callable[[WaveformFit], float],
    starts: Mapping[str, WaveformFit] | None = None,
    frames: bool = False,
) -> list[Candidate]:
    """Return the departures that a fit may lack.

    names : of those that it has.   penalty : χ² that a mass which is given adds to a fit.   starts : fits from whose
    unknowns those of a departure are to be searched, by name.   frames : whether the response may be in the other
    frame.
    """
    units, starts = sizes_in(fit), starts or {}
    own = fit.chi_square + penalty(fit)

    def weighed(name: str, end: WaveformFit) -> float:
        """Return ln of the Bayes factor of a fit."""
        fall = own - end.chi_square - penalty(end)
        if name == FRAME:
            return 0.5 * fall
        value, error = end.value(name), end.error(name)
        if not end.holds and _too_large(value, error, name, units):
            return -math.inf
        return bayes_factor(value, error, prior_of(name), fall)[0]

    def prior_of(name: str) -> Prior:
        return PRIORS[name]._replace(size=PRIORS[name].size * units[name])

    def fitted(name: str) -> WaveformFit | None:
        start = starts.get(name)
        ends = [_with(fit, name), start and fit_from(fit.problem, start.parameters)]
        found = [end for one in ends if (end := _converged(one)) is not None]
        return min(found, key=lambda one: one.chi_square, default=None)

    # what explains less than a tenth of what noise does not is not why the fit fails
    as_read = max(fit.problem.scales) == 1.0 and not fit.adequate
    excess = 0.1 * (fit.chi_square - fit.freedom) if as_read else 0.0
    tested = {name: one for name, one in fit.departures.items() if one.size**2 >= excess}
    # a damper to the base and one to the ground together make up for any delay
    barred = {"delay"} if {"c", "c_r"} <= set(fit.law.unknowns) else set()
    found = [
        Candidate(name, prior_of(name), partial(fitted, name), one, partial(weighed, name))
        for name, one in tested.items()
        if name not in (*names, *barred, *([GRADUAL] if max(fit.problem.scales) > 1.0 else []))
    ]
    if frames:
        # where it holds, the nearest starts lead there: no wide search for what most records are not
        others = [in_other_frame(one) for one in fit.lines]
        search = partial(fit_records, others, fit.k, fit.law, thorough=False)
        found.append(Candidate(FRAME, PRIORS[FRAME], search, None, partial(weighed, FRAME)))
    return found


def _too_large(value: float, error: float, name: str, units: Mapping[str, float]) -> bool:
    """Return whether a departure is larger than rigs have it.   units : of `sizes_in`."""
    return abs(value) - error > _MOST * PRIORS[name].size * units[name]


def _converged(fit: WaveformFit | None) -> WaveformFit | None:
    """Return the fit that further climbs lead to, until one ends in an optimum: one that takes more than three is no
    guide, nor is one that stays far from the records."""
    for _ in range(3):
        if fit is None or fit.converged:
            break
        before, fit = fit, refit(fit)
        # four times the noise squared, as where a search gives a start up
        if fit is not None and fit.misfit > 4.0 and fit.chi_square > 0.5 * before.chi_square:
            break
    return fit


def _with(fit: WaveformFit, name: str) -> WaveformFit | None:
    """Return the fit with a departure left free.

    The turn of a phase trades with c and m along a valley of χ² that is as narrow as the noise and curved, in which a
    climb from no turn crawls: it begins at the oscillator that has the turn of the score test, or what of it leaves
    each coefficient a tenth.
    """
    if name not in TURNS:
        return refit(fit, [name])
    one = fit.departures[name]
    falls = [-changes(one, fit, one.value).get(key, 0.0) for key in fit.law.unknowns]
    near = refit(fit, given={name: one.value / max(1.0, *(fall / 0.9 for fall in falls))})
    return refit(near if near is not None and near.chi_square < fit.chi_square else fit, [name])


def changes(one: Departure, fit: OscillatorFit, value: float) -> dict[str, float]:
    """Return the relative change of the numbers of a fit with a coefficient of this value, by symbol."""
    parts = {s: by * value / (fit.value(s) or 1.0) for s, by in one.slopes.items()}
    if "rho" in parts:
        # after a reversal the contact is as much stiffer as its corner is rounded
        parts["K_z"] = -2.0 * parts.pop("rho") + (value if one.symbol == GRADUAL else 0.0)
    return parts
