"""The manifest of a run: the configuration, code and packages that produced each file.

It has two parts. `reproducible` is the same whenever the same sources are run with the locked packages on the same kind
of machine: settings, digests of sources and results, and the jobs that produced them. `run` describes this particular
run: the origin of the code, the version of Python, the packages and the machine. Neither part contains a time, so the
manifest of an unchanged project does not change.
"""

from __future__ import annotations

import platform
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from importlib import metadata
from pathlib import Path
from typing import Any

from ...project.files import sha256
from .licences import licence
from .sources import digest_of

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
    top: str | Path = ".",
) -> dict[str, Any]:
    """The manifest as plain data.

    case : its name.   configuration : merged from the named files.   sources : all files on which results may depend,
    by their names in the project.   jobs : the jobs that produced the results, each {rule, script, inputs, outputs}
    with such names.   code : from `sources.code_version`.   lock : the file that pins the packages.   top : the folder
    that holds the results.
    """
    rule_of = {file: job["rule"] for job in jobs for file in job["outputs"]}
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
            "results": [
                {
                    "path": file,
                    "bytes": Path(top, file).stat().st_size,
                    "sha256": sha256(Path(top, file)),
                    "rule": rule_of[file],
                }
                for file in sorted(rule_of)
            ],
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
    """Versions and licences of the installed packages that the lock lists, and the names of those not as locked."""
    text = lock.read_text(encoding="utf-8") if lock.is_file() else ""
    pinned: dict[str, set[str]] = {}
    for name, version in re.findall(r"^([A-Za-z0-9._-]+)==([^\s;\\]+)", text, re.MULTILINE):
        pinned.setdefault(name, set()).add(version)
    installed = {}
    for name in sorted(pinned):
        # one may be for another system, or of an extra that is not installed
        with suppress(metadata.PackageNotFoundError):
            installed[name] = metadata.version(name)
    return {
        "packages": installed,
        "licences": {name: licence(name) for name in installed},
        "packages_not_as_locked": [n for n, v in installed.items() if v not in pinned[n]],
    }
