"""Renders the templates of `paper/site` to pages for Sphinx and inserts the texts of the project that they show.

A page is a Jinja template in Markdown: `{{ text("config/README.md") }}` inserts a whole text of the project,
`{{ section("README.md", "Rebuild it") }}` one of its sections without the heading. The links of an inserted text are
rewritten to the page that shows their target, or to a copy of the file.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from itertools import dropwhile, groupby, takewhile
from pathlib import Path
from typing import Any

import jinja2

from ..words import templates

SCHEME = "project:"
"""Prefix of a link to a file of the project, followed by the path from the root."""

_HEADING = re.compile(r"(#{1,6})\s+(.+?)\s*$")
_FENCE = re.compile(r"\s*(`{3,}|~{3,})")
_COMMENT = re.compile(r"^<!--.*?-->\n?", re.MULTILINE | re.DOTALL)
_LINK = re.compile(
    r"(`+)(?:(?!\1).)+?\1|(?P<before>(?P<picture>!?)\[[^\[\]]*\]\()(?P<target>[^()\s]+)\)",
    re.DOTALL,
)
_PATH = re.compile(r"\[`[^`]*[/.][^`]*`\]\(")  # a link under the name of a file or folder
_PAGE = re.compile(r"[^:]*\.md(?:#.*)?")
_NOT_IN_AN_ANCHOR = re.compile(r"[^\w\- ]")


@dataclass(frozen=True, slots=True)
class Section:
    """A heading of a text with the lines below it, up to the next heading of any level.

    level : 1 to 6; 0 for the lines before the first heading.   title : as written.   body : the lines below it.
    """

    level: int
    title: str
    body: str

    @property
    def anchor(self) -> str:
        """The anchor of the heading in links, formed as code hosts and MyST form it."""
        return _NOT_IN_AN_ANCHOR.sub("", self.title.strip().lower().replace(" ", "-"))


def sections(text: str) -> list[Section]:
    """The sections of a text in their order, without comments; an empty first section is omitted."""
    parts: list[tuple[int, str, list[str]]] = [(0, "", [])]
    for in_code, line in _lines(_COMMENT.sub("", text)):
        if (heading := _HEADING.match(line)) and not in_code:
            parts.append((len(heading[1]), heading[2], []))
        else:
            parts[-1][2].append(line)
    cut = [Section(level, title, "".join(lines).strip("\n")) for level, title, lines in parts]
    return cut if cut[0].body else cut[1:]


def with_inner(text: list[Section], title: str) -> list[Section]:
    """The section of that title with its subsections; none if no section has that title."""
    found = list(dropwhile(lambda one: one.title != title, text))
    return found[:1] + list(takewhile(lambda one: one.level > found[0].level, found[1:]))


def written(text: list[Section]) -> str:
    """Sections as Markdown."""
    headed = ((f"{'#' * one.level} {one.title}" * bool(one.level), one.body) for one in text)
    return "\n\n".join(part for parts in headed for part in parts if part) + "\n"


def of_project(text: str, folder: str) -> str:
    """A text with its links to files rewritten as `project:PATH`, the path taken from the root of the project.

    folder : the folder of the text, from the root; "" for the root.   Links to URLs and within the text are kept.
    """

    def named(target: str, picture: bool) -> str:
        if re.match(r"[a-z]+:|#", target):
            return target
        path, mark, place = target.partition("#")
        return f"{SCHEME}{posixpath.normpath(posixpath.join(folder, path))}{mark}{place}"

    return relinked(text, named)


def relinked(text: str, new: Callable[[str, bool], str]) -> str:
    """A text with the target of every link and picture replaced, except in code.

    A link to a page under the name of a file or folder, which a reader may not have, takes the page's title.
    new : (target, whether the target is a picture) → new target.
    """

    def replaced(link: re.Match[str]) -> str:
        if not link["target"]:
            return link[0]
        target = new(link["target"], bool(link["picture"]))
        titled = _PAGE.fullmatch(target) and _PATH.fullmatch(link["before"])
        return f"{'[](' if titled else link['before']}{target})"

    blocks = (
        (in_code, "".join(line for _, line in lines))
        for in_code, lines in groupby(_lines(text), key=lambda line: line[0])
    )
    return "".join(block if in_code else _LINK.sub(replaced, block) for in_code, block in blocks)


def _lines(text: str) -> Iterator[tuple[bool, str]]:
    """The lines of a text, including their line ends, each with whether it belongs to a fenced code block."""
    fence = ""
    for line in text.splitlines(keepends=True):
        mark = _FENCE.match(line)
        yield bool(fence or mark), line
        if mark and mark[1].startswith(fence):
            fence = "" if fence else mark[1]


FILE = "copied:"
"""Prefix of a link to a copied file; Sphinx does not change the rest of such a link."""

EXTRA = "extra"
"""Folder next to the pages that Sphinx copies unchanged."""

FOLDER = "files"
_AT_ONCE = 2  # pages that are rendered
_LARGEST = 4_000_000  # bytes of a file that is copied
_LOCAL_LINK = re.compile(r"""(?<=<a)([^>]*?)\shref="(?![a-z]+:|#)([^"#]*)(?:#[^"]*)?"(?=[^>]*>)""")


class SiteError(ValueError):
    """A page cannot be rendered; the message names the page and the problem."""


class Pages:
    """The pages of a site, made from the templates in a folder of the project.

    whole : text → the page that shows all of it.   parts : (text, anchor) → (page, anchor there, "" for its top).
    copies : path → contents of the files to which pages link.
    """

    def __init__(self, root: str | Path, folder: str, functions: Mapping[str, Any]) -> None:
        self.root, self.folder, self.functions = Path(root), folder, functions
        self.whole: dict[str, str] = {}
        self.parts: dict[tuple[str, str], tuple[str, str]] = {}
        self.copies: dict[str, bytes] = {}

    def made(self) -> dict[str, str]:
        """The Markdown of each page, by its path below the folder. Raises SiteError if a page cannot be rendered."""
        pages = templates(jinja2.FileSystemLoader(self.root / self.folder))
        names = sorted(pages.list_templates(extensions=["md"]))
        with ThreadPoolExecutor(_AT_ONCE) as threads:  # some wait for commands
            rendered = list(threads.map(partial(self._rendered, pages), names))
        texts = zip(names, rendered, strict=True)
        return {name: relinked(text, partial(self._led, name)) for name, text in texts}

    def _rendered(self, pages: jinja2.Environment, name: str) -> str:
        given = {
            "text": partial(self._text, name),
            "section": partial(self._section, name),
            "there": self._there,
            "picture": self._picture,
        }
        try:
            return pages.get_template(name).render(**given, **self.functions)
        except (jinja2.TemplateError, SiteError) as error:
            raise SiteError(f"{self.folder}/{name}: {error}") from error

    def _there(self, path: str) -> bool:
        return (self.root / path).is_file()

    def _picture(self, path: str, words: str) -> str:
        """A picture among the results, with what it shows in words; nothing where it was not made."""
        return f"![{words}]({SCHEME}{path})" if self._there(path) else ""

    def _sections(self, path: str) -> list[Section]:
        text = (self.root / path).read_text(encoding="utf-8")
        return sections(of_project(text, posixpath.dirname(path)))

    def _text(self, page: str, path: str) -> str:
        """A whole text, whose title becomes that of the page."""
        if path in self.whole:
            raise SiteError(f"{path} is on {self.whole[path]} already")
        self.whole[path] = page
        return written(self._sections(path))

    def _section(self, page: str, path: str, title: str, level: int = 0, inner: bool = True) -> str:
        """A section of a text; for the title "", the opening of the text up to its first heading below the title.

        level : the level of its heading on the page; 0 for no heading.   inner : whether to include its subsections.
        """
        known = self._sections(path)
        chosen = with_inner(known, title) if title else known[:1]
        if not chosen:
            titles = ", ".join(repr(section.title) for section in known)
            raise SiteError(f"{path} has no section {title!r}; it has {titles}")
        first, others = chosen[0], chosen[1:] if inner else []
        anchor = first.anchor if title else ""
        if title and (path, anchor) in self.parts:
            where = self.parts[path, anchor][0]
            raise SiteError(f"{title!r} of {path} is on {where} already")
        self.parts[path, anchor] = (page, anchor if level else "")
        self.parts |= {(path, one.anchor): (page, one.anchor) for one in others}
        down = (level or 1) - first.level
        others = [replace(one, level=one.level + down) for one in others]
        return written([replace(first, level=level), *others])

    def _led(self, page: str, target: str, picture: bool) -> str:
        """The target of a link; for one to a file of the project, the page that shows the file, or its copy."""
        if not target.startswith(SCHEME):
            return target
        path, _, place = target.removeprefix(SCHEME).partition("#")
        for text in (path, posixpath.join(path, "README.md")):
            if (text, place) in self.parts or text in self.whole:
                shown, anchor = self.parts.get((text, place)) or (self.whole[text], place)
                address = posixpath.relpath(shown, posixpath.dirname(page) or ".")
                return f"{address}#{anchor}" if anchor else address
        copied = self.copied(path)
        if copied is None:
            raise SiteError(
                f"{self.folder}/{page}: a link leads to {path}, which is on no page and no small file"
            )
        up = "../" * page.count("/")
        return f"{up}{EXTRA}/{copied}" if picture else f"{FILE}{up}{copied}"

    def copied(self, path: str) -> str | None:
        """The path of the copy of a file, from the root of the site; None if there is no such file or it is too large.

        An HTML page of results keeps its links to other small files; its other links are replaced by their text.
        """
        file = self.root / path
        if path.startswith("..") or not file.is_file() or file.stat().st_size > _LARGEST:
            return None

        def kept(link: re.Match[str]) -> str:
            target = posixpath.normpath(posixpath.join(posixpath.dirname(path), link[2]))
            return link[1] if self.copied(target) is None else link[0]

        if path not in self.copies:
            self.copies[path] = file.read_bytes()
            if file.suffix == ".html":
                live = _LOCAL_LINK.sub(kept, self.copies[path].decode())
                self.copies[path] = live.encode()
        return f"{FOLDER}/{path}"

    def write_copies(self, target: str | Path) -> None:
        """Write all of them into the folder FOLDER below `target`."""
        for path, content in self.copies.items():
            place = Path(target, FOLDER, path)
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(content)
