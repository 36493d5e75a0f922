"""Numbers that stand in the text of the article itself: there should be none but those of a short, reviewed list.

A number of a result gets into the text through a key of values.typ. What is scanned here is all the rest of the
typst sources: prose, alternative text, captions. Left out are keys and paths (strings handed to the functions that
print values or load files), labels and references, comments, layout (numbers with a unit of length, widths), and single
digits inside mathematics, which are coefficients and indices.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple

_MASKED = (
    r"(?<!:)//[^\n]*",
    r"(?:(?<=\b[nv]\()|(?<=\bwords\()|(?<=\bjudged\()|(?<=\bimage\()|(?<=\binclude )|(?<=\bimport ))"
    r"[^)\n]*?\"[^\"]*\"",
    r'results \+ "[^"]*"|studies \+ "[^"]*"|at\("[^"]*"\)',
    r"<[a-z][a-z0-9-]*>|@[a-z][a-z0-9-]*",
    r"\b(?:width|size): ?[\d.]+(?:%|pt|em|mm|cm)|\b[\d.]+(?:pt|em|mm|cm|fr)\b",
    r"\$[^$]*\$",
)
_NUMBER = r"(?<![\w.])[−-]?\d[\d.,\u2009]*\d|(?<![\w.])\d"
_LONG = r"(?<![\w.])\d+\.\d+|(?<![\w.])\d{2,}"
_WORD = (
    r"(?i)\b(?:three|four|five|six|seven|eight|nine|ten|eleven|twelve|dozen|twenty|thirty|forty|"
    r"fifty|hundred|thousand|million)\b"
)


class Typed(NamedTuple):
    """A number in the sources: file, line (from 1), the number, and the line's text."""

    file: str
    line: int
    number: str
    text: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.number!r} in {self.text.strip()!r}"


def typed_numbers(file: str, source: str) -> list[Typed]:
    """All numbers typed in a typst source, spelled ones from three on as well, in the order of the text."""
    bare = source
    for pattern in _MASKED:
        bare = re.sub(pattern, _blank, bare)
    spoken = re.sub(r'"[^"\n]*"', _blank, bare)  # words in alternative text read an equation aloud
    found = [(m.start(), m[0]) for m in (*re.finditer(_NUMBER, bare), *re.finditer(_WORD, spoken))]
    for formula in re.finditer(_MASKED[-1], source):
        found += [(formula.start() + m.start(), m[0]) for m in re.finditer(_LONG, formula[0])]
    lines = [(source.count("\n", 0, start), number) for start, number in sorted(found)]
    texts = source.splitlines()
    return [Typed(file, line + 1, number, texts[line]) for line, number in lines]


def not_excused(
    typed: Sequence[Typed], exceptions: Sequence[Mapping[str, str]]
) -> tuple[list[Typed], list[Mapping[str, str]]]:
    """The numbers that no exception covers, and the exceptions that cover none.

    exceptions : each with `text`, in which the number stands and which stands in its line, and optionally `file`.
    """
    excuses = [next((e for e in exceptions if _covers(e, number)), None) for number in typed]
    left = [number for number, excuse in zip(typed, excuses, strict=True) if excuse is None]
    return left, [e for e in exceptions if e not in excuses]


def _covers(exception: Mapping[str, str], number: Typed) -> bool:
    in_file = exception.get("file", number.file) == number.file
    return in_file and exception["text"] in number.text and number.number in exception["text"]


def _blank(match: re.Match[str]) -> str:
    return re.sub(r"[^\n]", " ", match[0])
