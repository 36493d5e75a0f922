"""Numbers that stand in the text of the article itself: there should be none but those of a short, reviewed list.

A number of a result gets into the text through a key of values.typ. What is scanned here is all the rest of the
typst sources: prose, alternative text, captions. Left out are keys and paths (strings handed to the functions that
print values or load files), labels and references, comments, layout (numbers with a unit of length, widths), and single
digits inside mathematics, which are coefficients and indices.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

_KEYED = re.compile(
    r"(?:(?<=\bn\()|(?<=\bv\()|(?<=\bwords\()|(?<=\bjudged\()|(?<=\bimage\()|(?<=\binclude )|(?<=\bimport ))"
    r"[^)\n]*?\"[^\"]*\""
)
_PATH = re.compile(r'results \+ "[^"]*"|studies \+ "[^"]*"|at\("[^"]*"\)')
_MASKED = (
    re.compile(r"(?<!:)//[^\n]*"),
    _KEYED,
    _PATH,
    re.compile(r"<[a-z][a-z0-9-]*>|@[a-z][a-z0-9-]*"),
    re.compile(r"\b(?:width|size): ?[\d.]+(?:%|pt|em|mm|cm)|\b[\d.]+(?:pt|em|mm|cm|fr)\b"),
    re.compile(r"\$[^$]*\$"),
)
_MATH = re.compile(r"\$[^$]*\$")
_NUMBER = re.compile(r"(?<![\w.])[−-]?\d[\d.,\u2009]*\d|(?<![\w.])\d")
_LONG = re.compile(r"(?<![\w.])\d+\.\d+|(?<![\w.])\d{2,}")
_WORD = re.compile(
    r"\b(?:three|four|five|six|seven|eight|nine|ten|eleven|twelve|dozen|twenty|thirty|forty|fifty|hundred|thousand|million)\b",
    re.IGNORECASE,
)


@dataclass(frozen=True)
class Typed:
    """A number in the sources: file, line (from 1), the number, and the line's text."""

    file: str
    line: int
    number: str
    text: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.number!r} in {self.text.strip()!r}"


@cache
def typed_numbers(file: str, source: str) -> tuple[Typed, ...]:
    """All numbers typed in a typst source, spelled ones from three on as well, in the order of the text."""
    bare = source
    for pattern in _MASKED:
        bare = pattern.sub(_blank, bare)
    spoken = re.sub(r'"[^"\n]*"', _blank, bare)  # words in alternative text read an equation aloud
    found = [(match.start(), match[0]) for match in _NUMBER.finditer(bare)]
    found += [(match.start(), match[0]) for match in _WORD.finditer(spoken)]
    for formula in _MATH.finditer(source):
        found += [(formula.start() + m.start(), m[0]) for m in _LONG.finditer(formula[0])]
    lines = source.splitlines()
    typed: list[Typed] = []
    for start, number in sorted(found):
        line = source.count("\n", 0, start)
        typed.append(Typed(file, line + 1, number, lines[line]))
    return tuple(typed)


def not_excused(
    typed: Sequence[Typed], exceptions: Sequence[Mapping[str, str]]
) -> tuple[list[Typed], list[Mapping[str, str]]]:
    """The numbers that no exception covers, and the exceptions that cover none.

    exceptions : each with `text`, in which the number stands and which stands in its line, and optionally `file`.
    """
    used: list[Mapping[str, str]] = []
    left = []
    for number in typed:
        excuse = next((e for e in exceptions if _covers(e, number)), None)
        if excuse is None:
            left.append(number)
        elif excuse not in used:
            used.append(excuse)
    return left, [e for e in exceptions if e not in used]


def _covers(exception: Mapping[str, str], number: Typed) -> bool:
    return (
        exception.get("file", number.file) == number.file
        and exception["text"] in number.text
        and number.number in exception["text"]
    )


def _blank(match: re.Match[str]) -> str:
    return re.sub(r"[^\n]", " ", match[0])
