"""Records by simulation: the exact steady motion or a free decay, sampled, with noise. Always labelled as such.

They serve to try an estimator on records whose truth is known. The white noise of the channels is independent.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..arguments import NUMBERS, instance, mapping, names, number, shown, whole
from ..arrays import Array
from ..model import BaseMotion, Oscillator
from ..motion.orbit import Orbit
from ..motion.sliders import SlidersOrbit
from ..motion.transient import transient
from .channel import ABSOLUTE, EXCITATIONS, RELATIVE, RESPONSES, ROTATING, Channel, sample_times
from .coordinate import ROTATION, TRANSLATION, Coordinate
from .record import Record

if TYPE_CHECKING:
    from ..motion.law_steady import Response


def measured_orbit(
    orbit: Orbit | Response | SlidersOrbit,
    *,
    rate_hz: float,
    cycles: float,
    noise: float | Mapping[str, float] = 0.0,
    seed: int | np.random.Generator = 0,
    channels: Sequence[str] | str = ("base_displacement", "displacement"),
    start: float = 0.0,
    source: str = "",
) -> Record:
    """Return the steady response sampled at `rate_hz` for `cycles` periods of the drive, from the time `start` (s) on.

    noise : standard deviation of the white noise of each channel, as a part of the rms of its clean signal (0.01: 1 %);
    one number for all channels or one by quantity (those not named have none).
    seed : of the noise, channel by channel in the order of `channels`, or a generator to draw from.
    channels : quantities to measure, all of a translation or all of a rotation, "angle" and the like: m, c, k, K_z, F_k
    and Y of the orbit are then in kg m², N m s/rad, N m/rad, N m/rad, N m and rad.

    Raises ValueError for an unknown quantity, a rate, a duration or a noise that makes no sense.

    >>> import math
    >>> from dampbalance import BaseMotion, Oscillator, measured_orbit, steady_orbit
    >>> osc = Oscillator(m=2.42, c=90.0, k=2310.0, K_z=208000.0, F_k=1.28)
    >>> orbit = steady_orbit(osc, BaseMotion(Y=0.004, omega=2 * math.pi * 3.5))
    >>> measured = measured_orbit(orbit, rate_hz=1000.0, cycles=20.0, noise=0.01)
    >>> list(measured), len(measured["displacement"].values)
    (['base_displacement', 'displacement'], 5714)
    """
    if not isinstance(getattr(orbit, "motion", None), BaseMotion):
        raise ValueError(f"orbit must be a steady orbit, got {shown(orbit)}")
    motion = orbit.motion
    rate_hz, cycles = number("rate_hz", rate_hz), number("cycles", cycles)
    start = number("start", start)
    channels = names("channels", channels, (*EXCITATIONS, *RESPONSES, *ROTATING))
    parts, random = _parts(noise, channels), _random(seed)
    samples = cycles * motion.period * rate_hz
    count = round(samples)
    if count < 2:
        sampled = f"{cycles} cycles at {rate_hz:g} samples per second"
        raise ValueError(f"{sampled} are {count} samples; at least 2 are needed")
    t = sample_times(rate_hz, start, 0, count)
    clean, measured = _clean(orbit, t, [ROTATING.get(q, q) for q in channels]), []
    for quantity in channels:
        values, part = clean[ROTATING.get(quantity, quantity)], parts.get(quantity, 0.0)
        if part > 0.0:
            rms = math.sqrt(float(np.mean(values**2)))
            values = values + part * rms * random.standard_normal(count)
        measured.append(Channel(quantity, t, values))
    unit = _coordinate(channels).unit("m")
    return Record.of(source or f"simulated, Y = {motion.Y:g} {unit}", measured)


def _clean(
    orbit: Orbit | Response | SlidersOrbit, t: Array, channels: Sequence[str]
) -> dict[str, Array]:
    """Return the signals without noise, by quantity, of the channels asked for and those that come with them."""
    motion, omega = orbit.motion, orbit.motion.omega
    y = np.asarray(motion.y(t), dtype=np.float64)
    clean = dict(zip(EXCITATIONS, (y, -(omega**2) * y, orbit.oscillator.k * y), strict=True))
    if not clean.keys() >= set(channels):
        state = orbit.state(t)
        clean |= dict(zip(ABSOLUTE, (state.x, state.v, state.acceleration), strict=True))
    if not clean.keys() >= set(channels):
        base = (y, -omega * motion.Y * np.sin(omega * t), -(omega**2) * y)
        relative = [clean[of] - of_base for of, of_base in zip(ABSOLUTE, base, strict=True)]
        clean |= dict(zip(RELATIVE, relative, strict=True))
    return clean


def measured_ring_down(
    oscillator: Oscillator,
    *,
    x: float = 0.0,
    v: float = 0.0,
    rate_hz: float,
    duration: float,
    held: float = 0.0,
    noise: float = 0.0,
    seed: int | np.random.Generator = 0,
    channels: Sequence[str] | str = ("displacement",),
) -> Record:
    """Return a free decay from the displacement x (m), to which the mass was pulled, with velocity v (m/s), for
    `duration` s.

    held : time for which the mass stands at x before, s.   noise : standard deviation of the white noise of each
    channel, as a part of the largest value of its clean signal.   seed : of the noise, channel by channel.
    channels : displacement, velocity and acceleration, or angle, angular_velocity and angular_acceleration of an
    oscillator that rotates, whose x and v are in rad and rad/s.

    Raises ValueError for a number outside its range, a channel that is not one of the mass, and where the mass does not
    start or no sample is left.

    >>> from dampbalance import Oscillator, measured_ring_down
    >>> osc = Oscillator(m=2.42, c=1.0, k=2310.0, K_z=208000.0, F_k=0.5)
    >>> decay = measured_ring_down(osc, x=0.01, rate_hz=1000.0, duration=3.0)
    >>> round(float(decay["displacement"].values[0]), 6)
    0.01
    """
    instance("oscillator", oscillator, Oscillator)
    x, v, held, noise = number("x", x), number("v", v), number("held", held), number("noise", noise)
    rate_hz, duration = number("rate_hz", rate_hz), number("duration", duration)
    absolute = (*ABSOLUTE, *(q for q, of in ROTATING.items() if of in ABSOLUTE))
    channels = names("channels", channels, absolute)
    random = _random(seed)
    if x == 0.0 and v == 0.0:
        raise ValueError("a free decay needs a displacement x or a velocity v to start with")
    samples = (duration + held) * rate_hz
    if samples < 2.0:
        raise ValueError(
            f"{duration:g} s at {rate_hz:g} samples per second are {samples:.3g} samples; ask for 2 at least"
        )
    t = np.arange(round(samples)) / rate_hz
    free = t >= held
    Z_m = oscillator.Z_m
    z = min(max(x, -Z_m), Z_m)
    state = transient(oscillator, None, float(t[-1]) + 1.0 / rate_hz, x=x, v=v, z=z, start=held)
    moved = state.state(t[free])
    measured = []
    signals = dict(zip(ABSOLUTE, (moved.x, moved.v, moved.acceleration), strict=True))
    for quantity in sorted(channels, key=absolute.index):
        own = ROTATING.get(quantity, quantity)
        values = np.full(t.size, x if own == "displacement" else 0.0)
        values[free] = signals[own]
        spread = noise * float(np.abs(values).max())
        measured.append(Channel(quantity, t, values + spread * random.standard_normal(t.size)))
    unit = _coordinate(channels).unit
    source = f"simulated, x = {x:g} {unit('m')}, v = {v:g} {unit('m/s')}"
    return Record.of(source, measured)


def _coordinate(quantities: Sequence[str]) -> Coordinate:
    return ROTATION if {*quantities} & ROTATING.keys() else TRANSLATION


def _parts(noise: object, channels: Sequence[str]) -> dict[str, float]:
    if not isinstance(noise, Mapping):
        return dict.fromkeys(channels, number("noise", noise))
    parts = mapping("noise", noise, "a mapping of quantities to numbers")
    names("quantities", list(parts), (*EXCITATIONS, *RESPONSES, *ROTATING))
    return {q: number(f"noise of {q}", part, NUMBERS["noise"]) for q, part in parts.items()}


def _random(seed: object) -> np.random.Generator:
    if not isinstance(seed, np.random.Generator):
        seed = whole("seed", seed)
    return np.random.default_rng(seed)
