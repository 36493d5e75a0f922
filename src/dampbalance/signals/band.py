"""The band about a mode in which a decay is fitted: the same filter for the record and for the model.

A real record contains more than its model: further modes, hum, quantization, a drift. Outside the band of the mode
these do not affect F_k and c. As the same linear filter is applied to record and model, it causes no bias.

The filter is a Butterworth of third order run forwards and backwards, so that it multiplies each frequency with

    |H(f)|² = 1 / (1 + u⁶),   u = (f² − f_low f_high) / (f (f_high − f_low))

and shifts no phase. The samples are continued beyond both ends by their mirror image, so that the filter multiplies
their cosine transform by |H|². A constant offset vanishes exactly, no transient of a filter enters the record, white
noise is not amplified, and a decimated record meets the same filter.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array

# Corners relative to the natural frequency, found with 200 simulated decays: drift and AC coupling lie below, the third
# harmonic, most second modes and, for slow rigs, the mains above.
_LOW, _HIGH = 0.35, 2.6


NOISE_PASSED = 5.0 * np.pi / 18.0
"""Mean square of white noise after the filter, relative to that of the noise between the corners: ∫du / (1 + u⁶)² over
u > 0, (π/6) / sin(π/6) · 5/6 = 0.873."""


@dataclass(frozen=True, slots=True)
class Band:
    """A band of frequencies between two corners.

    low, high : corners, where |H|² = 1/2, Hz.
    """

    low: float
    high: float

    @classmethod
    def about(cls, f_n: float, dt: float) -> Band:
        """Return the band from 0.35 to 2.6 times a natural frequency, but at most up to 0.4 of the sampling rate.

        f_n : Hz.   dt : sampling interval, s.   Raises ValueError if the mode lies above 0.4 of the sampling rate.
        """
        # anti-alias filters begin at 0.4 of the sampling rate
        high = min(_HIGH * f_n, 0.4 / dt)
        if not high > f_n:
            raise ValueError(
                f"{1.0 / dt:.6g} samples a second are too few for a mode at {f_n:.6g} Hz: sample faster"
            )
        return cls(_LOW * f_n, high)

    def gain(self, f: Array) -> Array:
        """Return the gain |H(f)|² of the filter; 0 at f = 0.   f : Hz, any shape."""
        safe = np.where(f == 0.0, 1.0, f)
        u = (safe**2 - self.low * self.high) / (safe * (self.high - self.low))
        # third order: 4 % of a second mode at four times the frequency passes
        return np.where(f == 0.0, 0.0, 1.0 / (1.0 + u**6))


def filtered(values: Array, dt: float, band: Band) -> Array:
    """Return values filtered to the band along axis 0, without a phase shift.

    values : samples, (n, …): a record, a model, or its derivatives in columns.   dt : sampling interval, s.
    """
    from scipy.fft import dct, idct  # slow to import

    n = len(values)
    gain = band.gain(np.arange(n) / (2.0 * n * dt))
    return idct(gain.reshape(-1, *[1] * (np.ndim(values) - 1)) * dct(values, axis=0), axis=0)


def freedom(band: Band, duration: float) -> float:
    """Return the number of independent values of a channel in a band, 2 × bandwidth × duration.

    The mean square of filtered white noise is known as well as that of 1.008 times as many independent values
    (Welch–Satterthwaite with |H|⁴).
    """
    return 2.0 * (band.high - band.low) * duration
