"""The parts of which the graph of an RO-Crate consists: entities, references between them, and names of files."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any
from urllib.parse import quote

Entity = dict[str, Any]

# Everything else is text. Python's own table grows with every version and depends on the system.
_TYPES = {
    ".cff": "application/yaml",
    ".css": "text/css",
    ".csv": "text/csv",
    ".html": "text/html",
    ".ipynb": "application/x-ipynb+json",
    ".js": "text/javascript",
    ".json": "application/json",
    ".md": "text/markdown",
    ".parquet": "application/vnd.apache.parquet",
    ".pdf": "application/pdf",
    ".png": "image/png",
    ".py": "text/x-python",
    ".rst": "text/x-rst",
    ".svg": "image/svg+xml",
    ".toml": "application/toml",
    ".yaml": "application/yaml",
    ".yml": "application/yaml",
}


def entity(identifier: str, kind: str | list[str], /, **properties: Any) -> Entity:
    """An entity with those of its properties that have a value; a list of one item is written as that item."""
    entries = {key: _unpacked(value) for key, value in properties.items()}
    return {"@id": identifier, "@type": kind} | {
        key: value for key, value in entries.items() if value not in (None, [])
    }


def references(entities: Iterable[Mapping[str, Any]]) -> list[dict[str, str]]:
    """References to these entities."""
    return [{"@id": one["@id"]} for one in entities]


@dataclass(frozen=True, slots=True)
class CrateFolder:
    """The folder that holds a crate, and the names of files as seen from there.

    root : the folder, relative to the project; "" is the project itself.   beside_sources : whether the files of the
    project can be reached from there. They cannot when the workflow was run in another folder: then the crate only
    describes them, under names that begin with '#'.
    """

    root: str = ""
    beside_sources: bool = True

    def name(self, path: str) -> str:
        """The name of a file in the crate, which is its path from there.   path : relative to the project."""
        if not self.beside_sources and not path.startswith("results/"):
            return f"#{quote(path)}"
        return quote(Path(os.path.relpath(path, self.root or ".")).as_posix())

    def references(self, paths: Iterable[str]) -> list[dict[str, str]]:
        """References to these files, in the order of their paths."""
        return [{"@id": self.name(path)} for path in sorted(paths)]

    def file(self, path: str, digest: str | None = None, size: int | None = None) -> Entity:
        """A file as an entity.   digest : SHA-256.   size : bytes."""
        return entity(
            self.name(path),
            "File",
            name=path,
            encodingFormat=_TYPES.get(PurePosixPath(path).suffix, "text/plain"),
            contentSize=None if size is None else str(size),
            sha256=digest,
        )


def _unpacked(value: Any) -> Any:
    return value[0] if isinstance(value, list) and len(value) == 1 else value
