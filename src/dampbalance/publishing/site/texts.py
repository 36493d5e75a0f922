"""Markdown cut into its sections, with links that say which file of the project they mean."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass

SCHEME = "project:"
"""How a link begins that names a file of the project by its path from the root."""

_HEADING = re.compile(r"(#{1,6})\s+(.+?)\s*$")
_FENCE = re.compile(r"\s*(`{3,}|~{3,})")
_COMMENT = re.compile(r"^<!--.*?-->\n?", re.MULTILINE | re.DOTALL)
_LINK = re.compile(
    r"(`+)(?:(?!\1).)+?\1|(?P<before>(?P<picture>!?)\[[^\[\]]*\]\()(?P<target>[^()\s]+)\)",
    re.DOTALL,
)
_NOT_IN_A_NAME = re.compile(r"[^\w\- ]")


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
        """The name by which links know it."""
        return anchor(self.title)


def anchor(title: str) -> str:
    """The name of a heading in links, as repositories on the web and Sphinx's reader of Markdown form it."""
    return _NOT_IN_A_NAME.sub("", title.strip().lower().replace(" ", "-"))


def sections(text: str) -> list[Section]:
    """A text as its sections, in their order; without comments, and without the empty one that would be the first."""
    found: list[tuple[int, str, list[str]]] = [(0, "", [])]
    fence = ""
    for line in _COMMENT.sub("", text).splitlines():
        opening = _FENCE.match(line)
        if opening and (not fence or opening[1].startswith(fence)):
            fence = "" if fence else opening[1]
        heading = None if fence or opening else _HEADING.match(line)
        if heading:
            found.append((len(heading[1]), heading[2], []))
        else:
            found[-1][2].append(line)
    made = [Section(level, title, "\n".join(lines).strip("\n")) for level, title, lines in found]
    return made if made[0].body else made[1:]


def with_inner(text: list[Section], title: str) -> list[Section]:
    """The section of that title with those inside it. Raises KeyError where there is none of that title."""
    for start, first in enumerate(text):
        if first.title == title:
            inner = [first]
            for section in text[start + 1 :]:
                if section.level <= first.level:
                    break
                inner.append(section)
            return inner
    raise KeyError(title)


def written(text: list[Section], shift: int = 0) -> str:
    """Sections as Markdown, their headings moved down by so many levels (up, where it is negative)."""
    parts: list[str] = []
    for section in text:
        if section.level:
            parts.append(f"{'#' * max(1, section.level + shift)} {section.title}")
        if section.body:
            parts.append(section.body)
    return "\n\n".join(parts) + "\n"


def of_project(text: str, folder: str) -> str:
    """A text with its links to files as `project:PATH`, from the root of the project on.

    folder : of the text, from the root on; "" for the root.   Links to addresses and within the text stay.
    """

    def named(target: str, picture: bool) -> str:
        if re.match(r"[a-z]+:", target) or target.startswith("#"):
            return target
        path, mark, place = target.partition("#")
        return f"{SCHEME}{posixpath.normpath(posixpath.join(folder, path))}{mark}{place}"

    return relinked(text, named)


def relinked(text: str, new: Callable[[str, bool], str]) -> str:
    """A text with the target of every link and picture replaced; what stands in code stays.

    new : (target, whether it is that of a picture) → target.
    """

    def replaced(found: re.Match[str]) -> str:
        if not found["target"]:
            return found[0]
        return f"{found['before']}{new(found['target'], bool(found['picture']))})"

    return "".join(
        part if is_code else _LINK.sub(replaced, part) for is_code, part in _blocks(text)
    )


def _blocks(text: str) -> Iterator[tuple[bool, str]]:
    """The text in stretches of lines: (whether it is a fenced block of code, the stretch)."""
    fence, lines = "", list[str]()
    for line in text.splitlines(keepends=True):
        mark = _FENCE.match(line)
        if mark and not fence:
            yield False, "".join(lines)
            fence, lines = mark[1], [line]
        elif mark and mark[1].startswith(fence):
            yield True, "".join([*lines, line])
            fence, lines = "", []
        else:
            lines.append(line)
    yield bool(fence), "".join(lines)
