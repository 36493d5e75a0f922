"""Pack an archive that a reader can verify and rebuild years later: sources, results, digests and instructions.

The same files give the same bytes: names are sorted, all entries have the same time and owner, and the compressed
stream has no time. (Another version of gzip may compress differently; the unpacked files are the same.) The crate
states when each result was written. Results that are built again belong to another run and give another crate.

The working tree is packed, not a commit (as `git archive` would): the results belong to the files as they lie there,
and the tree may itself be an unpacked archive, without git.
"""

from __future__ import annotations

import json
import subprocess
from collections.abc import Iterable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from ...project.files import replacing, sha256, write_json, write_text
from ..words import rendered
from .crate import crate
from .manifest import ARCHIVED_VERSION

# bytes; larger results are left out: a rebuild makes them again, and the manifest has their digests
LARGEST_PACKED = 5_000_000
TIME = 315_532_800  # s, time of every file: 1980-01-01, the earliest that all formats can hold
TAR = (
    *("tar", "--create", "--format=gnu", "--sort=name", f"--mtime=@{TIME}"),
    *("--owner=0", "--group=0", "--numeric-owner", "--mode=u=rwX,go=rX"),
    *("--force-local", "--use-compress-program=gzip -9n"),
)
"""GNU tar, whose archives are the same bytes for the same files."""


def pack(
    path: str | Path,
    sources: Iterable[str],
    manifest_file: str,
    citation: Mapping[str, Any],
    rebuild: str,
) -> None:
    """Write the archive. All paths are relative to the folder of the project, which must be the current folder.

    sources : files of the project.   manifest_file : of `manifest.manifest`.   citation : CITATION.cff.   rebuild : the
    command that builds the results again.
    """
    name = Path(path).name.removesuffix(".tar.gz")
    manifest = json.loads(Path(manifest_file).read_text(encoding="utf-8"))
    run, made = manifest["run"], manifest["reproducible"]
    sizes = {result["path"]: result["bytes"] for result in made["results"]}
    packed = [file for file, size in sizes.items() if size <= LARGEST_PACKED]
    # A job ended when its files were written; files of an unpacked archive have no such time.
    times = {file: Path(file).stat().st_mtime for file in packed}
    with TemporaryDirectory() as top, replacing(path) as temporary:
        folder = Path(top, name)
        guide = rendered(
            "archive.md.j2",
            name=name,
            made=made,
            run=run,
            rebuild=rebuild,
            manifest=manifest_file,
            left_out=sorted(sizes.keys() - packed),
            sizes=sizes,
            largest=f"{LARGEST_PACKED / 1e6:.0f}",
        )
        write_text(folder / "ARCHIVE.md", guide)
        code = {key: value for key, value in run["code"].items() if key != "known_from"}
        write_json(folder / ARCHIVED_VERSION, code)
        files = {file: Path(file) for file in (*sources, *packed, manifest_file)}
        files |= {file.name: file for file in folder.iterdir()}
        ended = {file: time for file, time in times.items() if time > TIME}
        crate(manifest, files, citation, ended).write(folder)
        names = sorted(p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file())
        lines = (f"{sha256(folder / file)}  {file}\n" for file in names)
        write_text(folder / "SHA256SUMS", "".join(lines))
        subprocess.run(
            [*TAR, f"--file={temporary.absolute()}", f"--directory={top}", name], check=True
        )
