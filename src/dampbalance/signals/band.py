"""The band about a mode, in which a decay is fitted: one filter for the record and for the model.

A real record holds more than its model: further modes, hum, the converter, a drift. They say nothing about F_k and c as
long as they lie outside the band of the mode. The same linear filter on record and model leaves no bias, whatever it
does to either.

The filter is a Butterworth of third order run forwards and backwards, so that it multiplies each frequency with

    |H(f)|² = 1 / (1 + u⁶),   u = (f² − f_low f_high) / (f (f_high − f_low))

and shifts no phase. The samples are continued beyond both ends by their mirror image, so that the filter is a product
with |H|² in their cosine transform. A constant offset vanishes exactly, no start-up of a filter reaches into the
record, white noise is nowhere amplified, and a record that was thinned meets the same filter.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array

# Corners relative to the natural frequency, found with 200 simulated decays: below lie drift and AC coupling, above
# the third harmonic, most second modes and the mains of slow rigs.
_LOW, _HIGH = 0.35, 2.6


NOISE_PASSED = 5.0 * np.pi / 18.0
"""Mean square of white noise after the filter, relative to that of the noise within its corners: ∫du / (1 + u⁶)² over
u > 0, (π/6) / sin(π/6) · 5/6 = 0.873."""


@dataclass(frozen=True, slots=True)
class Band:
    """A band of frequencies between two corners.

    low, high : corners, where |H|² = 1/2, Hz.
    """

    low: float
    high: float

    def __post_init__(self) -> None:
        """Raise ValueError where the corners are not in order."""
        if not 0.0 < self.low < self.high:
            raise ValueError(
                f"a band needs 0 < low < high, got {self.low:.6g} to {self.high:.6g} Hz"
            )

    @classmethod
    def about(cls, f_n: float, dt: float) -> Band:
        """Return the band from 0.35 to 2.6 times a natural frequency, its upper corner at most at 0.4 of the sampling
        rate.

        f_n : Hz.   dt : sampling interval, s. Raises ValueError where the mode lies above that.
        """
        # largest corner relative to the sampling rate: anti-alias filters begin here, and half the rate is the end
        high = min(_HIGH * f_n, 0.4 / dt)
        if not high > f_n:
            raise ValueError(
                f"{1.0 / dt:.6g} samples a second are too few for a mode at {f_n:.6g} Hz: sample faster"
            )
        return cls(_LOW * f_n, high)

    def gain(self, f: Array) -> Array:
        """Return |H(f)|², by which the filter multiplies each frequency; 0 at f = 0.   f : Hz, of any shape."""
        safe = np.where(f == 0.0, 1.0, f)
        u = (safe**2 - self.low * self.high) / (safe * (self.high - self.low))
        # a Butterworth filter of third order: 4 % of a second mode at four times the frequency passes
        return np.where(f == 0.0, 0.0, 1.0 / (1.0 + u ** (6)))


def filtered(values: Array, dt: float, band: Band) -> Array:
    """Return values in the band, filtered along axis 0 without a shift of phase; linear in the values.

    values : samples, (n, …): a record, a model, or its derivatives in columns.   dt : sampling interval, s.
    """
    from scipy.fft import dct, idct  # slow to import

    n = len(values)
    gain = band.gain(np.arange(n) / (2.0 * n * dt))
    return idct(gain.reshape(-1, *[1] * (np.ndim(values) - 1)) * dct(values, axis=0), axis=0)


def freedom(band: Band, duration: float) -> float:
    """Return independent values that a channel has in a band, 2 × bandwidth × duration.

    White noise that passed the filter has a mean square known as well as that of 1.008 times as many independent
    values (Welch–Satterthwaite with |H|⁴).
    """
    return 2.0 * (band.high - band.low) * duration
