"""Cost of `steady_orbits` against the number of cases and of threads, its memory, and the start-up of a process.

Writes scaling.{csv,md,svg,png}, memory.csv and process.csv.
"""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pandas as pd

from dampbalance import Regime, steady_orbits
from dampbalance.figures.style import FAINT, SLIP, STICK, page, place, save, styled
from dampbalance.project.files import write_csv, write_text

from .cases import PAPER, Sweep, sweep
from .measuring import Contestant, cores, interleaved, machine, markdown, quantity

_BYTES_OUT = 14 * 8 + 1  # of a case: fourteen features and the regime
_START_UP = """
import time
start = time.perf_counter()
from dampbalance import steady_orbits
loaded = time.perf_counter()
steady_orbits(m=2.42, c=90.0, k=2310.0, K_z=208000.0, F_k=1.28, Y=0.004, omega=30.0)
print(loaded - start, time.perf_counter() - loaded)
"""
_PEAK = """
import re, sys
from pathlib import Path
import numpy as np
from dampbalance import steady_orbits
def peak(n):
    omega = np.linspace(18.8, 75.4, n)
    steady_orbits(m=2.42, c=90.0, k=2310.0, K_z=208000.0, F_k=1.28, Y=0.008, omega=omega)
    return re.search(r"VmHWM:\\s*(\\d+)", Path("/proc/self/status").read_text())[1]
print(peak(1000), peak(int(sys.argv[1])))
"""


def solve(cases: Sweep, threads: int) -> None:
    steady_orbits(**cases.arguments(), threads=threads)


def measure(largest: int, repetitions: int) -> pd.DataFrame:
    """Columns cases, threads, wall_s_per_case (median), low, high (over the repetitions), cpu_s_per_case (median)."""
    threads = list(range(1, cores() + 1))
    rows = []
    everything = sweep(largest)
    for n in [10**e for e in range(2, len(str(largest)))]:
        cases = everything.take(n)
        contestants = [
            Contestant(str(count), n, lambda count=count, cases=cases: solve(cases, count))
            for count in threads
        ]
        if n < 10**6:
            interleaved(contestants, 1)  # caches filled
        # another process can only delay: short runs are repeated until some are undisturbed
        often = (
            10 * repetitions if n <= 10**5 else repetitions if n < 10**7 else min(repetitions, 2)
        )
        times = interleaved(contestants, often)
        for count in threads:
            own = times[times["name"] == str(count)]
            wall, cpu = own["wall_s_per_case"], own["cpu_s_per_case"]
            rows.append((n, count, wall.median(), wall.min(), wall.max(), cpu.median()))
    columns = ["cases", "threads", "wall_s_per_case", "low", "high", "cpu_s_per_case"]
    return pd.DataFrame(rows, columns=columns)


def peak_memory(largest: int) -> pd.DataFrame:
    """Columns cases, peak_bytes (of a separate process), bytes_per_case (the growth of the peak from 1000 cases);
    no rows where the system does not tell."""
    rows = []
    if Path("/proc/self/status").exists():
        for n in [10**e for e in range(4, len(str(largest)))]:
            before, after = (1024 * int(kilobytes) for kilobytes in _process(_PEAK, str(n)))
            rows.append((n, after, (after - before) / n))
    return pd.DataFrame(rows, columns=["cases", "peak_bytes", "bytes_per_case"])


def process_costs(repetitions: int) -> pd.DataFrame:
    """Columns quantity, seconds: medians of separate processes, with the kernels compiled already."""
    times = [[float(x) for x in _process(_START_UP)] for _ in range(repetitions)]
    loading, first = np.median(times, axis=0)
    rows = [("import", loading), ("first call", first)]
    rows.append(("case with several slips per half cycle, one thread", general_path(1000)))
    return pd.DataFrame(rows, columns=["quantity", "seconds"])


def _process(script: str, *arguments: str) -> list[str]:
    command = [sys.executable, "-c", script, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()


def general_path(n: int) -> float:
    """Processor time, s, per case where an orbit has several slip onsets per half cycle: near a third of the
    resonance."""
    omega = np.linspace(0.34, 0.36, n) * PAPER.omega_n
    c, F_k = 0.134 * np.sqrt(PAPER.m * PAPER.k), 0.1335 * PAPER.k * 0.004
    start = time.process_time()
    orbits = steady_orbits(
        m=PAPER.m, c=c, k=PAPER.k, K_z=24.0 * PAPER.k, F_k=F_k, Y=0.004, omega=omega, threads=1
    )
    seconds = time.process_time() - start
    if not np.all(orbits.regime == Regime.SEVERAL_SLIPS):
        raise AssertionError("not all of these orbits have several slips")
    return seconds / n


def table(times: pd.DataFrame, memory: pd.DataFrame, costs: pd.DataFrame) -> str:
    rows = [
        [
            f"{row.cases:,}",
            row.threads,
            *(quantity(s) for s in (row.wall_s_per_case, row.low, row.high, row.cpu_s_per_case)),
            f"{1e-6 / row.wall_s_per_case:.2f}",
        ]
        for row in times.itertuples(index=False)
    ]
    header = ["cases", "threads", "wall time per case", "best", "worst", "processor time per case"]
    text = markdown([*header, "million cases per second"], rows)
    rows = [
        [f"{row.cases:,}", f"{row.peak_bytes / 1e6:.0f} MB", f"{row.bytes_per_case:.0f}"]
        for row in memory.itertuples(index=False)
    ]
    text += "\n" + markdown(["cases", "peak memory of the process", "bytes per case"], rows)
    text += f"\nOf the bytes per case, {_BYTES_OUT} are the results; "
    text += "inputs that vary take 8 each.\n\n"
    rows = [[row.quantity, quantity(row.seconds)] for row in costs.itertuples(index=False)]
    text += markdown(["in a separate process, kernels compiled before", "time"], rows)
    return text + f"\nMachine: {machine()}.\n"


@styled()
def figure(times: pd.DataFrame, memory: pd.DataFrame, svg: Path, png: Path) -> None:
    """Time per case against the number of cases, one line for each number of threads; next to it peak memory."""
    drawn = page(180.0, 66.0)
    axes = place(drawn, 17.0, 12.0, 69.0, 50.0)
    for colour, (threads, group) in zip((SLIP, STICK) * 64, times.groupby("threads"), strict=False):
        label = f"{threads} thread" + ("s" if threads > 1 else "")
        axes.plot(group.cases, 1e6 * group.wall_s_per_case, "o-", color=colour, label=label)
        shade = {"color": colour, "alpha": 0.15, "linewidth": 0}
        axes.fill_between(group.cases, 1e6 * group.low, 1e6 * group.high, **shade)
    axes.axhline(1.0, color=FAINT, linewidth=0.6, linestyle="--")
    axes.set_ylabel("wall time per case (µs)")
    axes.legend()
    beside = place(drawn, 107.0, 12.0, 69.0, 50.0)
    peak, results = memory.peak_bytes / 1e6, memory.cases * _BYTES_OUT / 1e6
    beside.plot(memory.cases, peak, "o-", color=SLIP, label="peak of the process")
    beside.plot(memory.cases, results, "--", color=FAINT, label="the results alone")
    beside.set_ylabel("memory (MB)")
    beside.legend()
    for each in (axes, beside):
        each.set_xscale("log")
        each.set_yscale("log")
        each.set_xlabel("number of cases")
    alt = "Time per case and peak memory of steady_orbits against the number of cases"
    save(drawn, svg, png, alt)


def run(out: Path, largest: int = 10**7, repetitions: int = 5) -> None:
    """Measure, and write the results into the folder `out`."""
    times, memory = measure(largest, repetitions), peak_memory(largest)
    costs = process_costs(min(repetitions, 5))
    write_csv(out / "scaling.csv", times)
    write_csv(out / "memory.csv", memory)
    write_csv(out / "process.csv", costs)
    write_text(out / "scaling.md", table(times, memory, costs))
    figure(times, memory, out / "scaling.svg", out / "scaling.png")
