"""Packs an archive that a reader can verify and rebuild years later: sources, results, digests and instructions.

The same files give the same bytes: names are sorted, all entries have the same time and owner, and the compressed
stream has no time. (Another version of zlib may compress differently; the unpacked files are the same.) The crate
states when each result was written. Results that are built again belong to another run and give another crate.
"""

from __future__ import annotations

import gzip
import hashlib
import io
import os
import sys
import tarfile
import zlib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path, PurePosixPath
from typing import Any

from ...project.files import json_text, replacing, sha256
from ..words import rendered
from .crate import DESCRIPTOR, crate
from .manifest import ARCHIVED_VERSION

# Bytes; larger results are not packed, because a rebuild makes them again and the manifest has their digests
LARGEST_PACKED = 5_000_000
TIME = 315_532_800  # of every file, s: 1980-01-01, the earliest that all formats can hold
SUMS = "SHA256SUMS"


def pack(
    path: str | Path,
    sources: Iterable[str],
    manifest: Mapping[str, Any],
    manifest_file: str,
    crate_file: str,
    citation: Mapping[str, Any],
    rebuild: str,
) -> None:
    """Write the archive. All paths are relative to the folder of the project, which must be the current folder.

    sources : files of the project.   manifest, manifest_file, citation : as in `crate.crate`.   crate_file : the
    crate of the results, which is packed unchanged.   rebuild : the command that builds the results again.

    Raises ValueError for a file that changes while it is packed.
    """
    name = Path(path).name.removesuffix(".tar.gz")
    results = {r["path"]: r for r in manifest["reproducible"]["results"]}
    packed = {file for file, result in results.items() if result["bytes"] <= LARGEST_PACKED}
    files = {file: Path(file) for file in {*sources, *packed, manifest_file, crate_file}}
    digests = {file: sha256(source) for file, source in files.items()}

    run, made = manifest["run"], manifest["reproducible"]
    guide = rendered(
        "archive.md.j2",
        name=name,
        made=made,
        run=run,
        rebuild=rebuild,
        manifest=manifest_file,
        left_out=sorted(set(results) - packed),
        sizes={file: result["bytes"] for file, result in results.items()},
        largest=f"{LARGEST_PACKED / 1e6:.0f}",
    )
    code = {key: value for key, value in run["code"].items() if key != "known_from"}
    written = {
        ARCHIVED_VERSION: json_text(code).encode(),
        "ARCHIVE.md": guide.encode(),
    }
    digests |= {file: _digest(data) for file, data in written.items()}
    jobs = [
        {**job, "outputs": [file for file in job["outputs"] if file in digests]}
        for job in made["jobs"]
        if not digests.keys().isdisjoint(job["outputs"])
    ]
    # a job ended when its files were written; unpacked files have no such time
    times = {file: Path(file).stat().st_mtime for file in packed}
    kept = {"results": [results[file] for file in sorted(packed)], "jobs": jobs}
    metadata = crate(
        {**manifest, "reproducible": {**made, **kept}},
        manifest_file,
        citation,
        others={file: digest for file, digest in digests.items() if file != manifest_file},
        ended={file: time for file, time in times.items() if time > TIME},
    )
    written[DESCRIPTOR] = json_text(metadata).encode()
    digests[DESCRIPTOR] = _digest(written[DESCRIPTOR])
    lines = [f"{digest}  {file}\n" for file, digest in sorted(digests.items())]
    written[SUMS] = "".join(lines).encode()

    with (
        replacing(path) as temporary,
        open(temporary, "wb") as stream,
        gzip.GzipFile(filename="", fileobj=stream, mode="wb", compresslevel=9, mtime=0) as packer,
        tarfile.open(fileobj=packer, mode="w", format=tarfile.PAX_FORMAT) as tar,
    ):
        for file in sorted({*files, *written}):
            data = written[file] if file in written else files[file].read_bytes()
            if file in files and _digest(data) != digests[file]:
                raise ValueError(f"{file} changed while it was packed: run `make archive` again")
            entry = tarfile.TarInfo(f"{name}/{file}")
            entry.size, entry.mtime = len(data), TIME
            entry.mode = 0o755 if file in files and os.access(files[file], os.X_OK) else 0o644
            tar.addfile(entry, io.BytesIO(data))


def unpack(path: str | Path, folder: str | Path) -> None:
    """Unpack an archive into a folder. Nothing is written unless all entries are files in one folder dampbalance-….

    Raises ValueError naming the archive, and the entry that `pack` would not have written.
    """
    try:
        with tarfile.open(path, "r:gz") as tar:
            entries = tar.getmembers()
            if problem := _problem(entries):
                raise ValueError(f"{path}: {problem}; name an archive of `make archive`")
            for entry in entries:
                target = Path(folder, entry.name)
                if data := tar.extractfile(entry):
                    target.parent.mkdir(parents=True, exist_ok=True)
                    target.write_bytes(data.read())
                    target.chmod(0o755 if entry.mode & 0o100 else 0o644)
    except (tarfile.TarError, EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise ValueError(
            f"{path}: cannot be read as an archive ({error}); fetch or make it again"
        ) from None


def _problem(entries: Sequence[tarfile.TarInfo]) -> str:
    """Why the entries of an archive must not be unpacked; "" if they may."""
    for entry in entries:
        name, problem = PurePosixPath(entry.name), ""
        if not (entry.isfile() or entry.isdir()):
            problem = "is a link or a device"
        elif name.is_absolute() or ".." in name.parts or "\\" in entry.name:
            problem = "leads out of the folder"
        if problem:
            return f"{entry.name!r} {problem}: nothing was unpacked"
    tops = {PurePosixPath(entry.name).parts[:1] for entry in entries}
    alone = len(tops) == 1 and "".join(*tops).startswith("dampbalance-")
    return "" if alone else "does not hold one folder dampbalance-…"


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


if __name__ == "__main__":  # python -m … ARCHIVE FOLDER: `make verify`
    try:
        unpack(*sys.argv[1:])
    except (ValueError, OSError) as error:
        sys.exit(f"error: {error}")
