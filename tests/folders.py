"""Where the project under test stands, what a folder holds, and files that a test changes for a while."""

from __future__ import annotations

import fcntl
import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).parents[1]
PUBLISHED = ROOT / "paper/published"
PAPER_FILE = ROOT / "config/config.yaml"
PROJECT = (
    *("Snakefile", "codecheck.yml", "config", "paper", "pyproject.toml", "src", "workflow"),
    *(".ci", ".editorconfig", ".gitattributes", ".github", ".gitignore"),
    *(".snakemake-workflow-catalog.yml", "CHANGELOG.md", "CITATION.cff", "CONTRIBUTING.md"),
    *("LICENSE", "LICENSES", "Makefile", "README.md", "REUSE.toml", "results/README.md"),
    *("requirements.lock", "requirements-build.lock", "requirements-dev.lock"),
    *("requirements-engine.lock", "examples", "tests", "trials"),
)
"""All files and folders of the project, as under version control."""


def contents(folder: Path) -> dict[str, bytes]:
    """Every file below a folder, by its path in it."""
    files = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def shared(tmp_path_factory, name: str, make: Callable[[Path], object]) -> Path:
    """A folder that make(folder) fills, in the first process of the test run that asks for it; no test changes it."""
    top = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        top = top.parent
    folder, complete = top / name, top / f"{name}.complete"
    with (top / f"{name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not complete.exists():
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir()
            make(folder)
            complete.touch()
    return folder


@contextmanager
def restored(path: Path) -> Iterator[None]:
    """Put a file back at the end as it was, contents and times; one that was not there is removed."""
    before = (path.read_bytes(), path.stat()) if path.exists() else None
    try:
        yield
    finally:
        path.unlink(missing_ok=True)
        if before:
            path.write_bytes(before[0])
            os.utime(path, ns=(before[1].st_atime_ns, before[1].st_mtime_ns))
