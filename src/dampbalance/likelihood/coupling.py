"""Whether a response that is coupled through a capacitor (AC) would explain what a fit leaves.

Such a channel is a high-pass filter of first order with a corner f_c, iω/(iω + 2πf_c): it turns harmonic n by
arctan f_c/(nf) ahead, the fundamental most. Part of that is made up for by other parameters, c above all; the rest
shows in χ². To first order in f_c the fall of χ² costs nothing; where it is large, the coupling is taken out of the
harmonics and the oscillator fitted again, with the corner that makes χ² least.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array, Complexes, Integers
from .steady_search import climb_on
from .waveforms import WaveformFit

_STEPS = 5  # of Newton's method: χ² is nearly a parabola in the corner
_SMALL = 0.01  # standard errors of the corner: a step that does not matter


@dataclass(frozen=True, slots=True)
class Coupling:
    """AC coupling of the response that would explain what a fit leaves.

    hz, error_hz : corner and its standard error, Hz.   gain : by how much χ² falls.   fit : to the harmonics without
    the coupling.
    """

    hz: float
    error_hz: float
    gain: float
    fit: WaveformFit


def ac_coupling(fit: WaveformFit, shows: float) -> Coupling | None:
    """The AC coupling that makes χ² least; None where it falls by no more than `shows`, or the corner is none."""
    hz, last = 0.0, fit
    for _ in range(_STEPS):
        by_hz = _by_corner(last, hz)
        information = float(by_hz @ by_hz)
        step = -float(by_hz @ last.residual) / information if information else 0.0
        if not hz and not (step > 0.0 and step**2 * information > shows):
            return None
        hz = max(hz + step, 0.0)
        freed = [replace(one, x=one.x / _passed(hz, one.omega, one.n)) for one in fit.lines]
        following = climb_on(last, freed)
        if following is None:
            return None
        last = following
        if abs(step) * math.sqrt(information) < _SMALL:
            break
    gain = fit.chi_square - last.chi_square
    return Coupling(hz, information**-0.5, gain, last) if gain > shows else None


def _passed(hz: float, omega: float, n: Integers) -> Complexes:
    """What passes a high-pass filter of first order with a corner in Hz at the harmonics n of ω."""
    rates: Array = omega * n.astype(np.float64)
    passed: Complexes = 1j * rates / (1j * rates + 2.0 * math.pi * hz)
    return passed


def _by_corner(fit: WaveformFit, hz: float) -> Array:
    """Derivatives of the residuals by the corner, 1/Hz, as far as no unknown of the fit makes up for them.

    Of x_n (1 + 2πf_c/(inω)) that is x_n 2π/(inω), with the sign of data in a residual.
    """
    by_hz = np.zeros(fit.residual.size)
    for one, place in zip(fit.lines, fit.places, strict=True):
        change = 2.0j * math.pi / (one.n * one.omega) * _passed(hz, one.omega, one.n)
        change = change * one.x / one.x_error
        by_hz[place] = np.concatenate([[0.0, 0.0], change.real, change.imag])
    unknowns = fit.response[np.any(fit.response != 0.0, axis=1)].T
    return by_hz - unknowns @ np.linalg.lstsq(unknowns, by_hz)[0]
