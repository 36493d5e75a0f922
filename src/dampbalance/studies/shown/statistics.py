"""Statistics of errors: their sizes over all cases, or over many runs, with the uncertainty from their number."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from scipy import special

from ...arrays import Array, Integers
from ...balance import TERMS
from ...model import BaseMotion
from ...motion.orbit import NoSteadyOrbit, steady_orbit
from ..bound import fit_at_truth
from ..case_files import CasesLike, column_of
from ..cases import cases_between
from ..parameters import oscillator_of
from ..study_file import Estimator, Study

# Bins of sizes: a quantile is good to 0.06 %, below the three digits that are shown.
_PER_DECADE = 2000
_LOWEST, _HIGHEST = -18, 8  # decades: smaller and larger sizes fall into the first and the last bin

_NO_VALUES: Array = np.empty(0)


class Sizes:
    """Sizes of errors: how many there are, their extremes and quantiles. Missing errors count as cases only."""

    def __init__(self, errors: Array, within: float) -> None:
        size = np.abs(errors)
        size = size[np.isfinite(size)]
        self.cases, self.known = len(errors), len(size)
        self.within = int(np.count_nonzero(size <= within))
        self.smallest = float(size.min(initial=np.inf))
        self.largest = float(size.max(initial=-np.inf))
        count = (_HIGHEST - _LOWEST) * _PER_DECADE
        bins = places_of(size, _LOWEST, _PER_DECADE, count)
        self._reached = np.cumsum(np.bincount(bins, minlength=count))

    @property
    def share(self) -> float:
        """Share of all cases whose error is within the bound."""
        return self.within / self.cases

    def quantile(self, share: float) -> float:
        """Return the size that this share of the finite errors does not exceed, to 0.06 %; NaN without one."""
        if not self.known:
            return math.nan
        reached = int(np.searchsorted(self._reached, max(1.0, share * self.known)))
        middle = 10.0 ** (_LOWEST + (reached + 0.5) / _PER_DECADE)
        return float(min(max(middle, self.smallest), self.largest))


def places_of(errors: Array, lowest: int, per_decade: int, count: int) -> Integers:
    """Return the places of the sizes of errors in a histogram over their logarithms, the last one where they are
    unknown.

    lowest : decade at which it begins.   count : number of its places; what lies beyond them falls into the outer ones.
    """
    with np.errstate(divide="ignore"):  # log 0: the first place
        places = (np.log10(np.abs(errors)) - lowest) * per_decade
    return np.clip(np.nan_to_num(places, nan=np.inf), 0, count - 1).astype(np.int64)


def worst_errors(study: Study, cases: CasesLike, spec: Mapping[str, Any]) -> Array:
    """Return the error in each case by the fit that a figure or a number selects; with several fits (all pairs) the
    largest among them."""
    names = [f"{spec['of']}_relative_error__{fit.label}" for fit in study.fits_of(spec)]
    errors = np.array([column_of(cases, name) for name in names])
    sizes = np.where(np.isfinite(errors), np.abs(errors), -1.0)
    return np.take_along_axis(errors, sizes.argmax(axis=0)[None], axis=0)[0]


def spread(
    errors: Array, standard_errors: Array = _NO_VALUES, covered: Array = _NO_VALUES
) -> dict[str, float]:
    """Return statistics of an estimator over n runs. All except the counts are relative to the true value; NaN if
    unknown.

    runs, identified : how many there are, and have an estimate.   bias : mean error.   bias_error : its standard error,
    scatter/√n.   scatter : standard deviation of the errors.   rms : root of their mean square.   median, p95 : sizes
    that half and 95 % do not exceed.   p95_error : standard error of the latter, see `quantile_error`.
    standard_error : rms of the stated ones.   standard_error_error : its standard error, s(x²)/(2 rms √n).
    coverage : share of the runs whose 95 % interval holds the true value.   coverage_low, coverage_high : its 95 %
    interval, see `share_interval`.
    """
    finite, stated, judged = (x[np.isfinite(x)] for x in (errors, standard_errors, covered))
    n, squares, rms_error = len(finite), stated**2, math.nan
    if len(squares) > 1 and squares.any():
        rms_error = float(squares.std(ddof=1) / (2.0 * np.sqrt(squares.mean() * len(squares))))
    scatter = float(finite.std(ddof=1)) if n > 1 else np.nan
    sizes, shares = np.abs(finite), (0.5, 0.95)
    median, p95 = np.quantile(sizes, shares, method="inverted_cdf") if n else (np.nan, np.nan)
    low, high = share_interval(int(judged.sum()), len(judged))
    return {
        "runs": len(errors),
        "identified": n,
        "bias": _mean(finite),
        "bias_error": scatter / np.sqrt(n) if n else np.nan,
        "scatter": scatter,
        "rms": math.sqrt(_mean(finite**2)),
        "median": median,
        "p95": p95,
        "p95_error": quantile_error(sizes, 0.95),
        "standard_error": math.sqrt(_mean(squares)),
        "standard_error_error": rms_error,
        "coverage": _mean(judged),
        "coverage_low": low,
        "coverage_high": high,
    }


def spread_of(
    study: Study, cases: CasesLike, quantity: str, fit: Estimator, kept: Integers
) -> dict[str, float]:
    """Return the `spread` of one quantity by one fit over the cases with the numbers `kept`."""
    names = ["relative_error"]
    if "intervals" in study.columns:
        names += ["relative_standard_error", "covered"]
    return spread(*(column_of(cases, f"{quantity}_{name}__{fit.label}")[kept] for name in names))


def groups(cases: CasesLike, by: Sequence[str]) -> Iterator[tuple[dict[str, Any], Integers]]:
    """Yield ({axis: value}, numbers of the cases) for each combination of values of the axes `by`, in the order of the
    cases."""
    values = pd.DataFrame({name: column_of(cases, name) for name in by})
    for where, rows in values.groupby(list(by), sort=False):
        yield dict(zip(by, where, strict=True)), rows.index.to_numpy()


def _mean(values: Array) -> float:
    return float(values.mean()) if len(values) else np.nan


def quantile_error(values: Array, share: float) -> float:
    """Maritz–Jarrett standard error of a sample quantile.

    The quantile is the order statistic x_(k) of n independent values, k = ⌈share · n⌉; its standard error is the
    standard deviation over all drawings of n values with replacement:

        P(x*_(k) ≤ x_(i)) = I_{i/n}(k, n − k + 1)   (the incomplete beta function)

    Good to 40 % from 50 values; NaN where the quantile is the largest value, for which this gives no error.
    """
    n, k = len(values), math.ceil(share * len(values))
    if k == n:
        return math.nan
    weights = np.diff(special.betainc(k, n - k + 1, np.arange(n + 1) / n))
    ordered = np.sort(values)
    return float(np.sqrt(weights @ (ordered - weights @ ordered) ** 2))


def share_interval(count: int, runs: int) -> tuple[float, float]:
    """Return the 95 % interval of a probability observed in `count` of `runs` (Wilson's score interval); NaN without a
    run."""
    if runs == 0:
        return math.nan, math.nan
    from scipy import stats  # slow to import

    interval = stats.binomtest(count, runs).proportion_ci(method="wilson")
    return float(interval.low), float(interval.high)


def bounds_of(study: Study, cases: Integers) -> dict[str, float]:
    """Return the smallest relative standard error of an unbiased estimate from the records of a case, by term.

    cases : numbers of cases that differ only by their noise (the axis `run`). The Cramér–Rao bound takes m, k and the
    drive frequency as known and K_z as unknown. NaN where the records are not noisy ones, the cases differ in more,
    nothing slips, the contact yields gradually, or the likelihood has no such term.
    """
    nothing = dict.fromkeys(TERMS, math.nan)
    if not study.route.is_noisy or not cases.size:
        return nothing
    first = int(cases.min())
    held = cases_between(study, first, int(cases.max()) + 1)
    here = {name: array[cases - first] for name, array in held.values.items() if name != "run"}
    if any(len(set(array.tolist())) > 1 for array in here.values()) or here["noise"][0] == 0.0:
        return nothing
    if here.get("slip_range", [1.0])[0] > 1.0:  # the bound is that of one slider
        return nothing
    at, omega = int(cases[0]) - first, float(held.si["omega"][cases[0] - first])
    osc = oscillator_of(held.si, at)
    motions = [BaseMotion(float(Y), omega) for Y in held.Y[:, at]]
    try:
        samples = round(float(here["sampling_hz"][0]) * study.cycles * motions[0].period)
        # the noise is a part of the rms of each clean channel; 64 odd harmonics hold all digits of it
        part = float(here["noise"][0]) / math.sqrt(samples)
        x = [np.linalg.norm(steady_orbit(osc, motion).harmonics(64)) for motion in motions]
        errors = [(part * motion.Y, part * float(X)) for motion, X in zip(motions, x, strict=True)]
        fit = fit_at_truth(osc, motions, errors)
    except (ValueError, NoSteadyOrbit, ArithmeticError):
        return nothing
    if fit is None:
        return nothing
    return nothing | {s: fit.error(s) / fit.value(s) if fit.value(s) else math.inf for s in TERMS}
