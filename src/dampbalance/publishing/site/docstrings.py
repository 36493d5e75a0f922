"""Converts docstrings in the style of this project to reStructuredText, the markup that Sphinx reads.

A paragraph that begins like `m : mass, kg.   c : viscous damping, N s/m.` describes arguments; several on one line are
separated by three blanks. Indented lines are equations or tables and are shown unchanged; backticks mark code.
Everything else is text, whatever characters it contains: |x|, x*, F_k.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from textwrap import dedent, indent

_NAME = r"\*{0,2}[A-Za-z_φω][\w.\[\]]*"
_NAMES = rf"{_NAME}(?:, {_NAME})*"
_ARGUMENT = re.compile(rf"(?:^|(?<=\n)|(?<= {{3}}))({_NAMES}) : ")
_LIST = re.compile(r"(?:[-*]|\d+\.) ")
_MARK = r"[\\*`|_<]"
_INLINE = re.compile(
    r"(?P<ticks>`+)(?P<code>.+?)(?P=ticks)"
    r"|(?<![\w*])\*(?P<stressed>[^\s*](?:[^*]*[^\s*])?)\*(?![\w*])"
    r"|\b(?P<name>[A-Z]\w*Error|(?<=Raises )[A-Z]\w+|None|True|False|NaN)\b"
    rf"|(?P<mark>{_MARK})",
    re.DOTALL,
)


def markup(lines: Iterable[str]) -> list[str]:
    """The lines of a docstring as lines of reStructuredText."""
    made: list[str] = []
    for paragraph in _paragraphs(lines):
        made += [*_block(paragraph), ""]
    return made


def _paragraphs(lines: Iterable[str]) -> Iterator[list[str]]:
    """The paragraphs of a text, as lines; an indented one may contain empty lines and ends with the indentation."""
    block: list[str] = []
    for line in [*lines, "", "end"]:
        indented = bool(block) and block[0].startswith(" ")
        goes_on = line.startswith("  ") if indented else bool(line.strip())
        starts_code = not indented and block and line.startswith("    ") and not _is_argument(block)
        if block and (starts_code or not (goes_on or (indented and not line.strip()))):
            yield block
            block = []
        if line.strip() or block:
            block.append(line)


def _is_argument(block: list[str]) -> bool:
    return bool(_ARGUMENT.match(block[0])) or bool(_LIST.match(block[0]))


def _block(paragraph: list[str]) -> list[str]:
    text = "\n".join(paragraph).rstrip()
    if text.startswith(">>> "):
        return paragraph
    if text.startswith(" "):
        return [".. code-block:: none", "", *indent(dedent(text), "    ").split("\n")]
    if _ARGUMENT.match(text):
        return list(_arguments(text))
    if _LIST.match(text):
        return list(_listed(text))
    return _inline(text).split("\n")


def _arguments(text: str) -> Iterator[str]:
    """A definition list of arguments with their meanings."""
    _, *parts = _ARGUMENT.split(text)
    for names, meaning in zip(parts[::2], parts[1::2], strict=True):
        yield f"``{names}``"
        yield f"    {_inline(' '.join(meaning.split()))}"


def _listed(text: str) -> Iterator[str]:
    """A list with one entry for each mark at the beginning of a line."""
    for entry in re.split(r"\n(?=(?:[-*]|\d+\.) )", text):
        mark, words = entry.split(" ", 1)
        yield f"{mark} {_inline(' '.join(words.split()))}"


def _inline(text: str) -> str:
    """Text in which code and emphasis are marked up and all other characters are literal."""
    return _INLINE.sub(_set, text)


def _set(found: re.Match[str]) -> str:
    if found["mark"]:
        return f"\\{found[0]}"
    if found["stressed"]:
        stressed = re.sub(_MARK, r"\\\g<0>", found["stressed"])
        return rf"\ *{stressed}*\ "
    return rf"\ ``{found['code'] or found['name']}``\ "
