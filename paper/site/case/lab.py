"""The records of the worked case as a laboratory's logger writes them: semicolons, decimal commas, channels by number.

They are simulated, with 1 % of noise, so that what should come out is known: F_k = 2.1 N, c = 24 N s/m, K_z = 160 N/mm.
"""

import math
from pathlib import Path

import numpy as np

from dampbalance import BaseMotion, Oscillator, measured_orbit, steady_orbit

G = 9.80665  # m/s²
MOUNT = Oscillator(m=3.6, c=24.0, k=5200.0, K_z=160000.0, F_k=2.1)
OMEGA = 2.0 * math.pi * 5.0
FORCE = MOUNT.m * OMEGA**2 / MOUNT.k  # a mount moves against the table as under the force -m y'', which is that of m ω² y

rng = np.random.default_rng(7)
for run, amplitude in enumerate((0.002, 0.003, 0.0045, 0.0065), start=1):
    record = measured_orbit(
        steady_orbit(MOUNT, BaseMotion(Y=FORCE * amplitude, omega=OMEGA)),
        rate_hz=2000.0,
        cycles=20.0,
        channels=("base_displacement", "acceleration"),
    )
    t, y = record["base_displacement"].t, record["base_displacement"].values / FORCE
    acceleration = record["acceleration"].values - OMEGA**2 * y  # of the mass, against the ground
    columns = [(1e3 * y), acceleration / G]
    y_mm, a_g = (of + 0.01 * np.std(of) * rng.standard_normal(of.size) for of in columns)
    lines = ["Mount 7, shaker table, 5 Hz", "Time [s];CH1 [mm];CH2 [g];CH3 [°C]"]
    rows = zip(t, y_mm, a_g, strict=True)
    lines += [f"{t:.4f};{y:.4f};{a:.5f};21.4".replace(".", ",") for t, y, a in rows]
    Path(f"run{run}.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
