"""Copies of the whole project, each in its folder, and a way to run the workflow there."""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from numba.core.caching import _CacheLocator

from folders import PROJECT, contents
from workflow.starting import snakemake

get_subpath = _CacheLocator.get_suitable_cache_subpath

SMALL = ("--configfile", "small.yaml")
EXAMPLE = ("--configfile", "config/measured.yaml")
PROFILE = ("--workflow-profile", "workflow/profiles/default")  # as `make` starts it


@dataclass(frozen=True)
class Checkout:
    """A copy of the sources; `run` starts Snakemake in it with the copy's own package.

    project : the copy whose package is used, where the folder is another one.
    """

    folder: Path
    project: Path | None = None

    def run(self, *arguments: str, cores: int = 2) -> subprocess.CompletedProcess[str]:
        return snakemake(self.folder, "--cores", str(cores), *arguments, project=self.project)

    def made(self, *arguments: str, **options: Any) -> str:
        """What a run says that must succeed."""
        done = self.run(*arguments, **options)
        assert done.returncode == 0, done.stderr
        return done.stdout + done.stderr

    def refused(self, *arguments: str) -> str:
        """What a run says that must fail, with words and no traceback."""
        done = self.run(*arguments)
        said = done.stdout + done.stderr
        assert (done.returncode != 0, "Traceback" in said) == (True, False)
        return said

    def jobs(self, *arguments: str) -> dict[str, int]:
        """How many jobs of each rule a run would start (a dry run)."""
        said = self.made("--dry-run", *arguments)
        table = re.search(r"^job +count\n-.*\n((?:\w+ +\d+\n)*)", said, re.MULTILINE)
        rows = table[1].splitlines() if table else ()
        return {name: int(count) for name, count in map(str.split, rows)}

    def files(self, folder: str) -> dict[str, bytes]:
        """Every file below results/<folder>, by its path in it."""
        return contents(self.folder / "results" / folder)


def keep_kernels(source: Path, folder: Path) -> None:
    """Let a copy of the sources use the kernels that these have compiled: Numba knows sources by their path, size and
    time, and the package by a digest of them."""
    for cached in (source / "src").rglob("kernels-*/*_*"):
        kept = folder / cached.parent.relative_to(source)
        for package in (source / "src").rglob("*/"):
            own = folder / package.relative_to(source)
            if cached.name == get_subpath(str(package / "any.py")):
                shutil.copytree(cached, kept / get_subpath(str(own / "any.py")))
                for module in package.glob("*.py"):
                    shutil.copystat(module, own / module.name)
                break


def copied(source: Path, folder: Path, *more: str) -> Checkout:
    """The project, and what else is named, with the times of its files."""
    for name in (*PROJECT, *more):
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        if (source / name).is_dir():
            shutil.copytree(source / name, target, ignore=shutil.ignore_patterns("kernels-*"))
        elif (source / name).is_file():
            shutil.copy2(source / name, target)
    keep_kernels(source, folder)
    return Checkout(folder)
