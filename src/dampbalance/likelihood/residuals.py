"""Whether the residuals of a fit are the white noise it assumes: two tests that can fail.

Harmonics: what the model lacks (another law of friction, a nonlinear spring) repeats with the drive. The power of the
residual at its harmonics 1 … H, over the variance per sample of the rest, is χ² with 2H degrees of freedom for white
noise, less one for each fitted parameter.
Whiteness: a wrong frequency, drift or filtered noise correlates neighbouring samples. Ljung & Box (1978):
Q = n (n + 2) Σ_{l ≤ L} r_l²/(n − l) is χ² with L degrees of freedom for white noise, r_l the autocorrelation at lag l.

Both are summed over channels and records.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy import special  # scipy.stats has the same functions, and takes seconds to import

from ..arrays import Array
from .information import products

_HARMONICS = 9
_LAGS = 20
_FEWEST = 100  # samples; with fewer, neither statistic follows its distribution
# Of the signal's rms: a residual below it is rounding, and says nothing of the model.
_ROUNDING = 1e-9


@dataclass(frozen=True, slots=True)
class Adequacy:
    """Statistics of the two tests and the probability that white noise exceeds them (NaN: not tested).

    harmonics, whiteness : χ² per degree of freedom, close to 1 for an adequate model.
    """

    harmonics: float
    harmonics_p: float
    whiteness: float
    whiteness_p: float


class Residual(NamedTuple):
    """What a fit leaves of one channel of one record, each (n,): measured minus model, the measured signal, and the
    phase ωt of the drive, rad, in equal steps."""

    values: Array
    signal: Array
    phase: Array


def adequacy(residuals: Iterable[Residual], fitted: int) -> Adequacy:
    """Test the residuals of a fit; `fitted` counts its parameters except offsets and frequencies."""
    power = correlation = 0.0
    power_dof, correlation_dof = 0, 0
    for r, signal, phase in residuals:
        centred = r - r.mean()
        if r.size < _FEWEST or np.sqrt(np.mean(centred**2)) <= _ROUNDING * np.std(signal):
            continue
        statistic, dof = _harmonic_power(centred, phase)
        power, power_dof = power + statistic, power_dof + dof
        correlation += _ljung_box(centred)
        correlation_dof += _LAGS
    power_dof -= fitted
    harmonics, harmonics_p = _verdict(power, power_dof)
    return Adequacy(harmonics, harmonics_p, *_verdict(correlation, correlation_dof))


def _verdict(statistic: float, dof: int) -> tuple[float, float]:
    if dof <= 0:
        return math.nan, math.nan
    return statistic / dof, float(special.chdtrc(dof, statistic))


def _harmonic_power(r: Array, phase: Array) -> tuple[float, int]:
    """Power of r at the harmonics of the phase ωt, over its variance off them; and degrees of freedom."""
    step = float(phase[-1] - phase[0]) / (phase.size - 1)
    highest = min(_HARMONICS, math.floor(0.9 * math.pi / step))
    if highest < 1 or phase[-1] - phase[0] < 4.0 * math.pi:  # two cycles tell harmonics apart
        return 0.0, 0
    turn = np.exp(1j * phase)
    lines = [turn]
    for _ in range(1, highest):
        lines.append(lines[-1] * turn)
    basis = np.array([part for line in lines for part in (line.real, line.imag)])
    basis -= basis.mean(axis=1, keepdims=True)
    slope = products(basis, r[None])[:, 0]
    explained = float(slope @ np.linalg.solve(products(basis, basis), slope))
    dof = 2 * highest
    variance = (float(np.sum(r * r)) - explained) / (r.size - 1 - dof)
    return (explained / variance if variance > 0.0 else math.inf), dof


def _ljung_box(r: Array) -> float:
    n = r.size
    lags = np.arange(1, _LAGS + 1)
    autocorrelation = np.array([np.sum(r[lag:] * r[:-lag]) for lag in lags]) / np.sum(r * r)
    return float(n * (n + 2) * np.sum(autocorrelation**2 / (n - lags)))
