"""Docstrings of this project as reStructuredText, the markup that Sphinx reads.

A paragraph that begins like `m : mass, kg.   c : viscous damping, N s/m.` describes arguments; several on one line are
separated by three blanks. Indented lines are equations or tables and are shown unchanged; backticks mark code.
Everything else is text, whatever characters it contains: |x|, x*, F_k.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from textwrap import dedent, indent

_NAME = r"\*{0,2}[A-Za-z_φω][\w.\[\]]*"
_ARGUMENT = re.compile(rf"(?:^|(?<=\n)|(?<= {{3}}))({_NAME}(?:, {_NAME})*) : ")
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
    """The lines of a docstring as lines of reStructuredText; its arguments become a definition list."""
    made: list[str] = []
    for paragraph in _paragraphs(lines):
        text = "\n".join(paragraph).rstrip()
        block = paragraph
        if text.startswith(" "):
            block = [".. code-block:: none", "", *indent(dedent(text), "    ").split("\n")]
        elif _ARGUMENT.match(text):
            _, *parts = _ARGUMENT.split(text)
            pairs = zip(parts[::2], map(_line, parts[1::2]), strict=True)
            block = [line for names, words in pairs for line in (f"``{names}``", f"    {words}")]
        elif _LIST.match(text):
            entries = (entry.split(" ", 1) for entry in re.split(rf"\n(?={_LIST.pattern})", text))
            block = [f"{mark} {_line(words)}" for mark, words in entries]
        elif not text.startswith(">>> "):
            block = _INLINE.sub(_marked, text).split("\n")
        made += [*block, ""]
    return made


def _paragraphs(lines: Iterable[str]) -> Iterator[list[str]]:
    """The paragraphs of a text, as lines; an indented one may contain empty lines and ends with the indentation."""
    block: list[str] = []
    for line in [*lines, "", "end"]:
        indented = bool(block) and block[0].startswith(" ")
        goes_on = line.startswith("  ") if indented else bool(line.strip())
        listed = block and (_ARGUMENT.match(block[0]) or _LIST.match(block[0]))
        starts_code = block and not indented and not listed and line.startswith("    ")
        if block and (starts_code or not (goes_on or (indented and not line.strip()))):
            yield block
            block = []
        if line.strip() or block:
            block.append(line)


def _line(text: str) -> str:
    """Text in one line, in which code and emphasis are marked up and all other characters are literal."""
    return _INLINE.sub(_marked, " ".join(text.split()))


def _marked(found: re.Match[str]) -> str:
    if found["mark"]:
        return f"\\{found[0]}"
    if found["stressed"]:
        stressed = re.sub(_MARK, r"\\\g<0>", found["stressed"])
        return rf"\ *{stressed}*\ "
    return rf"\ ``{found['code'] or found['name']}``\ "
