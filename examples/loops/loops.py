"""Identify two contacts from measured loops, next to readings by hand, and predict a response with one of them.

Run it as `python loops.py DATA RESULTS`, two folders.

By hand, F_k is half the distance between the plateaus of the force (the medians of the last third of each half cycle),
K_z the slope of the force after a reversal, between half of either plateau, and the loss the area of the loop.
"""

from __future__ import annotations

import itertools
import json
import math
import sys
from pathlib import Path
from typing import Any

import jinja2
import matplotlib.pyplot as plt
import numpy as np

from dampbalance import Oscillator, Result, identify, steady_orbits

DAMPER = "damper_0_5in.csv", "damper_1in.csv", "damper_1_5in.csv"
RATE = 200.0  # Hz, of the tribometer: its column of times has gaps
SMALL = 0.05  # of the range of x: a return by more is a reversal

MASS, STIFFNESS, DAMPING = (
    0.5,
    4000.0,
    2.0,
)  # kg, N/m, N s/m: of an oscillator that the tribometer's contact shall damp
FORCED = 0.0002, 0.001, 0.004  # m, amplitudes of its base


def tribometer(folder: Path) -> dict[str, np.ndarray]:
    """Return the samples of the tribometer in SI; the force has the sign of the file."""
    _, N, x, f = np.loadtxt(folder / "tribometer.txt", skiprows=1, unpack=True)
    moved = {"time_s": np.arange(x.size) / RATE, "displacement_m": 1e-3 * x}
    return {**moved, "force_N": 1e-6 * f, "normal_force_N": 1e-6 * N}


def by_hand(x: np.ndarray, f: np.ndarray) -> dict[str, float]:
    """Return F_k (N), K_z (N/m) and the loss of a cycle (J) as they are read off a drawing.

    x : m, f : N, (n,), of several cycles; f has the sign of the motion.
    """
    turns, at, way = [0], 0, 0
    for i in range(1, x.size):
        if way * (x[i] - x[at]) >= 0.0 and way:
            at = i
        elif abs(x[i] - x[at]) > SMALL * np.ptp(x):
            turns += [at] if way else []
            at, way = i, 1 if x[i] > x[at] else -1
    plateaus, slopes, losses = [], [], []
    for start, end in itertools.pairwise(turns[1:]):
        half, force = x[start:end], f[start:end]
        last = np.abs(half - half[-1]) < abs(half[-1] - half[0]) / 3.0
        plateaus.append(np.median(force[last]))
        losses.append(2.0 * np.trapezoid(force, half))
    F_k = 0.5 * float(np.median(np.abs(np.subtract(plateaus[1:], plateaus[:-1]))))
    for start, end in itertools.pairwise(turns[1:]):
        half, force = x[start:end], f[start:end]
        first = int(np.argmax(np.abs(force - force[-1]) < 0.5 * F_k)) or force.size
        steep = np.abs(force[:first]) < 0.5 * F_k
        if steep.sum() > 1:
            slopes.append(np.polyfit(half[:first][steep], force[:first][steep], 1)[0])
    return {"F_k": F_k, "K_z": float(np.median(slopes)), "loss": float(np.median(losses))}


def numbers_of(found: Result[Any]) -> dict[str, Any]:
    """Return values, intervals and verdicts of an identification, and the sentences of its screen."""
    document = found.document()
    return {
        "numbers": {
            symbol: {
                "value": value,
                "interval": found.intervals[symbol],
                "verdict": verdict.verdict,
            }
            for (symbol, value), verdict in zip(
                found.values.items(), found.verdicts.values(), strict=True
            )
        },
        "friction_coefficient": document["friction_coefficient"],
        "screen": found.screen(100),
    }


def draw(found: Result[Any], file: Path) -> None:
    """Draw the response of an oscillator with the measured contact over the frequency, and with the contact loose; the
    bands hold what the intervals of F_k and K_z allow."""
    figure, axes = plt.subplots(figsize=(5.0, 3.5), layout="constrained")
    hertz = np.linspace(8.0, 60.0, 800)
    # the value, then both ends of both intervals
    F_k = np.array([found.values["F_k"], *np.repeat(found.intervals["F_k"], 2)])
    K_z = np.array([found.values["K_z"], *np.tile(found.intervals["K_z"], 2)])
    osc = Oscillator(m=MASS, c=DAMPING, k=STIFFNESS, K_z=K_z[0], F_k=F_k[0])
    for Y in FORCED:
        orbits = steady_orbits(
            osc, F_k=F_k[:, None], K_z=K_z[:, None], Y=Y, omega=2.0 * math.pi * hertz
        )
        ratio = orbits.X / Y
        (line,) = axes.plot(hertz, ratio[0], label=f"{1e3 * Y:g} mm")
        low, high = ratio.min(axis=0), ratio.max(axis=0)
        axes.fill_between(hertz, low, high, color=line.get_color(), alpha=0.25, lw=0.0)
    loose = Oscillator(m=MASS, c=DAMPING, k=STIFFNESS, K_z=1.0, F_k=0.0)
    free = steady_orbits(loose, Y=FORCED[0], omega=2.0 * math.pi * hertz)
    axes.plot(hertz, free.X / FORCED[0], "k:", label="no contact")
    axes.set(xlabel="$f$ (Hz)", ylabel="$X/Y$", yscale="log")
    axes.legend(title="base amplitude")
    figure.savefig(file, metadata={"Date": None})
    plt.close(figure)


def main(data: Path, results: Path) -> None:
    """Write page, numbers and pictures."""
    samples = tribometer(data)
    wear = identify(samples, kind="loops")
    damper = identify([data / name for name in DAMPER], kind="loops")
    moves = np.abs(np.gradient(samples["displacement_m"], samples["time_s"])) > 0.0
    first, last = np.flatnonzero(moves)[[0, -1]]
    hand = by_hand(samples["displacement_m"][first:last], -samples["force_N"][first:last])
    numbers = {
        "tribometer": numbers_of(wear) | {"by_hand": hand},
        "damper": numbers_of(damper),
        "oscillator": {"m_kg": MASS, "k_N_per_m": STIFFNESS, "c_N_s_per_m": DAMPING},
    }
    for name, found in (("tribometer", wear), ("damper", damper)):
        found.save(results / name, overwrite=True)
    draw(wear, results / "response.svg")
    (results / "loops.json").write_text(json.dumps(numbers, indent=1) + "\n", encoding="utf-8")
    template = Path(__file__).with_name("loops.md.j2").read_text(encoding="utf-8")
    environment = jinja2.Environment(
        trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True
    )
    page = environment.from_string(template).render(**numbers)
    (results / "loops.md").write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
