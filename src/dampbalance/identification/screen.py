"""A result as plain text: one screen, and the details with all tables and sentences."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import PurePath
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from ..findings.finding import Finding
from ..findings.sentences import MODELS
from ..findings.words import PER_SI, in_a_sentence, unit_of
from ..findings.words import sentence as worded
from ..fit.fit import OscillatorFit
from ..law.terms import FRICTION
from ..project.spelling import everything
from ..project.wording import (
    GREEK,
    NO_NUMBER,
    cut,
    label_with_unit,
    minus,
    number_text,
    part,
    percent,
    rounded,
    sentence,
    visible,
    with_error,
    with_unit,
)
from ..records.coordinate import Coordinate
from ..solver import NORMAL_95
from .answer import UNKNOWN, USABLE, USELESS, Interval, ParameterEstimate, Verdict, judged

if TYPE_CHECKING:
    from .level import Column
    from .result import Basis, Result

    AnyBasis: TypeAlias = Basis | type[Basis]
    Levels: TypeAlias = Sequence[Mapping[str, Any]]

_ROUNDING = 1e-12
_CAPTIONS = {"loops": "loops measured", "ring-down": "swings measured"}
"""Kind of records → the finding that explains the columns of its table of levels."""
_LAWS = 3  # damping laws listed on a screen
_LINES = 24  # of a screen
_ROOM = ((3, 12), (3, 6), (3, 3), (3, 2), (2, 2), (1, 2))
"""Numbers of causes of doubt and of levels on a screen; the first pair that fits is used."""


class Block(NamedTuple):
    """A piece of a screen: paragraphs, then a list, then a table.

    words : paragraphs.
    items : of the list.
    table : a line of heads and lines of cells.
    grouped : whether lines are listed below the name in their first column, and units below symbols.
    """

    words: Sequence[str] = ()
    items: Sequence[str] = ()
    table: Sequence[Sequence[str]] = ()
    grouped: bool = False


class Number(NamedTuple):
    """A number of the answer as text.

    symbol, p, verdict : of the number, SI units.
    """

    symbol: str
    p: ParameterEstimate
    verdict: Verdict

    @property
    def shown(self) -> ParameterEstimate:
        """The estimate in the displayed unit: ζ in percent."""
        if self.symbol != "zeta":
            return self.p
        low, high = self.p.interval
        return replace(
            self.p, value=100.0 * self.p.value, interval=Interval(100.0 * low, 100.0 * high)
        )

    @property
    def text(self) -> str:
        """The value with the half width of its interval, "1.2803 ± 0.0011", or with an asymmetric interval in brackets;
        a limit as "< 0.0023", a missing value as a dash."""
        value, (low, high) = self.shown.value, self.shown.interval
        half, middle = 0.5 * (high - low), 0.5 * (high + low)
        if math.isnan(value):
            return NO_NUMBER
        if math.isinf(high):
            return f"> {rounded(low, low)}"
        if low <= 0.0 < high:
            return f"< {number_text(high, 2)}"
        if not half > _ROUNDING * abs(value):
            return number_text(value, 5)
        # symmetric within a tenth of the half width
        if abs(value - middle) < 0.1 * half:
            return with_error(value, half)
        return f"{rounded(value, half)} [{rounded(low, half)}, {rounded(high, half)}]"

    def name(self, of: Coordinate) -> str:
        """Return the symbol as displayed."""
        return GREEK.get(self.symbol, of.symbol(self.symbol))

    def unit(self, of: Coordinate) -> str:
        """Return the displayed unit."""
        return "%" if self.symbol == "zeta" else of.unit(unit_of(self.symbol))

    def equation(self, of: Coordinate) -> str:
        """Return the number as an equation, "F_k = 1.2803 ± 0.0011 N"."""
        sign = "= " * (self.text[0] not in "<>")
        return with_unit(f"{self.name(of)} {sign}{self.text}", self.unit(of))


def numbers(found: Result[Any]) -> list[Number]:
    """Return the numbers of the answer, then m, f_n and ζ if a fit determines them."""
    verdicts = found.answer.verdicts
    own = [Number(s, p, verdicts[s]) for s, p in found.answer.parameters.items()]
    return own + [Number(s, p, judged(s, p)) for s, p in found.oscillator.items()]


def screen(found: Result[Any], width: int) -> str:
    """Return one screen: see `Result.screen`."""
    return plain(short_blocks(found), width)


def details(found: Result[Any], width: int | None = None) -> str:
    """Return all sentences and tables: see `Result.text`."""
    more = [one for one in found.rig if one is not found.hint or found.unanswered]
    rest = Block(found.in_sentences(more)), Block(table=weights(found))
    return plain([*blocks(found), *rest], width)


def short_blocks(found: Result[Any], tabled: bool = False) -> list[Block]:
    """Return the pieces of one screen, the last of which says where the rest is.   tabled : as for `blocks`."""
    for causes, levels in _ROOM:
        left = len(limiting(found)) - len(limiting(found, others=False)[:causes])
        more = f"{left} more and " * bool(left) + "all numbers"
        last = f"See {everything()} for {more}, and for what they depend on."
        parts = [*blocks(found, (causes, levels), tabled), Block([last])]
        # the width does not change what is shown; a notebook has room
        if tabled or plain(parts, 80).count("\n") <= _LINES:
            break
    return parts


def blocks(
    found: Result[Any], room: tuple[int, int] | None = None, tabled: bool = True
) -> list[Block]:
    """Return the pieces of a screen: the answer, measured quantities, the rig, the check and the causes of doubt. If
    there is no answer, its cause comes first and the numbers last.

    room : the most causes of doubt and levels; by default all.
    tabled : whether to show the numbers as a table, which is always done if there is no answer.
    """
    of_levels, first = found.level_documents, found.unanswered
    causes, levels = room or (None, len(of_levels))
    at = np.linspace(0, len(of_levels) - 1, min(len(of_levels), levels))
    of_levels = [of_levels[i] for i in at.round().astype(int)]
    check = found.in_sentences(found.check)
    whole = room is None
    shown = whole or not (tabled or first)  # in sentences
    head = [f"{found.head}:"] if tabled and not first else []
    table = Block(head, table=answers_table(found) if tabled or first else ())
    of_answer = [table, Block([*damping_of(found, shown), *check])]
    of_doubt = [Block(items=limiting(found, others=whole)[:causes])]
    parts = [*of_doubt, *of_answer] if first else [*of_answer, *of_doubt]
    doubted = any(of.verdict != USABLE for of in found.answer.verdicts.values())
    answer = [answer_in_words(found)] if shown or doubted or lead(found) else []
    measured = measured_block(found.basis, of_levels, found.coordinate)
    of_laws = found.in_sentences(found.laws.findings) if found.laws else ()
    laws = Block(of_laws, table=laws_table(found, None if whole else _LAWS))
    return [Block(answer), measured, *parts, laws]


def plain(parts: Iterable[Block], width: int | None) -> str:
    """Return blocks in plain characters, a blank line between them."""
    texts = []
    for of in parts:
        table = _grouped(of.table, width) if of.grouped and of.table else aligned(of.table)
        words = wrapped([*of.words, *(f"- {one}" for one in of.items)], width)
        texts.append("\n".join([*words, *table]))
    return "\n\n".join(filter(None, texts)) + "\n"


def lead(found: Result[Any]) -> str:
    """Return the sentence that precedes the numbers: there is no answer, with its first cause and the remedy, or no
    friction; otherwise an empty text."""
    coordinate, answer = found.coordinate, found.answer
    if found.unanswered:
        return sentence(f"no answer: {worded(_parted(found)[0], coordinate)}")
    verdict, c = answer.verdicts.get(FRICTION), answer.parameters.get("c")
    if verdict is None or c is None or (verdict.verdict, verdict.within) != (USABLE, math.inf):
        return ""
    friction, *others = [of.equation(coordinate) for of in numbers(found) if of.symbol != "K_z"]
    of_c = [one for one in others if one.startswith(("c ", "ζ "))]
    return f"No friction ({friction} at 95 %); {', '.join(of_c)}."


def _parted(found: Result[Any]) -> tuple[list[Finding], list[list[Finding]], list[list[Finding]]]:
    """Return `Result.limits` in parts: the cause of having no answer, the others on the answer, those on other answers
    alone."""
    others = {*found.approaches} - {found.answer.name}
    of_others = [group for group in found.limits if {one.of for one in group} <= others]
    own, first = [of for of in found.limits if of not in of_others], [*found.unanswered, []][0]
    cause = next((of for of in own if first and of[0].kind == first[0].kind), first)
    return cause, [of for of in own if of != cause], of_others


def limiting(found: Result[Any], *, others: bool = True) -> list[str]:
    """Return in sentences what limits the answer, except the cause that `lead` states, on which inputs it depends and,
    if `others`, what limits the other answers."""
    _, own, of_others = _parted(found)
    hint = found.in_sentences([found.hint] if found.hint and not found.unanswered else [])
    first, rest = ([sentence(named(found, of)) for of in groups] for groups in (own, of_others))
    return [*first, *hint, *(rest if others else [])]


def named(found: Result[Any], findings: Sequence[Finding]) -> str:
    """Return findings of one kind in a sentence that names their subject, unless that is the answer."""
    if found.answer.name in {one.of for one in findings}:
        return worded(findings, found.coordinate)
    return in_a_sentence(findings, found.sources, found.coordinate)


def answers_table(found: Result[Any]) -> list[tuple[str, ...]]:
    """Return the table of all answers, heads first: a line for each number, with its verdict after the answer to use. A
    star marks another answer with notes."""
    answer, *others = found.approaches.values()
    heads = ["at 95 %", answer.name, "verdict", *(o.name + " *" * bool(o.notes) for o in others)]
    lines = [tuple(heads)]
    for of in numbers(found):
        known = [other.parameters.get(of.symbol, UNKNOWN) for other in others]
        further = [of._replace(p=p).text for p in known]
        verdict = in_one({of.symbol: of.verdict}, found.coordinate)
        label = label_with_unit(of.name(found.coordinate), of.unit(found.coordinate))
        lines.append((label, of.text, verdict, *further))
    return lines


def _measured_table(basis: AnyBasis, levels: Levels, of: Coordinate) -> list[list[str]]:
    """Return the table of measured quantities, heads first, with a line for each level."""
    if not (levels and (columns := basis.columns.items())):
        return []
    heads = [label_with_unit(of.symbol(s), of.unit(unit)) for _, (s, unit, _) in columns]
    return [heads, *([_cell(level, *column) for column in columns] for level in levels)]


def _cell(level: Mapping[str, Any], key: str, column: Column) -> str:
    """Return a name, a count or a number as a cell, with the half width of its interval if it has an error."""
    value, factor = level[key], PER_SI.get(column.unit, 1.0)
    if isinstance(value, str):
        return short(value)
    if column.error:
        return with_error(factor * value, factor * NORMAL_95 * level[column.error])
    return minus(f"{value:g}") if value % 0.5 == 0.0 else number_text(factor * value, 3)


def short(source: str) -> str:
    """Return the name of a file without its folder; the whole name of a record that is not from a file."""
    path = PurePath(source)
    return visible(path.name if path.suffix else source)


def measured_block(basis: AnyBasis, levels: Levels, of: Coordinate) -> Block:
    """Return the table of measured quantities below a sentence that explains its columns; empty for kinds without one.

    levels : by the keys of the document.
    """
    if not (table := _measured_table(basis, levels, of)):
        return Block()
    caption = sentence(worded(Finding(_CAPTIONS[basis.kind]), of))
    return Block([caption], table=table, grouped=True)


def _grouped(table: Sequence[Sequence[str]], width: int | None) -> list[str]:
    """Return the lines of a table with units below symbols; each name of its first column stands above its lines, if
    there are several."""
    (what, *heads), *rows = table
    parts = zip(*(head.partition(" ")[::2] for head in heads), strict=True)
    symbols, units, *lines = aligned([*parts, *(row[1:] for row in rows)])
    told = [symbols, units]
    names, before = [row[0] for row in rows], ""
    for name, line in zip(names, lines, strict=True):
        title = name if name.startswith(what) else f"{what} {name}"
        told += [cut(f"{title}:", width or 80)] * (name != before and len({*names}) > 1)
        told, before = [*told, line], name
    return told


def aligned(table: Sequence[Sequence[str]]) -> list[str]:
    """Return the lines of a table with columns of equal width."""
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    return ["  ".join(map(str.ljust, line, widths)).rstrip() for line in table]


def in_one(verdicts: Mapping[str, Verdict], coordinate: Coordinate) -> str:
    """Return the verdicts on several numbers in one line: "usable within 1.2 %", or "usable within 0.3 %: F_k, c;
    none: K_z". The least accurate number of a group decides its percentage."""
    by_word: dict[tuple[str, bool], list[str]] = {}
    for symbol, one in verdicts.items():
        roughly = one.verdict == USABLE and math.isfinite(one.within) and one.within > USELESS
        by_word.setdefault((one.verdict, roughly), []).append(symbol)
    parts = []
    doubts = [of for of in by_word if of[0] != USABLE]
    # a reason that follows is that of the first doubt, which therefore stands last
    for word, roughly in [*(of for of in by_word if of not in doubts), *doubts[::-1]]:
        symbols = by_word[word, roughly]
        sizes = [within for s in symbols if math.isfinite(within := verdicts[s].within)]
        size = f" within {part(max(sizes))}" if word == USABLE and sizes else ""
        of = ", ".join(map(coordinate.symbol, symbols))
        parts.append(f"{word}{size}" + f": {of}" * (len(by_word) > 1))
    return "; ".join(parts)


def worded_first(findings: Sequence[Finding], coordinate: Coordinate) -> str:
    """Return the first finding in words, with others of its kind; empty if there are none."""
    first = [one for one in findings if one.kind == findings[0].kind]
    return worded(first, coordinate, remedy=False) if first else ""


def answer_in_words(found: Result[Any]) -> str:
    """Return the values with their 95 % intervals and verdicts in a sentence, "F_k = 2.100 ± 0.010 N, … at 95 %: usable
    within 0.6 %."; a doubt is followed by its first reason. If there is a `lead`, return that."""
    answer, coordinate = found.answer, found.coordinate
    if said := lead(found):
        return said
    of_law = [of for of in numbers(found) if of.symbol in answer.parameters]
    values = [of.equation(coordinate) for of in of_law if not math.isnan(of.p.value)]
    doubts = [f for v in answer.verdicts.values() if v.verdict != USABLE for f in v.findings]
    why = worded_first(doubts, coordinate)
    verdict = in_one(answer.verdicts, coordinate) + (f", as {why}" if why else "")
    return f"{', '.join(values)} at 95 %: {verdict}."


def damping_of(found: Result[Any], shown: bool = True) -> list[str]:
    """Return in sentences mass, natural frequency and damping ratio, and the damping of the smallest and the largest
    level.   shown : whether to state the numbers of the first sentence."""
    sentences, m = list[str](), found.mass
    if rig := [of for of in numbers(found) if of.symbol in found.oscillator]:
        given = " as given" * (not found.mass_error > _ROUNDING * m)
        mass, *others = [of.equation(found.coordinate) for of in rig]
        alone = " from c alone" * ("zeta" in found.oscillator)
        values = f"{', '.join([mass + given, *others])}{alone}. " * shown
        symbol = found.coordinate.symbol("m")
        sentences.append(
            f"{values}If {symbol} or f_n of your rig differs, check gains, units and k."
        )
    cycles = [of for of in found.level_documents if of.get("W_J", 0.0) > 0.0 and found.k > 0.0]
    sizes = sorted(cycles, key=lambda of: float(of["X_m"]))
    if sizes:
        at = [
            f"η = {number_text(of['loss_factor'], 3)}"
            + f", ζ_eq = {percent(of['equivalent_damping_ratio'], 3)}" * (m == m)
            + f" at X = {number_text(1e3 * of['X_m'], 3)} {found.coordinate.unit('mm')}"
            for of in sizes[:: len(sizes) - 1 or 1]
        ]
        sentences.append(f"With friction: {'; '.join(at)}.")
    return sentences


def with_ties(text: str) -> str:
    """Return text whose lines do not break between a number, its sign and its unit, or before a quotation."""
    return re.sub(r"(?<=[\d=±<>]) (?=\S)| (?=[=\"])", "\N{NO-BREAK SPACE}", text)


def wrapped(lines: Iterable[str], width: int | None) -> list[str]:
    """Return lines broken at a width, if there is one."""
    broken: list[str] = []
    for line in lines:
        tied = with_ties(line)
        indent = "  " * line.startswith(("- ", "* "))
        pieces = textwrap.wrap(
            tied,
            width or len(tied) + 1,
            subsequent_indent=indent,
            break_long_words=False,
            break_on_hyphens=False,
        )
        broken += [piece.replace("\N{NO-BREAK SPACE}", " ") for piece in pieces or [""]]
    return broken


def weights(found: Result[Any]) -> list[tuple[str, ...]]:
    """Return the table of the weighed models, heads first: what each adds to the plain oscillator, weight and size."""
    if len(found.weighed) < 2:
        return []
    lines = [
        (MODELS.get(name, name), f"{weight:.2g}", with_error(size, error) if error else "")
        for name, weight, size, error in found.weighed
    ]
    return [("model with", "weight", "size ± standard error (SI)"), *lines]


def laws_table(found: Result[Any], most: int | None = None) -> list[tuple[str, ...]]:
    """Return the table of compared damping laws, heads first, with weights and coefficients.

    most : lines for single laws, the heaviest; by default all.
    """
    if found.laws is None:
        return []
    laws = found.laws.laws
    lines: list[tuple[str, ...]] = [("law", "weight", "coefficients ± standard error")]
    for one in laws[:most]:
        values = ", ".join(
            f"{found.coordinate.symbol(key)} = {number_text(value, 5)} ± {number_text(error, 2)}"
            for key, (value, error) in one.coefficients.items()
        )
        law = ", ".join(map(found.coordinate.symbol, one.terms))
        lines.append((law, f"{one.weight:.2g}", values))
    if left := len(laws[most:]) if most else 0:
        lines.append((f"{left} others", f"{math.fsum(of.weight for of in laws[most:]):.2g}", ""))
    return lines


def implied(fit: OscillatorFit, given_mass: float | None = None) -> list[Finding]:
    """Return the finding that compares the mass of a fit with the stated one; none if the fit holds it or none is
    stated."""
    if given_mass is None or fit.error("m") < _ROUNDING * fit.m:
        return []
    return [Finding("masses", {"masses": (fit.m, given_mass)})]


def value_of(parameter: ParameterEstimate) -> str:
    """Return the value alone, "1.2807"; a lower limit as "> 30000", a missing value as a dash."""
    value, (low, high) = parameter.value, parameter.interval
    if math.isfinite(low) and not math.isfinite(high):
        return f"> {rounded(low, low)}"
    if not all(map(math.isfinite, (value, low, high))):
        return "–"
    return rounded(value, 0.5 * (high - low))


def interval_of(parameter: ParameterEstimate) -> str:
    """Return the interval alone, "[1.2784, 1.2831]"; a dash if an end is not known."""
    if not all(map(math.isfinite, (parameter.value, *parameter.interval))):
        return "–"
    low, high = parameter.interval
    return f"[{rounded(low, 0.5 * (high - low))}, {rounded(high, 0.5 * (high - low))}]"
