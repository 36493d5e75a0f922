"""Whether a fault of a channel would explain what a fit leaves: a response that is coupled through a capacitor (AC), or
a drive whose gain is wrong.

An AC-coupled channel is a high-pass filter of first order with a corner f_c, iω/(iω + 2πf_c): it turns harmonic n by
arctan f_c/(nf) ahead, the fundamental most. A drive that reads (1 + g)Y for Y makes the fit take g too much work and
stiffness, in the fundamental alone. Part of either is made up for by other parameters, c and m above all; the rest
shows in χ². To first order in the size of a fault the fall of χ² costs nothing; where it is large, the fault is taken
out of the harmonics and the oscillator fitted again, with the size that makes χ² least.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array, Complexes
from ..signals.lines import Lines
from .steady_search import climb_on
from .waveforms import WaveformFit

_STEPS = 5  # of Newton's method: χ² is nearly a parabola in the size of the fault
_SMALL_FAULT = 0.01  # standard errors of the size: a step that does not matter
_DIFFERENCE = 1e-4  # of the unit of a size: derivatives to 1e-4, far above rounding
_LARGEST_GAIN = 0.5  # of a gain: beyond it, a channel has another unit and no fault of calibration

Freed = Callable[[Lines, float], Lines]
"""The harmonics of a record without a fault of a size."""


@dataclass(frozen=True, slots=True)
class ChannelFault:
    """A fault of a channel that would explain what a fit leaves.

    kind : "coupling", whose size is the corner, Hz; "drive", by which part too much the drive reads; "delay", of the
    response, s.   size, error : and its standard error.   fit : to the harmonics without the fault.
    """

    kind: str
    size: float
    error: float
    fit: WaveformFit


def ac_coupling(fit: WaveformFit, shows: float) -> ChannelFault | None:
    """The AC coupling that makes χ² least; None where it falls by no more than `shows`, or the corner is none."""
    hz = min(one.omega for one in fit.lines) / (2.0 * math.pi)
    return _fault(fit, "coupling", _without_coupling, (0.0, math.inf), hz, shows)


def drive_gain(fit: WaveformFit, shows: float) -> ChannelFault | None:
    """The gain of the drive that makes χ² least; None where it falls by no more than `shows`, or no such gain is left
    below a unit."""
    return _fault(fit, "drive", _without_gain, (-_LARGEST_GAIN, _LARGEST_GAIN), 1.0, shows)


def _fault(
    fit: WaveformFit,
    kind: str,
    freed: Freed,
    bounds: tuple[float, float],
    unit: float,
    shows: float,
) -> ChannelFault | None:
    """The size of a fault that makes χ² least.   unit : of the size, which a derivative takes a small part of."""
    size, last = 0.0, fit
    for _ in range(_STEPS):
        by_size = _by_size(fit, last, freed, size, _DIFFERENCE * unit)
        information = float(by_size @ by_size)
        step = -float(by_size @ last.residual) / information if information else 0.0
        moved = min(max(size + step, bounds[0]), bounds[1])
        if last is fit and not (moved and step**2 * information > shows):
            return None
        size = moved
        following = climb_on(last, [freed(one, size) for one in fit.lines])
        if following is None:
            return None
        last = following
        if abs(step) * math.sqrt(information) < _SMALL_FAULT:
            break
    inside = size not in bounds
    shown = fit.chi_square - last.chi_square > shows
    return ChannelFault(kind, size, information**-0.5, last) if inside and shown else None


def _without_coupling(one: Lines, hz: float) -> Lines:
    """The harmonics before a high-pass filter of first order with a corner in Hz; of a relative motion, that passed it
    before the base's was added."""
    rates: Array = one.omega * one.n.astype(np.float64)
    base = _added(one)
    return replace(one, x=(one.x - base) * (1.0 + 2.0 * math.pi * hz / (1j * rates)) + base)


def _without_gain(one: Lines, gain: float) -> Lines:
    """The harmonics under a drive that was read as 1 + gain times itself."""
    Y = one.Y / (1.0 + gain)
    base = _added(one)
    return replace(one, Y=Y, base=one.base / (1.0 + gain), x=one.x - base * (1.0 - Y / one.Y))


def with_response(one: Lines, factor: float) -> Lines:
    """The harmonics of a response that was read in another unit, by a factor."""
    base = _added(one)
    return replace(one, x=(one.x - base) * factor + base, x_error=one.x_error * factor)


def _added(one: Lines) -> Complexes:
    """The motion of the base that was added to a relative one, as read, m, (h,)."""
    return np.where(one.n == 1, one.Y * one.relative, 0.0).astype(np.complex128)


def _by_size(fit: WaveformFit, last: WaveformFit, freed: Freed, size: float, step: float) -> Array:
    """Derivatives of the residuals by the size of a fault, as far as no unknown of the fit makes up for them."""
    by_size = np.zeros(fit.residual.size)
    for one, place in zip(fit.lines, fit.places, strict=True):
        less, more = freed(one, size), freed(one, size + step)
        x, Y = (more.x - less.x) / one.x_error, (more.Y - less.Y) / one.Y_error
        by_size[place] = -np.concatenate([[Y, 0.0], x.real, x.imag]) / step
    unknowns = last.response[np.any(last.response != 0.0, axis=1)].T
    return by_size - unknowns @ np.linalg.lstsq(unknowns, by_size)[0]
