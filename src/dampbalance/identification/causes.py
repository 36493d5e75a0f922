"""Departures of records from one oscillator as candidates to be weighed: their names, and their sizes in rigs.

A departure is a nuisance of the model (`fit/nuisances.py`), zero unless it is freed, or the other frame: motions
relative to the base that were taken for absolute, or the other way round. A score test (`fit/score.py`) shows to first
order how much of the residual each explains, and `fit/select.py` weighs them; those with some weight are fitted.

One departure is special. A contact that yields gradually has nearly the harmonics of one that yields at once with
another stiffness, so that χ² hardly changes. What does change has one direction, which all such contacts nearly share,
and one sign: this is what the records show best. Iwan's contact with a uniform distribution, whose corner is a
parabola, stands for those of Dahl, Bouc–Wen and several sliders.
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
"""Departures that turn the phase of the response, as damping does away from resonance."""

GRADUAL = ADDED[-1]
"""The departure that hardly shows: see above."""

FRAME = "frame"

NOT_IN_ROWS = frozenset({"k_3", GRADUAL})
"""Departures that do not act on the rows of the balance."""

_MOST = 3.5
"""Times the size that rigs have: a departure that is larger by more than its standard error stands for another
cause."""


def doubts_of(selection: Selection, *names: str) -> Mapping[str, float]:
    """Return the relative errors that numbers may have by departures that the fit may mistake.

    What looks like a gain may be a second mass or a flexible support, which only the higher harmonics distinguish from
    one, and F_k is in proportion to a gain; this concerns no response that is measured against the base. After a
    reversal, a contact that yields gradually has the stiffness of Iwan's contact only if it is one.

    names : of the departures that are reported.
    """
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
    """Yield a finding for each turn of the phase that the records support and that may change a number by half or more,
    where no oscillator has the higher harmonics, which would distinguish it from damping."""
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
    """Return the delay of the response with the size of the damper that it may be, where the law lacks that damper.

    A damper between base and mass adds c_r ẏ to k y and so acts like a lead of the base by τ = c_r/k, since
    k y(t + τ) = k y + kτ ẏ + …. If the law has only this damper, one to the ground acts like a lag of c/k. On a mount,
    which is driven by −mÿ, a damper to the ground acts like a lag of c/(mω²).
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
    """Return, for each departure, the unit of its size in `PRIORS` as a value in the unit of the departure."""
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

    names : of those that it has.   penalty : χ² that a given mass adds to a fit.   starts : by name, a fit from which
    that departure is searched as well.   frames : whether the response may be in the other frame.
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

    # a departure that explains less than a tenth of the excess over noise is not why the fit fails
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
        # where the other frame is right, the nearest starts lead to it, without a wide search
        others = [in_other_frame(one) for one in fit.lines]
        search = partial(fit_records, others, fit.k, fit.law, thorough=False)
        found.append(Candidate(FRAME, PRIORS[FRAME], search, None, partial(weighed, FRAME)))
    return found


def _too_large(value: float, error: float, name: str, units: Mapping[str, float]) -> bool:
    """Return whether a departure is larger than rigs have it.   units : of `sizes_in`."""
    return abs(value) - error > _MOST * PRIORS[name].size * units[name]


def _converged(fit: WaveformFit | None) -> WaveformFit | None:
    """Return the fit after up to three further climbs, which end at an optimum or far from the records."""
    for _ in range(3):
        if fit is None or fit.converged:
            break
        before, fit = fit, refit(fit)
        # four times the noise squared, the bound at which a search abandons a start
        if fit is not None and fit.misfit > 4.0 and fit.chi_square > 0.5 * before.chi_square:
            break
    return fit


def _with(fit: WaveformFit, name: str) -> WaveformFit | None:
    """Return the fit with a departure left free.

    A turn of the phase trades with c and m along a valley of χ² that is narrow and curved, in which a climb from zero
    crawls. It therefore begins with the turn of the score test, or the part of it that leaves each coefficient a tenth.
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
