"""What the graph of an RO-Crate is made of: entities, references between them, and the names of files."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any
from urllib.parse import quote

Entity = dict[str, Any]

# What is not here is text. The library of Python knows more with every version, and asks the system.
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
    """An entity with those of its properties that are known; a list of one is written as that one."""
    entries = {key: _unpacked(value) for key, value in properties.items()}
    return {"@id": identifier, "@type": kind} | {
        key: value for key, value in entries.items() if value not in (None, [])
    }


def references(entities: Iterable[Mapping[str, Any]]) -> list[dict[str, str]]:
    """What points at these entities."""
    return [{"@id": one["@id"]} for one in entities]


@dataclass(frozen=True, slots=True)
class Place:
    """Where a crate lies, and how files are named from there.

    root : its folder, relative to the project; "" is the project itself.   beside_sources : whether the files of the
    project are found from there. They are not when the workflow was run in another folder: then the crate describes
    them, under names that begin with '#'.
    """

    root: str = ""
    beside_sources: bool = True

    def name(self, path: str) -> str:
        """The name of a file in the crate: its path from the folder of the crate. path : relative to the project."""
        if not self.beside_sources and not path.startswith("results/"):
            return f"#{quote(path)}"
        return quote(Path(os.path.relpath(path, self.root or ".")).as_posix())

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
