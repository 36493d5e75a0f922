"""Records with a whole number of samples to the cycle, or nearly: what lies beyond half the sampling rate folds onto
the same phases in every cycle, unless a filter of the recorder takes it off. Whether one does is not told."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pandas as pd

from dampbalance import identify_forced
from dampbalance.project.wording import markdown_table

from .records import Level, record
from .truths import Truth, log_uniform

FREQUENCIES = (4.0, 5.0, 5.013, 9.0)
"""Hz, at 2 kHz: 500, 400, 398.96 and 222.2 samples to the cycle."""

SYMBOLS = ("F_k", "c", "K_z")
_DENSE = 1 << 15  # phases of a cycle that is filtered


@dataclass(frozen=True, eq=False)
class Filtered(Level):
    """A level behind a filter that takes off all above half the sampling rate, and nothing below."""

    def signal(self, quantity: str, phase: np.ndarray) -> np.ndarray:
        """Return a channel without noise at phases ωt, SI."""
        dense = np.arange(_DENSE) * (2.0 * math.pi / _DENSE)
        series = np.fft.rfft(super().signal(quantity, dense)) / _DENSE
        highest = math.ceil(math.pi * self.truth.rate_hz / self.truth.omega)
        values = np.zeros(phase.size)
        for n in range(1, highest):
            values += 2.0 * (series[n] * np.exp(1j * n * phase)).real
        return values


def draw(hertz: float, index: int, seed: int) -> tuple[Truth, bool]:
    """Return a set at a drive frequency, and whether its recorder filters."""
    random = np.random.default_rng((seed, index))
    spread = log_uniform(random)
    omega, m = 2.0 * math.pi * hertz, spread(0.3, 10.0)
    omega_n = omega / spread(0.5, 2.0)
    k = m * omega_n**2
    Y = spread(1e-3, 1e-2) * np.geomspace(1.0 / random.uniform(2.5, 6.0), 1.0, 4)
    truth = Truth(
        index=index,
        kind="model",
        m=m,
        c=2.0 * spread(0.01, 0.2) * m * omega_n,
        k=k,
        K_z=spread(5.0, 200.0) * k,
        F_k=spread(0.02, 0.3) * k * float(Y[1]),
        Y=tuple(Y.tolist()),
        omega=omega,
        cycles=tuple(random.uniform(20.0, 60.0, 4).tolist()),
        start=tuple(random.uniform(0.0, 1.0, 4).tolist()),
        rate_hz=2000.0,
        drive=str(random.choice(["base_displacement", "base_acceleration"])),
        answers=(str(random.choice(["displacement", "acceleration"])),),
        noise=float(random.choice([0.0005, 0.001, 0.002])),
        equal=False,
    )
    return truth, bool(random.random() < 0.5)


def outcome(run: tuple[float, int, int]) -> list[dict[str, object]]:
    """Return what comes out of a set, one row for each number.   run : frequency, index and seed."""
    truth, filtered = draw(*run)
    kind = Filtered if filtered else Level
    result = identify_forced([record(kind(truth, i), run[2]) for i in range(4)], stiffness=truth.k)
    of_set = {
        "hertz": run[0],
        "records": f"{truth.answers[0]}, {'filtered' if filtered else 'as it is'}",
        "causes": ", ".join(result.basis.common.clear),
    }
    rows: list[dict[str, object]] = []
    for symbol in SYMBOLS:
        low, high = result.intervals[symbol]
        true = truth.parameter(symbol)
        rows.append(
            {
                **of_set,
                "symbol": symbol,
                "usable": result.verdicts[symbol].verdict == "usable",
                "outside": not low <= true <= high,
                "width": 50.0 * (high - low) / true,
            }
        )
    return rows


def table(rows: pd.DataFrame) -> str:
    """Return how many numbers are usable and outside their interval, and how many sets have causes that are not there,
    in markdown."""
    rows["wrong"] = rows["outside"] & rows["usable"]
    lines = []
    for column in ("hertz", "records"):
        for key, group in rows.groupby(column):
            cells = [str(key), str(len(group) // len(SYMBOLS))]
            for _, one in group.groupby("symbol", sort=False):
                cells.append(f"{one['wrong'].sum()}, {one['width'].median():.2g}")
            first = group[group["symbol"] == SYMBOLS[0]]
            lines.append([*cells, str((first["causes"] != "").sum())])
    heads = ["", "sets", *(f"{s}: usable and outside, ± %" for s in SYMBOLS), "causes"]
    return markdown_table(heads, lines)
