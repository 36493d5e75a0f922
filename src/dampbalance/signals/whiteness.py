"""Tests of whether the residual of a fit is white noise, and as large as the noise of the record.

Each gives the probability that white noise gives a statistic at least as large. Averages over parts of a cycle reveal a
slow motion, a line of the spectrum a fast one, and third differences measure the noise of the record independently of
the model.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy import special

from ..arrays import Array
from .bursts import QUIET_PARTS, noise_of

# Least variance taken for noise, relative to the stated one: the residual of a record without noise is rounding.
_SHARE_OF_ROUNDING = 0.1


def averages(
    residuals: Sequence[Array], widths: Sequence[int], lost: int
) -> tuple[float, int, int]:
    """Return the F ratio of averages of residuals to the scatter about them, and its two degrees of freedom.

    widths : number of samples in an average, for each residual.   lost : degrees of freedom used by the fit.
    """
    between = within = 0.0
    bins = count = 0
    for residual, width in zip(residuals, widths, strict=True):
        n = residual.size // width
        parts = residual[: n * width].reshape(n, width)
        means = parts.mean(axis=1)
        between += width * float(means @ means)
        within += float(np.sum((parts - means[:, None]) ** 2))
        bins, count = bins + n, count + n * width
    first, rest = max(1, bins - lost), max(1, count - bins)
    return (between / first) / max(within / rest, _SHARE_OF_ROUNDING), first, rest


def chance_of_averages(residuals: Sequence[Array], widths: Sequence[int], lost: int) -> float:
    """Return the probability that averages of white noise over these widths, or a half, a quarter, … of them, are as
    large."""
    chances = []
    while True:
        ratio, first, rest = averages(residuals, widths, lost)
        chances.append(float(special.fdtrc(first, rest, ratio)))
        if max(widths) <= 2:
            return min(1.0, len(chances) * min(chances))
        widths = [max(2, width // 2) for width in widths]


def chance_of_lines(residuals: Sequence[Array]) -> float:
    """Return the probability that a spectrum of white noise has as sharp a line (Fisher's test)."""
    chances = [1.0]
    for residual in residuals:
        power = np.abs(np.fft.rfft(residual)[1:-1]) ** 2
        # the residual of a record without noise is rounding
        total = max(float(power.sum()), _SHARE_OF_ROUNDING * residual.size * power.size)
        if power.size > 2:
            share = float(power.max()) / total
            chances.append(min(1.0, power.size * (1.0 - share) ** (power.size - 1)))
    return min(1.0, len(residuals) * min(chances))


def excess_over_noise(residual: Array, values: Array, noise: float) -> float:
    """Return the ratio of a residual to the noise of the samples if it exceeds chance; otherwise 1.

    residual : in units of `noise`.   values : the samples.
    """
    # fewer samples do not measure the noise
    if values.size < 400:
        return 1.0
    ratio = math.sqrt(float(np.mean(residual**2))) * noise / noise_of(values)
    # relative error of the median of n third differences, 1.77/√n
    error = 1.77 / math.sqrt(values.size / QUIET_PARTS)
    # six standard errors: the noise is the smallest of several medians
    return ratio if ratio > 1.05 + 6.0 * error else 1.0
