"""A channel of a record: what it may hold, its samples, and the known effect of its transducer and filters."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import floats, one_of, text
from ..arrays import Array, Complexes, Mask
from .coordinate import ROTATION, TRANSLATION, Coordinate
from .equal_steps import HALF_A_STEP, uneven
from .errors import LARGEST_VALUE, LATEST, RecordError

ABSOLUTE = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s²"}
"""Motions of the mass against the ground."""
EXCITATIONS = {f"base_{quantity}": unit for quantity, unit in ABSOLUTE.items()} | {"force": "N"}
"""Excitations: one of these drives the oscillator, none in a free decay. A force f acts like a base motion y = f/k."""

RELATIVE = {f"relative_{quantity}": unit for quantity, unit in ABSOLUTE.items()}
"""Motions of the mass relative to the base, x − y, as a transducer between the two measures."""

RESPONSES = ABSOLUTE | RELATIVE
"""Responses of the mass; a record holds at least one. In a free decay and where a force drives, the base is at rest, so
that a relative motion is an absolute one."""

OF_FORCE = {"force_standard_error": "N"}
"""A column of a table of steady speeds: the standard error of its forces."""

ACCOMPANYING = {"normal_force": "N"} | OF_FORCE
"""Columns that accompany motion and friction: the force that presses a contact together, and the error of a force."""

QUANTITIES = EXCITATIONS | RESPONSES | ACCOMPANYING
"""Every quantity that a channel may hold, with the SI unit of its values."""

OF_LOOP = "displacement", "force"
"""What a measured loop consists of."""

ROTATING = {ROTATION.key(quantity): quantity for quantity in EXCITATIONS | RESPONSES | OF_FORCE}
"""Quantities of a record that rotates, angle, torque, …, and the quantity of a translation that each replaces."""

ORDERS = {q: [*ABSOLUTE.values()].index(unit) for q, unit in QUANTITIES.items() if unit != "N"}
"""Order of the time derivative of each motion: 0 for a displacement, 2 for an acceleration."""


def is_loop(quantities: Iterable[str]) -> bool:
    """Return whether a record of these quantities is a measured loop, which needs no times."""
    return {*OF_LOOP} <= {*quantities} <= {*OF_LOOP, "velocity", *ACCOMPANYING}


def sample_times(rate_hz: float, start: float, first: int, count: int) -> Array:
    """Return times, s, of `count` samples from number `first` on; the sample number 0 is taken at `start`."""
    number = np.arange(first, first + count, dtype=np.float64)
    steps = round(start * rate_hz)
    if steps / rate_hz == start:  # one division leads to 0.102, and not to 0.10200000000000001
        return (steps + number) / rate_hz
    return start + number / rate_hz


def mean_rate(t: Array) -> float:
    """Return samples per second of a channel with these times, s."""
    return (t.size - 1) / float(t[-1] - t[0])


@dataclass(frozen=True, slots=True)
class Correction:
    """Known effect of a channel on a signal on its way into the file.

    A channel with gain G, delay d and filters turns a harmonic e^{iωt} into H(iω) e^{iωt},

        H(s) = G e^{−sd} ∏ −p/(s − p) ∏ s/(s − q)

    with the poles p of its low-pass filter and q of its high-pass filter. A Butterworth filter of order n has its poles
    on the circle of its corner, 2πf e^{iπ(2j + n + 1)/(2n)}, j = 0 … n − 1. Harmonics divided by H are those of the
    signal.   gain : G.   delay : d, s.   low_pass, high_pass : p and q, rad/s, each with its conjugate.
    gain_error, delay_error : their standard uncertainties, which widen the intervals.
    """

    gain: float = 1.0
    delay: float = 0.0
    low_pass: tuple[complex, ...] = ()
    high_pass: tuple[complex, ...] = ()
    gain_error: float = 0.0
    delay_error: float = 0.0

    @property
    def of_time(self) -> bool:
        """Whether it is more than a gain."""
        return bool(self.delay or self.delay_error or self.low_pass or self.high_pass)

    def response(self, omega: ArrayLike) -> Complexes:
        """Return H(iω) at any ω, rad/s; at ω = 0 without the high-pass filter, which would pass nothing."""
        s = 1j * np.asarray(omega, dtype=np.float64)
        response: Complexes = self.gain * np.exp(-s * self.delay)
        for p in self.low_pass:
            response = response * (-p / (s - p))
        for q in self.high_pass:
            response = response * np.where(s == 0.0, 1.0, s / (s - q))
        return response

    def undone(self, values: Array, dt: float) -> Array:
        """Return samples as they were before gain and filters, except for a slow drift; the delay belongs to the times.

        Frequencies that a filter passes by less than a fifth are left out, since the inverse would show only noise
        there. The samples are continued by their mirror image, so that the ends of a moving signal do not ring.

        values : in steps of dt, s, (n,).
        """
        if not self.low_pass and not self.high_pass:
            return values / self.gain
        both = np.concatenate([values, values[::-1]])
        omega = 2.0 * math.pi * np.fft.rfftfreq(both.size, dt)
        response = self.response(omega) * np.exp(1j * omega * self.delay)
        with np.errstate(over="ignore"):
            # steep, so that the band of the motion is exact
            taper = 1.0 / (1.0 + (0.2 / np.abs(response / self.gain)) ** 8)
        before = np.fft.irfft(np.fft.rfft(both) * taper / response, both.size)
        return np.asarray(before[: values.size])


@dataclass(frozen=True, eq=False)
class Channel:
    """One signal: read-only arrays t (s) and values (SI unit of its quantity), shape (n,), n ≥ 2.

    quantity : one of `QUANTITIES`; one of `ROTATING` is replaced by the one of a translation, and the channel rotates.
    name : in the file, for messages.   correction : the known effect of the channel, not yet removed; None for none.
    coordinate : whether it rotates; the values are then in rad or N m.
    missing : mask of the samples that the record lacks, whose values are interpolated; None for none.
    timed : whether t are times; otherwise numbers of the samples, in a loop without times or a table of steady speeds.
    factor : SI units per reading of the file, 9.80665 for one in g.

    Raises ValueError naming the channel: unknown quantity, unequal lengths, a value that is not finite or beyond the
    bounds of `records/errors.py`, times that do not increase, have a gap, or are off equal steps by half a step.
    """

    quantity: str
    t: Array
    values: Array
    name: str = ""
    correction: Correction | None = None
    coordinate: Coordinate = TRANSLATION
    missing: Mask | None = None
    timed: bool = True
    factor: float = 1.0

    def __post_init__(self) -> None:
        text("the name of a channel", self.name)
        one_of(f"channel {self.name!r}: its quantity", self.quantity, (*QUANTITIES, *ROTATING))
        object.__setattr__(self, "name", self.name or self.quantity)
        if self.quantity in ROTATING:
            object.__setattr__(self, "coordinate", ROTATION)
            object.__setattr__(self, "quantity", ROTATING[self.quantity])
        this = f"channel {self.name!r}"
        for field in ("t", "values"):
            try:
                array = np.ascontiguousarray(floats(getattr(self, field))).view()
            except ValueError as error:
                raise ValueError(f"{this}: its {field} must be numbers, not {error}") from None
            array.flags.writeable = False
            object.__setattr__(self, field, array)
        sizes = f"{self.values.size} values at {self.t.size} times"
        if self.t.ndim != 1 or self.t.shape != self.values.shape:
            raise ValueError(f"{this} has {sizes}; each value needs its time")
        if self.t.size < 2:
            raise ValueError(f"{this} has {self.t.size} samples; a signal needs at least 2")
        for array, what, bound in ((self.t, "time", LATEST), (self.values, "value", LARGEST_VALUE)):
            within = np.abs(array) <= bound  # NaN is not
            if not within.all():
                i = int(np.argmin(within))
                beyond = f", beyond {bound:g}" if np.isfinite(array[i]) else ""
                what = f"{what} {i} (counted from 0) is {array[i]}{beyond}"
                raise ValueError(f"{this}: {what}; cut the record before it, or repair it")
        if problem := uneven(self.t, HALF_A_STEP):
            raise ValueError(f"{this}: its time {problem}")

    def __len__(self) -> int:
        return self.values.size

    @property
    def as_recorded(self) -> Array:
        """The values, NaN for those that are missing."""
        return self.values if self.missing is None else np.where(self.missing, np.nan, self.values)

    def part(self, samples: slice) -> Channel:
        """Return some of the samples as a channel."""
        missing = None if self.missing is None else self.missing[samples]
        return replace(self, t=self.t[samples], values=self.values[samples], missing=missing)

    @property
    def unit(self) -> str:
        """SI unit of the values."""
        return self.coordinate.unit(QUANTITIES[self.quantity])

    def corrected(self) -> Channel:
        """Return the channel with its known gain, delay and filters removed from the samples; of the correction, the
        uncertainties remain."""
        if (known := self.correction) is None:
            return self
        values = known.undone(self.values, 1.0 / mean_rate(self.t))
        left = Correction(gain_error=known.gain_error / known.gain, delay_error=known.delay_error)
        return replace(self, t=self.t - known.delay, values=values, correction=left)


def require_one_coordinate(source: str, coordinates: dict[str, Coordinate]) -> None:
    """Raise RecordError if some channels rotate and others do not.   coordinates : by the names of the channels."""
    first = {coordinate: name for name, coordinate in reversed(coordinates.items())}
    if len(first) > 1:
        raise RecordError(
            f"{source}: {first[ROTATION]!r} rotates and {first[TRANSLATION]!r} moves along a line, and a record does "
            "one of the two: name the channels to read in its mapping"
        )
