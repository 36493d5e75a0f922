"""The error that the steps of a converter leave in the harmonics of a periodic signal.

Rounding to steps of size q leaves an error of variance q²/12 in each sample. It is a function of the phase of a
periodic signal: it repeats from cycle to cycle, so that the scatter between cycles shows little of it, and averaging
reduces it only as far as the samples of a cycle fall on other phases than those of the cycle before. Noise of half a
step and more makes it random, by the factor e^{−4π²σ²/q²} of its variance; what is random, the scatter shows.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array

_LATTICE = 0.01  # of a step: how far a value may lie from a whole number of steps
_COPIES = 1e-9  # of the range: values closer than that differ by rounding of the numbers
_FINEST = 1e-6  # of the range: finer steps leave nothing that shows
# Independent errors in a cycle of A cos θ, over A/q: its rounding error is Σ ±(q/πj) sin(2πj A cos θ/q), whose
# harmonics n ≪ 2πA/q are (2q/πj) J_n(2πjA/q) with J_n² → q/(2π²jA) in the mean; their variance, ζ(3) q³/(π⁴A), is that
# of 2π⁴/12ζ(3) A/q independent errors.
_PHASES = 13.5


def converter_step(values: Array) -> float:
    """Step of the converter that some samples come from: the least difference of two values, where all values lie on a
    lattice of such steps; 0 where they do not, or where the steps are too fine to matter."""
    span = float(np.ptp(values))
    steps = np.diff(np.unique(values))
    steps = steps[steps > _COPIES * span]
    if not steps.size or not (step := float(steps.min())) > _FINEST * span:
        return 0.0
    whole = np.round(steps / step)
    return step if (np.abs(steps / step - whole) <= _LATTICE * whole).all() else 0.0


def rounding_error(
    step: float, span: float, samples: float, cycles: int, noise_rms: float
) -> float:
    """Standard deviation of the real and of the imaginary part of each harmonic that rounding leaves, in the unit of
    the channel.

    step : q.   span : of the signal, highest less lowest value.   samples : of a cycle, not necessarily whole.
    cycles : of the record.   noise_rms : of the samples, with what is random of their rounding.
    """
    if not step:
        return 0.0
    # places within a sampling interval at which cycles begin, as far apart as errors are independent
    places = max(1, math.ceil(_PHASES * 0.5 * span / step / samples))
    begins = np.modf(np.arange(min(cycles, 10 * places + 1000)) * samples)[0]
    different = np.unique(np.floor(begins * places)).size
    random = max(noise_rms**2 / step**2 - 1.0 / 12.0, 0.0)
    left = math.exp(-4.0 * math.pi**2 * random) / 12.0
    return step * math.sqrt(left * 2.0 / (samples * different))
