"""The table of config/records/stepped: steady responses of an oscillator whose contact yields gradually, five levels.

They are simulated, with 0.3 % of noise, so that what should come out is known: of the eight sliders seven slip at these
amplitudes, K_z = 35,000 N/m and F_k = 4.62 N, with c = 6 N s/m and m = 2 kg.
"""

from pathlib import Path

import numpy as np

from dampbalance.law.contact import Sliders
from dampbalance.records.synthetic import stepped_sine

table = stepped_sine(
    {"m": 2.0, "c": 6.0, "k": 180_000.0},
    Sliders(r=np.geomspace(2e-5, 4e-4, 8), kappa=np.arange(2e3, 10e3, 1e3)),
    amplitudes=[2e-5, 5e-5, 1e-4, 2e-4, 4e-4],
    frequencies_hz=np.linspace(46.0, 56.0, 15),
    noise=0.003,
    seed=2010,
)
rows = (",".join(f"{value:.6g}" for value in row) for row in zip(*table.values(), strict=True))
Path("levels.csv").write_text("\n".join([",".join(table), *rows]) + "\n", encoding="utf-8")
