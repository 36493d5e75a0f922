"""Time per steady state and accuracy, of ours and of the peers.

Writes peers.{csv,md,svg,png} and peers_repetitions.csv. Peers that are not installed are left out; the table says so.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pandas as pd

from dampbalance import steady_orbits
from dampbalance.figures.style import FAINT, SLIP, STICK, page, place, save, styled
from dampbalance.project.files import write_csv, write_text

from . import peer_scipy
from .cases import FEATURES, Sweep, forty_digits, sweep, worst_error
from .measuring import (
    Contestant,
    cores,
    interleaved,
    machine,
    markdown,
    medians,
    quantity,
    ratios,
    rounded,
)

Solver = Callable[[Sweep], np.ndarray]
REFERENCE = "dampbalance, 1 thread"


def ours(threads: int) -> Solver:
    def solve(cases: Sweep) -> np.ndarray:
        orbits = steady_orbits(**cases.arguments(), threads=threads)
        return np.stack([getattr(orbits, name) for name in FEATURES], axis=1)

    return solve


def solvers(size: float) -> tuple[dict[str, tuple[int, Solver]], list[str]]:
    """Return (how many cases each solver does in one go, and the solver) by name, ours on one thread first; peers not
    installed.

    size : a factor on all numbers of cases.
    """
    many, batch, few = int(2**18 * size), max(1, int(256 * size)), max(1, int(8 * size))
    found: dict[str, tuple[int, Solver]] = {REFERENCE: (many, ours(1))}
    if cores() > 1:
        found[f"dampbalance, {cores()} threads"] = (many, ours(cores()))
    missing = []
    if find_spec("heyoka"):
        from . import peer_heyoka as heyoka

        found["heyoka, events, from rest"] = (batch, heyoka.Settling(from_rest=True))
        found["heyoka, events, good guess"] = (batch, heyoka.Settling(from_rest=False))
        found["heyoka batch, shooting"] = (batch, heyoka.Shooting())
    else:
        missing.append("heyoka")
    if find_spec("diffrax"):
        from . import peer_diffrax as diffrax

        found["diffrax vmapped, events, from rest"] = (batch, diffrax.from_rest)
        found["diffrax vmapped, events, good guess"] = (batch, diffrax.from_guess)
        found["diffrax vmapped, shooting"] = (batch, diffrax.shooting)
    else:
        missing.append("diffrax")
    found["scipy, events, from rest"] = (few, peer_scipy.events_from_rest)
    found["scipy, events, good guess"] = (few, peer_scipy.events_from_guess)
    found["scipy, shooting"] = (few, peer_scipy.shooting)
    return found, missing


def measure(
    exact_cases: int, repetitions: int, size: float
) -> tuple[pd.DataFrame, pd.DataFrame, list[str]]:
    """Return timings of every repetition; their summary with the worst error of each method; missing peers."""
    found, missing = solvers(size)
    all_cases = sweep(max(exact_cases, *(n for n, _ in found.values())))
    exact = forty_digits(all_cases.take(exact_cases))
    errors = [worst_error(solve(all_cases.take(exact_cases)), exact) for _, solve in found.values()]
    contestants = [
        Contestant(name, n, lambda solve=solve, n=n: solve(all_cases.take(n)))
        for name, (n, solve) in found.items()
    ]
    interleaved(contestants, 1)  # everything compiled for its number of cases, caches filled
    timings = interleaved(contestants, repetitions)
    return timings, summarised(timings).assign(worst_relative_error=errors), missing


def summarised(timings: pd.DataFrame) -> pd.DataFrame:
    """Return columns name, cases, median times, and ratios, low, median and high: of processor and of wall time to ours
    on one thread (cpu_ratio_, wall_ratio_), of wall time to ours on all cores (all_cores_ratio_)."""
    summary = medians(timings)
    all_cores = [name for name in summary["name"] if name.startswith("dampbalance")][-1]
    for prefix, reference, time in (
        ("cpu_ratio_", REFERENCE, "cpu_s_per_case"),
        ("wall_ratio_", REFERENCE, "wall_s_per_case"),
        ("all_cores_ratio_", all_cores, "wall_s_per_case"),
    ):
        columns = ratios(timings, reference, time).set_index("name")
        summary = summary.join(columns.add_prefix(prefix), on="name")
    return summary


def table(summary: pd.DataFrame, missing: list[str], exact_cases: int, repetitions: int) -> str:
    rows = [
        [
            row.name,
            quantity(row.wall_s_per_case),
            quantity(row.cpu_s_per_case),
            rounded(row.cpu_ratio_median),
            f"{rounded(row.cpu_ratio_low)} – {rounded(row.cpu_ratio_high)}",
            rounded(row.all_cores_ratio_median),
            f"{rounded(row.all_cores_ratio_low)} – {rounded(row.all_cores_ratio_high)}",
            f"{row.worst_relative_error:.0e}",
        ]
        for row in summary.itertuples(index=False)
    ]
    header = ["method", "wall time per case", "processor time per case", "ratio of processor times"]
    header += ["its range", "ratio of wall times", "its range", "worst error"]
    note = (
        f"Ratios: within one of {repetitions} interleaved repetitions, median and range. Processor times are compared "
        "with the first line, core against core; wall times with ours on all cores, which is what a user of this "
        "machine waits: the peers run on one core. "
        f"Worst error: relative, of X, V_s, t_s, φ, a, b, W against 40 digits, {exact_cases} cases. "
        "Compilation is not counted. Ours computes three harmonics besides; the peers need not.\n"
    )
    left_out = f"\nNot installed and left out: {', '.join(missing)}.\n" if missing else ""
    return f"{markdown(header, rows)}\n{note}{left_out}\nMachine: {machine()}.\n"


@styled()
def figure(summary: pd.DataFrame, svg: Path, png: Path) -> None:
    """Draw processor time per case and worst error of each method: further left is faster, lower is more accurate."""
    drawn = page(150.0, 82.0)
    axes = place(drawn, 18.0, 13.0, 76.0, 64.0)
    for i, row in enumerate(summary.itertuples(index=False), start=1):
        colour = STICK if row.name.startswith("dampbalance") else SLIP
        at = row.cpu_s_per_case, row.worst_relative_error
        axes.plot(*at, "o", color=colour)
        offset = (4.0, 3.0) if i % 2 else (-9.0, -9.0)
        axes.annotate(str(i), at, xytext=offset, textcoords="offset points")
        drawn.text(98.0 / 150.0, (75.0 - 5.0 * i) / 82.0, f"{i}  {row.name}", fontsize=7.5)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.margins(0.12)
    axes.set_xlabel("processor time per steady state (s)")
    axes.set_ylabel("worst relative error")
    axes.grid(color=FAINT, alpha=0.2, linewidth=0.4)
    save(drawn, svg, png, "Time per steady state and worst relative error of each method")


def run(out: Path, repetitions: int = 9, exact_cases: int = 8, size: float = 1.0) -> None:
    """Measure, and write the results into the folder `out`."""
    timings, summary, missing = measure(exact_cases, repetitions, size)
    write_csv(out / "peers.csv", summary)
    write_csv(out / "peers_repetitions.csv", timings)
    write_text(out / "peers.md", table(summary, missing, exact_cases, repetitions))
    figure(summary, out / "peers.svg", out / "peers.png")
