"""Which damping law free decays support: a quick test of what friction and viscous damping leave, and all laws
compared.

The quick test belongs to every identification: it asks which one further coefficient the residual speaks for
(`fit.decay.departures_of`). The comparison tests every law by the likelihood of all samples: χ² of the best
oscillator with it, above that of the law with all terms, against the F distribution. The rows of the balance are read
with a motion of friction and viscous damping, and so they do not test other laws.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy import special

from ..arrays import Array
from ..balance import TERMS
from ..fit.decay import (
    COMMON,
    CORNER,
    FALLS,
    FURTHER,
    RingFit,
    departures_of,
    further_of,
    numbers_of,
    with_noise_of,
)
from ..fit.minimise import minimise
from ..fit.score import Departure
from ..fit.search import sound, with_one_more
from ..law.terms import FRICTION, KNOWN_TERMS
from ..motion.law_decays import LINEAR_UNKNOWNS, law_decay
from ..project.progress import followed
from ..project.wording import Remark, change_text, listed, number_text, percent
from ..signals.one_thread import one_thread
from ..signals.thresholds import P_FURTHER_TERM
from ..solver import NORMAL_95
from .answer import Answer, unit_of
from .causes import GRADUAL
from .law_comparison import ALPHA, MOST_TERMS, LawComparison, LawTest, Probability, chosen_of
from .stated import widened

_MOST_ALONG = 3  # coefficients that are fitted along
_AS_WELL = 6.0  # of χ²: another coefficient that explains the decays as well
_APART = 16.0  # of χ², four standard errors: beyond it, another cause of what looks like a friction that falls is out
_HINT = 1.7  # standard errors of a coefficient, more than one in twenty decays show by chance
_MATTERS = 3.0  # standard errors by which another law may move F_k or c, unsaid
_LEAST = 0.03  # of F_k or c
_SPEED_SHOWS = 4.0  # of χ²: two standard errors by which the speed over which friction falls shows
DECAY_TERMS = (FRICTION, "c", "c_2", "c_3")
"""Terms that free decays distinguish: base at rest and at one frequency, c_r and eta act as c does."""

_FALLING, _SPEED = "falling", "falling_speed"
_NAMED = (*TERMS, "rho")
_DENSE = 64  # instants of a period, of which a loss of energy is summed
_OTHERS = {
    "c_a": ("damping that differs by direction", "N s/m"),
    "k_2": ("a spring that is stiffer to one side", "N/m²"),
    "k_3": ("a spring that stiffens or softens with its deflection", "N/m³"),
    _FALLING: ("friction that falls with the speed", "N"),
    _SPEED: ("friction that falls over another speed", "m/s"),
    CORNER: ("an AC coupling of the channel", "Hz"),
}
_LEFT_OUT = (
    "free decays have one frequency and a base at rest: structural damping eta and damping relative to the base c_r "
    "act as viscous damping c does, friction that differs by direction as another position of rest; they are not tried"
)
_SURE = 900.0  # of χ²: laws that leave out so much need no fit
_REMEDY = "give decays from higher up, or with less noise"


def with_departures(fit: RingFit) -> tuple[RingFit, list[Remark]]:
    """The fit with further coefficients that the residual speaks for, one after the other, and a sentence on each.

    What another coefficient that explains the decays as well does to the numbers belongs to the sentence.
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
    along = [s for s in fit.problem.free if s in FURTHER and s != _SPEED]
    unbounded = {"F_k": math.inf, "c": math.inf}
    return fit, [
        Remark(_along(fit, s), doubts=unbounded if s in DECAY_TERMS else _as_well(fit, s))
        for s in along
    ]


def _likeliest(fit: RingFit) -> RingFit | None:
    """The fit with the further coefficient that lowers χ² most."""
    ends = [*filter(None, [with_one_more(fit)]), *_freed(fit, fit.point, _FALLING)]
    return min(ends, key=lambda one: one.chi_square, default=None)


def _freed(
    fit: RingFit, start: Array, symbol: str, free: Sequence[str] | None = None
) -> list[RingFit]:
    """The fit with a further coefficient, from a start; friction that falls with the speed with that speed fixed at
    several values, and those that explain the decays as well among its `minima`. Empty where it is free already.

    free : names of the other unknowns that move; default, those of the fit.
    """
    if symbol in fit.problem.free:
        return []
    problem = replace(fit.problem, free=(*(fit.problem.free if free is None else free), symbol))
    starts = [start]
    if symbol == _FALLING:
        starts = [problem.falling_over(start, part) for part in FALLS]
    ends = sorted(filter(None, map(problem.climb, starts)), key=lambda one: one.chi_square)
    if ends and symbol == _FALLING:
        with_speed = ends[0].problem.with_free(_SPEED).climb(ends[0].point)
        if with_speed is not None and with_speed.chi_square < ends[0].chi_square - _SPEED_SHOWS:
            return [with_speed]
    return [replace(ends[0], minima=tuple(ends[1:]))] if ends else []


def _along(fit: RingFit, symbol: str) -> str:
    """The sentence on a coefficient that is fitted along."""
    words, unit = _words(symbol)
    size = f"{number_text(fit.value(symbol), 3)} ± {number_text(fit.error(symbol), 1)}{unit}"
    if symbol in DECAY_TERMS:
        return (
            f"friction and viscous damping do not account for the decays: {words} explains them ({symbol} = {size}), "
            "and a friction that varies otherwise may, with other values; compare the laws (--laws, laws=True) before "
            "using F_k and c"
        )
    if symbol == _FALLING:
        loose, speed = number_text(fit.F_k + fit.value(symbol), 3), fit.value(_SPEED)
        return (
            f"{words} shows and is fitted along: F_k is the force at high speed, to which it falls by {size} over "
            f"{number_text(speed, 2)} m/s; a mass at rest breaks loose at {loose} N"
        )
    if symbol == CORNER:
        return f"{words} with a corner of {size} shows and is fitted along"
    return f"{words} shows and is fitted along ({symbol} = {size})"


def _as_well(fit: RingFit, symbol: str) -> dict[str, float]:
    """Relative changes of the numbers with another coefficient that explains the decays as well in place of one."""
    doubts: dict[str, float] = {}
    of = (symbol, _SPEED) if symbol == _FALLING else (symbol,)
    without = tuple(name for name in fit.problem.free if name not in of)
    start = fit.point.copy()
    start[COMMON.index(symbol)] = 0.0
    for other in FURTHER:
        for end in _freed(fit, start, other, without) if other != _SPEED else ():
            for one in (end, *end.minima):
                if one.chi_square - fit.chi_square < (_APART if symbol == _FALLING else _AS_WELL):
                    for name in (*TERMS, "K_z"):
                        here, there = getattr(fit, name), getattr(one, name)
                        if here and math.isfinite(here) and math.isfinite(there):
                            doubts[name] = max(doubts.get(name, 0.0), abs(there / here - 1.0))
    return doubts


def doubts_of(fit: RingFit, further: Sequence[Departure]) -> list[Remark]:
    """A sentence where friction and viscous damping do not account for the decays and what does cannot be fitted along,
    with what it may change.

    further : what each further coefficient explains.
    """
    shown = _shown(fit, further)
    if not shown:
        return []
    likely = max(shown, key=lambda one: abs(one.size))
    words, unit = _words(likely.symbol)
    if likely.value < 0.0 and likely.symbol in (*DECAY_TERMS, GRADUAL):
        words = "a friction that falls with the speed, or damping that grows less with it than viscous damping does,"
    moved = {s: by * likely.value / (fit.value(s) or math.inf) for s, by in likely.slopes.items()}
    doubts = {s: abs(moved[s]) for s in TERMS if s in moved}
    if "rho" in moved and not fit.rigid:  # K_z = ρ^{−2}
        doubts["K_z"] = 2.0 * abs(moved["rho"])
    chance = "p < 1e-6" if likely.p < 1e-6 else f"p = {likely.p:.1g}"
    return [
        Remark(
            f"friction and viscous damping do not account for the decays ({chance}): {words} would explain most of it "
            f"({likely.symbol} = {number_text(likely.value, 3)} ± {number_text(likely.error, 1)}{unit}); F_k and c "
            "may carry its effect",
            doubts=doubts,
        )
    ]


def shortcomings_of(fit: RingFit) -> list[Remark]:
    """A sentence where the decays are not those of one oscillator even in the band of the mode."""
    if sound(fit):
        return []
    return [
        Remark(
            "the decays are not those of one mass on a spring, a damper and one friction contact: the closest fit "
            f"leaves {percent(fit.residual_share)} of the motion in the band of the mode",
            doubts={"": math.inf},
        )
    ]


def _shown(fit: RingFit, further: Sequence[Departure]) -> list[Departure]:
    """The coefficients that are no chance, and can be: an AC coupling and a friction that falls have one sign, and with
    such a friction damping that falls with the speed is none but the friction at another speed."""
    positive = [_FALLING, CORNER]
    positive += [s for s in DECAY_TERMS if _FALLING in fit.problem.free]
    return [
        one
        for one in further
        if one.error > 0.0
        and one.p < P_FURTHER_TERM / len(further)
        and (one.value > 0.0 or one.symbol not in positive)
    ]


def _words(symbol: str) -> tuple[str, str]:
    """A coefficient in words, and its unit after a space."""
    if symbol == GRADUAL:
        return "a contact that yields gradually", ""
    if symbol in _OTHERS:
        words, unit = _OTHERS[symbol]
        return words, f" {unit}"
    return KNOWN_TERMS[symbol].words, f" {KNOWN_TERMS[symbol].unit}"


def condition_of(fit: RingFit, further: Iterable[Departure]) -> tuple[str, dict[str, float]]:
    """A sentence where F_k, c or K_z depend on the damping being viscous by more than the noise shows, and the decays
    are too few or too noisy to tell; and by how much, by name, in the units of the fit. Empty where they do not.

    Only a hint of it counts, which one in twenty sound decays give: what none shows would widen all intervals, though
    most dampers are viscous. It is no doubt: values are those of the law that was asked for, and what another would
    change is for their intervals. Friction that falls with speed acts as the negative of damping that grows with it.
    """
    worst, sentence, effects = _MATTERS, "", {}
    for one in further:
        if one.symbol not in DECAY_TERMS or one.size < _HINT:
            continue
        most = abs(one.value) + NORMAL_95 * one.error
        by_c = one.slopes.get("c", 0.0)
        if by_c < 0.0:
            most = min(most, -(fit.c + NORMAL_95 * fit.error("c")) / by_c)
        slopes = {s: by for s, by in one.slopes.items() if s in _NAMED and fit.error(s) > 0.0}
        moved = {s: most * by for s, by in slopes.items()}
        size = max((abs(by) / fit.error(s) for s, by in moved.items()), default=0.0)
        parts = {s: by / fit.value(s) for s, by in moved.items() if fit.value(s) > 0.0}
        large = {s: part for s, part in parts.items() if abs(part) > _LEAST}
        if size > worst and large:
            worst, effects = size, moved
            words = listed([_changed(fit, s, moved[s]) for s in large])
            sentence = (
                f"The values are those of friction and viscous damping. {KNOWN_TERMS[one.symbol].words.capitalize()} "
                f"is hinted at, which would change {words}; friction that falls with the speed looks alike and changes "
                f"them the other way. The intervals include both: {_REMEDY}, if the damping may not be viscous."
            )
    return sentence, effects


def with_effects(answer: Answer, fit: RingFit, effects: Mapping[str, float]) -> Answer:
    """Return the answer with its intervals widened by what another law would change: what a sentence states belongs to
    the number next to it.

    effects : of `condition_of`, taken as 95 % of what may be, either way.
    """
    parts = {s: by / fit.value(s) for s, by in effects.items() if fit.value(s) > 0.0}
    if "rho" in parts:
        parts["K_z"] = -2.0 * parts.pop("rho")  # K_z = ρ^{−2}
    return widened(answer, {"law": {s: part / NORMAL_95 for s, part in parts.items()}})


def _changed(fit: RingFit, name: str, by: float) -> str:
    """By how much an unknown changes, for a sentence; ρ as the stiffness that it stands for. None becomes negative."""
    value = fit.value(name)
    moved = max(value + by, 0.0)
    if name == "rho":  # K_z = ρ^{−2}
        name, value, moved = "K_z", value**-2, moved**-2 if moved else math.inf
    unit = "kg" if name == "m" else unit_of(name)
    return f"{name} by up to {change_text(value, moved - value, unit)}"


@one_thread
def compare_decay_laws(fit: RingFit) -> LawComparison:
    """Test every law of one to three terms, friction or not, with two of c, c_2 and c_3 at the most.

    Use it where the damping is not known to be viscous. Once a law is not rejected, of the larger laws only those that
    contain it are tested; laws without what is there by 30 standard errors need no fit. Where the residual of the law
    with all terms is not white noise, χ² is taken relative to what it leaves over parts of a cycle.

    fit : of the oscillator with friction and viscous damping to all decays.
    """
    damping = [s for s in DECAY_TERMS if s != FRICTION]
    laws = [
        (*friction, *some)
        for friction in ((), (FRICTION,))
        for size in range(MOST_TERMS + 1)
        for some in itertools.combinations(damping, size)
        if friction or some
    ]
    every = fit_law(fit, DECAY_TERMS)
    if every is None:
        raise ValueError("no law can be tested: the motion of the decays cannot be followed")
    fits: dict[tuple[str, ...], RingFit] = {}
    hopeless: dict[tuple[str, ...], float] = {}
    for _, alike in itertools.groupby(followed(sorted(laws, key=len), len(laws), "laws"), len):
        tests = [_tested(every, terms, one) for terms, one in fits.items()]
        enough = [set(test.terms) for test in tests if test.p_of() > ALPHA / len(laws)]
        for terms in alike:
            if enough and not any(smaller < set(terms) for smaller in enough):
                continue
            rise = _rise_without(every, [s for s in DECAY_TERMS if s not in terms])
            if rise > _SURE * every.misfit:
                hopeless[terms] = rise
                continue
            within = [one for smaller, one in fits.items() if set(smaller) < set(terms)]
            near = sorted(within, key=lambda one: one.chi_square)[:1]
            of_law = fit_law(fit, terms, [one.point for one in near])
            if of_law is None:
                continue
            fits[terms] = of_law
            if of_law.chi_square < every.chi_square:
                every = fit_law(fit, DECAY_TERMS, [of_law.point]) or every
    tests = [_tested(every, terms, rise) for terms, rise in hopeless.items()]
    tests += [_tested(every, terms, one) for terms, one in fits.items()]
    tests = sorted(tests, key=lambda test: len(test.terms))
    return chosen_of(tests, _LEFT_OUT, remedy=_REMEDY)


def fit_law(fit: RingFit, terms: Sequence[str], starts: Iterable[Array] = ()) -> RingFit | None:
    """The oscillator with a law, no coefficient negative, to the decays of a fit; None where no climb leads to one.

    What the law leaves out is given to its terms, in equal parts of the energy.

    terms : of `DECAY_TERMS`.   starts : points of other laws, to climb from as well.
    """
    losses, out = _losses(fit), [s for s in DECAY_TERMS if s not in terms]
    kept = [
        s for s in fit.problem.free if s not in DECAY_TERMS and (s != "rho" or FRICTION in terms)
    ]
    problem = replace(fit.problem, free=(*kept, *terms))
    points = []
    for start in (fit.point, *starts):
        point = start.copy()
        lost = math.fsum(start[COMMON.index(s)] / losses[s] for s in out)
        for s in terms:
            point[COMMON.index(s)] += losses[s] * lost / len(terms)
        for s in out:
            point[problem.friction_places if s == FRICTION else COMMON.index(s)] = 0.0
        points.append(point)
    ends = minimise(problem, points, scanned="")
    return ends[0] if ends else None


def _losses(fit: RingFit) -> dict[str, float]:
    """Coefficient of each term that alone would take the energy that friction and damping take in the fit."""
    powers = dict.fromkeys(DECAY_TERMS, 0.0)
    added = further_of(fit.point)
    for i, one in enumerate(fit.decays):
        par = numbers_of(fit.point_of(i), fit.k)
        times = np.arange(0.0, one.end - one.start, one.period / _DENSE)
        x, v, w = fit.point[fit.places(i)].tolist()
        speed = np.abs(law_decay(times, 1, x, v, w, par, added, LINEAR_UNKNOWNS)[:, 0])
        for order, symbol in enumerate(DECAY_TERMS):
            powers[symbol] += float(np.nansum(speed ** (order + 1)))
    loss = math.fsum(float(fit.point[COMMON.index(s)]) * powers[s] for s in DECAY_TERMS)
    return {symbol: loss / power for symbol, power in powers.items()}


def _rise_without(fit: RingFit, symbols: Sequence[str]) -> float:
    """What χ² rises by without the coefficients of some terms, to first order: pᵀ C⁻¹ p (Wald's test)."""
    places = [COMMON.index(symbol) for symbol in symbols]
    covariance = fit.covariance[np.ix_(places, places)]
    errors = np.sqrt(np.diag(covariance))
    if not (errors > 0.0).all():
        return 0.0
    z = fit.point[places] / errors
    return float(z @ np.linalg.lstsq(covariance / np.outer(errors, errors), z)[0])


def _tested(every: RingFit, terms: tuple[str, ...], law: RingFit | float) -> LawTest:
    """The test of a law by its χ² above that of all terms, in the noise that these leave.

    law : its fit, or what χ² rises by where it needs no fit.
    """
    rise = law.chi_square - every.chi_square if isinstance(law, RingFit) else law
    freedom, above = len(DECAY_TERMS) - len(terms), max(rise, 0.0) / every.misfit
    p = float(special.fdtrc(freedom, every.freedom, above / freedom)) if freedom else 1.0
    coefficients = (
        {s: (law.value(s), law.error(s)) for s in terms} if isinstance(law, RingFit) else {}
    )
    return LawTest(terms, coefficients, {"waveforms": Probability(above, freedom, p)})
