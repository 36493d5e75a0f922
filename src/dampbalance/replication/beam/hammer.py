"""The damping of one mode against its amplitude, from the decay after a blow.

A band-pass filter leaves one mode, whose analytic signal a(t) = A e^{iψ} (Hilbert's transform) has the envelope A and
the frequency ψ̇. The envelope of a mode that loses W(X) in a cycle obeys

    Ẋ = −ζ(X) ω X,      ζ(X) = W(X)/(2π m ω² X²),      X = A/ω² of an acceleration

so that the slope of ln A over a few cycles is −ζω at that amplitude (Feldman, Mech. Syst. Signal Process. 25 (2011)).
The filter smears the blow over the time 1/bandwidth and smooths A where it bends: `filter_bias` puts a decay of known
damping through the same steps and reports what comes out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import signal

from ...arrays import Array

_ORDER = 4  # of Butterworth's filter, which runs forward and backward: no delay


@dataclass(frozen=True, eq=False)
class ModalDecay:
    """A mode while it decays, at the middles of windows.

    t : s.   X : amplitude of displacement, m.   frequency_hz : instantaneous frequency.   zeta : damping ratio; (n,).
    """

    t: Array
    X: Array
    frequency_hz: Array
    zeta: Array


def modal_decay(
    t: Array, acceleration: Array, band_hz: tuple[float, float], *, start: float, window: float
) -> ModalDecay:
    """The amplitude, frequency and damping ratio of the mode in a band, window after window.

    t : s, evenly spaced, (n,).   acceleration : m/s², (n,).   band_hz : of the filter; it must hold the mode and no
    other one.   start : of the first window, s; late enough for the filter to have forgotten the blow.   window : s,
    several cycles long and short compared with the decay.

    Raises ValueError for a band that the sampling does not hold, a window of less than a cycle, and a record of less
    than two windows.
    """
    rate = (len(t) - 1) / (t[-1] - t[0])
    if not 0.0 < band_hz[0] < band_hz[1] < 0.5 * rate:
        raise ValueError(
            f"band_hz must lie between 0 and half the sampling rate, {0.5 * rate:.6g} Hz: got {list(band_hz)}"
        )
    if not window * band_hz[0] >= 1.0:
        raise ValueError(
            f"window_s must be a cycle of the band's lowest frequency at least, {1.0 / band_hz[0]:.3g} s, better "
            f"several: got {window:g}"
        )
    passed = signal.butter(_ORDER, band_hz, "bandpass", fs=rate, output="sos")
    analytic = signal.hilbert(signal.sosfiltfilt(passed, acceleration))
    log, phase = np.log(np.abs(analytic)), np.unwrap(np.angle(analytic))
    length, first = round(window * rate), int(np.searchsorted(t, start))
    # the last window, too, is where the filter has run out of neither end
    windows = (len(t) - first) // length - 1
    if windows < 1:
        raise ValueError(
            f"a record from {t[0]:.6g} to {t[-1]:.6g} s holds no two windows of {window:g} s after {start:g} s: "
            "shorten window_s or start_s"
        )
    parts = np.arange(first, first + windows * length).reshape(windows, length)
    step = (np.arange(length) - 0.5 * (length - 1)) / rate
    slope, omega = (of[parts] @ step / (step @ step) for of in (log, phase))
    X = np.exp(log[parts].mean(axis=1)) / omega**2
    return ModalDecay(t[parts].mean(axis=1), X, omega / (2.0 * math.pi), -slope / omega)


def filter_bias(
    decay: ModalDecay, t: Array, band_hz: tuple[float, float], *, start: float, window: float
) -> Array:
    """Relative error of ζ that filter and windows make at each window: of a blow at t[0] after which the mode decays as
    `decay` says, (n,).

    Between the amplitudes of the decay ζ is interpolated over ln X; beyond them it stays as it is.
    """
    order = np.argsort(decay.X)
    at, known = np.log(decay.X[order]), decay.zeta[order]
    omega = 2.0 * math.pi * float(decay.frequency_hz.mean())
    step = (t[-1] - t[0]) / (len(t) - 1)
    # backward and forward from the first window, where X is known
    first = int(np.searchsorted(t, decay.t[0]))
    log = np.empty(len(t))
    log[first] = math.log(decay.X[0])
    for i in range(first, 0, -1):
        log[i - 1] = log[i] + omega * step * np.interp(log[i], at, known)
    for i in range(first, len(t) - 1):
        log[i + 1] = log[i] - omega * step * np.interp(log[i], at, known)
    acceleration = omega**2 * np.exp(log) * np.sin(omega * (t - t[0]))
    seen = modal_decay(t, acceleration, band_hz, start=start, window=window)
    truth = np.interp(np.log(seen.X), at, known)
    return np.asarray(seen.zeta / truth - 1.0)
