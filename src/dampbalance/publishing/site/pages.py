"""Templates of `paper/site` → pages for Sphinx, with what each of them shows of the project's texts.

A page is Markdown and a template of Jinja: `{{ text("config/README.md") }}` stands for a whole text of the project,
`{{ section("README.md", "Rebuild it") }}` for what one of its sections says, without its heading. The texts stay where
they are; their links are led to the page that shows what they mean, or to a copy of the file.
"""

from __future__ import annotations

import posixpath
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
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
        """Page, by its path below the folder, → its Markdown. Raises SiteError for a page that cannot be made."""
        templates = jinja2.Environment(
            loader=jinja2.FileSystemLoader(self.root / self.folder),
            autoescape=False,  # Markdown, of nothing but files of the project
            undefined=jinja2.StrictUndefined,
            trim_blocks=True,
            lstrip_blocks=True,
            keep_trailing_newline=True,
        )
        rendered = {}
        for name in sorted(templates.list_templates(extensions=["md"])):
            given = {
                "text": partial(self._text, name),
                "section": partial(self._section, name),
                "there": lambda path: (self.root / path).is_file(),
            }
            try:
                rendered[name] = templates.get_template(name).render(**given, **self.functions)
            except jinja2.TemplateError as error:
                raise SiteError(f"{self.folder}/{name}: {error}") from error
        return {
            name: texts.relinked(text, partial(self._led, name)) for name, text in rendered.items()
        }

    def _sections(self, path: str) -> list[texts.Section]:
        text = (self.root / path).read_text(encoding="utf-8")
        return texts.sections(texts.of_project(text, posixpath.dirname(path)))

    def _text(self, page: str, path: str) -> str:
        """A whole text, its title that of the page."""
        if path in self.whole:
            raise SiteError(f"{self.folder}/{page}: {path} is on {self.whole[path]} already")
        self.whole[path] = page
        return texts.written(self._sections(path))

    def _section(self, page: str, path: str, title: str, level: int = 0, inner: bool = True) -> str:
        """What a section of a text says; for the title "", what stands before the first heading below that of the text.

        level : of its heading here; 0 for none.   inner : whether the sections inside it are shown, too.
        """
        known = self._sections(path)
        if not title:
            self.parts[path, ""] = (page, "")
            return texts.written([replace(known[0], level=0)])
        try:
            first, *others = texts.with_inner(known, title)
        except KeyError:
            titles = ", ".join(repr(section.title) for section in known)
            raise SiteError(
                f"{self.folder}/{page}: {path} has no section {title!r}; it has {titles}"
            ) from None
        if (path, first.anchor) in self.parts:
            where = self.parts[path, first.anchor][0]
            raise SiteError(f"{self.folder}/{page}: {title!r} of {path} is on {where} already")
        others = others if inner else []
        self.parts[path, first.anchor] = (page, first.anchor if level else "")
        self.parts |= {(path, one.anchor): (page, one.anchor) for one in others}
        down = (level or 1) - first.level
        others = [replace(one, level=one.level + down) for one in others]
        return texts.written([replace(first, level=level), *others])

    def _led(self, page: str, target: str, picture: bool) -> str:
        """Where a link of a page to a file of the project leads: to a page that shows it, or to a copy."""
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
