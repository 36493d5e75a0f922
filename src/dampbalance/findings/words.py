"""Findings in words: templates with numbers as people write them, in the units and nouns of a coordinate.

A template has fields in braces. `{X:.3g mm}` is the number X in this form and unit; `{share:percent}`, `{p:chance}` and
the like are the forms of `_FORMS`; `{size:± µs}` is a value with its standard error, `{mass:4 kg}` a number with four
significant digits. A field that names no number is a word of the coordinate: `{displacement}` is an
angle of records that rotate, `{F_k}` a T_k, `{N/m}` a N m/rad. `[name?text|other]` is the text where the number of that
name is there and not zero, and the other text where it is not; `{@code}` are the words of another entry.

An option stands as a shell takes it, `--mass`, `--skip-cycles {skip:.0f}`, `--kind=ring-down`, and is shown as its
reader types it (`project.spelling`).
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from decimal import Decimal
from pathlib import PurePath
from typing import Any, Protocol

from ..law.terms import term
from ..model import UNITS
from ..project.spelling import spelled
from ..project.wording import (
    change_text,
    factor,
    larger_by,
    listed,
    number_text,
    part,
    signed,
    times,
    with_error,
    with_unit,
    written,
)
from .finding import Finding
from .sentences import MODELS, SENTENCES

_MOST_NAMES = 6  # of records in a sentence

_FIELD = re.compile(r"\{([^{}:]+)(?::([^{}]*))?\}")
_PART = re.compile(r"\{@([^{}]+)\}")
_CHOICE = re.compile(r"\[(\w+)\?([^\[\]|]*)(?:\|([^\[\]]*))?\]")
_OPTION = re.compile(r'--([a-z][a-z-]*)(?:[ =](?:"([^"]*)"|(\{[^{}]*\})|(?<==)(\w[\w-]*)))?')
PER_SI = {
    **{"mm": 1e3, "N/mm": 1e-3, "µs": 1e6, "ppm": 1e6, "%": 100.0, "N/mm³": 1e-9, "µm/N": 1e6},
    "°": math.degrees(1.0),
}
"""Units that numbers are shown in, per SI unit."""
_UNITS = {
    **UNITS,
    **{"k_3": "N/m³", "falling": "N", "falling_speed": "m/s", "corner": "Hz", "gradual": ""},
    **{"f_n": "Hz", "zeta": ""},
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
    parts = [of.words, of.remedy] if remedy else [of.words]
    return "; ".join(filter(None, (_filled(part, some, vocabulary) for part in parts)))


def _filled(template: str, findings: Sequence[Finding], vocabulary: Vocabulary) -> str:
    """Return a template with the numbers of findings of one kind."""
    shown = findings[0].numbers

    def chosen(match: re.Match[str]) -> str:
        return match[2] if shown.get(match[1]) else match[3] or ""

    def field(match: re.Match[str]) -> str:
        name, spec = match[1], match[2] or ""
        if name not in shown:
            return _word(name, vocabulary)
        if isinstance(shown[name], Finding):
            return sentence([one.numbers[name] for one in findings], vocabulary, remedy=False)
        form, _, unit = (spec, "", "") if spec in _FORMS else spec.partition(" ")
        values = [one.numbers[name] for one in findings]
        if (
            len(values) > 1
            and isinstance(values[0], float | int)
            and not isinstance(values[0], bool)
        ):
            values = sorted({min(values), max(values)})
        scale = PER_SI.get(unit, 1.0)
        texts = [_formed(value, form, scale, vocabulary) for value in values]
        ends = " to ".join(dict.fromkeys(texts))
        return with_unit(ends, vocabulary.unit(unit)) if unit else ends

    def option(match: re.Match[str]) -> str:
        value = match[2] or match[3] or match[4] or ""
        return spelled(match[1].replace("-", "_"), value.format_map(shown))  # as it can be typed

    template = _PART.sub(lambda match: SENTENCES[match[1]].words, template)
    while _CHOICE.search(template):  # choices within choices from the inside
        template = _CHOICE.sub(chosen, template)
    template = _OPTION.sub(option, template)
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


def _word(name: str, vocabulary: Vocabulary) -> str:
    """Return a word of the coordinate: a noun, a symbol or a unit of a translation."""
    noun, symbol = vocabulary.noun(name), vocabulary.symbol(name)
    return noun if noun != name else symbol if symbol != name else vocabulary.unit(name)


def unit_of(symbol: str) -> str:
    """Return the SI unit of a number by its symbol."""
    return _UNITS[symbol] if symbol in _UNITS else term(symbol).unit


def values_of(numbers: Iterable[tuple[str, float]], vocabulary: Vocabulary) -> str:
    """Return numbers by their symbols, "F_k = 1.28 N, c = 90.0 N s/m"."""
    return ", ".join(_of(s, "=", number_text(p, 3), vocabulary) for s, p in numbers)


def _of(symbol: str, sign: str, text: str, vocabulary: Vocabulary) -> str:
    """Return a number in words: F_k < 0.01 N."""
    unit = vocabulary.unit(unit_of(symbol))
    return with_unit(f"{vocabulary.symbol(symbol)} {sign} {text}", unit)


def limit(symbol: str, low: float, high: float, vocabulary: Vocabulary) -> str:
    """Return a number that has a limit only, in words: "F_k < 0.0001 N"."""
    above = math.isinf(high)
    shown = number_text(low, 4) if above else number_text(high, 2)
    return _of(symbol, ">" if above else "<", shown, vocabulary)


def masses(implied: float, given: float, vocabulary: Vocabulary) -> str:
    """Return the comparison of two masses, "records imply 3.1000 kg, you gave 3.098 kg (0.06 % less)"."""
    ratio, off, unit = given / implied, given / implied - 1.0, vocabulary.unit("kg")
    if not 0.5 < ratio < 2.0:
        how = f"{times(ratio)} that"
        own, other = number_text(implied, 4), number_text(given, 4)
    else:
        shown = 1 - math.floor(math.log10(abs(given - implied))) if off else 4
        written_with = -int(Decimal(f"{given:.6g}").as_tuple().exponent)
        how = f"{part(off)} {'less' if off < 0.0 else 'more'}"
        own, other = f"{implied:.{max(written_with + 1, shown, 0)}f}", f"{given:.6g}"
    return f"records imply {own} {unit}, you gave {other} {unit} ({how})"


def _formed(value: Any, form: str, scale: float, vocabulary: Vocabulary) -> str:
    """Return a value in a form of a template."""
    if form in _FORMS:
        return _FORMS[form](value, vocabulary)
    if isinstance(value, Finding):
        return sentence(value, vocabulary, remedy=False)
    if isinstance(value, str):
        return value
    if isinstance(value, tuple) and not isinstance(value[0], float | int):
        last = "or" if isinstance(value[0], tuple) and form != "±" else "and"
        return listed([_formed(one, form, scale, vocabulary) for one in value], last)
    if form in ("±", "sized"):
        size, error = (scale * number for number in value)
        sure = form == "±" or error < abs(size)
        return with_error(size, error) if sure else f"about {number_text(size, 1)}"
    value = scale * value if scale != 1.0 else value
    return number_text(value, int(form)) if form.isdigit() else written(value, form or ".6g")


def _changes(values: Any, of: Vocabulary) -> str:
    """Return changes of numbers, (symbol, value, change), in words: "F_k by 0.01 N"."""
    texts = (f"{of.symbol(s)} by {change_text(p, by, of.unit(unit_of(s)))}" for s, p, by in values)
    return listed([*texts])


def _symbols(value: Any, vocabulary: Vocabulary) -> str:
    return listed([*map(vocabulary.symbol, [value] if isinstance(value, str) else value)])


def _remedies(value: Any, vocabulary: Vocabulary) -> str:
    return listed([_filled(SENTENCES[one.code].remedy, [one], vocabulary) for one in value])


def _law(terms: Sequence[str], vocabulary: Vocabulary) -> str:
    """Return a law by what its terms are: "friction force and viscous damping (F_k, c)"."""
    symbols = ", ".join(map(vocabulary.symbol, terms))
    return f"{listed([phrase(term(symbol).words, vocabulary) for symbol in terms])} ({symbols})"


def phrase(words: str, vocabulary: Vocabulary) -> str:
    """Return words with their nouns in the coordinate: friction torque for friction force."""
    return " ".join(map(vocabulary.noun, words.split(" ")))


_FORMS: Mapping[str, Callable[[Any, Vocabulary], str]] = {
    "percent": lambda value, _: part(value),
    "factor": lambda value, _: factor(value),
    "times": lambda value, _: times(value),
    "larger": lambda value, _: larger_by(value),
    "ppm": lambda v, _: f"{signed(1e6 * v)} ppm" if abs(v) < 1e-3 else f"{signed(100.0 * v, 2)} %",
    "chance": lambda p, _: "below 1e-6" if p < 1e-6 else f"{p:.1g}",
    "p-value": lambda p, _: "p < 1e-6" if p < 1e-6 else f"p = {p:.1g}",
    "noun": lambda value, of: of.noun(value),
    "or": lambda value, of: " or ".join(map(of.noun, value)),
    "any": lambda values, of: listed([sentence(one, of) for one in values], "or"),
    "symbols": _symbols,
    "models": lambda names, _: listed([MODELS.get(name, name) for name in names]),
    "law": _law,
    "laws": lambda values, of: " or ".join(_law(terms, of) for terms in values),
    "remedies": _remedies,
    "changes": _changes,
    "effects": lambda values, of: "; ".join(
        f"1 % in {what} changes {_changes(parts, of)}" for what, parts in values
    ),
    "values": values_of,
    "readings": lambda values, of: listed(
        [f"{of.symbol(s)} = {number_text(v, 3)} {of.unit(unit)}" for s, v, unit in values], "or"
    ),
    "limits": lambda values, of: listed([limit(s, low, high, of) for s, low, high in values]),
    "masses": lambda value, of: masses(value[0], value[1], of),
    "each": lambda v, of: listed([f"{number_text(x, 4)} {of.unit('N')} ({n})" for x, n in v]),
}
"""How a template may show a number, besides as Python's format does."""
