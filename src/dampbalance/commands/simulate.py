"""dampbalance simulate: a record of the exact steady response, with noise, as text or for MATLAB.

Each record is exact except for white noise, independent in every channel. The oscillator is that of the paper unless
options say otherwise. With a --channel such as base_angle and angle it rotates: kg m², N m s/rad, N m/rad, N m and rad
then stand for kg, N s/m, N/m, N and m.

With --law the damping is that of its terms, c among them (c is 0 unless the law or --damping gives it); the contact
keeps its --friction unless the law gives F_k. The terms, their coefficients in SI units: c on the velocity of the mass,
c_r on that relative to the base, c_2 quadratic, c_3 cubic, eta structural, a loss factor.

With --sliders the contact yields gradually: Jenkins elements in parallel, each a spring of kappa that slips at a
deflection of r, so that the friction force of all is the sum of kappa × r. They are the whole contact unless
--friction adds the oscillator's own element, with --contact-stiffness.

  dampbalance simulate level1.csv --frequency 3.5 --amplitude 0.004 --noise 0.01 --seed 1
  dampbalance simulate level1.csv --frequency 3.5 --amplitude 0.004 --law c_2=40,eta=0.02
  dampbalance simulate level1.csv --frequency 3.5 --amplitude 0.004 --sliders 1e-5:40000,5e-5:8000,2e-4:2000
  dampbalance simulate level1.csv --frequency 3.5 --amplitude "9 N" --channel force --channel acceleration
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..arguments import NUMBERS, Bounds
from ..model import BaseMotion, Oscillator
from ..motion.law_response import law_response
from ..motion.law_steady import Response
from ..motion.orbit import Orbit, steady_orbit
from ..motion.sliders import SlidersOrbit, sliders_orbit
from ..project.wording import listed
from ..records.channel import EXCITATIONS, RESPONSES, ROTATING
from ..records.errors import RecordError
from ..records.quantities import quantity as read_number
from ..records.record import Record
from ..records.synthetic import measured_orbit
from ..records.writers import write
from .options import FILE, argument, coefficients, quantity, sliders, whole

# the paper's oscillator: m, kg, c, N s/m, k and K_z, N/m, F_k, N
MASS, DAMPING, STIFFNESS, CONTACT, FRICTION = 2.42, 90.0, 2310.0, 208000.0, 1.28


def arguments(
    own: dict[str, dict[str, Any]], noise_of: str, channels: Sequence[str], default: Sequence[str]
) -> dict[str, dict[str, Any]]:
    """Return the arguments of a command that writes a record: its own, and those of the oscillator, the noise and the
    file.

    noise_of : to which the noise is relative.   channels, default : quantities, and those without --channel.
    """
    words = f"a quantity; may be repeated (default: {', '.join(default)})"
    return {
        "record": argument(".csv or other text, or .mat", **FILE),
        **own,
        "--mass": quantity("m", MASS, "m, kg"),
        "--damping": quantity("c", None, f"c, N s/m (default: {DAMPING:g})"),
        "--stiffness": quantity("k", STIFFNESS, "k, N/m"),
        "--contact-stiffness": quantity("K_z", CONTACT, "K_z, N/m"),
        "--friction": quantity("F_k", None, f"F_k, N (default: {FRICTION:g})"),
        "--rate": quantity("rate_hz", 5000.0, "samples per second"),
        "--noise": quantity("noise", 0.0, f"rms, relative to {noise_of}"),
        "--seed": quantity("seed", 0, "seed of the noise", type=whole("seed")),
        "--channel": argument(words, action="append", choices=channels),
        "--overwrite": argument("replace an existing file"),
    }


_CHANNELS = ("base_displacement", "displacement")
_IN_MOTION = [*EXCITATIONS, *RESPONSES]

ARGUMENTS = arguments(
    {
        "--frequency": quantity(
            "frequency", None, "drive frequency, Hz", required=True, metavar="HZ"
        ),
        "--amplitude": argument(
            "amplitude of the base, m, or of the force, N, where a --channel is the force and none the base",
            required=True,
            metavar="AMPLITUDE",
        ),
        "--law": argument(
            "terms of the damping with their coefficients, see below (default: c alone)",
            type=coefficients,
            metavar="SYMBOL=VALUE,…",
        ),
        "--sliders": argument(
            "Jenkins elements, m:N/m, see below; not with --law", type=sliders, metavar="R:KAPPA,…"
        ),
        "--cycles": quantity("cycles", 100.0, "cycles of the drive"),
        "--start": quantity("start", 0.0, "time of the first sample, s"),
        "--decimals": quantity(
            "decimals", None, "round the values, in SI units, to N decimals", type=whole("decimals")
        ),
    },
    "that of the channel",
    _IN_MOTION + [of for of, linear in ROTATING.items() if linear in _IN_MOTION],
    _CHANNELS,
)


def writing(
    simulated: Callable[..., Record], default: Sequence[str]
) -> Callable[[argparse.Namespace], None]:
    """Return a command that writes a record, and prints the name of its file.

    simulated : function that takes options and, by their names, what all records have.   default : its quantities.

    The command raises ValueError where the file exists and may not be replaced, before anything is simulated.
    """

    def run(options: argparse.Namespace) -> None:
        if options.record.exists() and not options.overwrite:
            remedy = "choose another name, or add --overwrite"
            raise ValueError(f"{options.record} exists already: {remedy}")
        samples = {"rate_hz": options.rate, "noise": options.noise, "seed": options.seed}
        record = simulated(options, channels=tuple(options.channel or default), **samples)
        file = write(options.record, record)
        options.written.append(str(file))
        print(f"Written: {file}")

    return run


def _steady_record(options: argparse.Namespace, **common: Any) -> Record:
    """Return the record of a steady response."""
    law = dict(options.law or {})
    if options.sliders and options.law:
        raise ValueError("--sliders and --law cannot be combined: leave out one")
    osc = oscillator(options, law, 0.0 if options.sliders else FRICTION)
    Y = _amplitude(options.amplitude, common["channels"], osc.k, law)
    motion = BaseMotion(Y=Y, omega=2.0 * math.pi * options.frequency)
    cycle = f"a cycle of {options.frequency:g} Hz"
    require_brief(osc, 1.0 / options.frequency, cycle, "a higher --frequency", bool(law))
    orbit: Orbit | Response | SlidersOrbit
    if options.sliders:
        orbit = sliders_orbit(osc, motion, *zip(*options.sliders, strict=True))
    else:  # exact where the law is friction and c
        orbit = law_response(osc, motion, law) if law else steady_orbit(osc, motion)
    record = measured_orbit(orbit, cycles=options.cycles, start=options.start, **common)
    return record if options.decimals is None else _rounded(record, options.decimals)


run = writing(_steady_record, _CHANNELS)


def _amplitude(text: str, channels: Sequence[str], k: float, law: Collection[str]) -> float:
    """Return the amplitude of the base, m, from a text that may have a unit; where the channel that drives is a force,
    or a torque, of the base motion f/k that it stands for.

    Raises ValueError where several channels drive, or the law has a damper to a base that rests.
    """
    driving = [one for one in channels if ROTATING.get(one, one) in EXCITATIONS]
    if len({*driving}) > 1:
        raise ValueError(f"only one of {listed(driving)} can drive: leave out the other --channel")
    by_force = [ROTATING.get(one, one) for one in driving] == ["force"]
    if by_force and "c_r" in law:
        raise ValueError("--law c_r: the base, to which it is, rests under a force: give c")
    bounds, per = (Bounds("N"), k) if by_force else (NUMBERS["Y"], 1.0)
    try:
        return read_number("--amplitude", text, bounds) / per
    except ValueError as error:
        other = "the base, name its" if by_force else "a force, name that and no base as"
        raise ValueError(f"{error}; for that of {other} --channel") from None


def require_brief(
    osc: Oscillator, duration: float, within: str, remedy: str, law: bool = False
) -> None:
    """Raise ValueError where the oscillator swings more often within a duration, s, than can be followed."""
    swings = math.sqrt((osc.k + osc.K_z) / osc.m) * duration / (2.0 * math.pi)
    # a second or two of computing; of a law a minute or two
    most = 3_000 if law else 300_000
    if swings > most:
        raise ValueError(
            f"the oscillator swings {swings:.2g} times in {within}, and no more than {most:,} can be followed"
            f"{' under such a law' * law}; ask for {remedy}, or more --mass"
        )


def oscillator(
    options: argparse.Namespace, law: dict[str, float], friction: float = FRICTION
) -> Oscillator:
    """Return the oscillator of the options; it takes friction and c out of a law that gives them.

    friction : F_k, N, where neither options nor law give it.
    """
    given = {"c": options.damping, "F_k": options.friction}
    for symbol, option in (("c", "--damping"), ("F_k", "--friction")):
        if symbol in law and given[symbol] is not None:
            raise ValueError(f"{symbol} is in --law and given by {option} as well: leave out one")
    default = {"c": 0.0 if law else DAMPING, "F_k": friction}
    c, F_k = (
        law.pop(symbol, default[symbol] if given[symbol] is None else given[symbol])
        for symbol in ("c", "F_k")
    )
    return Oscillator(options.mass, c, options.stiffness, options.contact_stiffness, F_k)


def _rounded(measurement: Record, decimals: int) -> Record:
    each = measurement.channels.values()
    channels = [replace(c, values=np.round(c.values, decimals)) for c in each]
    for channel in channels:
        if not np.ptp(channel.values) > 0.0:
            rounded = f"constant when rounded to {decimals} decimals"
            raise RecordError(f"{channel.name} is {rounded}: keep more of them")
    return Record.of(measurement.name, channels)
