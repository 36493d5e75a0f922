"""dampbalance release: a record of the exact free decay after a release or a blow, as text or for MATLAB.

The record is exact except for white noise, independent in every channel. The oscillator is that of the paper unless
options say otherwise; its damping is so strong that it hardly oscillates.

  dampbalance release decay.csv --displacement 0.01 --damping 1 --friction 0.5 --noise 0.01
  dampbalance identify decay.csv --stiffness 2310

With --channel angle the oscillator rotates, like a pendulum: displacement, velocity, mass, damping, stiffnesses and
friction are then in rad, rad/s, kg m², N m s/rad, N m/rad and N m.
"""

from __future__ import annotations

import argparse

from ..records.channel import ABSOLUTE, ROTATING
from ..records.record import Record
from ..records.synthetic import measured_ring_down
from .options import quantity
from .simulate import arguments, oscillator, require_brief, write_new

ARGUMENTS = arguments(
    {
        "--displacement": quantity("x", 0.0, "initial displacement, m", metavar="X"),
        "--velocity": quantity("v", 0.0, "initial velocity, as after a blow, m/s", metavar="V"),
        "--duration": quantity("duration", 3.0, "duration of the decay, s"),
        "--held": quantity("held", 0.2, "time for which the mass is held before, s"),
    },
    "the largest value of the channel",
    [*ABSOLUTE, *(q for q, linear in ROTATING.items() if linear in ABSOLUTE)],
    ["displacement"],
)


def run(options: argparse.Namespace) -> None:
    """Simulate and write a record of a free decay."""
    write_new(options, _measurement)


def _measurement(options: argparse.Namespace) -> Record:
    """Return the record of a free decay."""
    osc = oscillator(options, {})
    require_brief(osc, options.duration, f"{options.duration:g} s", "a shorter --duration")
    return measured_ring_down(
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
