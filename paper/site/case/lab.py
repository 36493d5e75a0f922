"""The records of the worked case as a laboratory's logger writes them: semicolons, decimal commas, channels by number.

They are simulated, with 1 % of noise, so that what should come out is known: F_k = 2.1 N, c = 24 N s/m, K_z = 160 N/mm.
"""

import math
from pathlib import Path

from dampbalance import BaseMotion, Oscillator, measured_orbit, steady_orbit

G = 9.80665  # m/s²
MOUNT = Oscillator(m=3.6, c=24.0, k=5200.0, K_z=160000.0, F_k=2.1)

for run, amplitude in enumerate((0.002, 0.003, 0.0045, 0.0065), start=1):
    record = measured_orbit(
        steady_orbit(MOUNT, BaseMotion(Y=amplitude, omega=2 * math.pi * 5.0)),
        rate_hz=1000.0,
        cycles=20.0,
        noise=0.01,
        seed=run,
        channels=("base_displacement", "acceleration"),
    )
    base, mass = record["base_displacement"], record["acceleration"]
    rows = zip(base.t, 1e3 * base.values, mass.values / G, strict=True)
    lines = ["Mount 7, shaker table, 5 Hz", "Time [s];CH1 [mm];CH2 [g];CH3 [°C]"]
    lines += [f"{t:.3f};{y:.4f};{a:.5f};21.4".replace(".", ",") for t, y, a in rows]
    Path(f"run{run}.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
