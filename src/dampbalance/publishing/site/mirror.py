"""Files of the project that pages link to, as they lie in the project: the site has them in the folder `files`.

A page of results (HTML) keeps those of its links that lead to other small files; from the others the link is taken, not
the words.
"""

from __future__ import annotations

import posixpath
import re
import shutil
from pathlib import Path

FOLDER = "files"
_LARGEST = 4_000_000  # bytes of a file that is copied
_LOCAL_LINK = re.compile(r"""(?<=<a)([^>]*?)\shref="(?![a-z]+:|#)([^"#]*)(?:#[^"]*)?"(?=[^>]*>)""")


class Mirror:
    """What a site shows of the files of a project: paths from its root on, added one by one and copied at the end."""

    def __init__(self, root: str | Path) -> None:
        self.root = Path(root)
        self.paths: set[str] = set()

    def add(self, path: str) -> str | None:
        """Where the site has that file, from its own root on; None where there is no such file, or a large one."""
        file = self.root / path
        if path.startswith("..") or not file.is_file() or file.stat().st_size > _LARGEST:
            return None
        if path not in self.paths:
            self.paths.add(path)
            if file.suffix == ".html":
                for target in _LOCAL_LINK.finditer(file.read_text(encoding="utf-8")):
                    self.add(_from(path, target[2]))
        return f"{FOLDER}/{path}"

    def copy(self, target: str | Path) -> None:
        """Copy all of them into the folder FOLDER below `target`."""
        for path in sorted(self.paths):
            place = Path(target) / FOLDER / path
            place.parent.mkdir(parents=True, exist_ok=True)
            if place.suffix == ".html":
                text = (self.root / path).read_text(encoding="utf-8")
                place.write_text(self._pruned(text, path), encoding="utf-8", newline="\n")
            else:
                shutil.copyfile(self.root / path, place)

    def _pruned(self, text: str, path: str) -> str:
        """A page without the links that would be dead."""

        def kept(found: re.Match[str]) -> str:
            return found[0] if _from(path, found[2]) in self.paths else found[1]

        return _LOCAL_LINK.sub(kept, text)


def _from(path: str, target: str) -> str:
    """The path, from the root on, of what a page links to."""
    return posixpath.normpath(posixpath.join(posixpath.dirname(path), target))
