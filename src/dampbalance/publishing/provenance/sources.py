"""Which files are the project's own, and which version of them this is."""

from __future__ import annotations

import hashlib
import json
import re
import subprocess
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

COMPUTING = (
    "Snakefile",
    "codecheck.yml",
    "config",
    "paper",
    "pyproject.toml",
    "requirements.lock",
    "src",
    "workflow",
)
"""Files and folders that results can depend on."""

PROJECT = (
    *COMPUTING,
    ".ci",
    ".editorconfig",
    ".gitattributes",
    ".github",
    ".gitignore",
    ".snakemake-workflow-catalog.yml",
    "CHANGELOG.md",
    "CITATION.cff",
    "CONTRIBUTING.md",
    "LICENSE",
    "LICENSES",
    "Makefile",
    "README.md",
    "REUSE.toml",
    "requirements-build.lock",
    "results/README.md",
    "tests",
    "trials",
)
"""All files and folders of the project: what version control holds."""

ARCHIVED_VERSION = "VERSION.json"  # written into an archive, where there is no git
_LEFT_BEHIND = re.compile(r"__pycache__|\.ipynb_checkpoints|.*\.egg-info|\.DS_Store|.*~|\..*_cache")


def files_of(root: str | Path, names: Iterable[str] = PROJECT) -> list[str]:
    """The files below `names` that exist in the folder `root`: relative paths with slashes, sorted; no caches."""
    root = Path(root)
    return sorted(
        path.relative_to(root).as_posix() for name in names for path in _below(root / name)
    )


def digest_of(data: Any) -> str:
    """The SHA-256 digest of plain data (mappings, lists, numbers, text), whatever the order of the keys."""
    text = json.dumps(data, sort_keys=True, ensure_ascii=False, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def code_version(root: str | Path, version: str) -> dict[str, Any]:
    """Which code this is.

    version : of the package.   commit, committed : hash and date (ISO 8601) of the commit that the files stem from, or
    None.   modified : whether files differ from that commit, or None.   known_from : git, archive, or nothing.
    """
    root = Path(root).resolve()
    state: dict[str, Any] = dict.fromkeys(("commit", "committed", "modified"))
    known_from = "nothing"
    archived = root / ARCHIVED_VERSION
    # A folder of an archive may lie within someone else's repository: that one says nothing of this code.
    own = _git(root, "rev-parse", "--show-toplevel") == str(root)
    if own and (commit := _git(root, "log", "-1", "--format=%H %cs")):
        state["commit"], _, state["committed"] = commit.partition(" ")
        state["modified"] = bool(_git(root, "status", "--porcelain"))
        known_from = "git"
    elif archived.is_file():
        stated = json.loads(archived.read_text(encoding="utf-8"))
        state = {key: stated.get(key) for key in state}
        known_from = "archive"
    return {"version": version, **state, "known_from": known_from}


def _below(path: Path) -> Iterator[Path]:
    if _LEFT_BEHIND.fullmatch(path.name):
        return
    if path.is_file():
        yield path
    elif path.is_dir():
        for inner in path.iterdir():
            yield from _below(inner)


def _git(root: Path, *arguments: str) -> str | None:
    """What git answers in that folder; None where there is no git, or no repository that it trusts."""
    command = ["git", "--no-optional-locks", *arguments]
    try:
        done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return None
    return done.stdout.strip()
