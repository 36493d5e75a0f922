"""dampbalance release: a record of the exact free decay after a release or a blow, in any of the formats."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import Any

from ..model import Oscillator
from ..motion.jit import interpreted
from ..records.limits import LATEST
from ..records.measurement import RESPONSES
from ..records.synthetic import measured_ring_down
from ..records.writers import write
from .options import number
from .simulate import ARGUMENTS as OF_FORCED
from .simulate import DAMPING, FRICTION

EPILOG = """\
The record is exact except for its noise, which is white, of every channel by itself. The oscillator is that of the
paper unless told otherwise; it damps so much that it hardly swings.

  dampbalance release decay.csv --displacement 0.01 --damping 1 --friction 0.5 --noise 0.01
  dampbalance identify decay.csv --stiffness 2310
"""
_MOST_SWINGS = 300_000  # a second or two of computing

ARGUMENTS: dict[str, dict[str, Any]] = {
    "record": OF_FORCED["record"],
    "--displacement": {
        "type": number(-1e15),
        "default": 0.0,
        "metavar": "X",
        "help": "to which the mass was pulled, m (default: %(default)s)",
    },
    "--velocity": {
        "type": number(-1e15),
        "default": 0.0,
        "metavar": "V",
        "help": "that a blow gives it, m/s (default: %(default)s)",
    },
    "--duration": {
        "type": number(0.0, LATEST),
        "default": 3.0,
        "help": "of the decay, s (default: %(default)s)",
    },
    "--held": {
        "type": number(0.0, LATEST),
        "default": 0.2,
        "help": "time for which the mass is held before, s (default: %(default)s)",
    },
    **{
        name: OF_FORCED[name]
        for name in (
            "--mass",
            "--damping",
            "--stiffness",
            "--contact-stiffness",
            "--friction",
            "--rate",
        )
    },
    "--noise": OF_FORCED["--noise"]
    | {"help": "rms over the largest value of the channel (default: %(default)s)"},
    "--seed": OF_FORCED["--seed"],
    "--channel": {
        "action": "append",
        "choices": list(RESPONSES),
        "help": "a quantity; may be repeated (default: displacement)",
    },
    "--format": OF_FORCED["--format"],
    "--overwrite": OF_FORCED["--overwrite"],
}


def run(options: argparse.Namespace) -> None:
    """Simulate and write; a file that exists is not touched unless told so."""
    path: Path = options.record
    if path.exists() and not options.overwrite:
        raise ValueError(f"{path} exists already: choose another name, or add --overwrite")
    osc = Oscillator(
        m=options.mass,
        c=DAMPING if options.damping is None else options.damping,
        k=options.stiffness,
        K_z=options.contact_stiffness,
        F_k=FRICTION if options.friction is None else options.friction,
    )
    swings = math.sqrt((osc.k + osc.K_z) / osc.m) * options.duration / (2.0 * math.pi)
    if swings > _MOST_SWINGS:
        raise ValueError(
            f"the oscillator swings {swings:.2g} times in {options.duration:g} s, and no more than {_MOST_SWINGS:,} "
            "can be followed; ask for a shorter --duration, or more --mass"
        )
    with interpreted(False):
        measurement = measured_ring_down(
            osc,
            x=options.displacement,
            v=options.velocity,
            rate_hz=options.rate,
            duration=options.duration,
            held=options.held,
            noise=options.noise,
            seed=options.seed,
            channels=tuple(options.channel or ("displacement",)),
        )
    for written in write(path, measurement, options.format):
        print(f"Written: {written}")
