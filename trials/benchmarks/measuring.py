"""Timing side by side: every repetition runs each contestant once, in the same order: all see the same machine."""

from __future__ import annotations

import os
import platform
import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import pandas as pd

from dampbalance.project.wording import markdown_table

PACKAGES = ("numpy", "numba", "scipy", "heyoka", "diffrax", "jax")
TIMES = ("wall_s_per_case", "cpu_s_per_case")


@dataclass(frozen=True)
class Contestant:
    """Something to time: `run()` does `cases` cases. What it compiles or loads has been done before."""

    name: str
    cases: int
    run: Callable[[], object]


def interleaved(contestants: list[Contestant], repetitions: int) -> pd.DataFrame:
    """Return columns repetition, name, cases, wall_s_per_case (what a user waits for) and cpu_s_per_case (of all
    threads; what the work costs, whoever else uses the machine)."""
    rows = []
    for repetition in range(repetitions):
        for contestant in contestants:
            wall, cpu = time.perf_counter(), time.process_time()
            contestant.run()
            wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
            cases = contestant.cases
            rows.append((repetition, contestant.name, cases, wall / cases, cpu / cases))
    return pd.DataFrame(rows, columns=["repetition", "name", "cases", *TIMES])


def medians(timings: pd.DataFrame) -> pd.DataFrame:
    """Return columns name, cases and the median of each time, in the order of the contestants."""
    names = timings["name"].unique()
    grouped = timings.groupby("name")
    table = grouped[list(TIMES)].median()
    table.insert(0, "cases", grouped["cases"].first())
    return table.loc[names].reset_index()


def ratios(timings: pd.DataFrame, reference: str, time_column: str) -> pd.DataFrame:
    """Return cost of each contestant in units of the reference's in the same repetition: columns name, low, median,
    high."""
    table = timings.pivot(index="repetition", columns="name", values=time_column)
    relative = table.div(table[reference], axis=0)
    spread = {"low": relative.min(), "median": relative.median(), "high": relative.max()}
    summary = pd.DataFrame(spread)
    return summary.loc[timings["name"].unique()].reset_index()


def cores() -> int:
    """Return those this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def load() -> str:
    """Return how many processes wanted a processor in the last minute."""
    return f"{os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else "unknown"


def machine() -> str:
    """Return processor, cores, operating system, load and versions, in one line."""
    model = platform.processor() or platform.machine()
    information = Path("/proc/cpuinfo")
    if information.exists():
        lines = information.read_text(encoding="utf-8").splitlines()
        named = {line.split(":")[0].strip(): line.split(":")[-1].strip() for line in lines if line}
        model = named.get("model name", model)
        if "cpu family" in named:
            model += f" (family {named['cpu family']}, model {named['model']})"
    versions = [f"Python {platform.python_version()}"]
    for package in PACKAGES:
        try:
            versions.append(f"{package} {version(package)}")
        except PackageNotFoundError:
            continue
    return (
        f"{model}, {cores()} cores, {platform.system()}, load at the end {load()} (this run included); "
        f"{', '.join(versions)}"
    )


def quantity(seconds: float) -> str:
    """Return a duration with three digits and a fitting unit."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


def rounded(ratio: float) -> str:
    """Return a ratio with three digits."""
    return f"{float(f'{ratio:.3g}'):,.0f}" if ratio >= 100.0 else f"{ratio:.3g}"


def markdown(header: list[str], rows: list[list[object]]) -> str:
    """Return a table; the first column is text, the others are numbers."""
    cells = [[str(cell) for cell in row] for row in rows]
    return markdown_table(header, cells, "l" + "r" * (len(header) - 1)) + "\n"
