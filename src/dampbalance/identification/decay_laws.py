"""Which damping law free decays support: a quick test of what friction and viscous damping leave, and all laws
compared.

The quick test belongs to every identification: it asks which one further coefficient the residual speaks for
(`fit.law_fit.law_departures`). The comparison tests every law by the likelihood of all samples: χ² of the best
oscillator with it, above that of the law with all terms, against the F distribution. The rows of the balance are read
with a motion of friction and viscous damping, and so they do not test other laws.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence

from scipy import special

from ..fit.decay import RingFit
from ..fit.law_fit import DECAY_TERMS, LawFit, fit_law
from ..fit.score import Departure
from ..law.terms import FRICTION, KNOWN_TERMS
from ..project.progress import followed
from ..project.wording import change_text, listed, number_text
from ..signals.one_thread import one_thread
from ..solver import NORMAL_95
from .answer import Answer, unit_of
from .causes import GRADUAL
from .law_comparison import ALPHA, MOST_TERMS, LawComparison, LawTest, Probability, chosen_of
from .stated import widened

_CHANCE = 0.02  # probability of a doubt on decays with friction and viscous damping
_MATTERS = 3.0  # standard errors by which another law may move F_k or c, unsaid
_LEAST = 0.03  # of F_k or c
_OTHERS = {
    "c_a": ("damping that differs by direction", "N s/m"),
    "k_2": ("a spring that is stiffer to one side", "N/m²"),
    "k_3": ("a spring that stiffens or softens with its deflection", "N/m³"),
}
_LEFT_OUT = (
    "free decays have one frequency and a base at rest: structural damping eta and damping relative to the base c_r "
    "act as viscous damping c does, friction that differs by direction as another position of rest; they are not tried"
)
_SURE = 900.0  # of χ²: laws that leave out so much need no fit
_CAUTION = (
    "the samples are those of no oscillator with such a law within white noise: the contact, the spring or the "
    "measuring chain differs, and what is left counts as noise"
)
_REMEDY = "give decays from higher up, or with less noise"


def doubt_of(fit: RingFit, further: Sequence[Departure]) -> str:
    """A sentence where friction and viscous damping do not account for the decays and one further coefficient does,
    with the likely cause; empty where nothing speaks against them.

    further : what each further coefficient explains.
    """
    # residuals that are like a motion repeat themselves: fewer of them are independent
    scale = 1.0 if fit.adequate else math.sqrt(fit.misfit)
    damping = [one for one in further if one.symbol != GRADUAL]
    shown = [(abs(one.size) / scale, one) for one in damping if one.error > 0.0]
    size, likely = max(shown, key=lambda pair: pair[0], default=(0.0, None))
    p = len(shown) * 2.0 * special.ndtr(-size)
    if likely is None or p > _CHANCE:
        return ""
    chance = "p < 1e-6" if p < 1e-6 else f"p = {p:.1g}"
    begin = f"friction and viscous damping do not account for the decays ({chance}): "
    if likely.symbol in _OTHERS:
        words, unit = _OTHERS[likely.symbol]
        return (
            f"{begin}{words} would explain most of it ({likely.symbol} = {number_text(likely.value, 3)} ± "
            f"{number_text(likely.error, 1)} {unit}); F_k and c may carry its effect"
        )
    if likely.value < 0.0:
        return (
            f"{begin}the damping grows less with the speed than viscous damping does, or the friction falls with it; "
            "F_k and c are not those of the rig"
        )
    # their powers of the velocity are so close that only the motions under them tell which it is
    symbols = [one.symbol for one in further if one.symbol in DECAY_TERMS and one.value > 0.0]
    fits = [law for s in symbols if (law := fit_law(fit, (FRICTION, "c", s))) is not None]
    law = min(fits, key=lambda one: one.chi_square, default=None)
    symbol, values = (likely.symbol, "") if law is None else (law.terms[-1], _values_of(law))
    return (
        f"{begin}{KNOWN_TERMS[symbol].words} in addition would explain most of it{values}; compare the laws (--laws, "
        "laws=True) before using F_k and c"
    )


def _values_of(law: LawFit) -> str:
    coefficients = ((s, *law.coefficient(s)) for s in law.terms)
    return f" ({', '.join(f'{s} = {number_text(x, 4)} ± {number_text(error, 2)}' for s, x, error in coefficients)})"


def condition_of(fit: RingFit, further: Iterable[Departure]) -> tuple[str, dict[str, float]]:
    """A sentence where F_k, c or K_z depend on the damping being viscous by more than the noise shows, and the decays
    are too few or too noisy to tell; and by how much, by name, in the units of the fit. Empty where they do not.

    It is no doubt: values are those of the law that was asked for, and what another would change is for their
    intervals. Friction that falls with speed acts as the negative of damping that grows with it.
    """
    worst, sentence, effects = _MATTERS, "", {}
    for one in further:
        if one.symbol not in DECAY_TERMS:
            continue
        most = abs(one.value) + NORMAL_95 * one.error
        by_c = one.slopes.get("c", 0.0)
        if by_c < 0.0:
            most = min(most, -(fit.c + NORMAL_95 * fit.error("c")) / by_c)
        slopes = {s: by for s, by in one.slopes.items() if s != "m" and fit.error(s) > 0.0}
        moved = {s: most * by for s, by in slopes.items()}
        size = max((abs(by) / fit.error(s) for s, by in moved.items()), default=0.0)
        parts = {s: by / fit.value(s) for s, by in moved.items() if fit.value(s) > 0.0}
        large = {s: part for s, part in parts.items() if abs(part) > _LEAST}
        if size > worst and large:
            worst, effects = size, moved
            words = listed([_changed(fit, s, moved[s]) for s in large])
            sentence = (
                f"The values are those of friction and viscous damping. {KNOWN_TERMS[one.symbol].words.capitalize()} "
                f"that these decays would not show changes {words}, and friction that falls with the speed the other "
                f"way; their intervals include both: {_REMEDY}, if the damping may not be viscous."
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
    fits: dict[tuple[str, ...], LawFit] = {}
    hopeless: dict[tuple[str, ...], float] = {}
    for _, alike in itertools.groupby(followed(sorted(laws, key=len), len(laws), "laws"), len):
        tests = [_tested(every, terms, one) for terms, one in fits.items()]
        enough = [set(test.terms) for test in tests if test.p_of() > ALPHA / len(laws)]
        for terms in alike:
            if enough and not any(smaller < set(terms) for smaller in enough):
                continue
            rise = every.without([s for s in DECAY_TERMS if s not in terms])
            if rise > _SURE * _noise(every):
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
    caution = "" if every.adequate else _CAUTION
    tests = sorted(tests, key=lambda test: len(test.terms))
    return chosen_of(tests, _LEFT_OUT, remedy=_REMEDY, caution=caution)


def _noise(every: LawFit) -> float:
    """What the law with all terms leaves per degree of freedom; over parts of a cycle, where that is not white."""
    return every.chi_square / every.freedom * (1.0 if every.adequate else every.misfit)


def _tested(every: LawFit, terms: tuple[str, ...], law: LawFit | float) -> LawTest:
    """The test of a law by its χ² above that of all terms, in the noise that these leave.

    law : its fit, or what χ² rises by where it needs no fit.
    """
    rise = law.chi_square - every.chi_square if isinstance(law, LawFit) else law
    freedom, above = len(DECAY_TERMS) - len(terms), max(rise, 0.0) / _noise(every)
    p = float(special.fdtrc(freedom, every.freedom, above / freedom))
    coefficients = {s: law.coefficient(s) for s in terms} if isinstance(law, LawFit) else {}
    return LawTest(terms, coefficients, {"waveforms": Probability(above, freedom, p)})
