"""Simulated tables of a stepped sine, whose truth is known. Always labelled as such."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from ..arrays import Array
from ..law.contact import Sliders


def stepped_sine(
    oscillator: Mapping[str, float],
    sliders: Sliders,
    *,
    amplitudes: Sequence[float],
    frequencies_hz: Sequence[float],
    noise: float = 0.0,
    seed: int = 0,
) -> dict[str, Array]:
    """Return a table of steady responses to a stepped sine whose amplitude is controlled, columns by name, a line each.

    At an amplitude X and a frequency ω/2π the force is |Z| X and the displacement lags it by arg Z, with the dynamic
    stiffness Z = k + ¾k_3X² − mω² + iωc + Σ κ D(X/r) of the fundamental (`contact.py`).

    oscillator : m, c, k and k_3, SI units; what is left out is zero.   sliders : of the contact.
    amplitudes : X of each level, m.   noise : standard deviation of the relative error of each force and response, and
    of each phase, rad.   seed : of the noise.
    """
    parts = {name: oscillator.get(name, 0.0) for name in ("m", "c", "k", "k_3")}
    frequency = np.tile(np.asarray(frequencies_hz, dtype=np.float64), len(amplitudes))
    X, omega = np.repeat(amplitudes, len(frequencies_hz)), 2.0 * math.pi * frequency
    Z = parts["k"] + 0.75 * parts["k_3"] * X**2 - parts["m"] * omega**2 + 1j * omega * parts["c"]
    Z = Z + sliders.secant(X)
    errors = 1.0 + noise * np.random.default_rng(seed).standard_normal((3, X.size))
    return {
        "frequency_Hz": frequency,
        "force_N": np.abs(Z) * X * errors[0],
        "acceleration_m_per_s2": omega**2 * X * errors[1],
        "phase_deg": np.degrees(math.pi - np.angle(Z) + errors[2] - 1.0),
        "level": np.repeat(np.arange(1.0, len(amplitudes) + 1.0), len(frequencies_hz)),
    }
