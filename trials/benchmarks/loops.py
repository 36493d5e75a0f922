"""Identification of measured loops against the number of samples and cycles, up to a wear test of 10,000 cycles.

Reading and identifying are timed together, after start-up; what a contact is fitted to is bounded, and all else grows
with the samples. Writes loops.{csv,md}.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from dampbalance import identify_loops
from dampbalance.law.contact import play
from dampbalance.project.files import write_csv, write_text

from .measuring import machine, markdown, quantity

SIZES = ((20_000, 200), (40_000, 400), (80_000, 800), (1_000_000, 10_000))  # samples, cycles
AIM = 10.0  # s, of the largest
F_K, K_Z, C, X = 10.0, 5e4, 3.0, 1e-3
NOISE = 0.01  # of F_k
SEED = 2010


def record(samples: int, cycles: int) -> dict[str, np.ndarray]:
    """Return the loops of one slider and a damper under a sine of 1 Hz."""
    t = np.linspace(0.0, cycles, samples)
    x = X * np.sin(2.0 * math.pi * t)
    z = play(x, F_K / K_Z)[0]
    noise = NOISE * F_K * np.random.default_rng(SEED).normal(size=t.size)
    force = K_Z * z + C * np.gradient(x, t) + noise
    return {"time_s": t, "displacement_m": x, "force_N": force}


def run(out: Path, sizes: Sequence[tuple[int, int]] = SIZES) -> None:
    """Measure, and write the results into the folder `out`.   sizes : samples and cycles of each record."""
    identify_loops(record(5_000, 50))  # kernels loaded, caches filled
    rows = []
    for samples, cycles in sizes:
        given = record(samples, cycles)
        wall, cpu = time.perf_counter(), time.process_time()
        found = identify_loops(given)
        row = {"samples": samples, "cycles": cycles, "wall_s": time.perf_counter() - wall}
        row |= {"cpu_s": time.process_time() - cpu, "F_k_error": found.values["F_k"] / F_K - 1.0}
        rows.append(row)
    table = pd.DataFrame(rows)
    write_csv(out / "loops.csv", table)
    lines = [
        [
            f"{r.samples:,}",
            f"{r.cycles:,}",
            *map(quantity, (r.wall_s, r.cpu_s)),
            f"{100.0 * r.F_k_error:.2g}",
        ]
        for r in table.itertuples(index=False)
    ]
    head = ["samples", "cycles", "wall time", "processor time", "error of F_k, %"]
    written = (
        f"{markdown(head, lines)}\nAimed at: {AIM:g} s for the largest. Machine: {machine()}.\n"
    )
    write_text(out / "loops.md", written)
