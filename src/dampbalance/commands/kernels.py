"""Compile the kernels of the rebuild: python -m dampbalance.commands.kernels, once per installation; `make` does it in
its set-up.

A kernel is compiled when it is first called, and kept. Here small cases call those that the rebuild needs, in two
processes; all others are compiled by whoever calls them first.
"""

from __future__ import annotations

import math
import subprocess
import sys
import time
from typing import Any

import numpy as np

import dampbalance as db

from ..motion.law_decays import rounding
from ..motion.orbit import Orbit
from ..motion.regime import Regime
from ..replication.clean import of_record
from ..replication.fixed_step import simulate

_OSCILLATOR: dict[str, Any] = {"m": 2.42, "c": 40.0, "k": 2310.0, "K_z": 208000.0, "F_k": 1.28}
_MOTION = db.BaseMotion(0.004, 2.0 * math.pi * 4.92)


def steady() -> None:
    """Compute steady responses and their features, alone and many at a time."""
    orbit = db.steady_orbit(db.Oscillator(**_OSCILLATOR), _MOTION)
    db.measured_orbit(orbit, rate_hz=1000.0, cycles=8.0)
    db.steady_orbits(**_OSCILLATOR, Y=[1e-5, 0.0006, 0.004], omega=_MOTION.omega)


def harmonics() -> None:
    """Compute harmonics of a steady response, which fits follow, and fixed steps with their read-outs."""
    # an orbit of two phases, made by hand as the other process compiles what solves for one
    phases = np.array([[0.0, 0.0, -2.5e-3, 0.0, -6e-6], [3e-3, 1.0, -2.488e-3, 8e-3, 6e-6]])
    oscillator = db.Oscillator(**_OSCILLATOR)
    Orbit(oscillator, _MOTION, Regime.ONE_SLIP, 4.7, phases).harmonics(3)
    record = simulate(oscillator, _MOTION, step=2e-5, cycles=4, keep_cycles=3)
    of_record(record, _MOTION.omega, oscillator.k)
    rounding(np.array([0.0]), 1.28, 208000.0)


PARTS = {"steady": steady, "harmonics": harmonics}


def main(names: list[str]) -> None:
    """Compile the parts named; without a name all of them, each in a process."""
    if names:
        for name in names:
            PARTS[name]()
        return
    began = time.monotonic()
    print("Compiling the kernels, once per installation …", file=sys.stderr, flush=True)
    command = (sys.executable, "-m", "dampbalance.commands.kernels")
    null = subprocess.DEVNULL
    running = [subprocess.Popen([*command, name], stdout=null, stderr=null) for name in PARTS]
    if sum(process.wait() != 0 for process in running):
        print("They cannot be compiled now, and are when they are first called.", file=sys.stderr)
        return
    print(f"Compiled after {time.monotonic() - began:.0f} s.", file=sys.stderr)


if __name__ == "__main__":
    main(sys.argv[1:])
