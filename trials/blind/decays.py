"""Records of free decays: each set drawn by (seed, index) alone, its motion from an independent integrator."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from dampbalance.records.channel import Channel
from dampbalance.records.record import Record

from .gradual import CONTACTS
from .other_motion import NO_DEPARTURE, Departure, one_slider, ring_down_on
from .truths import ANSWERS, NOISE, SEED, Linear, log_uniform

_DECAYS = 2  # so that the draws are not those of the forced sets
_SETTLES = 3.0  # time constants of the slowest decay that a burst lasts at the most


@dataclass(frozen=True)
class Decay(Linear):
    """One record of one to three free decays. SI units.

    starts : of each, ("pluck", x) for a release from x or ("blow", v) for a velocity added at rest.   lead : time that
    the mass is held, or rests, before each, s.   lasts : of each, s.   pull : time that a hand takes to pull it, s.
    answers : channels.   noise : as a part of the largest value.   offset : of a channel, of its largest value.
    departure : what its motion has in addition to friction and viscous damping.   contact : of `gradual.CONTACTS`,
    instead of one that yields at once.
    """

    index: int
    m: float
    c: float
    k: float
    K_z: float
    F_k: float
    starts: tuple[tuple[str, float], ...]
    lead: tuple[float, ...]
    lasts: tuple[float, ...]
    pull: tuple[float, ...]
    rate_hz: float
    answers: tuple[str, ...]
    noise: float
    offset: float
    departure: Departure = NO_DEPARTURE
    contact: str = ""

    @property
    def height(self) -> float:
        """The first amplitude over F_k/k."""
        kind, size = self.starts[0]
        return abs(size) / (1.0 if kind == "pluck" else self.omega_n) * self.k / self.F_k


def draw(index: int, seed: int = SEED) -> Decay:
    """Set number `index` ≥ 0: ζ 0.002–0.1, K_z/k 3–300, a first amplitude of 5–50 F_k/k, m 0.1–10 kg, f_n 1–50 Hz, all
    log-uniform; 50–400 samples per free cycle."""
    random = np.random.default_rng((_DECAYS, seed, index))
    spread = log_uniform(random)
    m, f_n = spread(0.1, 10.0), spread(1.0, 50.0)
    omega_n = 2.0 * math.pi * f_n
    k = m * omega_n**2
    zeta, K = spread(0.002, 0.1), spread(3.0, 300.0)
    height, x = spread(5.0, 50.0), spread(1e-4, 1e-2)
    count = int(random.integers(1, 4))
    kinds = random.permutation(["pluck", "blow", "both"])[0]
    starts, lasts = [], []
    cycles = min(0.25 * height, _SETTLES / (2.0 * math.pi * zeta)) + 4.0
    for i in range(count):
        kind = str(random.choice(["pluck", "blow"])) if kinds == "both" else str(kinds)
        size = x * (1.0 if i == 0 else random.uniform(0.5, 1.0)) * random.choice([-1.0, 1.0])
        starts.append((kind, float(size * (1.0 if kind == "pluck" else omega_n))))
        lasts.append(cycles / f_n * random.uniform(0.8, 1.6))
    led = bool(random.random() < 0.5)
    lead = [random.uniform(0.5, 3.0) / f_n * (led or i > 0) for i in range(count)]
    answers = random.permutation(ANSWERS)[: 2 if random.random() < 0.15 else 1].tolist()
    return Decay(
        index=index,
        m=m,
        c=2.0 * zeta * math.sqrt(k * m),
        k=k,
        K_z=K * k,
        F_k=k * x / height,
        starts=tuple(starts),
        lead=tuple(float(t) for t in lead),
        lasts=tuple(float(t) for t in lasts),
        pull=tuple(random.uniform(1.0, 3.0) / f_n for _ in range(count)),
        rate_hz=spread(50.0, 400.0) * f_n,
        answers=tuple(answer for answer in ANSWERS if answer in answers),
        noise=float(random.choice(NOISE)),
        offset=float(random.uniform(-0.3, 0.3)),
    )


def departing(decay: Decay, field: str, order: int, share: float) -> Decay:
    """Return the decay with a further term, which would take a share of the loss of the motion without it.

    field : of `Departure`.   order : power of the velocity, or of the displacement in a spring, that its force grows
    with; the share of a spring is that of its force in the force at the start.
    """
    signals, _ = clean(decay)
    x, v = np.abs(signals[:2])
    if field == "cubic":
        size = share * decay.k * float(x.max()) ** (1 - order)
    else:
        loss = float(np.sum(decay.F_k * v + decay.c * v**2))
        size = share / (1.0 - share) * loss / float(np.sum(v ** (order + 1)))
    return replace(decay, departure=Departure(**{field: size}))


def falling(decay: Decay, part: float, speed: float) -> Decay:
    """Return the decay with friction that falls with speed, F_k (1 + part · e^(−|ẋ|/v_s)) (Stribeck).

    speed : v_s over the largest speed of the motion without it.
    """
    top = float(np.abs(clean(decay)[0][1]).max())
    return replace(decay, departure=Departure(falling=part, speed=speed * top))


def clean(decay: Decay) -> tuple[np.ndarray, list[float]]:
    """Return (x, x′, x″) of the record, (3, n), and the times at which the mass comes free, s."""
    step, Z_m = 1.0 / decay.rate_hz, decay.F_k / decay.K_z
    contact = CONTACTS.get(decay.contact, one_slider)(decay.K_z, decay.F_k)
    parts: list[np.ndarray] = []
    x = z = 0.0
    free, count = [], 0
    for i, (kind, size) in enumerate(decay.starts):
        v = size if kind == "blow" else 0.0
        if kind == "pluck":
            if i:
                parts.append(pulled(x, size, decay.pull[i], step))
            x, z = size, math.copysign(Z_m, size)
        parts.append(at_rest(x, round(decay.lead[i] / step)))
        count = sum(part.shape[1] for part in parts)
        free.append(count * step)
        forces, how = contact[:, 1] * (z / Z_m), decay.departure
        moved = ring_down_on(contact, decay, x, v, forces, step, decay.lasts[i], how)
        parts.append(moved)
        # a hand grasps it, or holds it while it is struck
        x = float(moved[0, -1])
        z = min(max(-decay.k * x / decay.K_z, -Z_m), Z_m)
    return np.hstack(parts), free


def at_rest(x: float, count: int) -> np.ndarray:
    held = np.zeros((3, count))
    held[0] = x
    return held


def pulled(start: float, end: float, lasts: float, step: float) -> np.ndarray:
    """Return a hand that moves the mass from one place to another, after it has grasped it for as long."""
    n = max(4, round(lasts / step))
    turn = np.arange(n) * (math.pi / n)
    rate = math.pi / (n * step)
    half = 0.5 * (end - start)
    x = start + half * (1.0 - np.cos(turn))
    moved = [x, half * rate * np.sin(turn), half * rate**2 * np.cos(turn)]
    return np.hstack([at_rest(start, n), moved])


def record(decay: Decay, seed: int | None = None) -> tuple[Record, list[float]]:
    """Return the record with its noise, and the times at which the mass comes free, s.   seed : default, that of the
    set."""
    signals, free = clean(decay)
    t = np.arange(signals.shape[1]) / decay.rate_hz
    channels = []
    for quantity in decay.answers:
        order = ANSWERS.index(quantity)
        values = signals[order]
        largest = float(np.abs(values).max())
        key = (_DECAYS, SEED if seed is None else seed, decay.index, order)
        random = np.random.default_rng(key)
        noisy = values + decay.noise * largest * random.standard_normal(t.size)
        channels.append(Channel(quantity, t, noisy + decay.offset * largest))
    return Record.of(f"decay {decay.index}", channels), free
