"""Identification of measured levels, five of 20,000 samples.

Reading and identifying are timed together and apart, and so is the fit of one oscillator to the harmonics of all
levels, which identifying contains; the errors of the estimates are listed with the times. Start-up, import and first
call, is timed in separate processes, and the import split by package. Writes identification.{csv,md,svg,png},
identification_{repetitions,errors}.csv, start_up.csv and imports.csv.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd

from dampbalance import BaseMotion, steady_orbit
from dampbalance.arrays import Array
from dampbalance.figures.style import FAINT, SLIP, STICK, page, place, save, styled
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
PARTS_SHOWN = 8  # packages in the split of the import

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
_IMPORTED = re.compile(r"import time:\s*(\d+) \|\s*\d+ \|\s*(\S+)")


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


def _signals(measurement: Record) -> list[Array]:
    """Return t, y and x."""
    y, x = measurement["base_displacement"], measurement["displacement"]
    return [y.t, y.values, x.values]


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


def errors(samples: int) -> pd.DataFrame:
    """Return columns name, then of F_k and of c the relative error and the standard error that each way
    reports."""
    given = measurements(samples)
    found = identify_readings([read_features(m, PAPER.k) for m in given], PAPER.k)
    fit, truth = found.basis.common.fit, {"F_k": PAPER.F_k, "c": PAPER.c}
    assert fit is not None
    answers = {
        name: {s: (e.coefficients[s].value, e.coefficients[s].standard_error) for s in truth}
        for name, e in found.estimates.items()
    }
    answers[FIT] = {s: (getattr(fit, s), fit.error(s)) for s in truth}
    rows = [
        {"name": name}
        | {f"{s}_error": answer[s][0] / true - 1.0 for s, true in truth.items()}
        | {f"{s}_standard_error": answer[s][1] / true for s, true in truth.items()}
        for name, answer in answers.items()
    ]
    columns = ["name", "F_k_error", "F_k_standard_error", "c_error", "c_standard_error"]
    return pd.DataFrame(rows, columns=columns)


def start_up(samples: int, repetitions: int) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return columns quantity, wall_s, best_wall_s, cpu_s (median, least, median) of import and first call, the kernels
    being compiled already; and of the import, columns package, seconds, by `python -X importtime`."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "levels.npy"
        np.save(file, [_signals(measurement) for measurement in measurements(samples)])
        arguments = [str(file), str(PAPER.k)]
        # the first process also reads the files into memory and compiles what is not compiled
        told = _process(_FIRST_CALL, arguments, "-X", "importtime").stderr
        runs = [_process(_FIRST_CALL, arguments).stdout.split() for _ in range(repetitions)]
    wall, cpu = np.moveaxis(np.array(runs, dtype=float).reshape(-1, 2, 2), 2, 0)
    wall, cpu = (np.column_stack([part, part.sum(axis=1)]) for part in (wall, cpu))
    times = {"wall_s": np.median(wall, axis=0), "best_wall_s": wall.min(axis=0)}
    times["cpu_s"] = np.median(cpu, axis=0)
    return pd.DataFrame({"quantity": ["import", "first call", "both"]} | times), imports(told)


def imports(told: str) -> pd.DataFrame:
    """Return columns package, seconds: the times of `-X importtime`, summed over the modules of each package."""
    seconds: dict[str, float] = {}
    for own, module in _IMPORTED.findall(told):
        package = module.split(".")[0]
        seconds[package] = seconds.get(package, 0.0) + 1e-6 * int(own)
    table = pd.DataFrame({"package": list(seconds), "seconds": list(seconds.values())})
    return table.sort_values("seconds", ascending=False, ignore_index=True)


def _process(script: str, arguments: list[str], *options: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *options, "-c", script, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True)


def text(
    summary: pd.DataFrame,
    wrong: pd.DataFrame,
    starting: pd.DataFrame,
    loading: pd.DataFrame,
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
    rows = [[name, *(f"{100.0 * e:.2g}" for e in off)] for name, *off in wrong.to_numpy()]
    header = ["what was found, %", "error of F_k", "its standard error", "error of c"]
    written += markdown([*header, "its standard error"], rows) + "\n"
    rows = [[step, *map(quantity, seconds)] for step, *seconds in starting.to_numpy()]
    written += markdown(["start-up of a process, kernels compiled before", *times], rows)
    shown = loading.head(PARTS_SHOWN)
    listed = ", ".join(f"{r.package} {quantity(r.seconds)}" for r in shown.itertuples(index=False))
    total = quantity(loading["seconds"].sum())
    return f"{written}\nOf one import, {total} (`python -X importtime`): {listed}.\n\nMachine: {machine()}.\n"


@styled()
def figure(summary: pd.DataFrame, starting: pd.DataFrame, svg: Path, png: Path) -> None:
    """Draw one bar for each time, processor time filled, wall time as a line; the time asked for dashed."""
    drawn = page(150.0, 14.0 + 6.0 * (len(summary) + 2))
    axes = place(drawn, 58.0, 11.0, 88.0, 6.0 * (len(summary) + 2))
    steps = starting.head(2)
    names = [*summary["name"], *("start-up: " + steps["quantity"])]
    wall = [*summary["wall_s_per_case"], *steps["wall_s"]]
    cpu = [*summary["cpu_s_per_case"], *steps["cpu_s"]]
    axes.barh(names, cpu, color=SLIP, height=0.6, label="processor time")
    axes.plot(wall, names, "|", color=STICK, markersize=10.0, label="wall time")
    axes.axvline(1.0, color=FAINT, linewidth=0.6, linestyle="--")
    axes.invert_yaxis()
    axes.set_xlim(0.0, None)
    axes.set_xlabel("time (s)")
    axes.legend()
    save(drawn, svg, png, "Time of identifying five levels of measured samples, and of start-up")


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
    wrong = errors(samples)
    starting, loading = start_up(samples, min(repetitions, 5))
    write_csv(out / "identification.csv", summary)
    write_csv(out / "identification_repetitions.csv", timings)
    write_csv(out / "identification_errors.csv", wrong)
    write_csv(out / "start_up.csv", starting)
    write_csv(out / "imports.csv", loading)
    written = text(summary, wrong, starting, loading, samples, repetitions)
    write_text(out / "identification.md", written)
    figure(summary, starting, out / "identification.svg", out / "identification.png")
