"""Departures of records from one oscillator that are read right: unknowns of their model, zero unless they are freed.

    delay              s          the response lags the base in the record by more than in its motion
    gain               1          the drive reads (1 + g)Y for Y
    corner             Hz         the response is AC-coupled: a high-pass of first order, iω/(iω + 2πf_c)
    low_pass           s          time constant of a low-pass of first order in the response, 1/(1 + iωτ)
    friction_level     1          the friction force is F_k(1 + p ln(Y/Ȳ)), Ȳ the geometric mean of the levels
    friction_speed     1          it is larger at rest, F_k(1 + p e^{−|ẋ|/v}), v a tenth of the largest speed
    c_2                N s²/m²    damping that grows with the speed, c_2|ẋ|ẋ
    k_3                N/m³       a spring that is not linear, k_3 x³
    gradual            1          the contact yields gradually: 1 for that of Iwan, see `rounding`

The channels and the level act exactly. The last four forces, `FORCES`, act to first order: a force δF that the model
lacks moves the mass by what the equations of its steady motion, linear in δF, give (`Response.moved_by`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from ..arrays import Array, Complexes, Integers
from ..motion.law_decays import rounding
from ..motion.law_steady import Response
from ..signals.lines import Lines

Force = Callable[[Array, Array], Array]
"""Force on the mass, N, of x + X and ẋ in the half cycle from the reversal at −X on, as for `Response.moved_by`."""

FALLING = 0.1
"""Speed over the largest at which a friction force that changes with the speed has fallen by a factor e."""

_LARGEST_GAIN = 0.5  # beyond it a channel has another unit, and no fault of calibration

NUISANCES: Mapping[str, tuple[float, float]] = {
    "delay": (-math.inf, math.inf),
    "gain": (-_LARGEST_GAIN, _LARGEST_GAIN),
    "corner": (0.0, math.inf),
    "low_pass": (0.0, math.inf),
    "friction_level": (-math.inf, math.inf),
    "friction_speed": (-math.inf, math.inf),
    "c_2": (-math.inf, math.inf),
    "k_3": (-math.inf, math.inf),
    "gradual": (0.0, math.inf),
}
"""The least and the greatest value of each nuisance."""


def _at_rest(response: Response, fastest: float) -> Force:
    """Friction that is larger at rest. From a turn to the onset of slip it acts the way that it did before the turn; a
    contact that never slips does not have it."""
    o, v_0 = response.oscillator, FALLING * fastest
    F_k = o.F_k * response.slips
    return lambda u, v: F_k * np.where(u < 2.0 * o.Z_m, -1.0, np.exp(-np.abs(v) / v_0))


def _gradual(response: Response, fastest: float) -> Force:
    o = response.oscillator
    return lambda u, v: np.asarray(rounding(np.maximum(u, 0.0), o.F_k, o.K_z))


FORCES: Mapping[str, Callable[[Response, float], Force]] = {
    "friction_speed": _at_rest,
    "c_2": lambda response, fastest: lambda u, v: v * np.abs(v),
    "k_3": lambda response, fastest: lambda u, v: (u - response.X) ** 3,
    "gradual": _gradual,
}
"""The force of a unit of each, for a motion and the largest speed of all records, m/s."""


def units_of(k: float, m: float, omega: float, X: float) -> dict[str, float]:
    """Size of each nuisance that changes a motion by about as much as itself.

    k, m : of the oscillator, N/m and kg.   omega, X : of the fastest record, rad/s, and of the largest motion, m.
    """
    units = dict.fromkeys(NUISANCES, 1.0)
    units |= {"delay": 1.0 / omega, "low_pass": 1.0 / omega, "corner": omega / (2.0 * math.pi)}
    return units | {"c_2": math.sqrt(k * m) / (omega * X), "k_3": k / X**2}


def read_by_channels(
    x: Complexes, base: float, n: Integers, one: Lines, values: Mapping[str, float]
) -> Complexes:
    """Return the harmonics x_n, m, as the channels of a record read them.

    base : true amplitude of the base, m; the one read is added to a response relative to the base.   values : of the
    nuisances.
    """
    rate = 1j * one.omega * n
    factor = np.exp(-values["delay"] * rate) / (1.0 + values["low_pass"] * rate)
    factor *= rate / (rate + 2.0 * math.pi * values["corner"])
    first = np.where(n == 1, base * one.relative, 0.0)
    return np.asarray(factor * (x - first) + (1.0 + values["gain"]) * first)


def in_other_frame(one: Lines) -> Lines:
    """Return the harmonics of a response that is relative to the base and was taken for absolute, or the other way
    round, without that error."""
    y = np.zeros(max(int(one.n[-1]), one.base.size + 1) + 1, dtype=np.complex128)
    y[1], y[2 : one.base.size + 2] = one.Y, one.base
    sign = -1.0 if one.relative else 1.0
    return replace(one, x=one.x + sign * y[one.n], relative=not one.relative)


def with_response(one: Lines, factor: float) -> Lines:
    """Return the harmonics of a response that was read in another unit, by a factor."""
    base = np.where(one.n == 1, one.Y * one.relative, 0.0)
    return replace(one, x=(one.x - base) * factor + base, x_error=one.x_error * factor)
