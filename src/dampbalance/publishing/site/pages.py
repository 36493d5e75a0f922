"""Renders the templates of `paper/site` to pages for Sphinx and inserts the texts of the project that they show.

A page is a Jinja template in Markdown: `{{ text("config/README.md") }}` inserts a whole text of the project,
`{{ section("README.md", "Rebuild it") }}` one of its sections without the heading. The links of an inserted text are
rewritten to the page that shows their target, or to a copy of the file.
"""

from __future__ import annotations

import posixpath
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import jinja2

from ..markdown import templates
from . import texts
from .mirror import Mirror

FILE = "copied:"
"""Prefix of a link to a copied file; Sphinx does not change the rest of such a link."""

EXTRA = "extra"
"""Folder next to the pages that Sphinx copies unchanged."""


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
