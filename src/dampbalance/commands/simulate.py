"""dampbalance simulate: a record of the exact steady response, with noise, in any of the formats."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import Any

import numpy as np

from ..model import BaseMotion, Oscillator
from ..motion.orbit import steady_orbit
from ..records.errors import RecordError
from ..records.limits import HIGHEST_RATE, LATEST, LOWEST_RATE
from ..records.measurement import QUANTITIES, Channel, Measurement
from ..records.synthetic import measured_orbit
from ..records.writers import write
from .options import LARGEST, SMALLEST, number, whole

EPILOG = """\
Each record is exact except for its noise, which is white, of every channel by itself. The oscillator is that of the
paper unless told otherwise.

  dampbalance simulate level1.csv --frequency 3.5 --amplitude 0.004 --noise 0.01 --seed 1
"""
_MOST_SWINGS = 300_000  # a second or two of computing
_CHANNELS = ("base_displacement", "displacement")


def _quantity(
    default: float, words: str, low: float = SMALLEST, high: float = LARGEST
) -> dict[str, Any]:
    words = f"{words} (default: %(default)s)"
    return {"type": number(low, high), "default": default, "help": words}


ARGUMENTS: dict[str, dict[str, Any]] = {
    "record": {"type": Path, "metavar": "FILE", "help": "its suffix names the format"},
    "--frequency": {
        "type": number(1e-9, 1e9),
        "required": True,
        "metavar": "HZ",
        "help": "of the drive, Hz",
    },
    "--amplitude": {"type": number(), "required": True, "metavar": "Y", "help": "of the base, m"},
    "--mass": _quantity(2.42, "m, kg"),
    "--damping": _quantity(90.0, "c, N s/m", 0.0),
    "--stiffness": _quantity(2310.0, "k, N/m"),
    "--contact-stiffness": _quantity(208000.0, "K_z, N/m"),
    "--friction": _quantity(1.28, "F_k, N", 0.0),
    "--rate": _quantity(5000.0, "samples per second", LOWEST_RATE, HIGHEST_RATE),
    "--cycles": _quantity(100.0, "of the drive"),
    "--start": _quantity(0.0, "time of the first sample, s", -LATEST, LATEST),
    "--noise": _quantity(0.0, "rms over that of the channel", 0.0, 1e6),
    "--seed": {"type": whole(), "default": 0, "help": "of the noise (default: %(default)s)"},
    "--channel": {
        "action": "append",
        "choices": list(QUANTITIES),
        "help": f"a quantity; may be repeated (default: {', '.join(_CHANNELS)})",
    },
    "--decimals": {
        "type": whole(-15, 30),
        "metavar": "N",
        "help": "round the values, in SI units, to N decimals",
    },
    "--format": {"help": "where the suffix stands for several, e.g. matlab73"},
    "--overwrite": {"action": "store_true", "help": "replace a file that is there already"},
}


def run(options: argparse.Namespace) -> None:
    """Simulate and write; a file that exists is not touched unless told so."""
    path: Path = options.record
    if path.exists() and not options.overwrite:
        raise ValueError(f"{path} exists already: choose another name, or add --overwrite")
    osc = Oscillator(
        m=options.mass,
        c=options.damping,
        k=options.stiffness,
        K_z=options.contact_stiffness,
        F_k=options.friction,
    )
    motion = BaseMotion(Y=options.amplitude, omega=2.0 * math.pi * options.frequency)
    swings = math.sqrt((osc.k + osc.K_z) / osc.m) / motion.omega
    if swings > _MOST_SWINGS:
        raise ValueError(
            f"the oscillator swings {swings:.2g} times in a cycle of {options.frequency:g} Hz, and no more than "
            f"{_MOST_SWINGS:,} can be followed; ask for a higher --frequency, or more --mass"
        )
    measurement = measured_orbit(
        steady_orbit(osc, motion),
        rate_hz=options.rate,
        cycles=options.cycles,
        noise=options.noise,
        seed=options.seed,
        channels=tuple(options.channel or _CHANNELS),
        start=options.start,
    )
    if options.decimals is not None:
        measurement = _rounded(measurement, options.decimals)
    for written in write(path, measurement, options.format):
        print(f"Written: {written}")


def _rounded(measurement: Measurement, decimals: int) -> Measurement:
    channels = [
        Channel(q, measurement[q].t, np.round(measurement[q].values, decimals)) for q in measurement
    ]
    for channel in channels:
        if not np.ptp(channel.values) > 0.0:
            raise RecordError(
                f"{channel.quantity} is constant when rounded to {decimals} decimals: keep more of them"
            )
    return Measurement.of(measurement.source, channels)
