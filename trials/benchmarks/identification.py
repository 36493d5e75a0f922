"""Identification of measured levels, five of 20,000 samples.

Reading and identifying are timed together and apart, and so is the fit of one oscillator to the harmonics of all
levels, which identifying contains. Start-up, import and first call, is timed in separate processes. Writes
identification.{csv,md}, identification_repetitions.csv and start_up.csv.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd

from dampbalance import BaseMotion, steady_orbit
from dampbalance.fit.steady_search import fit_records
from dampbalance.identification.forced import identify_readings
from dampbalance.project.files import write_csv, write_text
from dampbalance.records.record import Record
from dampbalance.records.synthetic import measured_orbit
from dampbalance.signals.mean_harmonics import read_features
from paper_case import LEVELS, OMEGA

from .cases import PAPER
from .measuring import (
    Contestant,
    interleaved,
    machine,
    markdown,
    medians,
    quantity,
    ratios,
    rounded,
)

CYCLES = 100.0
NOISE = 0.01  # of the rms of each channel
SEED = 2010
BOTH = "read and identify"
READING = "… reading the features"
IDENTIFYING = "… identifying, balance and fit"
FIT = "… fitting one oscillator: maximum likelihood"

_FIRST_CALL = """
import sys, time
clocks = lambda: (time.perf_counter(), time.process_time())
start = clocks()
from dampbalance.identification.forced import identify_readings
from dampbalance.records.record import Record
from dampbalance.records.channel import Channel
from dampbalance.signals.mean_harmonics import read_features
from dampbalance.fit.steady_search import fit_records
loaded = clocks()
import numpy as np
readings = []
for level in np.load(sys.argv[1]):
    t, y, x = level
    channels = [Channel("base_displacement", t, y), Channel("displacement", t, x)]
    readings.append(read_features(Record.of("level", channels), float(sys.argv[2])))
identify_readings(readings, float(sys.argv[2]))
end = clocks()
print(*(b - a for a, b in zip(start, loaded)), *(b - a for a, b in zip(loaded, end)))
"""


def measurements(samples: int) -> list[Record]:
    """Return one simulated measurement of `samples` samples for each level: displacements of base and mass."""
    return [
        measured_orbit(
            steady_orbit(PAPER, BaseMotion(Y, OMEGA)),
            rate_hz=samples * OMEGA / (2.0 * np.pi * CYCLES),
            cycles=CYCLES,
            noise=NOISE,
            seed=SEED + level,
        )
        for level, Y in enumerate(LEVELS)
    ]


def contestants(samples: int) -> list[Contestant]:
    """Return what is timed; a case is the whole set of five levels."""
    given = measurements(samples)
    k = PAPER.k
    readings = [read_features(measurement, k) for measurement in given]
    lines = [reading.lines for reading in readings]
    return [
        Contestant(BOTH, 1, lambda: identify_readings([read_features(m, k) for m in given], k)),
        Contestant(READING, 1, lambda: [read_features(m, k) for m in given]),
        Contestant(IDENTIFYING, 1, lambda: identify_readings(readings, k)),
        Contestant(FIT, 1, lambda: fit_records(lines, k)),
    ]


def start_up(samples: int, repetitions: int) -> pd.DataFrame:
    """Return columns quantity, wall_s, best_wall_s, cpu_s (median, least, median) of import and first call, the kernels
    being compiled already."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "levels.npy"
        channels = [[*record.channels.values()] for record in measurements(samples)]
        np.save(file, [[y.t, y.values, x.values] for y, x in channels])
        arguments = [str(file), str(PAPER.k)]
        # the first process also reads the files into memory and compiles what is not compiled
        _process(_FIRST_CALL, arguments)
        runs = [_process(_FIRST_CALL, arguments).stdout.split() for _ in range(repetitions)]
    wall, cpu = np.moveaxis(np.array(runs, dtype=float).reshape(-1, 2, 2), 2, 0)
    wall, cpu = (np.column_stack([part, part.sum(axis=1)]) for part in (wall, cpu))
    times = {"wall_s": np.median(wall, axis=0), "best_wall_s": wall.min(axis=0)}
    times["cpu_s"] = np.median(cpu, axis=0)
    return pd.DataFrame({"quantity": ["import", "first call", "both"]} | times)


def _process(script: str, arguments: list[str]) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", script, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True)


def text(
    summary: pd.DataFrame,
    starting: pd.DataFrame,
    samples: int,
    repetitions: int,
) -> str:
    rows: list[list[object]] = [
        [
            row.name,
            *(quantity(s) for s in (row.wall_s_per_case, row.best_wall_s, row.cpu_s_per_case)),
            f"{rounded(row.cpu_ratio_median)} ({rounded(row.cpu_ratio_low)} – {rounded(row.cpu_ratio_high)})",
        ]
        for row in summary.itertuples(index=False)
    ]
    levels = f"five levels, {samples * len(LEVELS):,} samples"
    times = ["wall time", "best", "processor time"]
    written = markdown([levels, *times, "ratio of processor times"], rows)
    written += (
        f"\nMedians of {repetitions} interleaved repetitions, after start-up; ratio: to the first line in the same "
        "repetition, with its range.\n\n"
    )
    rows = [[step, *map(quantity, seconds)] for step, *seconds in starting.to_numpy()]
    written += markdown(["start-up of a process, kernels compiled before", *times], rows)
    return f"{written}\nMachine: {machine()}.\n"


def run(out: Path, samples: int = 20_000, repetitions: int = 9) -> None:
    """Measure, and write the results into the folder `out`.

    samples : of each of the five levels.
    """
    taking_part = contestants(samples)
    interleaved(taking_part, 1)  # kernels loaded, caches filled
    timings = interleaved(taking_part, repetitions)
    summary = medians(timings)
    best = timings.groupby("name")["wall_s_per_case"].min().rename("best_wall_s")
    relative = ratios(timings, BOTH, "cpu_s_per_case").set_index("name").add_prefix("cpu_ratio_")
    summary = summary.join(best, on="name").join(relative, on="name")
    starting = start_up(samples, min(repetitions, 5))
    write_csv(out / "identification.csv", summary)
    write_csv(out / "identification_repetitions.csv", timings)
    write_csv(out / "start_up.csv", starting)
    written = text(summary, starting, samples, repetitions)
    write_text(out / "identification.md", written)
