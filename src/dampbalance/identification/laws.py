"""Which damping law do the records support? Each law that can be had of a few terms is tested, the smallest one kept.

A law is tested in two ways, both with the onset of slip of the oscillator that has this law:

    balance      e = A p − W of the rows, p their generalised least squares; eᵀ C⁻¹ e, C the covariance of e over the
                 replicates of the records, all rows together: a common K_z moves them all
    waveforms    χ² of the harmonics of all records about the steady responses of the oscillator

each against the F distribution of its degrees of freedom; a law is as probable as the less probable of the two, times
two. Those that noise would make improbable are rejected by Holm's procedure, which keeps the chance to reject any law
that is true, with terms too many or not, below `ALPHA`. The smallest law that is not rejected is the answer: an extra
term is there by chance in less than that part of all cases. Where no law's waveforms hold, the balance alone decides.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..arrays import Array
from ..balance import APPROACHES, Rows
from ..law.law import Law
from ..law.terms import FRICTION, KNOWN_TERMS
from ..reading.fitting import fit_quickly, with_mass
from ..reading.lines import probability
from ..reading.noisy import Means, Reading
from ..reading.one_thread import one_thread
from ..reading.waveforms import WaveformFit
from ..solver import solve
from .evidence import ALPHA, MOST_TERMS, Comparison, Evidence, Probability
from .identify import RowsOf
from .microstick import sample_of
from .notes import YARDSTICK
from .oscillator import Whole, joined

_REPEATS = 4  # of generalised least squares, whose covariance depends on its solution
_ALIKE = 1.001  # of frequencies: nearer ones are one


@one_thread
def compare_laws(
    readings: Sequence[Reading],
    k: float,
    *,
    law: Law | None = None,
    mass: float | None = None,
    replicates: int = 1000,
    seed: int = 2010,
) -> Comparison:
    """Test every law of no, one or two terms beside friction; once one is not rejected, of the larger ones those alone
    that hold it.

    readings, k, mass, replicates, seed : as for `identify`.   law : whose given coefficients are part of every law, and
    whose groups hold for the terms that have some.
    """
    if replicates <= len(readings):
        raise ValueError(
            "laws are compared by the covariance of all rows, which takes more replicates than records: "
            f"ask for more than {len(readings)} replicates, got {replicates}"
        )
    asked = law or Law()
    frequencies = [reading.steady.frequency_hz for reading in readings]
    left_out = ""
    terms = [s for s in KNOWN_TERMS if s != FRICTION and s not in asked.given]
    if max(frequencies) < _ALIKE * min(frequencies) and {"c", "eta"} & set(terms) == {"c", "eta"}:
        terms.remove("eta")
        left_out = "at one frequency structural damping eta acts as viscous damping c does, and is not tried"
    random = np.random.default_rng(seed)
    means = [reading.resampled(replicates, random) for reading in readings]
    lines = [reading.lines for reading in readings]
    found: list[tuple[Evidence, WaveformFit | None]] = []
    count = sum(math.comb(len(terms), size) for size in range(MOST_TERMS + 1))
    for size in range(MOST_TERMS + 1):
        enough = [set(e.terms) for e, _ in found if e.p > ALPHA / count]
        for some in itertools.combinations(terms, size):
            if enough and not any(smaller < {FRICTION, *asked.given, *some} for smaller in enough):
                continue  # a smaller law may be the one: only what more terms would add to it is of interest
            tried = Law(
                (FRICTION, *asked.given, *some),
                asked.given,
                {s: of for s, of in asked.groups.items() if s in (FRICTION, *some)},
            )
            if len(tried.unknowns) > len(readings):
                continue
            within = [f for e, f in found if f is not None and set(e.terms) < set(tried.terms)]
            near = sorted(within, key=lambda fit: fit.chi_square)[:1]
            fit = fit_quickly(lines, k, tried, near)
            known = None if mass is None or fit is None else with_mass(fit, mass)
            found.append((_tested(tried, readings, means, known or fit), known or fit))
    evidence = _judged([e for e, _ in found])
    by_balance = all(e.rejected for e in evidence)
    kept = [e for e in evidence if not (e.rejected_by_balance if by_balance else e.rejected)]
    kept = [e for e in kept if e.balance is not None and not math.isnan(e.balance.p)]
    smallest = [e for e in kept if len(e.terms) == min(len(k.terms) for k in kept)]
    smallest.sort(key=lambda e: -(e.p_of_balance if by_balance else e.p))
    chosen = smallest[0].terms if smallest else None
    alike = tuple(e.terms for e in smallest[1:])
    return Comparison(tuple(evidence), chosen, by_balance and bool(kept), alike, left_out)


def _tested(
    law: Law, readings: Sequence[Reading], means: Sequence[Means], fit: WaveformFit | None
) -> Evidence:
    """The evidence for one law.   fit : the oscillator that has it."""
    if fit is None:
        return Evidence(law, {}, None, None)
    waveforms = Probability(
        fit.chi_square, fit.freedom, probability(fit.chi_square, fit.freedom, fit.lines)
    )
    whole = Whole(fit, False, None)
    mine = joined(readings, whole, law)
    rows_of = RowsOf(APPROACHES[YARDSTICK], law, whole, fit.k, "reversal")
    rows = rows_of(sample_of(mine, [reading.mean for reading in mine]).features)
    rows = rows[:, 0]
    drawn = rows_of(sample_of(mine, means).features)
    cycles = min(len(reading.steady.weights) for reading in readings)
    balance, coefficients = _generalised(rows, drawn, cycles)
    return Evidence(law, coefficients, balance, waveforms)


def _generalised(
    rows: Rows, drawn: Rows, cycles: int
) -> tuple[Probability | None, dict[str, tuple[float, float]]]:
    """Test of the rows by generalised least squares, and the coefficients.   drawn : replicates of the rows, (L, r)."""
    used = rows.usable
    rows, drawn = rows[used], drawn[used]
    symbols = [key for key in rows.terms if key not in rows.given]
    freedom = int(used.sum()) - len(symbols)
    estimate = solve(replace(rows, covariance=drawn.scatter()))
    values = {symbol: float(estimate[symbol]) for symbol in symbols}
    if freedom < 0 or not all(map(math.isfinite, values.values())):
        return None, {}
    A = np.column_stack([rows.terms[symbol] for symbol in symbols])
    right = rows.W - sum(p * rows.terms[key] for key, p in rows.given.items())
    for _ in range(_REPEATS):
        factor = np.linalg.cholesky(_covariance(drawn, {**rows.given, **values}))
        white, aim = np.linalg.solve(factor, A), np.linalg.solve(factor, right)
        size = np.linalg.norm(white, axis=0)
        solution = np.linalg.lstsq(white / size, aim)[0] / size
        values = dict(zip(symbols, solution.tolist(), strict=True))
    chi_square = float(np.sum((white @ solution - aim) ** 2))
    inverse = np.linalg.pinv(white / size) / size[:, None]
    errors = np.sqrt(np.sum(inverse**2, axis=1)).tolist()
    found = {s: (values[s], error) for s, error in zip(symbols, errors, strict=True)}
    return Probability(chi_square, freedom, _chance(chi_square, freedom, cycles - 1)), found


def _covariance(drawn: Rows, values: Mapping[str, float]) -> Array:
    """Covariance of the misfits of the rows, (L, L), J²."""
    return np.atleast_2d(np.cov(drawn.misfit(values)))


def _chance(chi_square: float, freedom: int, known: int) -> float:
    """Probability of a χ² as large, with a covariance from `known` degrees of freedom."""
    from scipy import special  # slow to import

    return float(special.fdtrc(freedom, known, chi_square / freedom)) if freedom else math.nan


def _judged(evidence: Sequence[Evidence]) -> list[Evidence]:
    """The evidence with what Holm's procedure rejects."""
    both = _rejected([e.p for e in evidence])
    alone = _rejected([e.p_of_balance for e in evidence])
    return [
        replace(e, rejected=one, rejected_by_balance=other)
        for e, one, other in zip(evidence, both, alone, strict=True)
    ]


def _rejected(p: Sequence[float]) -> list[bool]:
    """Holm's procedure: the smallest p, the second … are rejected while below ALPHA/n, ALPHA/(n − 1) …"""
    order = sorted(range(len(p)), key=lambda i: p[i])
    rejected = [False] * len(p)
    for rank, i in enumerate(order):
        if p[i] > ALPHA / (len(p) - rank):
            break
        rejected[i] = True
    return rejected
