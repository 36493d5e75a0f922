"""Copies of the project, in which Snakemake is started as a user starts it."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from snakemake.utils import update_config

from folders import PROJECT, ROOT, contents, restored
from processes import run

SNAKEMAKE = (sys.executable, "-m", "snakemake")
SMALL = ("--configfile", "small.yaml")
EXAMPLE = ("--configfile", "config/measured.yaml")
DAILY = ("level", "damping")  # c is taken from the configuration, and set by an axis
EVERY = tuple(sorted(path.stem for path in (ROOT / "config/studies").glob("*.yaml")))
PROFILE = ("--workflow-profile", "workflow/profiles/default")  # as `make` starts it


@dataclass(frozen=True)
class Checkout:
    """A copy of the project.

    package : whose package Snakemake uses in it. That of the tests has compiled kernels; a copy whose package is edited
    compiles its own.
    """

    folder: Path
    package: Path = ROOT

    def run(self, *arguments: str, cores: int = 2) -> subprocess.CompletedProcess[str]:
        command = (*SNAKEMAKE, f"--cores={cores}", *arguments)
        return run(*command, folder=self.folder, PYTHONPATH=str(self.package / "src"))

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

    def jobs(self, *arguments: str) -> dict[str, str]:
        """Message → reason of each job that a run would start (a dry run)."""
        said = self.made("--dry-run", *arguments)
        return dict(re.findall(r"^Job \d+: (.*)\nReason: (.*)", said, re.MULTILINE))

    def files(self, folder: str) -> dict[str, bytes]:
        """Every file below results/<folder>, by its path in it."""
        return contents(self.folder / "results" / folder)


def copied(source: Path, folder: Path, *more: str) -> Checkout:
    """The project, and what else is named, with the times of its files."""
    for name in (*PROJECT, *more):
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        if (source / name).is_dir():
            caches = shutil.ignore_patterns("__pycache__")
            shutil.copytree(source / name, target, ignore=caches, dirs_exist_ok=True)
        elif (source / name).is_file():
            shutil.copy2(source / name, target)
    return Checkout(folder)


def dump(path: Path, document: Any) -> None:
    """Write a document as YAML."""
    path.write_text(yaml.safe_dump(document, allow_unicode=True, sort_keys=False), encoding="utf-8")


def read(path: Path) -> Any:
    """The document of a YAML file."""
    return yaml.safe_load(path.read_text(encoding="utf-8"))


def configuration(folder: Path) -> dict[str, Any]:
    """The configuration of the small case, as its two files have it."""
    config = read(folder / "config/config.yaml")
    update_config(config, read(folder / "small.yaml"))
    return config


@contextmanager
def edited(file: Path, changes: dict[str, str]) -> Iterator[None]:
    """Other words in a file, until the end."""
    text = file.read_text(encoding="utf-8")
    for old, new in changes.items():
        assert old in text, old
        text = text.replace(old, new, 1)
    with restored(file):
        file.write_text(text, encoding="utf-8")
        yield


def small_case(folder: Path, studies: Iterable[str]) -> Checkout:
    """A copy of the project with the small case, and with few cases in these studies, which are of its oscillator."""
    copy = copied(ROOT, folder)
    shutil.copy2(ROOT / "tests/workflow/small.yaml", folder)
    for name in studies:
        file = folder / f"config/studies/{name}.yaml"
        dump(file, read(file) | read(ROOT / f"tests/workflow/studies/{name}.yaml"))
    return copy


def summaries(studies: Iterable[str]) -> list[str]:
    """The targets of studies of the small case."""
    return [f"results/small/studies/{name}/summary.md" for name in studies]
