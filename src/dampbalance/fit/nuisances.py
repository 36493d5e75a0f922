"""Nuisances of forced records, faults of a channel or of the model that a fit can include: zero unless they are freed.

    delay              s          the response lags the base in the record by more than in its motion
    gain               1          the drive reads (1 + g)Y for Y
    corner             Hz         the response is AC-coupled: a high-pass of first order, iω/(iω + 2πf_c)
    friction_level     1          the friction force is F_k(1 + p ln(Y/Ȳ)), Ȳ the geometric mean of the levels
    friction_speed     1          it is larger at rest, F_k(1 + p e^{−|ẋ|/v}), v a tenth of the largest speed
    c_2                N s²/m²    damping that grows with the speed, c_2|ẋ|ẋ
    k_3                N/m³       a spring that is not linear, k_3 x³
    gradual            1          the contact yields gradually: 1 for that of Iwan, see `rounding`
    folded             1          the part of the harmonics beyond half the sampling rate that no filter took off

All act exactly. The four before the last, `FORCES`, need a motion with one onset of slip per half cycle, or none.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..arrays import Complexes, Integers
from ..signals.record_harmonics import RecordHarmonics

FALLING = 0.1
"""Speed over the largest at which a friction force that changes with the speed has fallen by a factor e."""

FOLDED = "folded"
"""The nuisance that is fitted wherever it matters: most recorders have a filter that their records do not mention."""

NUISANCES: Mapping[str, tuple[float, float]] = {
    "delay": (-0.5 * math.pi, 0.5 * math.pi),  # a quarter cycle; beyond, it is another channel
    "gain": (-0.2, 0.2),  # beyond, it is another unit and no fault of calibration
    # beyond, less than 70 % of the fundamental is left, which a laboratory would notice
    "corner": (0.0, 1.0),
    "friction_level": (-1.0, 1.0),
    "friction_speed": (0.0, 2.0),  # at rest it is larger, three times at most
    "c_2": (-math.inf, math.inf),
    "k_3": (-math.inf, math.inf),
    # beyond one, the force falls before the contact slips; at one, slopes are singular
    "gradual": (0.0, 0.98),
    FOLDED: (0.0, 1.0),
}
"""The least and the greatest value of each nuisance that a rig may have, in `units_of` a motion."""

FORCES = ("friction_speed", "c_2", "k_3", "gradual")
"""Nuisances that are forces which the oscillator lacks."""


def units_of(k: float, omega: float, X: float, Y: float) -> dict[str, float]:
    """Return the size of each nuisance that changes a motion by about as much as itself.

    k : N/m.   omega : of the fastest record, rad/s.   X, Y : of the largest motion and drive, m.
    """
    units = dict.fromkeys(NUISANCES, 1.0)
    units |= {"delay": 1.0 / omega, "corner": omega / (2.0 * math.pi)}
    return units | {"c_2": k * Y / (omega * X) ** 2, "k_3": k / X**2}


def read_by_channels(
    x: Complexes, base: float, n: Integers, one: RecordHarmonics, values: Mapping[str, float]
) -> Complexes:
    """Return the harmonics x_n, m, as the channels of a record read them.

    base : true amplitude of the base, m; the one read is added to a response relative to the base.   values : of the
    nuisances.
    """
    rate = 1j * one.omega * n
    factor = np.exp(-values["delay"] * rate) * (rate / (rate + 2.0 * math.pi * values["corner"]))
    first = np.where(n == 1, base * one.of_base, 0.0)
    return np.asarray(factor * (x - first) + (1.0 + values["gain"]) * first)


def in_other_frame(one: RecordHarmonics) -> RecordHarmonics:
    """Return the harmonics of a response that is relative to the base and was taken for absolute, or the other way
    round, without that error."""
    sign = -1.0 if one.of_base else 1.0
    return replace(one, x=one.x + sign * base_of(one), of_base=1.0 - one.of_base)


def with_gain(one: RecordHarmonics, gain: float) -> RecordHarmonics:
    """Return the harmonics with the response multiplied by a gain in the frame in which it was measured."""
    added = one.of_base * base_of(one)
    x = gain * (one.x - added) + added
    return replace(one, x=x, x_error=abs(gain) * one.x_error)


def base_of(one: RecordHarmonics) -> Complexes:
    """Return the harmonics of the base at the orders of those of the response, m."""
    y = np.zeros(max(int(one.n[-1]), one.base.size + 1) + 1, dtype=np.complex128)
    y[1], y[2 : one.base.size + 2] = one.Y, one.base
    return y[one.n]
