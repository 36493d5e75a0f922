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
from typing import Any

from ..records.channel import ABSOLUTE, ROTATING
from ..records.record import Record
from ..records.synthetic import measured_ring_down
from .options import quantity
from .simulate import arguments, oscillator, require_brief, writing

_CHANNELS = ("displacement",)

ARGUMENTS = arguments(
    {
        "--displacement": quantity("x", 0.0, "initial displacement, m", metavar="X"),
        "--velocity": quantity("v", 0.0, "initial velocity, as after a blow, m/s", metavar="V"),
        "--duration": quantity("duration", 3.0, "duration of the decay, s"),
        "--held": quantity("held", 0.2, "time for which the mass is held before, s"),
    },
    "the largest value of the channel",
    [*ABSOLUTE, *(q for q, linear in ROTATING.items() if linear in ABSOLUTE)],
    _CHANNELS,
)


def _decay(options: argparse.Namespace, **common: Any) -> Record:
    """Return the record of a free decay."""
    osc = oscillator(options, {})
    require_brief(osc, options.duration, f"{options.duration:g} s", "a shorter --duration")
    x, v, duration, held = options.displacement, options.velocity, options.duration, options.held
    return measured_ring_down(osc, x=x, v=v, duration=duration, held=held, **common)


run = writing(_decay, _CHANNELS)
