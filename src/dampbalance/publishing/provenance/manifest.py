"""The manifest of a run: the configuration, code and packages that produced each file; and what CITATION.cff states.

It has two parts. `reproducible` is the same whenever the same sources are run with the locked packages on the same kind
of machine: settings, digests of sources and results, and the jobs that produced them. `run` describes this particular
run: the origin of the code, the version of Python, the packages with the licences that they state, and the machine.
Neither part contains a time, so the manifest of an unchanged project does not change.

The commit of a build is in the manifest, which nothing else depends on: printed in the article it would change the PDF
with every commit, though no number had changed. The article prints the one that CITATION.cff states for a release.
"""

from __future__ import annotations

import hashlib
import json
import platform
import re
import subprocess
from collections.abc import Iterable, Mapping, Sequence
from importlib import metadata
from pathlib import Path
from typing import Any

from ...project.files import sha256

COMPUTING = (
    *("Snakefile", "codecheck.yml", "config", "paper", "pyproject.toml"),
    *("requirements.lock", "src", "workflow"),
)
"""Files and folders on which results can depend."""

_LEFT_BEHIND = re.compile(r"__pycache__|\.ipynb_checkpoints|.*\.egg-info|\.DS_Store|.*~|\..*_cache")


def files_of(root: str | Path, names: Iterable[str]) -> list[str]:
    """Return the files below `names` in the folder `root`, as sorted relative paths with slashes, without caches."""
    starts = [Path(root, name) for name in names]
    paths = {path for start in starts for path in (start, *start.rglob("*")) if path.is_file()}
    files = [path.relative_to(root) for path in paths]
    return sorted(f.as_posix() for f in files if not any(map(_LEFT_BEHIND.fullmatch, f.parts)))


def digest_of(data: Any) -> str:
    """Return the SHA-256 digest of plain data (mappings, lists, numbers, text), independent of the order of keys."""
    text = json.dumps(data, sort_keys=True, ensure_ascii=False, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def code_version(root: str | Path, version: str) -> dict[str, Any]:
    """Return the version of the code in a folder, and its commit where git knows it.

    version : of the package.   commit, committed : hash and date (ISO 8601) of the commit of the files, or None.
    modified : whether files differ from that commit, or None.   known_from : git, or nothing.
    """
    root = Path(root).resolve()
    known_from = "nothing"
    state: dict[str, Any] = dict.fromkeys(("commit", "committed", "modified"))
    # An unpacked archive may lie within another repository, whose commit does not describe this code.
    own = _git(root, "rev-parse", "--show-toplevel") == str(root)
    if own and (commit := _git(root, "log", "-1", "--format=%H %cs")):
        state["commit"], _, state["committed"] = commit.partition(" ")
        state["modified"] = bool(_git(root, "status", "--porcelain"))
        known_from = "git"
    return {"version": version, **state, "known_from": known_from}


def _git(root: Path, *arguments: str) -> str | None:
    """Return the output of git in that folder; None without git, or without a repository that git trusts."""
    command = ["git", "--no-optional-locks", *arguments]
    try:
        done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return None
    return done.stdout.strip()


ABOUT = (
    "Which configuration, code and packages made the results. 'reproducible': the same sources with the packages of "
    "requirements.lock give the same again (another kind of processor may change the last bits of a number, and so "
    "digests). 'run': the code's origin, the packages and the machine of this very run; it may differ from run to run."
)


def manifest(
    case: str,
    configuration: Mapping[str, Any],
    configuration_files: Sequence[str],
    sources: Mapping[str, str | Path],
    jobs: Sequence[Mapping[str, Any]],
    code: Mapping[str, Any],
    lock: str | Path,
) -> dict[str, Any]:
    """Return the manifest as plain data.

    case : its name.   configuration : merged from the named files.   sources : all files on which results may depend,
    by their names in the project.   jobs : the jobs that produced the results, each {rule, script, inputs, outputs}
    with such names, the results as paths from the working folder.   code : from `code_version`.   lock : the file that
    pins the packages.
    """
    rule_of = {file: job["rule"] for job in jobs for file in job["outputs"]}
    results = [
        {"path": name, "bytes": Path(name).stat().st_size, "sha256": sha256(name), "rule": rule}
        for name, rule in sorted(rule_of.items())
    ]
    digests = {name: sha256(path) for name, path in sorted(sources.items())}
    return {
        "about": ABOUT,
        "reproducible": {
            "case": case,
            "version": code["version"],
            "configuration": dict(configuration),
            "configuration_sha256": digest_of(configuration),
            "configuration_files": list(configuration_files),
            "sources_sha256": digest_of(digests),
            "sources": digests,
            "results": results,
            "jobs": sorted((dict(job) for job in jobs), key=lambda job: list(job["outputs"])),
        },
        "run": {
            "code": dict(code),
            "python": platform.python_version(),
            "implementation": platform.python_implementation(),
            "system": platform.system(),
            "machine": platform.machine(),
            **_packages(Path(lock)),
        },
    }


def _packages(lock: Path) -> dict[str, Any]:
    """Return versions and licences of the installed packages in the lock, and the names of those not as locked."""
    text = lock.read_text(encoding="utf-8") if lock.is_file() else ""
    pinned: dict[str, set[str]] = {}
    for name, version in re.findall(r"^([A-Za-z0-9._-]+)==([^\s;\\]+)", text, re.MULTILINE):
        pinned.setdefault(name, set()).add(version)
    found = {re.sub("[-_.]+", "-", of.name).lower(): of for of in metadata.distributions()}
    # a package of another system, or of an extra, is not installed
    installed = {name: found[name] for name in sorted(pinned.keys() & found)}
    versions = {name: of.version for name, of in installed.items()}
    return {
        "packages": versions,
        "licences": {name: _licence(of) for name, of in installed.items()},
        "packages_not_as_locked": [n for n, v in versions.items() if v not in pinned[n]],
    }


def _licence(package: metadata.Distribution) -> str:
    """Return the licence that a package states: the expression, its classifiers, or the first line of its text."""
    stated = package.metadata
    classifiers = [of for of in stated.get_all("Classifier", []) if of.startswith("License ::")]
    classified = " and ".join(of.rpartition(" :: ")[2] for of in classifiers)
    named = [*stated.get_all("License-Expression", []), classified, *stated.get_all("License", [])]
    return next((text.partition("\n")[0] for text in named if text), "not stated")


ADDRESSES = {
    **{"repository-code": "repository", "repository": "repository", "url": "page"},
    **{"repository-artifact": "archive", "doi": "doi", "commit": "commit"},
}
"""Key of CITATION.cff → what it is called here."""


def software(citation: Mapping[str, Any]) -> dict[str, Any]:
    """Return {version, licence, authors, addresses} as a citation file (CFF 1.2) states them.

    authors : names in the order of the file.   addresses : repository, page, archive, doi, commit and contact, those
    stated. Raises KeyError for a file without version, license or authors.
    """
    contacts = [
        f"{author_name(one)} {one.get('email', '')}".strip() for one in citation.get("contact", [])
    ]
    return {
        "version": str(citation["version"]),
        "licence": str(citation["license"]),
        "authors": [author_name(author) for author in citation["authors"]],
        "addresses": {ADDRESSES[k]: str(citation[k]) for k in ADDRESSES if citation.get(k)}
        | ({"contact": ", ".join(contacts)} if contacts else {}),
    }


def author_name(author: Mapping[str, Any]) -> str:
    """Return an author of a citation file, a person or a group, as it is printed."""
    parts = ("given-names", "name-particle", "family-names", "name-suffix")
    return str(author.get("name") or " ".join(str(author[key]) for key in parts if author.get(key)))
