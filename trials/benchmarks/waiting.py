"""What a user waits for: help, the first call after installation, a rebuild, one after a change, and large studies.

Everything runs in a temporary copy of the project, on all cores; each line is the median of some repetitions.
"""

from __future__ import annotations

import contextlib
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pandas as pd
import psutil

from dampbalance.project.files import write_csv, write_text

from .measuring import machine, markdown, quantity
from .pipeline import copy_project

FIRST_CALL = """
from dampbalance import BaseMotion, Oscillator, steady_orbit, steady_orbits
from dampbalance.estimates import estimate_table
from dampbalance.features import of_orbit, stack
osc = Oscillator(m=2.42, c=90.0, k=2310.0, K_z=208000.0, F_k=1.28)
orbits = [steady_orbit(osc, BaseMotion(Y=Y, omega=30.0)) for Y in (0.004, 0.008)]
orbits[0].state([0.0, 0.1])
estimate_table(stack([of_orbit(orbit) for orbit in orbits]), osc.k, [(0, 1)])
steady_orbits(m=2.42, c=90.0, k=2310.0, K_z=208000.0, F_k=1.28, Y=0.004, omega=30.0)
"""
CONFIG, MAP = "config/config.yaml", "config/studies/map.yaml"


class Wait(NamedTuple):
    """Wall-clock and processor time, s, and peak memory of all processes together, bytes."""

    wall_s: float
    cpu_s: float
    memory_bytes: float


def waited(command: list[str], folder: Path) -> Wait:
    """Run a command in a copy of the project and wait for it. Pages that processes share are counted in each."""
    environment = os.environ | {"PYTHONPATH": str(folder / "src")}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    start = time.perf_counter()
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    process = subprocess.Popen(command, cwd=folder, env=environment, **quiet)
    peak = 0.0
    watching = threading.Event()

    def watch() -> None:
        nonlocal peak
        while not watching.wait(0.2):
            peak = max(peak, _memory(process.pid))

    watcher = threading.Thread(target=watch)
    watcher.start()
    process.wait()
    wall = time.perf_counter() - start
    watching.set()
    watcher.join()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Wait(wall, cpu, peak)


def _memory(pid: int) -> float:
    """Resident memory of a process and of all that it started, bytes."""
    total = 0.0
    with contextlib.suppress(psutil.NoSuchProcess):  # one that has just ended
        process = psutil.Process(pid)
        for each in (process, *process.children(recursive=True)):
            total += each.memory_info().rss
    return total


def snakemake(folder: Path, target: str) -> Wait:
    """Build a target on all cores; the file `target`, or the page for `all`, must be there then."""
    command = [sys.executable, "-m", "snakemake", "--cores", "all", "--quiet", "all", "--", target]
    wait = waited(command, folder)
    if not (folder / ("results/paper/report.html" if target == "all" else target)).exists():
        raise RuntimeError(f"{target} was not built in {folder}")
    return wait


def helped(folder: Path) -> Wait:
    return waited([sys.executable, "-m", "dampbalance", "--help"], folder)


def first_called(folder: Path) -> Wait:
    """All common kernels compiled."""
    for kernels in folder.glob("src/**/kernels-*"):
        shutil.rmtree(kernels)
    return waited([sys.executable, "-c", FIRST_CALL], folder)


def rebuilt(folder: Path) -> Wait:
    for made in (folder / "results/paper", folder / "results/studies", folder / ".snakemake"):
        shutil.rmtree(made, ignore_errors=True)
    return snakemake(folder, "all")


def changed(folder: Path) -> Wait:
    """A rebuild after F_k was raised by a hundredth; the verdicts on print are worse then, and said to be."""
    path = folder / CONFIG
    text = path.read_text(encoding="utf-8")
    (friction,) = re.findall(r"F_k_N: ([0-9.]+)", text)
    new = text.replace(f"F_k_N: {friction}", f"F_k_N: {1.01 * float(friction):.6f}")
    path.write_text(new, encoding="utf-8")
    return snakemake(folder, "all")


def studied(folder: Path, cases: int) -> Wait:
    """The map of `config/studies/map.yaml`, from nothing to its summary."""
    path = folder / MAP
    text = path.read_text(encoding="utf-8")
    path.write_text(re.sub(r"count: \d+.*", f"count: {cases}", text), encoding="utf-8")
    shutil.rmtree(folder / "results/studies/map", ignore_errors=True)
    return snakemake(folder, "results/studies/map/summary.md")


def measure(folder: Path, repetitions: int, sizes: tuple[int, ...]) -> pd.DataFrame:
    """Columns what, wall_s, low, high, cpu_s, memory_bytes: medians, and the range of the wall-clock times."""
    tasks: dict[str, Callable[[], Wait]] = {
        "dampbalance --help": lambda: helped(folder),
        "whole rebuild": lambda: rebuilt(folder),
        "rebuild after F_k was changed": lambda: changed(folder),
        **{f"study of {n:,} cases": lambda n=n: studied(folder, n) for n in sizes},
        "first call after installation (compiles)": lambda: first_called(folder),
    }
    first_called(folder)
    if repetitions > 1:
        rebuilt(folder)  # what is compiled once is compiled
    rows = []
    for what, task in tasks.items():
        waits = pd.DataFrame([task() for _ in range(repetitions)])
        wall_s, cpu_s, memory = waits.median()
        rows.append((what, wall_s, waits["wall_s"].min(), waits["wall_s"].max(), cpu_s, memory))
    return pd.DataFrame(rows, columns=["what", "wall_s", "low", "high", "cpu_s", "memory_bytes"])


def text(table: pd.DataFrame, repetitions: int) -> str:
    header = ["", "wall time", "best", "worst", "processor time", "peak memory"]
    rows = [
        [
            row.what,
            *(quantity(seconds) for seconds in (row.wall_s, row.low, row.high, row.cpu_s)),
            f"{row.memory_bytes / 1e9:.2f} GB",
        ]
        for row in table.itertuples(index=False)
    ]
    note = f"Medians of {repetitions}, on all cores; memory is the sum over all processes at its highest."
    return f"{markdown(header, rows)}\n{note}\n\nMachine: {machine()}.\n"


def run(out: Path, repetitions: int = 3, sizes: tuple[int, ...] = (1_048_576, 10_485_760)) -> None:
    """Measure, and write the results into the folder `out`."""
    with tempfile.TemporaryDirectory() as name:
        copy_project(Path(name))
        table = measure(Path(name), repetitions, sizes)
    write_csv(out / "waiting.csv", table)
    write_text(out / "waiting.md", text(table, repetitions))
