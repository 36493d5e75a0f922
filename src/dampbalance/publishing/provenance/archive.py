"""Packs an archive that a reader can verify and rebuild years later: sources, results, digests and instructions.

The same files give the same bytes: names are sorted, all entries have the same time and owner, and the compressed
stream has no time. (Another version of zlib may compress differently; the unpacked files are the same.) The crate
states when each result was written. Results that are built again belong to another run and give another crate.
"""

from __future__ import annotations

import gzip
import hashlib
import io
import json
import os
import sys
import tarfile
import zlib
from collections.abc import Iterable, Mapping
from pathlib import Path, PurePosixPath
from typing import Any

from ...project.files import replacing, sha256
from .crate import DESCRIPTOR, crate
from .sources import ARCHIVED_VERSION

# Bytes; larger results are not packed, because a rebuild makes them again and the manifest has their digests
LARGEST_PACKED = 5_000_000
TIME = 315_532_800  # of every file, s: 1980-01-01, the earliest that all formats can hold
SUMS = "SHA256SUMS"
NUMERICAL = ("numpy", "scipy", "numba", "pandas", "matplotlib")

README = """\
# {name}

Sources of dampbalance {version} ({commit})
with the results of the case `{case}`. Start with `README.md`, which describes the project, and `results/README.md`,
which describes the results.

## Verify

In this folder

```
sha256sum --check --quiet SHA256SUMS
```

prints nothing if every file is as it was packed.

## Rebuild

The results were computed with {python}. A rebuild needs Python 3.11 or newer, make and, for the
installation of the packages, a connection to a package index:

```
make setup    # the packages of requirements.lock, each checked against its digest
make clean    # removes the packed results; keep a copy if you need them
{rebuild}
sha256sum --check --quiet SHA256SUMS
```

Afterwards only `{manifest}` may differ, because it names the machine of the run. On another kind of
processor, or with other packages, the last bits of numbers may differ, and so may the digests; verdicts should not.

If the packages were stored together with this archive (`make wheels`), no connection is needed: unpack them into a
folder and run `PIP_NO_INDEX=1 PIP_FIND_LINKS=that/folder make setup`. They fit one version of Python and one kind of
system only.

If the packages are no longer available, `requirements.lock` states the version of each package, and the manifest lists
those that were installed, with their licences. The numbers were computed by {packages}.

## What is included

- `SHA256SUMS`: the digest of every file
- `VERSION.json`: the commit of the sources
- `ro-crate-metadata.json`: the description of the archive as an RO-Crate, with the job that produced each result
- `{manifest}`: the merged configuration, digests, packages and machine
- all other files: the project as under version control, and its results

## What is omitted

{omitted}
"""


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

    code = manifest["run"]["code"]
    guide = readme(name, manifest, set(results) - packed, manifest_file, rebuild)
    written = {
        ARCHIVED_VERSION: _json({k: v for k, v in code.items() if k != "known_from"}),
        "ARCHIVE.md": guide.encode(),
    }
    digests |= {file: _digest(data) for file, data in written.items()}
    jobs = [
        {**job, "outputs": [file for file in job["outputs"] if file in digests]}
        for job in manifest["reproducible"]["jobs"]
        if not digests.keys().isdisjoint(job["outputs"])
    ]
    kept = {"results": [results[file] for file in sorted(packed)], "jobs": jobs}
    metadata = crate(
        {**manifest, "reproducible": {**manifest["reproducible"], **kept}},
        manifest_file,
        citation,
        others={file: digest for file, digest in digests.items() if file != manifest_file},
        ended=_when_written(packed),
    )
    written[DESCRIPTOR] = _json(metadata)
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
            executable = file in files and os.access(files[file], os.X_OK)
            tar.addfile(_entry(f"{name}/{file}", len(data), executable), io.BytesIO(data))


def unpack(path: str | Path, folder: str | Path) -> None:
    """Unpack an archive into a folder. Nothing is written unless all entries are files in one folder dampbalance-….

    Raises ValueError naming the archive, and the entry that `pack` would not have written.
    """
    try:
        with tarfile.open(path, "r:gz") as tar:
            entries = tar.getmembers()
            tops = {PurePosixPath(entry.name).parts[:1] for entry in entries}
            for entry in entries:
                if problem := _misplaced(entry):
                    raise ValueError(
                        f"{path}: {entry.name!r} {problem}: nothing was unpacked; name an archive of `make archive`"
                    )
            if len(tops) != 1 or not "".join(*tops).startswith("dampbalance-"):
                raise ValueError(
                    f"{path}: does not hold one folder dampbalance-…; name an archive of `make archive`"
                )
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


def _misplaced(entry: tarfile.TarInfo) -> str:
    """Why an entry of an archive must not be unpacked; "" if it may."""
    if not (entry.isfile() or entry.isdir()):
        return "is a link or a device"
    name = PurePosixPath(entry.name)
    if name.is_absolute() or ".." in name.parts or "\\" in entry.name:
        return "leads out of the folder"
    return ""


def readme(
    name: str, manifest: Mapping[str, Any], left_out: set[str], manifest_file: str, rebuild: str
) -> str:
    """The instructions in the archive: its contents, how to verify it and how to rebuild the results."""
    made, run = manifest["reproducible"], manifest["run"]
    code = run["code"]
    commit = f"commit {code['commit']}" if code["commit"] else "a commit that is not known"
    if code["modified"]:
        commit += ", with changes that the archive holds"
    sizes = {result["path"]: result["bytes"] for result in made["results"]}
    omitted = "Nothing: the archive contains every result."
    if left_out:
        omitted = (
            f"Results larger than {LARGEST_PACKED / 1e6:.0f} MB are omitted. A rebuild makes them again; "
            f"their digests are in `{manifest_file}`.\n"
        ) + "".join(f"\n- `{file}` ({sizes[file] / 1e6:.0f} MB)" for file in sorted(left_out))
    packages = [f"{p} {run['packages'][p]}" for p in NUMERICAL if p in run["packages"]]
    return README.format(
        name=name,
        version=made["version"],
        commit=commit,
        case=made["case"],
        python=f"Python {run['python']} on {run['system']} ({run['machine']})",
        packages=", ".join(packages) or "those named in pyproject.toml",
        rebuild=rebuild,
        manifest=manifest_file,
        omitted=omitted,
    )


def _entry(name: str, size: int, executable: bool) -> tarfile.TarInfo:
    entry = tarfile.TarInfo(name)
    entry.size, entry.mtime, entry.mode = size, TIME, 0o755 if executable else 0o644
    return entry


def _when_written(files: Iterable[str]) -> dict[str, float]:
    """The time when each file was last written, s since 1970, which is when its job ended; none for unpacked files."""
    times = {file: Path(file).stat().st_mtime for file in files}
    return {file: time for file, time in times.items() if time > TIME}


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def _json(data: Any) -> bytes:
    return (json.dumps(data, indent=1, ensure_ascii=False) + "\n").encode()


if __name__ == "__main__":  # python -m … ARCHIVE FOLDER: `make verify`
    try:
        unpack(*sys.argv[1:])
    except (ValueError, OSError) as error:
        sys.exit(f"error: {error}")
