"""Copies of the whole project, each in its folder, and a way to run the workflow there."""

from __future__ import annotations

import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from numba.core.caching import _CacheLocator

from dampbalance.publishing.provenance.sources import PROJECT
from workflow.starting import snakemake

get_subpath = _CacheLocator.get_suitable_cache_subpath

SMALL = ("--configfile", "small.yaml")


@dataclass(frozen=True)
class Checkout:
    """A copy of the sources; `run` starts Snakemake in it with the copy's own package.

    project : the copy whose package is used, where the folder is another one.
    """

    folder: Path
    project: Path | None = None

    def run(
        self, *arguments: str, cores: int = 2, compiled: bool = True
    ) -> subprocess.CompletedProcess[str]:
        return snakemake(
            self.folder, "--cores", str(cores), *arguments, compiled=compiled, project=self.project
        )

    def jobs(self, *arguments: str, compiled: bool = True) -> dict[str, int]:
        """How many jobs of each rule a run would start (a dry run)."""
        done = self.run("--dry-run", *arguments, compiled=compiled)
        assert done.returncode == 0, done.stderr
        lines = done.stdout.splitlines() + done.stderr.splitlines()
        counts = {}
        for i, line in enumerate(lines):
            if line.split() == ["job", "count"]:
                for row in lines[i + 2 :]:
                    if len(row.split()) != 2:
                        break
                    name, count = row.split()
                    counts[name] = int(count)
                break
        return counts

    def files(self, folder: str) -> dict[str, bytes]:
        """Every file below results/<folder>, by its path in it."""
        top = self.folder / "results" / folder
        return {
            str(path.relative_to(top)): path.read_bytes()
            for path in sorted(top.rglob("*"))
            if path.is_file()
        }


def keep_kernels(source: Path, folder: Path) -> None:
    """Let a copy use the compiled kernels that came along: Numba names their folder after the path of the sources."""
    for cached in (folder / "src").rglob("kernels-*/*_*"):
        for package in (source / "src").rglob("*/"):
            if cached.name == get_subpath(str(package / "any.py")):
                own = folder / package.relative_to(source)
                cached.rename(cached.parent / get_subpath(str(own / "any.py")))
                break


def copied(source: Path, folder: Path, *more: str) -> Checkout:
    """The project, and what else is named, with the times of its files."""
    for name in (*PROJECT, *more):
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        if (source / name).is_dir():
            shutil.copytree(source / name, target)
        elif (source / name).is_file():
            shutil.copy2(source / name, target)
    keep_kernels(source, folder)
    return Checkout(folder)
