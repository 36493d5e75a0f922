"""Renders the templates of `paper/site` to pages for Sphinx and inserts the texts of the project that they show.

A page is a Jinja template in Markdown: `{{ text("config/README.md") }}` inserts a whole text of the project,
`{{ section("README.md", "Rebuild it") }}` one of its sections without the heading. The links of an inserted text are
rewritten to the page that shows their target, or to a copy of the file.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import jinja2

from ..markdown import templates
from . import texts

FILE = "copied:"
"""Prefix of a link to a copied file; Sphinx does not change the rest of such a link."""

EXTRA = "extra"
"""Folder next to the pages that Sphinx copies unchanged."""

FOLDER = "files"
_LARGEST = 4_000_000  # bytes of a file that is copied
_LOCAL_LINK = re.compile(r"""(?<=<a)([^>]*?)\shref="(?![a-z]+:|#)([^"#]*)(?:#[^"]*)?"(?=[^>]*>)""")


class SiteError(ValueError):
    """A page cannot be rendered; the message names the page and the problem."""


class Pages:
    """The pages of a site, made from the templates in a folder of the project.

    whole : text → the page that shows all of it.   parts : (text, anchor) → (page, anchor there, "" for its top).
    """

    def __init__(self, root: str | Path, folder: str, functions: Mapping[str, Any]) -> None:
        self.root, self.folder, self.functions = Path(root), folder, functions
        self.whole: dict[str, str] = {}
        self.parts: dict[tuple[str, str], tuple[str, str]] = {}
        self.mirror = Mirror(root)

    def made(self) -> dict[str, str]:
        """The Markdown of each page, by its path below the folder. Raises SiteError if a page cannot be rendered."""
        pages = templates(jinja2.FileSystemLoader(self.root / self.folder))
        rendered = {}
        for name in sorted(pages.list_templates(extensions=["md"])):
            given = {
                "text": partial(self._text, name),
                "section": partial(self._section, name),
                "there": lambda path: (self.root / path).is_file(),
            }
            try:
                rendered[name] = pages.get_template(name).render(**given, **self.functions)
            except jinja2.TemplateError as error:
                raise SiteError(f"{self.folder}/{name}: {error}") from error
        return {
            name: texts.relinked(text, partial(self._led, name)) for name, text in rendered.items()
        }

    def _sections(self, path: str) -> list[texts.Section]:
        text = (self.root / path).read_text(encoding="utf-8")
        return texts.sections(texts.of_project(text, posixpath.dirname(path)))

    def _text(self, page: str, path: str) -> str:
        """A whole text, whose title becomes that of the page."""
        if path in self.whole:
            raise SiteError(f"{self.folder}/{page}: {path} is on {self.whole[path]} already")
        self.whole[path] = page
        return texts.written(self._sections(path))

    def _section(self, page: str, path: str, title: str, level: int = 0, inner: bool = True) -> str:
        """A section of a text; for the title "", the opening of the text up to its first heading below the title.

        level : the level of its heading on the page; 0 for no heading.   inner : whether to include its subsections.
        """
        known = self._sections(path)
        chosen = texts.with_inner(known, title) if title else known[:1]
        if not chosen:
            titles = ", ".join(repr(section.title) for section in known)
            raise SiteError(
                f"{self.folder}/{page}: {path} has no section {title!r}; it has {titles}"
            )
        first, others = chosen[0], chosen[1:] if inner else []
        anchor = first.anchor if title else ""
        if title and (path, anchor) in self.parts:
            where = self.parts[path, anchor][0]
            raise SiteError(f"{self.folder}/{page}: {title!r} of {path} is on {where} already")
        self.parts[path, anchor] = (page, anchor if level else "")
        self.parts |= {(path, one.anchor): (page, one.anchor) for one in others}
        down = (level or 1) - first.level
        others = [replace(one, level=one.level + down) for one in others]
        return texts.written([replace(first, level=level), *others])

    def _led(self, page: str, target: str, picture: bool) -> str:
        """The target of a link; for one to a file of the project, the page that shows the file, or its copy."""
        if not target.startswith(texts.SCHEME):
            return target
        path, _, place = target.removeprefix(texts.SCHEME).partition("#")
        for text in (path, posixpath.join(path, "README.md")):
            if (text, place) in self.parts or text in self.whole:
                shown, anchor = self.parts.get((text, place)) or (self.whole[text], place)
                address = posixpath.relpath(shown, posixpath.dirname(page) or ".")
                return f"{address}#{anchor}" if anchor else address
        copied = self.mirror.add(path)
        if copied is None:
            raise SiteError(
                f"{self.folder}/{page}: a link leads to {path}, which is on no page and no small file"
            )
        up = "../" * page.count("/")
        return f"{up}{EXTRA}/{copied}" if picture else f"{FILE}{up}{copied}"


class Mirror:
    """The files of a project to which pages link, by path from the root; added one by one and copied at the end.

    An HTML page of results keeps its links to other small files; its other links are replaced by their text.
    """

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
