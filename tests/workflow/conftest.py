"""A copy of the workflow in a folder of its own, and a way to run it there."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest
from numba.core.caching import _CacheLocator

get_subpath = _CacheLocator.get_suitable_cache_subpath

ROOT = Path(__file__).parents[2]
COPIED = (
    "Snakefile",
    "CITATION.cff",
    "config",
    "paper/article",
    "paper/notebook",
    "paper/published",
    "requirements.lock",
    "src",
    "workflow",
)


@dataclass(frozen=True)
class Checkout:
    """A copy of the sources; `run` starts Snakemake in it with the copy's own package."""

    folder: Path

    def run(self, *arguments: str, cores: int = 2) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "snakemake", "--cores", str(cores), *arguments]
        environment = os.environ | {"PYTHONPATH": str(self.folder / "src")}
        return subprocess.run(
            command, cwd=self.folder, env=environment, capture_output=True, text=True, check=False
        )

    def jobs(self, *arguments: str) -> dict[str, int]:
        """How many jobs of each rule a run would start (a dry run)."""
        done = self.run("--dry-run", *arguments)
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


def keep_kernels(folder: Path) -> None:
    """Let a copy use the compiled kernels that came along: Numba names their folder after the path of the sources."""
    for cached in (folder / "src").rglob("kernels-*/*_*"):
        for package in (ROOT / "src").rglob("*/"):
            if cached.name == get_subpath(str(package / "any.py")):
                own = folder / package.relative_to(ROOT)
                cached.rename(cached.parent / get_subpath(str(own / "any.py")))
                break


@pytest.fixture(scope="module")
def checkout(tmp_path_factory):
    """Makes copies of the sources: checkout() -> Checkout."""

    def make() -> Checkout:
        folder = tmp_path_factory.mktemp("checkout")
        for name in COPIED:
            source, target = ROOT / name, folder / name
            target.parent.mkdir(parents=True, exist_ok=True)
            if source.is_dir():
                shutil.copytree(source, target)
            else:
                shutil.copy2(source, target)
        shutil.copy2(Path(__file__).parent / "small.yaml", folder / "small.yaml")
        keep_kernels(folder)
        return Checkout(folder)

    return make
