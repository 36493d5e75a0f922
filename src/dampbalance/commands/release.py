"""dampbalance release: a record of the exact free decay after a release or a blow, as text or for MATLAB."""

from __future__ import annotations

import argparse
from typing import Any

from ..records.channel import ABSOLUTE, ROTATING
from ..records.synthetic import measured_ring_down
from .options import quantity
from .simulate import ARGUMENTS as OF_FORCED
from .simulate import DAMPING, oscillator, require_brief, require_new, save

EPILOG = """\
The record is exact except for white noise, independent in every channel. The oscillator is that of the paper unless
options say otherwise; its damping is so strong that it hardly oscillates.

  dampbalance release decay.csv --displacement 0.01 --damping 1 --friction 0.5 --noise 0.01
  dampbalance identify decay.csv --stiffness 2310

With --channel angle the oscillator rotates, like a pendulum: displacement, velocity, mass, damping, stiffnesses and
friction are then in rad, rad/s, kg m², N m s/rad, N m/rad and N m.
"""

_ALIKE = ("--mass", "--stiffness", "--contact-stiffness", "--friction", "--rate")
ARGUMENTS: dict[str, dict[str, Any]] = {
    "record": OF_FORCED["record"],
    "--displacement": quantity("x", 0.0, "initial displacement, m", metavar="X"),
    "--velocity": quantity("v", 0.0, "initial velocity, as after a blow, m/s", metavar="V"),
    "--duration": quantity("duration", 3.0, "duration of the decay, s"),
    "--held": quantity("held", 0.2, "time for which the mass is held before, s"),
    **{name: OF_FORCED[name] for name in _ALIKE},
    "--damping": quantity("c", DAMPING, "c, N s/m"),
    "--noise": OF_FORCED["--noise"]
    | {"help": "rms, relative to the largest value of the channel (default: %(default)s)"},
    "--seed": OF_FORCED["--seed"],
    "--channel": {
        "action": "append",
        "choices": [*ABSOLUTE, *(q for q, linear in ROTATING.items() if linear in ABSOLUTE)],
        "help": "a quantity; may be repeated (default: displacement)",
    },
    "--overwrite": OF_FORCED["--overwrite"],
}


def run(options: argparse.Namespace) -> None:
    """Simulate and write a record."""
    require_new(options)
    osc = oscillator(options, {})
    require_brief(osc, options.duration, f"{options.duration:g} s", "a shorter --duration")
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
    save(options, measurement)
