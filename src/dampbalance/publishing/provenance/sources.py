"""Lists the files of the project and determines their version."""

from __future__ import annotations

import hashlib
import json
import re
import subprocess
from collections.abc import Iterable
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
"""Files and folders on which results can depend."""

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
    "requirements-dev.lock",
    "results/README.md",
    "tests",
    "trials",
)
"""All files and folders of the project, as under version control."""

ARCHIVED_VERSION = "VERSION.json"  # written into an archive, where there is no git
_LEFT_BEHIND = re.compile(r"__pycache__|\.ipynb_checkpoints|.*\.egg-info|\.DS_Store|.*~|\..*_cache")


def files_of(root: str | Path, names: Iterable[str] = PROJECT) -> list[str]:
    """The files below `names` in the folder `root`, as sorted relative paths with slashes; caches are excluded."""
    root = Path(root)
    paths = (path for name in names for path in (root / name, *(root / name).rglob("*")))
    files = (path.relative_to(root) for path in paths if path.is_file())
    return sorted(
        file.as_posix() for file in files if not any(map(_LEFT_BEHIND.fullmatch, file.parts))
    )


def digest_of(data: Any) -> str:
    """The SHA-256 digest of plain data (mappings, lists, numbers, text), independent of the order of keys."""
    text = json.dumps(data, sort_keys=True, ensure_ascii=False, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def code_version(root: str | Path, version: str) -> dict[str, Any]:
    """The version of the code in a folder, from git or, in an unpacked archive, from its VERSION.json.

    version : of the package.   commit, committed : hash and date (ISO 8601) of the commit of the files, or None.
    modified : whether files differ from that commit, or None.   known_from : git, archive, or nothing.
    """
    root = Path(root).resolve()
    archived, known_from = root / ARCHIVED_VERSION, "nothing"
    state: dict[str, Any] = dict.fromkeys(("commit", "committed", "modified"))
    # An unpacked archive may lie within another repository, whose commit does not describe this code.
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


def _git(root: Path, *arguments: str) -> str | None:
    """The output of git in that folder; None without git, or without a repository that git trusts."""
    command = ["git", "--no-optional-locks", *arguments]
    try:
        done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return None
    return done.stdout.strip()
