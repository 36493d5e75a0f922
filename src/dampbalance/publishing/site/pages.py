"""Templates of `paper/site` → pages for Sphinx, with what each of them shows of the project's texts.

A page is Markdown and a template of Jinja: `{{ text("config/README.md") }}` stands for a whole text of the project,
`{{ section("README.md", "Rebuild it") }}` for what one of its sections says, without its heading. The texts stay where
they are; their links are led to the page that shows what they mean, or to a copy of the file.
"""

from __future__ import annotations

import posixpath
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import jinja2

from . import texts
from .mirror import Mirror

FILE = "copied:"
"""How a link begins that leads to a copied file; Sphinx leaves the rest of it as it is."""

EXTRA = "extra"
"""Folder beside the pages for what Sphinx copies as it is."""


class SiteError(ValueError):
    """A page that cannot be made; the message names the page, and what is wrong with it."""


@dataclass
class Placed:
    """Where the texts of the project are shown.

    whole : path → page.   parts : (path, anchor) → (page, anchor there, "" for its top).
    """

    whole: dict[str, str] = field(default_factory=dict)
    parts: dict[tuple[str, str], tuple[str, str]] = field(default_factory=dict)

    def page_of(self, path: str, place: str) -> tuple[str, str] | None:
        """The page that shows a text, or the part of it with that anchor, and the anchor there."""
        if (path, place) in self.parts:
            return self.parts[path, place]
        if path in self.whole:
            return self.whole[path], place
        return None


class Pages:
    """The pages of a site, made from the templates in a folder of the project."""

    def __init__(self, root: str | Path, folder: str, functions: Mapping[str, Any]) -> None:
        self.root, self.folder, self.functions = Path(root), folder, functions
        self.placed, self.mirror = Placed(), Mirror(root)

    def made(self) -> dict[str, str]:
        """Page, by its path below the folder, → its Markdown. Raises SiteError for a page that cannot be made."""
        names = sorted(
            path.relative_to(self.root / self.folder).as_posix()
            for path in (self.root / self.folder).rglob("*.md")
        )
        rendered = {name: self._rendered(name) for name in names}
        return {name: self._linked(name, text) for name, text in rendered.items()}

    def _rendered(self, name: str) -> str:
        environment = jinja2.Environment(
            loader=jinja2.FileSystemLoader(self.root / self.folder),
            autoescape=False,  # Markdown, of nothing but files of the project
            undefined=jinja2.StrictUndefined,
            trim_blocks=True,
            lstrip_blocks=True,
            keep_trailing_newline=True,
        )
        given: dict[str, Callable[..., Any]] = {
            "text": lambda path: self._text(name, path),
            "section": lambda path, title, level=0, inner=True: self._section(
                name, path, title, level, inner
            ),
            "there": lambda path: (self.root / path).is_file(),
        }
        try:
            return environment.get_template(name).render(**given, **self.functions)
        except jinja2.TemplateError as error:
            raise SiteError(f"{self.folder}/{name}: {error}") from error

    def _sections(self, path: str) -> list[texts.Section]:
        text = (self.root / path).read_text(encoding="utf-8")
        return texts.sections(texts.of_project(text, posixpath.dirname(path)))

    def _text(self, page: str, path: str) -> str:
        """A whole text, its title that of the page."""
        if path in self.placed.whole:
            raise SiteError(f"{self.folder}/{page}: {path} is on {self.placed.whole[path]} already")
        self.placed.whole[path] = page
        return texts.written(self._sections(path))

    def _section(self, page: str, path: str, title: str, level: int, inner: bool) -> str:
        """What a section of a text says; for the title "", what stands before the first heading below that of the text.

        level : of its heading here; 0 for none.   inner : whether the sections inside it are shown, too.
        """
        found = self._sections(path)
        if not title:
            self.placed.parts[path, ""] = (page, "")
            return texts.written([texts.Section(0, "", found[0].body)])
        try:
            first, *others = texts.with_inner(found, title)
        except KeyError:
            known = ", ".join(repr(section.title) for section in found)
            raise SiteError(
                f"{self.folder}/{page}: {path} has no section {title!r}; it has {known}"
            ) from None
        if (path, first.anchor) in self.placed.parts:
            where = self.placed.parts[path, first.anchor][0]
            raise SiteError(f"{self.folder}/{page}: {title!r} of {path} is on {where} already")
        others = others if inner else []
        self.placed.parts[path, first.anchor] = (page, first.anchor if level else "")
        self.placed.parts |= {(path, one.anchor): (page, one.anchor) for one in others}
        if not level:
            others = [replace(one, level=one.level - first.level + 1) for one in others]
            return texts.written([replace(first, level=0), *others])
        return texts.written([first, *others], shift=level - first.level)

    def _linked(self, name: str, text: str) -> str:
        """The page with its links to files of the project led to pages, or to copies."""

        def led(target: str, picture: bool) -> str:
            if not target.startswith(texts.SCHEME):
                return target
            path, _, place = target.removeprefix(texts.SCHEME).partition("#")
            for known in (path, posixpath.join(path, "README.md")):
                if found := self.placed.page_of(known, place):
                    page = posixpath.relpath(found[0], posixpath.dirname(name) or ".")
                    return f"{page}#{found[1]}" if found[1] else page
            copied = self.mirror.add(path)
            if copied is None:
                raise SiteError(
                    f"{self.folder}/{name}: a link leads to {path}, which is on no page and no small file"
                )
            up = "../" * name.count("/")
            return f"{up}{EXTRA}/{copied}" if picture else f"{FILE}{up}{copied}"

        return texts.relinked(text, led)
