"""Random draws of read-outs about their exact values.

Could read-outs that the paper does not print keep a bound that it states (`drawn`)? At ω2 and ω3 the paper states
errors of its two-point formulas without the read-outs behind them. A bound is open if some read-outs that the authors
may have used keep it and others do not. The formulas are those of Table 3, with one φ and one t_s for all levels; X of
each level and the one φ are drawn uniformly about their exact values, and X + X_s stays exact.

How much does the rounding of Table 1 cost the Fourier balance (`rounding_errors`)? Its read-outs are drawn uniformly
within half a unit of their last decimal, like the rounding errors of arbitrary values: those of one experiment are one
draw of many.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...balance import Rows, fourier
from ...features import Features
from ...project.case import Case
from ...solver import solve
from ..authors_route import APPROACHES_OF_TABLE_3
from ..numbers import COEFFICIENTS, HARMONIC_APPROACHES
from .printed import PAIRS

DRAWS = 10_000
"""Number of draws of the read-outs, which determines a share to half a per cent."""

SEED = 2010

SPREADS = ((1e-6, 3e-3), (2e-6, 4e-3), (5e-6, 5e-4))
"""Half widths of X, m, and φ, rad: a unit of the X behind Table 3 and two of its units, with a φ as far off as those of
Table 1 are read; and half a unit of the decimals of Table 1, which the paper says that it used."""

ROUNDED = (0.5e-6, 0.0)
"""Half widths of X, m, and φ, rad, where X is rounded as for Table 3 and φ is exact."""

DECIMALS = {"X": 5, "X_s": 5, "X_1": 5, "X_3": 5, "X_5": 5, "phi_fundamental": 3}
"""Decimals of what the Fourier balance reads, m and rad: X, X_s and φ as in Table 1, the harmonics as X."""

RARE = 0.05
"""A bound is decided if less than this share of the draws exceeds it, or less than this share keeps it."""


class Drawn(NamedTuple):
    """The share of draws whose largest error exceeds a bound.

    X_m, phi_rad : half widths of what was drawn.   share : of the draws.
    low, high : quantiles RARE and 1 − RARE of the largest error, per cent.
    """

    X_m: float
    phi_rad: float
    share: float
    low: float
    high: float


def drawn(
    exact: Features, case: Case, bound: float, spreads: Sequence[tuple[float, float]] = SPREADS
) -> list[Drawn]:
    """Draw the largest error of F_k and c over the pairs of levels and compare it with a bound, per cent.

    exact : exact features at the frequency.   spreads : half widths, as SPREADS.
    """
    shares = []
    for X_m, phi_rad in spreads:
        errors = _largest_errors(exact, case, X_m, phi_rad)
        low, high = np.quantile(errors, [RARE, 1.0 - RARE])
        share = float(np.mean(errors > bound))
        shares.append(Drawn(X_m, phi_rad, share, float(low), float(high)))
    return shares


def open_to(drawn: Sequence[Drawn]) -> bool:
    """Return whether some read-outs keep a bound and others do not, for at least one of the spreads."""
    return any(RARE <= spread.share <= 1.0 - RARE for spread in drawn)


def exceedances_in_words(drawn: Sequence[Drawn], bound: str) -> str:
    """Return sentences on how often the bound, as printed, is exceeded."""
    cases = [
        f"{100.0 * spread.share:.0f} % with X ± {1e6 * spread.X_m:g} µm and phi ± {spread.phi_rad:g} rad"
        for spread in drawn
    ]
    return (
        "The read-outs at this frequency are not printed. Of "
        f"{DRAWS:,} random ones about the exact values, the largest error exceeds {bound} % in {', '.join(cases)}."
    )


def rounding_errors(exact: Features, case: Case, more: int = 0) -> Array:
    """Return the largest error of F_k by the Fourier balance over the pairs of levels, per cent, a number per draw.

    Its distribution shows what rounding all read-outs to DECIMALS costs.

    exact : exact features at the frequency.   more : further decimals that are kept.
    """
    random = np.random.default_rng(SEED)
    many = _repeated(exact)
    read = {
        name: getattr(many, name)
        + 10.0 ** -(decimals + more) * random.uniform(-0.5, 0.5, many.X.shape)
        for name, decimals in DECIMALS.items()
    }
    return _worst_of_pairs(fourier(many.replaced(**read), case.oscillator.k), case, ["F_k"])


def _largest_errors(exact: Features, case: Case, X_m: float, phi_rad: float) -> Array:
    """Return the largest error of F_k and c over the pairs by all harmonic approaches, per cent, a number per draw."""
    random = np.random.default_rng(SEED)
    many = _repeated(exact.with_common("phi", "t_s"))
    moved = X_m * random.uniform(-1.0, 1.0, many.X.shape)
    read = many.replaced(
        X=many.X + moved,
        X_s=many.X_s - moved,
        phi=many.phi + phi_rad * random.uniform(-1.0, 1.0, DRAWS),
    )
    largest = np.zeros(DRAWS)
    for name in HARMONIC_APPROACHES:
        rows = APPROACHES_OF_TABLE_3[name](read, case.oscillator.k)
        largest = np.maximum(largest, _worst_of_pairs(rows, case, COEFFICIENTS))
    return largest


def _repeated(features: Features) -> Features:
    """Return features with a second axis of DRAWS equal entries."""
    return features[:, None][:, np.zeros(DRAWS, dtype=np.int64)]


def _worst_of_pairs(rows: Rows, case: Case, symbols: Sequence[str]) -> Array:
    """Return the largest error of these coefficients over the pairs of levels, per cent, a number per draw."""
    estimate = solve(rows[np.transpose(PAIRS)])
    true = {symbol: getattr(case.oscillator, symbol) for symbol in symbols}
    errors = [np.abs(estimate[symbol] / of - 1.0).max(axis=0) for symbol, of in true.items()]
    return 100.0 * np.max(errors, axis=0)
