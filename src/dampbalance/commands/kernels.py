"""Compile all kernels: python -m dampbalance.commands.kernels, once per installation; `make` does it in its set-up.

A kernel is compiled when it is first called, and kept. Here small cases call them: first, in two processes, those that
the rebuild needs; then, in the background, those of free decays and distorted drives.
"""

from __future__ import annotations

import math
import subprocess
import sys
import time
from typing import Any

import numpy as np

import dampbalance as db

from ..motion.distorted import distorted_harmonics
from ..motion.jit import interpreted
from ..motion.law_decays import rounding
from ..motion.orbit import Orbit
from ..motion.play import play
from ..replication.clean import of_record
from ..replication.fixed_step import simulate

_OSCILLATOR: dict[str, Any] = {"m": 2.42, "c": 40.0, "k": 2310.0, "K_z": 208000.0, "F_k": 1.28}
_OMEGA = 2.0 * math.pi * 4.92


def _orbit() -> Orbit:
    return db.steady_orbit(db.Oscillator(**_OSCILLATOR), db.BaseMotion(0.004, _OMEGA))


def steady() -> None:
    """Compute steady responses, alone and many at a time."""
    db.measured_orbit(_orbit(), rate_hz=1000.0, cycles=8.0)
    db.steady_orbits(**_OSCILLATOR, Y=[1e-5, 0.0006, 0.004], omega=_OMEGA)


def harmonics() -> None:
    """Compute harmonics of steady responses, which fits follow, and fixed steps with their read-outs."""
    with interpreted():
        orbit = _orbit()
    orbit.harmonics(3)
    record = simulate(orbit.oscillator, orbit.motion, step=2e-5, cycles=4, keep_cycles=3)
    of_record(record, _OMEGA, orbit.oscillator.k)
    rounding(np.array([0.0]), 1.28, 208000.0)


def rest() -> None:
    """Compute features of an orbit, responses to a distorted drive and with several sliders, decays, and loops."""
    orbit = _orbit()
    distorted_harmonics(orbit, np.array([orbit.X, 0.01 * orbit.X], dtype=complex), 3)
    several = db.sliders_orbit(
        db.Oscillator(**_OSCILLATOR), db.BaseMotion(0.004, _OMEGA), [1e-5], [1e5]
    )
    db.measured_orbit(several, rate_hz=1000.0, cycles=2.0)
    osc = db.Oscillator(**_OSCILLATOR | {"c": 1.0, "F_k": 0.5})
    decay = db.measured_ring_down(osc, x=0.01, rate_hz=500.0, duration=2.0, noise=0.01)
    db.identify(decay, osc.k, laws=True)
    play(np.zeros(3), np.zeros(2), 1.0, math.inf, np.ones(3))


PARTS = {"steady": steady, "harmonics": harmonics, "rest": rest}


def main(names: list[str]) -> None:
    """Compile the parts named; without a name all of them, the last one in the background."""
    if names:
        for name in names:
            PARTS[name]()
        return
    began = time.monotonic()
    print("Compiling the kernels, once per installation …", file=sys.stderr, flush=True)
    command = (sys.executable, "-m", "dampbalance.commands.kernels")
    running = [_started(*command, name) for name in ("steady", "harmonics")]
    if sum(process.wait() != 0 for process in running):
        print("They cannot be compiled now, and are when they are first called.", file=sys.stderr)
        return
    print(f"Compiled after {time.monotonic() - began:.0f} s.", file=sys.stderr)
    _started("nice", "-n", "19", *command, "rest")


def _started(*command: str) -> subprocess.Popen[bytes]:
    """Return a silent process that outlives this one."""
    return subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, process_group=0
    )


if __name__ == "__main__":
    main(sys.argv[1:])
