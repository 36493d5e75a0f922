"""Findings in words: templates with numbers as people write them, in the units and nouns of a coordinate.

A template has fields in braces. `{X:.3g mm}` is the number X in this form and unit; `{share:percent}`, `{p:chance}` and
the like are the forms of `_FORMS`; `{size:± µs}` is a value with its standard error, `{mass:4 kg}` a number with four
significant digits. A field that names no number is a word of the coordinate: `{displacement}` is an
angle of records that rotate, `{F_k}` a T_k, `{N/m}` a N m/rad. `[name?text|other]` is the text where the number of that
name is there and not zero, and the other text where it is not.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import PurePath
from typing import Any, Protocol

from ..law.terms import term
from ..model import UNITS
from ..project.wording import (
    change_text,
    factor,
    larger_by,
    listed,
    number_text,
    part,
    signed,
    with_error,
    with_unit,
    written,
)
from .finding import Finding
from .sentences import SENTENCES

_MOST_NAMES = 6  # of records in a sentence

_FIELD = re.compile(r"\{([^{}:]+)(?::([^{}]*))?\}")
_CHOICE = re.compile(r"\[(\w+)\?([^\[\]|]*)(?:\|([^\[\]]*))?\]")
_PER_SI = {
    **{"mm": 1e3, "µs": 1e6, "ppm": 1e6, "%": 100.0, "N/mm³": 1e-9, "µm/N": 1e6},
    "°": math.degrees(1.0),
}


class Vocabulary(Protocol):
    """The words of a coordinate (`records.coordinate`)."""

    def unit(self, unit: str) -> str:
        """Return the unit that belongs to one of a translation."""

    def symbol(self, symbol: str) -> str:
        """Return the symbol, F_k or T_k."""

    def noun(self, noun: str) -> str:
        """Return a noun or the name of a quantity, displacement or angle; anything else as it is."""


def sentence(
    findings: Finding | Sequence[Finding], vocabulary: Vocabulary, *, remedy: bool = True
) -> str:
    """Return what a finding says, or several of one kind, each number that differs among them as its range.

    It names no record: see `in_a_sentence`.   remedy : whether it says what helps, too.
    """
    some = [findings] if isinstance(findings, Finding) else list(findings)
    of = SENTENCES[some[0].code]
    template = f"{of.words}; {of.remedy}" if remedy and of.remedy else of.words
    shown = some[0].numbers

    def chosen(match: re.Match[str]) -> str:
        return match[2] if shown.get(match[1]) else match[3] or ""

    def field(match: re.Match[str]) -> str:
        name, spec = match[1], match[2] or ""
        if name not in shown:
            return _word(name, vocabulary)
        form, _, unit = spec.partition(" ")
        scale = _PER_SI.get(unit, 1.0)
        texts = [_formed(v, form, scale, vocabulary) for v in _ends(some, name)]
        joined = texts[0] if len(set(texts)) == 1 else " to ".join(texts)
        return with_unit(joined, vocabulary.unit(unit)) if unit else joined

    while _CHOICE.search(template):  # choices within choices from the inside
        template = _CHOICE.sub(chosen, template)
    return _FIELD.sub(field, template)


def in_a_sentence(
    findings: Sequence[Finding], sources: Sequence[str], vocabulary: Vocabulary, **more: Any
) -> str:
    """Return findings of one kind as a sentence that names the records or answers that they are about.

    sources : of all records.
    """
    words, own = sentence(findings, vocabulary, **more), [*dict.fromkeys(f.of for f in findings)]
    if own == [""]:
        return words
    if set(own) <= set(sources):
        names = [PurePath(source).name for source in sources]
        short = dict(zip(sources, names, strict=True)) if len(set(names)) == len(names) else {}
        if len(own) == len(sources) > 1:
            own = [f"all {len(sources)} records"]
        elif len(own) > _MOST_NAMES:
            some = ", ".join(short.get(one, one) for one in own[: _MOST_NAMES - 1])
            own = [f"{len(own)} of {len(sources)} records ({some} …)"]
        own = [short.get(one, one) for one in own]
    return f"{listed(own)}: {words}"


def _ends(findings: Sequence[Finding], name: str) -> list[Any]:
    """Return the value of a number, or the least and the greatest where findings differ in it."""
    values = [one.numbers[name] for one in findings]
    return values[:1] if len(values) == 1 else sorted({min(values), max(values)})


def _word(name: str, vocabulary: Vocabulary) -> str:
    """Return a word of the coordinate: a noun, a symbol or a unit of a translation."""
    noun, symbol = vocabulary.noun(name), vocabulary.symbol(name)
    return noun if noun != name else symbol if symbol != name else vocabulary.unit(name)


def unit_of(symbol: str) -> str:
    """Return the SI unit of a number by its symbol."""
    return UNITS.get(symbol) or term(symbol).unit


def _formed(value: Any, form: str, scale: float, vocabulary: Vocabulary) -> str:
    """Return a value in a form of a template."""
    if form in _FORMS:
        return _FORMS[form](value, vocabulary)
    if isinstance(value, Finding):
        return sentence(value, vocabulary, remedy=False)
    if isinstance(value, str):
        return value
    if form == "±":
        size, error = value
        return with_error(scale * size, scale * error)
    if isinstance(value, tuple):
        last = "or" if value and isinstance(value[0], tuple) else "and"
        return listed([_formed(one, form, scale, vocabulary) for one in value], last)
    value = scale * value if scale != 1.0 else value
    return number_text(value, int(form)) if form.isdigit() else written(value, form or ".6g")


def _changes(value: Any, vocabulary: Vocabulary) -> str:
    return listed(
        [
            f"{vocabulary.symbol(s)} by {change_text(p, by, vocabulary.unit(unit_of(s)))}"
            for s, p, by in value
        ]
    )


def _symbols(value: Any, vocabulary: Vocabulary) -> str:
    return listed([*map(vocabulary.symbol, [value] if isinstance(value, str) else value)])


def _values(value: Any, vocabulary: Vocabulary) -> str:
    return ", ".join(
        with_unit(f"{vocabulary.symbol(s)} = {number_text(p, 3)}", vocabulary.unit(unit_of(s)))
        for s, p in value
    )


_FORMS: Mapping[str, Callable[[Any, Vocabulary], str]] = {
    "percent": lambda value, _: f"{part(value)}",
    "factor": lambda value, _: f"{factor(value)}",
    "larger": lambda value, _: f"{larger_by(value)}",
    "ppm": lambda v, _: f"{signed(1e6 * v)} ppm" if abs(v) < 1e-3 else f"{signed(100.0 * v, 2)} %",
    "chance": lambda p, _: "below 1e-6" if p < 1e-6 else f"{p:.1g}",
    "noun": lambda value, vocabulary: vocabulary.noun(value),
    "symbols": _symbols,
    "changes": _changes,
    "values": _values,
}
"""How a template may show a number, besides as Python's format does."""
