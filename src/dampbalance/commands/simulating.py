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
from ..records.measurement import QUANTITIES, Channel, Measurement
from ..records.synthetic import measured_orbit
from ..records.writers import write

_EPILOG = """\
Each record is exact but for its noise, which is white, of every channel by itself. The oscillator is that of the paper
unless told otherwise.

  dampbalance simulate level1.csv --frequency 3.5 --amplitude 0.004 --noise 0.01 --seed 1
"""
_CHANNELS = ("base_displacement", "displacement")


def add_to(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "simulate",
        help="write a record with known truth",
        description=__doc__,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    add("record", type=Path, metavar="FILE", help="its suffix names the format")
    add("--frequency", type=float, required=True, metavar="HZ", help="of the drive, Hz")
    add("--amplitude", type=float, required=True, metavar="Y", help="of the base, m")
    add("--mass", type=float, default=2.42, help="m, kg (default: %(default)s)")
    add("--damping", type=float, default=90.0, help="c, N s/m (default: %(default)s)")
    add("--stiffness", type=float, default=2310.0, help="k, N/m (default: %(default)s)")
    add("--contact-stiffness", type=float, default=208000.0, help="K_z, N/m (default: %(default)s)")
    add("--friction", type=float, default=1.28, help="F_k, N (default: %(default)s)")
    add("--rate", type=float, default=5000.0, help="samples per second (default: %(default)s)")
    add("--cycles", type=float, default=100.0, help="of the drive (default: %(default)s)")
    add(
        "--start",
        type=float,
        default=0.0,
        help="time of the first sample, s (default: %(default)s)",
    )
    add(
        "--noise",
        type=float,
        default=0.0,
        help="rms over that of the channel (default: %(default)s)",
    )
    add("--seed", type=int, default=0, help="of the noise (default: %(default)s)")
    add(
        "--channel",
        action="append",
        choices=list(QUANTITIES),
        help=f"a quantity; may be repeated (default: {', '.join(_CHANNELS)})",
    )
    add("--decimals", type=int, metavar="N", help="round the values, in SI units, to N decimals")
    add("--format", help="where the suffix stands for several, e.g. matlab73")
    add("--overwrite", action="store_true", help="replace a file that is there already")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Simulate and write; a file that exists is not touched unless told so."""
    path: Path = options.record
    if path.exists() and not options.overwrite:
        raise ValueError(f"{path} exists already: choose another name, or add --overwrite")
    if not (math.isfinite(options.frequency) and options.frequency > 0.0):
        raise ValueError(f"--frequency must be a positive number of Hz, got {options.frequency}")
    if options.seed < 0:
        raise ValueError(f"--seed must be 0 or a positive whole number, got {options.seed}")
    osc = Oscillator(
        m=options.mass,
        c=options.damping,
        k=options.stiffness,
        K_z=options.contact_stiffness,
        F_k=options.friction,
    )
    motion = BaseMotion(Y=options.amplitude, omega=2.0 * math.pi * options.frequency)
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
