"""Simulated records: the exact steady motion or a free decay, sampled, with noise; their names say so.

They serve to test an estimator on records with known parameters. The channels have independent white noise.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..arguments import NUMBERS, instance, mapping, names, number, shown, whole
from ..arrays import Array
from ..law.contact import Sliders
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
    """Return a record of a steady response, simulated with noise.

    Use it to try an identification on a record whose parameters are known, or to check a planned experiment.

    orbit : the steady response, as from `steady_orbit`.
    rate_hz : samples per second.
    cycles : length of the record in periods of the drive.
    noise : standard deviation of the white noise of each channel, relative to the rms of its clean signal (0.01: 1 %);
        one number for all channels, or one by quantity (a quantity that is not named has none).
    seed : of the noise, drawn channel by channel in the order of `channels`, or a generator to draw from.
    channels : quantities to measure, all of a translation, "displacement" and so on, or all of a rotation, "angle" and
        so on; m, c, k, K_z, F_k and Y of the orbit are then in kg m², N m s/rad, N m/rad, N m/rad, N m and rad.
    start : time of the first sample, s.
    source : name of the record; default, one that states Y.

    Raises ValueError for an unknown quantity and for a rate, a duration or a noise out of range.

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
    motion, omega = orbit.motion, orbit.motion.omega
    channels = names("channels", channels, (*EXCITATIONS, *RESPONSES, *ROTATING))
    t = _times(rate_hz, number("cycles", cycles) * motion.period, number("start", start))
    y, state = np.asarray(motion.y(t), dtype=np.float64), orbit.state(t)
    base = (y, -omega * motion.Y * np.sin(omega * t), -(omega**2) * y)
    clean = dict(zip(ABSOLUTE, (state.x, state.v, state.acceleration), strict=True))
    # a force leaves the base at rest
    moves = "force" not in {ROTATING.get(one, one) for one in channels}
    clean |= {of: clean[q] - z * moves for of, q, z in zip(RELATIVE, ABSOLUTE, base, strict=True)}
    clean |= dict(zip(EXCITATIONS, (*base, orbit.oscillator.k * y), strict=True))
    source = source or f"simulated, Y = {motion.Y:g} {_coordinate(channels).unit('m')}"
    return _record(source, t, clean, channels, noise, _rms, seed)


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
    """Return a record of a free decay, simulated with noise.

    Use it to try an identification on a record whose parameters are known, or to check a planned experiment.

    x, v : displacement to which the mass is pulled, m, and its initial velocity, m/s; rad and rad/s for a rotation.
    rate_hz : samples per second.
    duration : of the decay, s.
    held : time for which the mass is held at x before, s.
    noise : standard deviation of the white noise of each channel, relative to the largest value of its clean signal.
    seed : of the noise, drawn channel by channel, or a generator to draw from.
    channels : displacement, velocity and acceleration, or angle, angular_velocity and angular_acceleration.

    Raises ValueError for a number out of range, a channel that is not one of the mass, a mass that does not move, and
    fewer than two samples.

    >>> from dampbalance import Oscillator, measured_ring_down
    >>> osc = Oscillator(m=2.42, c=1.0, k=2310.0, K_z=208000.0, F_k=0.5)
    >>> decay = measured_ring_down(osc, x=0.01, rate_hz=1000.0, duration=3.0)
    >>> round(float(decay["displacement"].values[0]), 6)
    0.01
    """
    instance("oscillator", oscillator, Oscillator)
    x, v, held = number("x", x), number("v", v), number("held", held)
    absolute = (*ABSOLUTE, *(q for q, of in ROTATING.items() if of in ABSOLUTE))
    channels = sorted(names("channels", channels, absolute), key=absolute.index)
    if x == 0.0 and v == 0.0:
        raise ValueError("a free decay needs a displacement x or a velocity v to start with")
    t = _times(rate_hz, number("duration", duration) + held)
    z = min(max(x, -oscillator.Z_m), oscillator.Z_m)
    end = float(t[-1]) + 1.0 / rate_hz
    moved = transient(oscillator, None, end, x=x, v=v, z=z, start=held).state(t[t >= held])
    signals = dict(zip(ABSOLUTE, (moved.x, moved.v, moved.acceleration), strict=True))
    before = np.zeros(np.count_nonzero(t < held))
    clean = {q: np.append(before + x * (q == "displacement"), of) for q, of in signals.items()}
    unit = _coordinate(channels).unit
    source = f"simulated, x = {x:g} {unit('m')}, v = {v:g} {unit('m/s')}"
    return _record(source, t, clean, channels, number("noise", noise), _largest, seed)


def _times(rate_hz: float, duration: float, start: float = 0.0) -> Array:
    """Return sampling times, s. Raises ValueError for fewer than two."""
    count = round(duration * number("rate_hz", rate_hz))
    if count < 2:
        sampled = f"{duration:g} s at {rate_hz:g} samples per second"
        raise ValueError(f"{sampled} are {count} samples; at least 2 are needed")
    return sample_times(rate_hz, start, 0, count)


def _record(
    source: str,
    t: Array,
    clean: Mapping[str, Array],
    channels: Sequence[str],
    noise: float | Mapping[str, float],
    size: Callable[[Array], float],
    seed: int | np.random.Generator,
) -> Record:
    """Return the record of signals with noise, relative to the `size` of each."""
    if not isinstance(seed, np.random.Generator):
        seed = np.random.default_rng(whole("seed", seed))
    parts = dict.fromkeys(channels, noise)
    if isinstance(noise, Mapping):
        parts = mapping("noise", noise, "a mapping of quantities to numbers")
        names("quantities", list(parts), (*EXCITATIONS, *RESPONSES, *ROTATING))
    measured = []
    for quantity in channels:
        values = clean[ROTATING.get(quantity, quantity)]
        part = number(f"noise of {quantity}", parts.get(quantity, 0.0), NUMBERS["noise"])
        if part > 0.0:
            values = values + part * size(values) * seed.standard_normal(t.size)
        measured.append(Channel(quantity, t, values))
    return Record.of(source, measured)


def _rms(values: Array) -> float:
    return math.sqrt(float(np.mean(values**2)))


def _largest(values: Array) -> float:
    return float(np.abs(values).max())


def _coordinate(quantities: Sequence[str]) -> Coordinate:
    return ROTATION if {*quantities} & ROTATING.keys() else TRANSLATION


def stepped_sine(
    oscillator: Mapping[str, float],
    sliders: Sliders,
    *,
    amplitudes: Sequence[float],
    frequencies_hz: Sequence[float],
    noise: float = 0.0,
    seed: int = 0,
) -> dict[str, Array]:
    """Return a table of steady responses to a stepped sine with controlled amplitude, as columns by name.

    At an amplitude X and a frequency ω/2π the force is |Z| X and the displacement lags it by arg Z, with the dynamic
    stiffness Z = k + ¾k_3X² − mω² + iωc + Σ κ D(X/r) of the fundamental (`law/contact.py`).

    oscillator : m, c, k and k_3 in SI units, zero if left out.   sliders : of the contact.
    amplitudes : X of each level, m.   frequencies_hz : of the lines of each level.
    noise : standard deviation of the relative error of each force and response, and of each phase, rad.
    seed : of the noise.
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
