"""Copies the files of the project to which pages link into the folder `files` of the site, at their paths.

An HTML page of results keeps its links to other small files; its other links are replaced by their text.
"""

from __future__ import annotations

import posixpath
import re
from pathlib import Path

FOLDER = "files"
_LARGEST = 4_000_000  # bytes of a file that is copied
_LOCAL_LINK = re.compile(r"""(?<=<a)([^>]*?)\shref="(?![a-z]+:|#)([^"#]*)(?:#[^"]*)?"(?=[^>]*>)""")


class Mirror:
    """The files of a project that the site contains, by path from the root; added one by one and copied at the end."""

    def __init__(self, root: str | Path) -> None:
        self.root = Path(root)
        self.contents: dict[str, bytes] = {}

    def add(self, path: str) -> str | None:
        """The path of the copy, from the root of the site; None if the file does not exist or is too large."""
        file = self.root / path
        if path.startswith("..") or not file.is_file() or file.stat().st_size > _LARGEST:
            return None
        if path not in self.contents:
            self.contents[path] = file.read_bytes()
            if file.suffix == ".html":
                self.contents[path] = self._with_live_links(path).encode()
        return f"{FOLDER}/{path}"

    def _with_live_links(self, path: str) -> str:
        """A page without the links that would be dead; the targets of the others are added."""

        def kept(link: re.Match[str]) -> str:
            target = posixpath.normpath(posixpath.join(posixpath.dirname(path), link[2]))
            return link[1] if self.add(target) is None else link[0]

        return _LOCAL_LINK.sub(kept, self.contents[path].decode())

    def copy(self, target: str | Path) -> None:
        """Write all of them into the folder FOLDER below `target`."""
        for path, content in self.contents.items():
            place = Path(target, FOLDER, path)
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(content)
