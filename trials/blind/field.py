"""Records as laboratories have them: free decays and forced tests, each with an imperfection of rig or recorder.

The motion follows the equations of `other_motion.py`. The signal of the sensor is made at four times the rate of the
record, so that filters are those of the hardware.

What counts as true: the F_k, c and k of these equations. For a gradual contact F_k is the force at which all of it
slips; friction that differs by direction (± A) or varies (B, D) counts by its mean; friction that falls with speed by
its force at high speed, which is F_k of the law, as the share above it is a property of slow motion; with k given 3 %
wrong F_k and c are not scaled with it. On a frame that yields k is given as it is felt at the mass, 1/(1/k + 1/k_s), as
a laboratory would measure it; F_k and c are those of the contact and the damper.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import signal

from dampbalance.records.channel import Channel
from dampbalance.records.record import Record

from .decays import at_rest, pulled
from .gradual import CONTACTS
from .other_motion import Contact, Rig, follow, moved, one_slider
from .truths import ANSWERS, Linear, log_uniform

_FIELD = 7  # so that the draws are not those of other sets
STEPS = 2048
"""Of a natural period; kinks cost 1e-5 of the motion and 5e-5 of the acceleration, a hundredth of the least noise."""

# samples of the signal for one of the record: filters of hardware, and no aliasing by them
_OVER = 4
_MAINS = ((50.0, 1.0), (100.0, 0.3), (150.0, 0.5))  # Hz, relative to the first line
# Hz: nobody samples a motion of 1 Hz so slowly that mains at 50 Hz folds over it
_LOWEST_RATE = 120.0
_LEAD = 20.0  # periods of a forced test before its record, in which filters settle
_SETTLES = 1.5  # over ζ, natural periods: e^(−2π · 1.5) = 1e-4 of the transient is left

CLEAN, MODE, HUM, DRIFT, AC = "clean", "second mode", "hum", "offset and drift", "AC coupling"
FILTER, BITS, CLIPPED, SUPPORT = "anti-alias filter", "12 bits", "clipping", "flexible support"
CUBIC, GRADUAL, STRIBECK, ASYMMETRY = "cubic spring", "gradual contact", "Stribeck", "asymmetry"
MODULATED, THIRD, STIFFNESS, ALL = "modulation", "third harmonic", "k 3 % wrong", "all at once"
DOUBLE, LEAD, UNSETTLED = "double hit", "pre-trigger", "not settled"

_BOTH = (BITS, CLIPPED, SUPPORT, CUBIC, GRADUAL, STRIBECK, ASYMMETRY, MODULATED, THIRD, STIFFNESS)
DECAYS = (CLEAN, MODE, HUM, DRIFT, AC, FILTER, DOUBLE, LEAD, *_BOTH, ALL)
FORCED = (CLEAN, MODE, HUM, DRIFT, AC, FILTER, UNSETTLED, *_BOTH, ALL)
"""Kinds of the sets, in turn; `EACH` of them, and the rest are clean."""

EACH = 10
# what "all at once" has, of sizes in the lowest 30 % of their logarithm
_MILD = (MODE, HUM, DRIFT, FILTER, BITS)


@dataclass(frozen=True)
class Field(Linear):
    """One set: an oscillator, how it moves and how it is measured. SI units.

    kind : of its imperfection.   seed, index, forced : that it is drawn by.   X : first amplitude of a decay with its
    sign, or about that of the highest level.   blow : whether a decay begins with a blow and not with a release.
    cycles : length of each record, in natural periods of a decay or periods of the drive.   Y : amplitudes of the base,
    m; none in a decay.   drive, answer : channels.   rate_hz : samples per second.   noise : over the rms of each
    channel.   mass_given : whether `identify` is given m.
    """

    kind: str
    seed: int
    index: int
    forced: bool
    m: float
    c: float
    k: float
    K_z: float
    F_k: float
    X: float
    blow: bool
    cycles: tuple[float, ...]
    Y: tuple[float, ...]
    omega: float
    drive: str
    answer: str
    rate_hz: float
    noise: float
    mass_given: bool

    def random(self, stream: int) -> np.random.Generator:
        """Return a generator of this set: 1 for sizes of the imperfection, 2 + i for what differs from level to
        level."""
        return np.random.default_rng((_FIELD, self.seed, self.index, int(self.forced), stream))

    def has(self, kind: str) -> bool:
        """Return whether the set has an imperfection."""
        return kind == self.kind or (self.kind == ALL and kind in _MILD)


def kind_of(index: int, forced: bool) -> str:
    """Return the kind of set number `index` ≥ 0."""
    kinds = FORCED if forced else DECAYS
    return kinds[index % len(kinds)] if index < EACH * len(kinds) else CLEAN


def draw(index: int, forced: bool, seed: int) -> Field:
    """Set number `index` ≥ 0: m 0.5–20 kg, f_n 1–30 Hz, ζ 0.3–4 %, K_z/k 3–100, noise 0.1–2 %, all log-uniform; 20–400
    samples a cycle.

    A decay slips in 4–40 half cycles: so many that viscous damping takes a tenth of the energy, 2πζn/3 with n = 0.05/ζ,
    and not so many that it alone would leave less than a tenth of the amplitude, n = 0.73/ζ.

    A forced test has 3–6 levels, the highest 2–6 times the lowest, at, near, below or above resonance; friction takes
    25–70 % of the loss at the lowest level.
    """
    random = np.random.default_rng((_FIELD, seed, index, int(forced)))
    spread = log_uniform(random)
    m, f_n, zeta = spread(0.5, 20.0), spread(1.0, 30.0), spread(0.003, 0.04)
    omega_n = 2.0 * math.pi * f_n
    k, c = m * omega_n**2, 2.0 * zeta * m * omega_n
    K, X = spread(3.0, 100.0), spread(1e-4, 1e-2)
    if forced:
        low, high = [(0.98, 1.02), (0.85, 1.15), (0.6, 0.85), (1.15, 1.8)][random.integers(4)]
        omega = omega_n * float(random.uniform(low, high))
        levels, share = int(random.integers(3, 7)), float(random.uniform(0.25, 0.7))
        amplitudes = X * np.geomspace(1.0 / random.uniform(2.0, 6.0), 1.0, levels)
        # of the lowest level: a share of the loss 4 F_k X + πcωX²
        F_k = share / (1.0 - share) * math.pi * c * omega * amplitudes[0] / 4.0
        damping = c + 4.0 * F_k / (math.pi * omega * amplitudes)
        Y = np.hypot(1.0 - (omega / omega_n) ** 2, damping * omega / k) * amplitudes
        cycles = random.uniform(30.0, 100.0, levels)
    else:
        omega, Y = omega_n, np.empty(0)
        half_cycles = spread(max(4.0, 0.05 / zeta), min(40.0, 0.73 / zeta))
        X *= random.choice([-1.0, 1.0])
        # X_n = F_k/k after n half cycles of X_{i+1} = q X_i − (1 + q) F_k/k
        q = math.exp(-math.pi * zeta / math.sqrt(1.0 - zeta**2))
        left = q**half_cycles
        F_k = k * abs(X) * left / (1.0 + (1.0 + q) * (1.0 - left) / (1.0 - q))
        cycles = np.array([0.5 * half_cycles + random.uniform(2.0, 4.0)])
    kind = kind_of(index, forced)
    return Field(
        kind=kind,
        seed=seed,
        index=index,
        forced=forced,
        m=m,
        c=c,
        k=k,
        K_z=K * k,
        F_k=float(F_k),
        X=float(X),
        blow=bool(random.random() < 0.5) or kind == DOUBLE,
        cycles=tuple(cycles.tolist()),
        Y=tuple(Y.tolist()),
        omega=omega,
        drive=str(random.choice(["base_displacement", "base_acceleration"])),
        answer=str(random.choice(ANSWERS)),
        rate_hz=max(spread(20.0, 400.0) * omega / (2.0 * math.pi), _LOWEST_RATE),
        noise=spread(0.001, 0.02),
        mass_given=bool(random.random() < 0.5),
    )


def stiffness_given(one: Field) -> float:
    """Return k as a laboratory gives it, N/m."""
    if one.kind == STIFFNESS:
        return one.k * (1.0 + 0.03 * one.random(1).choice([-1.0, 1.0]))
    rig, _ = rig_of(one)
    felt = rig.k_s > 0.0 and not one.forced
    return 1.0 / (1.0 / one.k + 1.0 / rig.k_s) if felt else one.k


def rig_of(one: Field, level: int = 0) -> tuple[Rig, Contact]:
    """Return the numbers of the equations at a level, and the contact; sizes are drawn alike for all levels."""
    random = one.random(1)
    spread, sign = log_uniform(random), float(random.choice([-1.0, 1.0]))
    top = abs(one.X)
    rig = Rig(one.m, one.c, one.k, sigma=float(not one.forced))
    if one.forced:
        rig = rig._replace(Y=one.Y[level], omega=one.omega)
    contact = one_slider(one.K_z, one.F_k)
    if one.kind == SUPPORT:
        k_s = spread(20.0, 100.0) * one.k
        omega_s, zeta_s = spread(3.0, 8.0) * one.omega_n, spread(0.003, 0.01)
        m_s = k_s / omega_s**2
        rig = rig._replace(k_s=k_s, m_s=m_s, c_s=2.0 * zeta_s * m_s * omega_s)
    elif one.kind == CUBIC:
        rig = rig._replace(k_3=sign * spread(0.01, 0.05) * one.k / top**2)
    elif one.kind == GRADUAL:
        contact = CONTACTS[str(random.choice(list(CONTACTS)))](one.K_z, one.F_k)
    elif one.kind == STRIBECK:
        speed = spread(0.03, 0.3) * top * one.omega
        rig = rig._replace(falling=spread(0.05, 0.3), speed=speed)
    elif one.kind == ASYMMETRY:
        rig = rig._replace(sided=sign * spread(0.02, 0.1))
    elif one.kind == MODULATED:
        size = spread(0.02, 0.1)
        slow = one.omega / (max(one.cycles) * random.uniform(0.2, 1.0))
        phase = one.random(2 + level).uniform(0.0, 2.0 * math.pi)
        in_time = {"varying": size, "rate": slow, "phase": phase}
        in_place = {"sloping": sign * size / top}
        rig = rig._replace(**(in_time if random.random() < 0.5 else in_place))
    return rig, contact


def motion(one: Field, level: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Return times, s, since the release or since phase 0 of the drive, and (x, x′, x″), (3, n).

    A decay has a lead, at negative times: the mass is held for a period, or it rests; in a set with a pre-trigger it
    rests longer, and a hand pulls it out. A forced test has a lead of `_LEAD` periods, unless it has not settled:
    it then begins at rest, and lasts longer, or with 5–30 % of the transient of a linear oscillator left.
    """
    rig, contact = rig_of(one, level)
    random = one.random(2 + level)
    random.random()  # the phase of the modulation
    step = 1.0 / (_OVER * one.rate_hz)
    every = math.ceil(step * one.omega_n * STEPS / (2.0 * math.pi))
    period = 2.0 * math.pi / one.omega
    state, f, t = np.zeros(4), np.zeros(len(contact)), 0.0

    def followed(count: int) -> np.ndarray:
        nonlocal t
        out = np.empty((3, count))
        t = follow(rig, contact, state, f, t, step / every, every, out)
        return out

    if one.forced:
        settles = one.omega / one.omega_n / one.zeta  # cycles: 1/ζ natural periods
        skipped, lasts = _SETTLES * settles + random.uniform(0.0, 1.0), one.cycles[level] + _LEAD
        if one.kind == UNSETTLED:
            left, from_rest = random.uniform(0.05, 0.3), random.random() < 0.5
            skipped = 0.0 if from_rest else -math.log(left) / (2.0 * math.pi) * settles
            lasts = one.cycles[level] + (0.5 * _SETTLES * settles if from_rest else 0.0)
        skipped = round(skipped * period / step)
        signals = followed(skipped + round(lasts * period / step))[:, skipped:]
        return (skipped + np.arange(signals.shape[1])) * step, signals
    if one.blow:
        state[1] = one.X * one.omega_n
    else:
        state[0] = one.X
        f[:] = [moved(0.0, one.X, element) for element in contact]
    lead = [at_rest(state[0], round(period / step))]
    if one.kind == LEAD:
        rest = at_rest(0.0, round(random.uniform(0.5, 3.0) * period / step))
        if not one.blow:
            hand = pulled(0.0, one.X, random.uniform(1.0, 3.0) * period, step)
            lead = [hand, at_rest(one.X, round(random.uniform(0.5, 2.0) * period / step))]
        lead = [rest, *lead]
    parts = []
    if one.kind == DOUBLE:
        parts = [followed(round(random.uniform(0.3, 1.5) * period / step))]
        state[1] += random.uniform(0.2, 0.6) * one.X * one.omega_n
    count = round(one.cycles[0] * period / step)
    signals = np.hstack([*lead, *parts, followed(count)])
    released = sum(part.shape[1] for part in lead)
    return (np.arange(signals.shape[1]) - released) * step, signals


def _ringing(
    one: Field, t: np.ndarray, v: np.ndarray, spread: Callable[[float, float], float]
) -> np.ndarray:
    """Return a second mode, of amplitude 1 after a kick: by the release, or by each reversal of the friction."""
    omega, zeta = spread(4.0, 9.0) * one.omega, spread(0.005, 0.02)
    kicks = [(0.0, 1.0)]
    if one.forced:
        at = np.flatnonzero(v[:-1] * v[1:] < 0.0)
        times = t[at] + (t[1] - t[0]) * v[at] / (v[at] - v[at + 1])
        kicks = list(zip(times, np.sign(v[at + 1]), strict=True))
    ringing = np.zeros(t.size)
    for time, sign in kicks:
        since = np.maximum(t - time, 0.0)
        ringing += sign * np.exp(-zeta * omega * since) * np.sin(omega * since)
    return ringing


def _drifting(length: float, t: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """Return an offset and a drift that slows down, as of a sensor that warms up, each a few per cent."""
    signs = random.choice([-1.0, 1.0], 2)
    warm = 1.0 - np.exp(-(t - t[0]) / (random.uniform(0.3, 2.0) * length))
    return signs[0] * random.uniform(0.02, 0.1) + signs[1] * random.uniform(0.01, 0.05) * warm


def sensed(one: Field, t: np.ndarray, signals: np.ndarray, level: int = 0) -> np.ndarray:
    """Return the signal as the sensor and its amplifier hand it over.   t, signals : of `motion`."""
    clean = signals[ANSWERS.index(one.answer)]
    sizes, random = one.random(1), one.random(100 + level)
    any_size, part = log_uniform(sizes), 0.3 if one.kind == ALL else 1.0

    def size(low: float, high: float) -> float:
        return any_size(low, low * (high / low) ** part)

    def filtered(values: np.ndarray, order: int, corner: float, kind: str) -> np.ndarray:
        poles = signal.butter(order, corner, kind, fs=_OVER * one.rate_hz, output="sos")
        held = 0.0 if one.forced else values[0]  # what came before a decay
        return signal.sosfilt(poles, values, zi=signal.sosfilt_zi(poles) * held)[0]

    peak = float(np.abs(clean).max())
    values = clean.copy()
    if one.has(MODE):
        ringing = _ringing(one, t, signals[1], any_size)
        values += size(0.01, 0.05) * peak / np.abs(ringing).max() * ringing
    if one.has(THIRD):  # x³ has a third harmonic of a quarter
        values += 4.0 * any_size(0.002, 0.01) * clean**3 / peak**2
    if one.has(AC):
        corner = any_size(0.02, 0.15) * one.omega / (2.0 * math.pi)
        values = filtered(values, 1, corner, "high")
    if one.has(DRIFT):
        values += part * peak * _drifting(t[-1] - t[0], t, random)
    if one.has(HUM):
        phases, top = random.uniform(0.0, 2.0 * math.pi, len(_MAINS)), size(0.001, 0.01) * peak
        for (hertz, line), phase in zip(_MAINS, phases, strict=True):
            values += top * line * np.sin(2.0 * math.pi * hertz * t + phase)
    if one.has(FILTER):
        order, corner = int(sizes.choice([4, 6, 8])), sizes.uniform(0.3, 0.45) * one.rate_hz
        values = filtered(values, order, corner, "low")
    return values


def _recorded(one: Field, values: np.ndarray, peak: float) -> np.ndarray:
    """Return a channel within the range of the recorder.   peak : largest value in all records."""
    sizes = one.random(3)
    if one.has(CLIPPED):
        top = sizes.uniform(0.7, 0.95) * peak
        values = np.clip(values, -top, top)
    if one.has(BITS):
        step = sizes.uniform(1.3, 4.0) * peak / 2**11
        values = np.round(values / step) * step
    return values


def records(one: Field) -> list[Record]:
    """Return the records of a set: a decay, or one for each level. A decay begins within half a period after the
    release."""
    channels = []
    for level in range(max(1, len(one.Y))):
        random = one.random(200 + level)
        t, signals = motion(one, level)
        values = sensed(one, t, signals, level)
        period, begins = 2.0 * math.pi / one.omega, t[0]
        if one.forced:
            begins += _LEAD * period * (one.kind != UNSETTLED)
        elif one.kind != LEAD:
            begins = random.uniform(0.0, 0.5) * period
        first = int(np.searchsorted(t, begins))
        t, values = t[first::_OVER], values[first::_OVER]
        of_level = {one.answer: values}
        if one.forced:
            y = one.Y[level] * np.cos(one.omega * t)
            acceleration = one.drive == "base_acceleration"
            of_level[one.drive] = -(one.omega**2) * y if acceleration else y
        noisy = {
            name: clean + one.noise * clean.std() * random.standard_normal(t.size)
            for name, clean in of_level.items()
        }
        channels.append((t - t[0], noisy))
    peak = max(float(np.abs(of_level[one.answer]).max()) for _, of_level in channels)
    measured = []
    for level, (t, of_level) in enumerate(channels):
        of_level[one.answer] = _recorded(one, of_level[one.answer], peak)
        name = f"{'level' if one.forced else 'decay'} {level + 1}"
        parts = [Channel(quantity, t, values) for quantity, values in of_level.items()]
        measured.append(Record.of(name, parts))
    return measured
