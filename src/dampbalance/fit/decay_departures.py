"""What free decays may have beyond one friction force, viscous damping and a linear spring: candidates to be weighed.

Each of `decay.FURTHER` is a candidate, with the size in which rigs have it (`select.PRIORS`). A score test says to
first order what each explains of what a fit leaves, and `select.select` fits those of some weight. The noise is what
each model leaves in the band of the fit: with ν degrees of freedom, an unknown of t standard errors raises the
logarithm of the likelihood by ½ ν ln(1 + t²/ν).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from functools import partial

import numpy as np

from .decay import CORNER, FALLS, FRICTION_FORCE, FURTHER, SHARED, DecayFit, with_noise_of
from .fit import OscillatorFit
from .multistart import climbs
from .parameters import Parameters
from .score import Departure, departures_from
from .select import (
    PRIORS,
    REFITTED,
    Candidate,
    Prior,
    Selection,
    bayes_factor,
    evidence_of,
    select,
)

NUMBERS = ("F_k", "c", "rho", "m")
"""The numbers of an answer."""

FALLING, SPEED, GRADUAL, FADING = "falling", "falling_speed", "gradual", "fading"
FRICTIONS = "frictions"
"""A friction force for each decay."""


def departures_of(fit: DecayFit) -> list[Departure]:
    """Test what each of `FURTHER` that is not free would explain in the band of the fit; empty where the motion cannot
    be followed. A friction that falls with the speed, or grows, has that of `FALLS` at which it explains most."""
    free, top = {*fit.further, SPEED}, fit.problem.speed(fit.point)
    if any(one.of_cycles for one in fit.decays):  # of excerpts each has a friction force
        free.add(FADING)
    found = {one.symbol: one for one in _tested(fit, [s for s in FURTHER if s not in free])}
    for part in FALLS[1:] if FALLING in found else ():
        at = fit.parameters.moved(falling_speed=part * top)
        for one in _tested(replace(fit, parameters=at), [FALLING]):
            found[FALLING] = max(found[FALLING], one, key=lambda of: abs(of.size))
    return [*found.values()]


def _tested(fit: DecayFit, symbols: Iterable[str]) -> list[Departure]:
    """Test what some of `FURTHER` would explain."""
    problem, parameters = replace(fit.problem, slips=fit.slips), fit.parameters
    whole = problem.columns(fit.point, added=True)
    if not np.isfinite(whole).all():
        return []
    # of several friction forces, by their mean and by the others' distance from the first
    first, *others = [i for i, name in enumerate(parameters.names) if name == FRICTION_FORCE]
    first_force = whole[:, [first]]
    whole[:, [first]] += whole[:, others].sum(axis=1, keepdims=True)
    whole[:, others] -= first_force
    moving = parameters.free & (np.abs(whole[:, :-1]).max(axis=0) > 0.0)
    shared = [i for i, name in enumerate(parameters.names) if name in SHARED and i not in others]
    own = [*filter(moving.__getitem__, shared)]
    names = [parameters.names[i] for i in own]
    own += [i for i in np.flatnonzero(moving).tolist() if i not in own]
    added = {s: whole[:, parameters.places[s]] for s in symbols}
    return departures_from(
        whole[:, -1], whole[:, own], added, names, noise_known=False, freedom=fit.freedom
    )


def weighed(fit: DecayFit) -> Selection:
    """Return the models of decays with their weights: the plain one, and those of each of `FURTHER`.

    fit : where a search ended, with or without further coefficients.
    """
    none = dict.fromkeys(fit.further, 0.0)
    start = fit.parameters.held(*none).moved(**none)
    plain = with_noise_of(_with_frictions(fit, start, own=False) or fit)

    def further(end: DecayFit, _: tuple[str, ...] = ()) -> list[Candidate]:
        return candidates(end, fit)

    return select(plain, further(plain), NUMBERS, further=further)


def _with_frictions(fit: DecayFit, start: Parameters, *, own: bool) -> DecayFit | None:
    """Return the fit with one friction force, or one for each decay."""
    decays = (replace(one, friction=one.label if own else "") for one in fit.decays)
    problem = replace(fit.problem, decays=tuple(decays))
    values = {FRICTION_FORCE: fit.F_k, **start.by_key}
    free = (one.name for one in start if one.free)
    return problem.climb(problem.parameters(values, free))


def candidates(fit: DecayFit, near: DecayFit) -> list[Candidate]:
    """Return the further coefficients that a fit may lack.   near : a fit that may have some, to start from as well."""
    sizes = sizes_in(fit)
    found = []
    for one in (_in_noise(one, fit) for one in departures_of(fit)):
        prior = PRIORS.get(f"{one.symbol} in decays") or PRIORS[one.symbol]
        prior = prior._replace(size=prior.size * sizes[one.symbol])
        # what shows by itself is fitted, whatever explains more: far from a model the first order does not compare
        shows = bayes_factor(one.value, one.error, prior)[0] > -math.log(REFITTED)
        # of what the decays do not show a fit would know less than is known beforehand
        hidden = one.error > prior.size
        fitted = (lambda: None) if hidden else partial(_fitted, fit, one.symbol, near)
        evidence = partial(_evidence, fit, one.symbol, prior)
        tested = None if shows and not hidden else one
        found.append(Candidate(one.symbol, prior, fitted, tested, evidence))
    if len(fit.decays) > 1 and fit.frictions.size == 1:
        fitted = partial(_own_frictions, fit, near)
        evidence = partial(_of_frictions, fit)
        found.append(Candidate(FRICTIONS, PRIORS[FRICTIONS], fitted, evidence=evidence))
    return found


def _own_frictions(fit: DecayFit, near: DecayFit) -> DecayFit | None:
    """Return the fit with a friction force for each decay, in the noise that it leaves."""
    starts = [fit.parameters, *([_without(near, fit)] if near.frictions.size > 1 else [])]
    return _lowest(_with_frictions(fit, start, own=True) for start in starts)


def _without(near: DecayFit, fit: DecayFit, *but: str) -> Parameters:
    """Return the unknowns of a fit without the further coefficients that another one does not have.   but : that stay
    all the same."""
    none = dict.fromkeys([s for s in near.further if s not in (*fit.further, *but)], 0.0)
    return near.parameters.held(*none).moved(**none)


def _lowest(ends: Iterable[DecayFit | None]) -> DecayFit | None:
    """Return the closest fit, in the noise that it leaves; None where there is none."""
    end = min(filter(None, ends), key=lambda one: one.chi_square, default=None)
    return None if end is None else with_noise_of(end)


def _of_frictions(plain: DecayFit, end: DecayFit) -> float:
    """Return ln of the Bayes factor of a friction force for each decay, by the n − 1 distances from the mean."""
    n = end.frictions.size
    contrasts = np.linalg.qr(np.column_stack([np.ones(n), np.eye(n)[:, 1:]]))[0][:, 1:]
    forces = [one.key(FRICTION_FORCE) for one in end.decays]
    C = contrasts.T @ OscillatorFit.covariance_of(end, *forces) @ contrasts
    v, size = contrasts.T @ end.frictions, PRIORS[FRICTIONS].size * plain.F_k
    return evidence_of(gain_of(end, plain), v, C, size, positive=False)


def sizes_in(fit: DecayFit) -> dict[str, float]:
    """Return the unit in which `PRIORS` has the size of each coefficient, in the unit of that coefficient."""
    omega = math.sqrt(fit.k / fit.m)
    v = fit.problem.speed(fit.point)
    X, F_k = v / omega, max(fit.F_k, fit.error("F_k"))
    # a damper with the loss of a cycle at X
    c = fit.c + 4.0 * F_k / (math.pi * v)
    units = {"k_3": fit.k / X**2, "c_2": c / v, FALLING: F_k, CORNER: omega / (2.0 * math.pi)}
    return units | {FADING: 1.0, GRADUAL: 1.0}


def _in_noise(one: Departure, fit: DecayFit) -> Departure:
    """Return a departure with the error with which it has the weight of a noise that is known, and a contact that
    yields gradually with its stiffness after a reversal."""
    slopes, nu = dict(one.slopes), fit.freedom
    if one.symbol == GRADUAL and "rho" in slopes:
        slopes["rho"] -= 0.5 * fit.value("rho")
    gain = nu * math.log1p(one.size**2 / nu)
    error = abs(one.value) / math.sqrt(gain) if gain > 0.0 else one.error
    return replace(one, error=error, slopes=slopes)


def _fitted(fit: DecayFit, name: str, near: DecayFit) -> DecayFit | None:
    """Return the fit with one further coefficient, in the noise that it leaves; None where no climb leads to one. The
    speed over which friction falls is searched from several ones."""
    problem = replace(fit.problem, slips=fit.slips)
    starts = [fit.parameters.freed(name)]
    if name == FALLING:
        top = problem.speed(fit.point)
        starts = [starts[0].moved(falling_speed=part * top) for part in FALLS]
        # a force that is rounded in speed is far from one that is not
        starts += [start.moved(falling=-0.5 * fit.F_k) for start in starts[:1]]
    if name in near.further:
        starts.append(_without(near, fit, name, SPEED))
    if len(starts) > 1:
        starts = [one.parameters for one in climbs(problem.thinned(), starts)[:1]]
    if name == FALLING:
        starts = [one.freed(SPEED) for one in starts]
    return _lowest(map(problem.climb, starts))


def _evidence(plain: DecayFit, name: str, prior: Prior, end: DecayFit) -> float:
    """Return ln of the Bayes factor of a fit with one further coefficient."""
    error = end.error(name)
    if not error > 0.0:
        return -math.inf
    return bayes_factor(end.value(name), error, prior, gain_of(end, plain))[0]


def gain_of(end: DecayFit, plain: DecayFit) -> float:
    """Return 2 ln of the ratio of the likelihoods of two fits to the same samples, each in the noise that it leaves."""
    pairs = zip(end.residuals(), plain.residuals(), strict=True)
    logs = (
        r.size * math.log(before.noise / after.noise) for (_, after, r), (_, before, _) in pairs
    )
    of_noise = 2.0 * math.fsum(logs) * plain.freedom / plain.problem.samples
    return of_noise + plain.chi_square - end.chi_square


def as_pendulum(fit: DecayFit) -> bool:
    """Return whether decays are those of a pendulum rather than of a mass on a spring, linear or with k_3.   fit : of a
    pendulum."""
    problem, here = replace(fit.problem, pendulum=False), fit.parameters
    spring = problem.climb(here)
    if spring is None:
        return True
    softer = here.freed("k_3").moved(k_3=fit.value("k_3") - fit.k / 6.0)  # of k sin θ
    size = PRIORS["k_3"].size * sizes_in(fit)["k_3"]
    prior = PRIORS["k_3"]._replace(size=size)
    of_pendulum, of_k_3 = (
        lambda end: 0.5 * gain_of(end, spring),
        partial(_evidence, spring, "k_3", prior),
    )
    rivals = [
        Candidate("pendulum", PRIORS["pendulum"], lambda: fit, evidence=of_pendulum),
        Candidate("k_3", prior, partial(problem.climb, softer), evidence=of_k_3),
    ]
    return select(spring, rivals, NUMBERS).best.name == "pendulum"
