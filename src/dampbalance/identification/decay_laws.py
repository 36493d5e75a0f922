"""Which damping law free decays support: all laws compared.

The comparison tests every law by the likelihood of all samples: χ² of the best oscillator with it, above that of the
law with all terms, against the F distribution. The rows of the balance are read with a motion of friction and viscous
damping, and so they do not test other laws.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import special

from ..findings.finding import Finding
from ..fit.decay import DecayFit
from ..fit.multistart import multistart
from ..fit.parameters import Parameters
from ..fit.search import sound
from ..law.terms import FRICTION
from ..signals.one_thread import one_thread
from .law_comparison import LawComparison, LawTest, Probability, compared

DECAY_TERMS = (FRICTION, "c", "c_2")
"""Terms that free decays distinguish: base at rest and at one frequency, c_r and eta act as c does."""

_SURE = 900.0  # of χ²: laws that leave out so much need no fit


@one_thread
def compare_decay_laws(fit: DecayFit) -> LawComparison:
    """Test the laws of c and c_2 in addition to friction, or without it, on free decays, see
    `law_comparison.compared`.

    Use it where the damping is not known to be viscous. Laws without what is there by 30 standard errors need no fit.
    Where the residual of the law with all terms is not white noise, χ² is taken relative to what it leaves over parts
    of a cycle.

    fit : of the oscillator with friction and viscous damping to all decays.
    """
    first = fit_law(fit, DECAY_TERMS)
    if first is None:
        raise ValueError("no law can be tested: the motion of the decays cannot be followed")
    every = first
    fits: dict[tuple[str, ...], DecayFit | None] = {}

    def test(terms: tuple[str, ...], near: DecayFit | None) -> tuple[LawTest, DecayFit | None]:
        nonlocal every
        rise, start = _without(every, [s for s in DECAY_TERMS if s not in terms])
        if rise > _SURE * every.misfit:
            return _tested(every, terms, rise), None
        if terms not in fits:
            others = [near.parameters] if near else []
            others += [fit.parameters] if {FRICTION, "c"} <= {*terms} else []
            fits[terms] = fit_law(fit, terms, (start, *others))
        of_law = fits[terms]
        if of_law is None:
            return LawTest(terms, tests={"waveforms": None}), None
        if of_law.chi_square < every.chi_square:
            again = fit_law(fit, DECAY_TERMS, (of_law.parameters,)) or every
            every = min(every, again, key=lambda one: one.chi_square)
        return _tested(every, terms, of_law.chi_square - every.chi_square, of_law), of_law

    damping = [s for s in DECAY_TERMS if s != FRICTION]
    while True:  # until no law is closer to the decays than that of all terms, which contains it
        before = every
        laws = compared(damping, test, (Finding("damping alike in decays"),))
        if every is before:
            return laws


def fit_law(
    fit: DecayFit, terms: Sequence[str], starts: Sequence[Parameters] = ()
) -> DecayFit | None:
    """Return the oscillator with a law, no coefficient negative, to the decays of a fit; None where no climb leads to
    one.

    terms : of `DECAY_TERMS`.   starts : to climb from; default, that of the fit.
    """
    kept = {s for s in fit.free if s not in DECAY_TERMS and (s != "rho" or FRICTION in terms)}
    out = {one.key: 0.0 for one in fit.parameters if one.name in {*DECAY_TERMS} - {*terms}}
    points = (start.by_key | out for start in starts or (fit.parameters,))
    free = kept | {*terms}
    ends = multistart(fit.problem, [fit.problem.parameters(one, free) for one in points])
    return ends[0] if ends else None


def _without(every: DecayFit, symbols: Sequence[str]) -> tuple[float, Parameters]:
    """Return what χ² rises by without the coefficients p of some terms, to first order, pᵀ C⁻¹ p (Wald's test), and the
    point to which the other coefficients then move."""
    own, point = every.parameters, every.point.copy()
    out = [i for i, name in enumerate(own.names) if name in symbols]
    others = [i for i, name in enumerate(own.names) if name in DECAY_TERMS and i not in out]
    errors = np.sqrt(np.diag(every.covariance)[out])
    if not (errors > 0.0).all():
        return 0.0, own
    z = point[out] / errors
    covariance = every.covariance[:, out] / errors
    solved = np.linalg.lstsq(covariance[out] / errors[:, None], z)[0]
    point[others] -= covariance[others] @ solved
    return float(z @ solved), own.at(point)


def _tested(
    every: DecayFit,
    terms: tuple[str, ...],
    rise: float,
    of_law: DecayFit | None = None,
) -> LawTest:
    """Return the test of a law by what χ² rises by from that of all terms, in the noise that these leave, and by
    the tests of the fit that is the answer.

    of_law : its fit, where it needs one.
    """
    freedom, above = len(DECAY_TERMS) - len(terms), max(rise, 0.0) / every.misfit
    p = float(special.fdtrc(freedom, every.freedom, above / freedom)) if freedom else 1.0
    law, doubts = {}, list[float]()
    if of_law is not None:
        law = {s: (of_law.value(s), of_law.error(s)) for s in terms}
        doubts = [] if sound(of_law) else [of_law.chance]
    waveforms = Probability(above, freedom, min([p, *doubts]))
    return LawTest(terms, law, {"waveforms": waveforms}, explains=not doubts)
