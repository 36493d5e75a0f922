"""The time of the whole rebuild, split by rule, from Snakemake's own records.

Rebuilds everything in a temporary copy of the project, one job at a time, and writes pipeline.{csv,md,svg,png}.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pandas as pd

from dampbalance.figures.style import SLIP, page, place, save, styled
from dampbalance.project.files import write_csv, write_text
from folders import ROOT

from .measuring import machine, markdown, quantity

NOT_COPIED = (".*", "results", "__pycache__", "build", "dist")


def copy_project(folder: Path) -> None:
    """Copy the project, without what was built."""
    ignore = shutil.ignore_patterns(*NOT_COPIED)
    shutil.copytree(ROOT, folder, ignore=ignore, dirs_exist_ok=True)


def rebuild(folder: Path) -> float:
    """Copy the project and build it there; wall-clock seconds of the build."""
    copy_project(folder)
    start = time.perf_counter()
    command = [sys.executable, "-m", "snakemake", "--cores", "1", "--quiet", "all"]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if run.returncode != 0:
        raise RuntimeError(f"the rebuild failed:\n{run.stdout}\n{run.stderr}")
    return time.perf_counter() - start


def jobs(folder: Path) -> pd.DataFrame:
    """Columns rule, start, end (s) of each job that Snakemake recorded in a folder, where it ran them one by one."""
    records = []
    for path in (folder / ".snakemake/metadata").rglob("*"):
        if path.is_file():
            record = json.loads(path.read_text(encoding="utf-8"))
            if record.get("starttime") and record.get("endtime"):
                records.append((record["rule"], record["starttime"], record["endtime"]))
    merged: list[tuple[str, float, float]] = []
    for rule, start, end in sorted(records):  # a job has a record for each of its outputs
        if merged and merged[-1][0] == rule and start < merged[-1][2]:
            merged[-1] = rule, merged[-1][1], max(end, merged[-1][2])
        else:
            merged.append((rule, start, end))
    return pd.DataFrame(merged, columns=["rule", "start", "end"])


def split(records: pd.DataFrame, total: float) -> pd.DataFrame:
    """Columns rule, jobs, seconds, share; the last row is what Snakemake itself takes."""
    records = records.assign(seconds=records["end"] - records["start"])
    table = records.groupby("rule")["seconds"].agg(jobs="count", seconds="sum").reset_index()
    table = table.sort_values("seconds", ascending=False, ignore_index=True)
    rest = {"rule": "(Snakemake)", "jobs": 0, "seconds": max(0.0, total - table["seconds"].sum())}
    table = pd.concat([table, pd.DataFrame([rest])], ignore_index=True)
    return table.assign(share=table["seconds"] / total)


def text(table: pd.DataFrame, total: float) -> str:
    rows = [
        [row.rule, row.jobs or "", quantity(row.seconds), f"{row.share:.0%}"]
        for row in table.itertuples(index=False)
    ]
    note = f"In all {quantity(total)}, one job at a time, the kernels being compiled already."
    return f"{markdown(['rule', 'jobs', 'time', 'share'], rows)}\n{note}\n\nMachine: {machine()}.\n"


@styled()
def figure(table: pd.DataFrame, svg: Path, png: Path) -> None:
    """One bar for each rule."""
    drawn = page(90.0, 12.0 + 5.0 * len(table))
    axes = place(drawn, 38.0, 10.0, 48.0, 5.0 * len(table))
    axes.barh(table["rule"], table["seconds"], color=SLIP, height=0.6)
    axes.invert_yaxis()
    axes.set_xlabel("time (s)")
    save(drawn, svg, png, "Time of the whole rebuild, by rule")


def run(out: Path) -> None:
    """Measure, and write the results into the folder `out`."""
    with tempfile.TemporaryDirectory() as name:
        total = rebuild(Path(name))
        records = jobs(Path(name))
    table = split(records, total)
    write_csv(out / "pipeline.csv", table)
    write_text(out / "pipeline.md", text(table, total))
    figure(table, out / "pipeline.svg", out / "pipeline.png")
