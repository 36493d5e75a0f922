"""What friction and viscous damping leave of free decays: a quick test of which one further coefficient the residual
speaks for (`fit.decay.departures_of`)."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ..balance import TERMS
from ..findings.finding import UNBOUNDED, Finding
from ..fit.decay import CORNER, FALLS, FURTHER, DecayFit, departures_of, with_noise_of
from ..fit.parameters import Parameters
from ..fit.score import Departure
from ..fit.search import sound, with_one_more
from ..law.terms import KNOWN_TERMS
from ..signals.thresholds import AS_WELL, P_FURTHER_TERM, SHOWS
from ..solver import NORMAL_95
from .answer import Answer
from .causes import GRADUAL
from .law_comparison import DECAY_TERMS
from .stated import widened

if TYPE_CHECKING:
    from .result import Result

_MOST_ALONG = 3  # coefficients that are fitted along
_HINT = 1.7  # standard errors of a coefficient, more than one in twenty decays show by chance
_MATTERS = 3.0  # standard errors by which another law may move F_k or c, unsaid
_LEAST = 0.03  # of F_k or c
_SPEED_SHOWS = 4.0  # of χ²: two standard errors by which the speed over which friction falls shows
_FALLING, _SPEED = "falling", "falling_speed"
_NAMED = (*TERMS, "rho")
_OTHERS = {
    "k_3": "a spring that stiffens or softens with its deflection",
    _FALLING: "friction that falls with the speed",
    _SPEED: "friction that falls over another speed",
    CORNER: "an AC coupling of the channel",
    GRADUAL: "a contact that yields gradually",
}


def with_departures(fit: DecayFit) -> tuple[DecayFit, list[Finding]]:
    """Return the fit with further coefficients that the residual speaks for, one after the other, and a finding on
    each, with what another coefficient that explains the decays as well does to the numbers.
    """
    for _ in range(_MOST_ALONG):
        departures = departures_of(fit)
        shown = _shown(fit, departures)
        more = _likeliest(fit) if shown else None
        # to first order, the noise being what the coefficient leaves
        size = max((one.size**2 for one in shown), default=0.0)
        gained = fit.chi_square * size / (fit.freedom + size)
        if more is None or fit.chi_square - more.chi_square < 0.5 * gained:
            break
        fit = with_noise_of(more)
    along = [s for s in fit.further if s != _SPEED]
    unbounded = {"F_k": math.inf, "c": math.inf}
    return fit, [_along(fit, s, unbounded if s in DECAY_TERMS else _as_well(fit, s)) for s in along]


def pendulum_if_likelier(identified: Callable[..., Result[Any]]) -> Result[Any]:
    """Return the answer to decays that rotate: as a pendulum, where a linear spring leaves more than noise and k_3
    explains that no better.

    identified : returns the answer; its keyword `pendulum` says whether the restoring torque is k sin θ.
    """
    answers: list[Result[Any]] = []
    errors: list[ValueError] = []
    for pendulum in (False, True):
        try:
            answers.append(identified(pendulum=pendulum))
        except ValueError as error:
            errors.append(error)
        if answers and not pendulum and _linear(answers[0].basis):
            break
    if not answers:
        raise errors[0]
    *plain, found = answers
    fit = found.basis.fit
    if not fit.problem.pendulum or not _likelier(fit, [one.basis.fit for one in plain]):
        return answers[0]
    return replace(found, odd=(*found.odd, Finding("pendulum")))


def _linear(basis: Any) -> bool:
    """Return whether decays show no spring that is not linear."""
    k_3 = [abs(one.size) for one in basis.departures if one.symbol == "k_3"]
    return basis.fit.white and "k_3" not in basis.fit.further and max(k_3, default=0.0) ** 2 < SHOWS


def _likelier(fit: DecayFit, plain: Sequence[DecayFit]) -> bool:
    """Return whether the fit of a pendulum is likelier than those with a linear spring, which need to be worse by more
    than chance, and with k_3.   plain : the fit with a spring, if there is one."""
    if any(one.white and not fit.white for one in plain):
        return False
    spring, here = replace(fit.problem, pendulum=False), fit.parameters
    softer = here.freed("k_3").moved(k_3=fit.value("k_3") - fit.k / 6.0)
    rivals = [(spring.climb(here), SHOWS), (spring.climb(softer), -AS_WELL)]
    noise = max(1.0, fit.misfit)
    return all(
        one is None or one.chi_square > fit.chi_square + noise * least for one, least in rivals
    )


def _likeliest(fit: DecayFit) -> DecayFit | None:
    """Return the fit with the further coefficient that lowers χ² most."""
    ends = [*filter(None, [with_one_more(fit)]), *_freed(fit, fit.parameters, _FALLING)]
    return min(ends, key=lambda one: one.chi_square, default=None)


def _freed(fit: DecayFit, start: Parameters, symbol: str) -> list[DecayFit]:
    """Return the fit with a further coefficient, from a start; friction that falls with the speed with that speed fixed
    at several values, and those that explain the decays as well among its `minima`. Empty where it is free already."""
    if symbol in fit.further:
        return []
    problem, starts = fit.problem, [start.freed(symbol)]
    if symbol == _FALLING:
        top = problem.speed(start.values)
        starts = [starts[0].moved(falling_speed=part * top) for part in FALLS]
    ends = sorted(filter(None, map(problem.climb, starts)), key=lambda one: one.chi_square)
    if ends and symbol == _FALLING:
        with_speed = problem.climb(ends[0].parameters.freed(_SPEED))
        if with_speed is not None and with_speed.chi_square < ends[0].chi_square - _SPEED_SHOWS:
            return [with_speed]
    return [replace(ends[0], minima=tuple(ends[1:]))] if ends else []


def _along(fit: DecayFit, symbol: str, effect: Mapping[str, float]) -> Finding:
    """Return the finding on a coefficient that is fitted along."""
    size = fit.value(symbol), fit.error(symbol)
    if symbol in DECAY_TERMS:
        what = KNOWN_TERMS[symbol].words
        return Finding("other law", {"what": what, "value": (symbol, *size)}, effect)
    if symbol == _FALLING:
        of = {"by": size, "speed": fit.value(_SPEED), "loose": fit.F_k + size[0]}
        return Finding("falls along", of, effect)
    if symbol == CORNER:
        return Finding("corner along", {"size": size}, effect)
    return Finding("included", {"what": _OTHERS[symbol], "value": (symbol, *size)}, effect)


def _as_well(fit: DecayFit, symbol: str) -> dict[str, float]:
    """Return relative changes of the numbers with another coefficient that explains the decays as well in place of
    one."""
    doubts: dict[str, float] = {}
    of = (symbol, _SPEED) if symbol == _FALLING else (symbol,)
    start = fit.parameters.held(*of).moved(**{symbol: 0.0})
    for other in FURTHER:
        for end in _freed(fit, start, other) if other != _SPEED else ():
            for one in (end, *end.minima):
                if one.chi_square - fit.chi_square < (SHOWS if symbol == _FALLING else AS_WELL):
                    for name in (*TERMS, "K_z"):
                        here, there = getattr(fit, name), getattr(one, name)
                        if here and math.isfinite(here) and math.isfinite(there):
                            doubts[name] = max(doubts.get(name, 0.0), abs(there / here - 1.0))
    return doubts


def doubts_of(fit: DecayFit, further: Sequence[Departure]) -> list[Finding]:
    """Return a sentence where friction and viscous damping do not account for the decays and what does cannot be fitted
    along, with what it may change.

    further : what each further coefficient explains.
    """
    shown = _shown(fit, further)
    if not shown:
        return []
    likely = max(shown, key=lambda one: abs(one.size))
    moved = {s: by * likely.value / (fit.value(s) or math.inf) for s, by in likely.slopes.items()}
    doubts = {s: abs(moved[s]) for s in TERMS if s in moved}
    if "rho" in moved and not fit.rigid:  # K_z = ρ^{−2}
        doubts["K_z"] = 2.0 * abs(moved["rho"])
    of = {
        "p": likely.p,
        "what": _OTHERS.get(likely.symbol) or KNOWN_TERMS[likely.symbol].words,
        "value": (likely.symbol, likely.value, likely.error),
        "falls": likely.value < 0.0 and likely.symbol in (*DECAY_TERMS, GRADUAL),
    }
    return [Finding("unexplained decays", of, doubts)]


def shortcomings_of(fit: DecayFit) -> list[Finding]:
    """Return a sentence where the decays are not those of one oscillator even in the band of the mode."""
    if sound(fit):
        return []
    return [Finding("no one decays", {"share": fit.residual_share}, UNBOUNDED)]


def _shown(fit: DecayFit, further: Sequence[Departure]) -> list[Departure]:
    """Return the coefficients that are no chance, and can be: an AC coupling and a friction that falls have one sign,
    and with such a friction damping that falls with the speed is none but the friction at another speed."""
    positive = [_FALLING, CORNER]
    positive += [s for s in DECAY_TERMS if _FALLING in fit.further]
    return [
        one
        for one in further
        if one.error > 0.0
        and one.p < P_FURTHER_TERM / len(further)
        and (one.value > 0.0 or one.symbol not in positive)
    ]


def condition_of(
    fit: DecayFit, further: Iterable[Departure]
) -> tuple[list[Finding], dict[str, float]]:
    """Return a finding where F_k, c or K_z depend on the damping being viscous by more than the noise shows, and the
    decays are too few or too noisy to tell; and by how much, by name, in the units of the fit. Empty where they do not.

    Only a hint of it counts, which one in twenty sound decays give: what none shows would widen all intervals, though
    most dampers are viscous. It is no doubt: values are those of the law that was asked for, and what another would
    change is for their intervals. Friction that falls with speed acts as the negative of damping that grows with it.
    """
    one = next((one for one in further if one.symbol == "c_2"), None)
    if one is None or one.size < _HINT:
        return [], {}
    most = abs(one.value) + NORMAL_95 * one.error
    by_c = one.slopes.get("c", 0.0)
    if by_c < 0.0:
        most = min(most, -(fit.c + NORMAL_95 * fit.error("c")) / by_c)
    slopes = {s: by for s, by in one.slopes.items() if s in _NAMED and fit.error(s) > 0.0}
    moved = {s: most * by for s, by in slopes.items()}
    parts = {s: by / fit.value(s) for s, by in moved.items() if fit.value(s) > 0.0}
    large = [s for s, part in parts.items() if abs(part) > _LEAST]
    if not large or max(abs(by) / fit.error(s) for s, by in moved.items()) <= _MATTERS:
        return [], {}
    changes = tuple(_changed(fit, s, moved[s]) for s in large)
    return [Finding("hints of another law", {"changes": changes})], moved


def with_effects(answer: Answer, fit: DecayFit, effects: Mapping[str, float]) -> Answer:
    """Return the answer with its intervals widened by what another law would change: what a sentence states belongs to
    the number next to it.

    effects : of `condition_of`, taken as 95 % of what may be, either way.
    """
    parts = {s: by / fit.value(s) for s, by in effects.items() if fit.value(s) > 0.0}
    if "rho" in parts:
        parts["K_z"] = -2.0 * parts.pop("rho")  # K_z = ρ^{−2}
    return widened(answer, {"law": {s: part / NORMAL_95 for s, part in parts.items()}})


def _changed(fit: DecayFit, name: str, by: float) -> tuple[str, float, float]:
    """Return an unknown, its value, and by how much it changes; ρ as the stiffness that it stands for. None becomes
    negative."""
    value = fit.value(name)
    moved = max(value + by, 0.0)
    if name == "rho":  # K_z = ρ^{−2}
        name, value, moved = "K_z", value**-2, moved**-2 if moved else math.inf
    return name, value, moved - value
