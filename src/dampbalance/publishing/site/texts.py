"""Markdown cut into its sections, with links that say which file of the project they mean."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import dropwhile, groupby, takewhile

SCHEME = "project:"
"""How a link begins that names a file of the project by its path from the root."""

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
    """A heading of a text and what stands below it, up to the next heading of any level.

    level : 1 to 6; 0 for what stands before the first heading.   title : as written.   body : lines below it.
    """

    level: int
    title: str
    body: str

    @property
    def anchor(self) -> str:
        """The name of the heading in links, as repositories on the web and Sphinx's reader of Markdown form it."""
        return _NOT_IN_AN_ANCHOR.sub("", self.title.strip().lower().replace(" ", "-"))


def sections(text: str) -> list[Section]:
    """A text as its sections, in their order; without comments, and without the empty one that would be the first."""
    parts: list[tuple[int, str, list[str]]] = [(0, "", [])]
    for in_code, line in _lines(_COMMENT.sub("", text)):
        if (heading := _HEADING.match(line)) and not in_code:
            parts.append((len(heading[1]), heading[2], []))
        else:
            parts[-1][2].append(line)
    cut = [Section(level, title, "".join(lines).strip("\n")) for level, title, lines in parts]
    return cut if cut[0].body else cut[1:]


def with_inner(text: list[Section], title: str) -> list[Section]:
    """The section of that title with those inside it. Raises KeyError where there is none of that title."""
    found = list(dropwhile(lambda one: one.title != title, text))
    if not found:
        raise KeyError(title)
    first, *after = found
    return [first, *takewhile(lambda one: one.level > first.level, after)]


def written(text: list[Section]) -> str:
    """Sections as Markdown."""
    parts: list[str] = []
    for one in text:
        parts += [f"{'#' * one.level} {one.title}"] if one.level else []
        parts += [one.body] if one.body else []
    return "\n\n".join(parts) + "\n"


def of_project(text: str, folder: str) -> str:
    """A text with its links to files as `project:PATH`, from the root of the project on.

    folder : of the text, from the root on; "" for the root.   Links to addresses and within the text stay.
    """

    def named(target: str, picture: bool) -> str:
        if re.match(r"[a-z]+:|#", target):
            return target
        path, mark, place = target.partition("#")
        return f"{SCHEME}{posixpath.normpath(posixpath.join(folder, path))}{mark}{place}"

    return relinked(text, named)


def relinked(text: str, new: Callable[[str, bool], str]) -> str:
    """A text with the target of every link and picture replaced; what stands in code stays.

    new : (target, whether it is that of a picture) → target.
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
    """The lines of a text with their ends, each with whether it belongs to a fenced block of code."""
    fence = ""
    for line in text.splitlines(keepends=True):
        mark = _FENCE.match(line)
        yield bool(fence or mark), line
        if mark and mark[1].startswith(fence):
            fence = "" if fence else mark[1]
