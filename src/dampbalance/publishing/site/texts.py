"""Cuts Markdown into sections and resolves its links to files of the project."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import dropwhile, groupby, takewhile

SCHEME = "project:"
"""Prefix of a link to a file of the project, followed by the path from the root."""

_HEADING = re.compile(r"(#{1,6})\s+(.+?)\s*$")
_FENCE = re.compile(r"\s*(`{3,}|~{3,})")
_COMMENT = re.compile(r"^<!--.*?-->\n?", re.MULTILINE | re.DOTALL)
_LINK = re.compile(
    r"(`+)(?:(?!\1).)+?\1|(?P<before>(?P<picture>!?)\[[^\[\]]*\]\()(?P<target>[^()\s]+)\)",
    re.DOTALL,
)
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

    new : (target, whether the target is a picture) → new target.
    """

    def replaced(link: re.Match[str]) -> str:
        if not link["target"]:
            return link[0]
        return f"{link['before']}{new(link['target'], bool(link['picture']))})"

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
