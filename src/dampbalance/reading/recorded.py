"""What a record adds to the harmonics of a motion under a harmonic base: the motion that further harmonics of the base
cause.

The fit of an oscillator compares the harmonics of a record with those of the exact motion under y = Y cos ωt. What
differs because the base moves otherwise, Δ_n, follows from the oscillator itself and from the harmonics y_n of the
base, which are measured: by the exact motion under all of them (`motion/distorted.py`), not to first order. The fit is
made to x_n − Δ_n, Δ_n is computed anew for the oscillator found, and so on until it stays as it is: the residuals of
that fit are exact, its derivatives are those under the harmonic base.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..arrays import Complexes
from ..law.law import Law
from ..law.steady import Response
from ..motion.distorted import distorted_harmonics
from ..motion.orbit import NoSteadyOrbit
from .fitting import climb_on, fit_oscillator
from .lines import Lines
from .waveforms import WaveformFit

_MOST = 12  # repetitions; each leaves some hundredths of the change before
_STAYS = 1e-2  # of the error of a harmonic: a change that does not matter


def fit_records(
    lines: Sequence[Lines], k: float, law: Law | None = None, *, thorough: bool = True
) -> WaveformFit | None:
    """The oscillator of largest likelihood for records whose base need not be harmonic; arguments as for
    `fitting.fit_oscillator`, whose fit it is where the base is harmonic.

    The harmonics of the fit, `fit.lines`, are those of the records without what the harmonics of the base add.
    """
    plain = not any(one.base.any() for one in lines)
    fit = fit_oscillator(lines, k, law, thorough=thorough and plain)
    if plain or fit is None:
        return fit
    fit = settled(fit, lines)
    if fit.adequate or not thorough:
        return fit
    # the first climbs may have led elsewhere, misled by the harmonics of the base
    again = fit_oscillator(fit.lines, k, law)
    return min((fit, settled(again or fit, lines)), key=lambda one: one.chi_square)


def settled(fit: WaveformFit, lines: Sequence[Lines]) -> WaveformFit:
    """The fit to these harmonics without what the base of the fit's own oscillator adds to them; the fit itself where
    the base is harmonic. Use it after a fit that took the harmonics as they are, or those of another fit."""
    if not any(one.base.any() for one in lines):
        return fit
    for _ in range(_MOST):
        freed = [
            replace(one, x=one.x - added(one.base, response, one.n.size))
            for one, response in zip(lines, fit.responses, strict=True)
        ]
        moved = max(
            float(np.max(np.abs(new.x - old.x) / new.x_error))
            for new, old in zip(freed, fit.lines, strict=True)
        )
        following = climb_on(fit, freed)
        if following is None:
            break
        fit = following
        if moved < _STAYS:
            break
    return fit


def added(base: Complexes, response: Response, count: int) -> Complexes:
    """Δ_n, n = 1, 3 … 2 count − 1, m: what harmonics of the base add to those of a motion, (count,).

    base : y_n, n = 2, 3 …, m, phases counted from the peak of the fundamental.   response : the motion under the
    fundamental alone.
    """
    n = np.arange(1, 2 * count, 2)
    if not base.any():
        return np.zeros(count, dtype=np.complex128)
    orbit, order = response.orbit, np.arange(2, base.size + 2)
    # a damper to the base moves the mass as well: the base of the orbit is (1 + inω c_r/k) y_n
    to_base = 1.0 + 1j * order * math.tan(response.advance + response.turned)
    y = np.append(orbit.motion.Y, base * to_base * np.exp(-1j * order * response.advance))
    try:
        change = distorted_harmonics(orbit, y, 2 * count)[::2] - orbit.harmonics(count)
    except NoSteadyOrbit:
        # as if it slipped on
        own, rates = orbit.oscillator, n * orbit.motion.omega
        forced = np.zeros(2 * count, dtype=np.complex128)
        forced[1 : y.size] = own.k * y[1 : forced.size]
        change = forced[::2] / (own.k - rates**2 * own.m + 1j * rates * own.c)
    return change * np.exp(1j * n * response.advance)
