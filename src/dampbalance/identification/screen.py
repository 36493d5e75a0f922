"""A result in plain characters: one screen, and all of it with tables and sentences."""

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
"""Finding that says what the columns of the table of a kind of records are."""
_LAWS = 3  # compared that a screen has room for
_LINES = 24  # of a screen
_ROOM = ((3, 12), (3, 6), (3, 3), (3, 2), (2, 2), (1, 2))
"""Causes of doubt and levels that a screen shows, the most that fit."""


class Block(NamedTuple):
    """A piece of a screen, as a terminal and a notebook show it, in this order.

    words : paragraphs.   items : of a list.   table : a line of heads and lines of cells.   grouped : whether the lines
    of the table are below the names in its first column, and units below symbols.
    """

    words: Sequence[str] = ()
    items: Sequence[str] = ()
    table: Sequence[Sequence[str]] = ()
    grouped: bool = False


class Number(NamedTuple):
    """A number of the answer: a row of every table of it.

    symbol, p, verdict : of the number, SI.
    """

    symbol: str
    p: ParameterEstimate
    verdict: Verdict

    @property
    def shown(self) -> ParameterEstimate:
        """The estimate in the unit that is shown: ζ in percent."""
        if self.symbol != "zeta":
            return self.p
        low, high = self.p.interval
        return replace(
            self.p, value=100.0 * self.p.value, interval=Interval(100.0 * low, 100.0 * high)
        )

    @property
    def text(self) -> str:
        """The value with the half width of its interval, "1.2803 ± 0.0011", or with the interval where that is not
        symmetric; a limit, "< 0.0023"; a dash for no value."""
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
        # an interval is shown as ± if its value lies off the middle by less than a tenth of the half width
        if abs(value - middle) < 0.1 * half:
            return with_error(value, half)
        return f"{rounded(value, half)} [{rounded(low, half)}, {rounded(high, half)}]"

    def name(self, of: Coordinate) -> str:
        """Return the symbol as it is read."""
        return GREEK.get(self.symbol, of.symbol(self.symbol))

    def unit(self, of: Coordinate) -> str:
        """Return the unit that is shown."""
        return "%" if self.symbol == "zeta" else of.unit(unit_of(self.symbol))

    def equation(self, of: Coordinate) -> str:
        """Return F_k = 1.2803 ± 0.0011 N."""
        sign = "= " * (self.text[0] not in "<>")
        return with_unit(f"{self.name(of)} {sign}{self.text}", self.unit(of))


def numbers(found: Result[Any]) -> list[Number]:
    """Return the numbers of the answer, then m, f_n and ζ where a fit determines them."""
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
    """Return the pieces of one screen, with what shows the rest.   tabled : as for `blocks`."""
    for causes, levels in _ROOM:
        left = len(limiting(found)) - len(limiting(found, others=False)[:causes])
        more = f"{left} more and " * bool(left) + "all numbers"
        last = f"See {everything()} for {more}, and for what they depend on."
        parts = [*blocks(found, (causes, levels), tabled), Block([last])]
        # whatever its width, it says the same; a notebook has room
        if tabled or plain(parts, 80).count("\n") <= _LINES:
            break
    return parts


def blocks(
    found: Result[Any], room: tuple[int, int] | None = None, tabled: bool = True
) -> list[Block]:
    """Return the pieces of a screen: the answer, what is measured, what it says of the rig, what checks it and what
    limits it. Where there is no answer, the cause comes first and the numbers last.

    room : causes of doubt and levels that there is room for; default, all.
    tabled : whether the numbers are a table, as they are where there is no answer; default, in addition to sentences.
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
    return [Block(answer), measured, *parts, *comparison(found, None if whole else _LAWS)]


def plain(parts: Iterable[Block], width: int | None) -> str:
    """Return blocks in plain characters, a blank line between them."""
    texts = []
    for of in parts:
        table = _grouped(of.table, width) if of.grouped and of.table else aligned(of.table)
        words = wrapped([*of.words, *(f"- {one}" for one in of.items)], width)
        texts.append("\n".join([*words, *table]))
    return "\n\n".join(filter(None, texts)) + "\n"


def lead(found: Result[Any]) -> str:
    """Return the sentence before all numbers: that there is no answer, its first cause and the remedy, or no friction;
    else an empty one."""
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
    """Return `Result.limits` in parts: that for which there is no answer, others on the answer, on other answers
    alone."""
    others = {*found.approaches} - {found.answer.name}
    of_others = [group for group in found.limits if {one.of for one in group} <= others]
    own, first = [of for of in found.limits if of not in of_others], [*found.unanswered, []][0]
    cause = next((of for of in own if first and of[0].kind == first[0].kind), first)
    return cause, [of for of in own if of != cause], of_others


def limiting(found: Result[Any], *, others: bool = True) -> list[str]:
    """Return what limits the answer, and on what it depends, in sentences, without the cause that `lead` states, and
    what limits the others."""
    _, own, of_others = _parted(found)
    hint = found.in_sentences([found.hint] if found.hint and not found.unanswered else [])
    first, rest = ([sentence(named(found, of)) for of in groups] for groups in (own, of_others))
    return [*first, *hint, *(rest if others else [])]


def named(found: Result[Any], findings: Sequence[Finding]) -> str:
    """Return findings of one kind in a sentence that names what they are about, unless that is the answer."""
    if found.answer.name in {one.of for one in findings}:
        return worded(findings, found.coordinate)
    return in_a_sentence(findings, found.sources, found.coordinate)


def answers_table(found: Result[Any]) -> list[tuple[str, ...]]:
    """Return the numbers with their intervals, a line each below a line of heads: of the answer with the verdict, then
    of the others. A star marks an answer with notes."""
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


def measured_table(basis: AnyBasis, levels: Levels, of: Coordinate) -> list[list[str]]:
    """Return what is measured of each level, a line each below a line of heads; nothing where the answer says it all.

    levels : by the keys of the document.
    """
    if not (levels and (columns := basis.columns.items())):
        return []
    heads = [label_with_unit(of.symbol(s), of.unit(unit)) for _, (s, unit, _) in columns]
    return [heads, *([_cell(level, *column) for column in columns] for level in levels)]


def _cell(level: Mapping[str, Any], key: str, column: Column) -> str:
    """Return a name, a count or a number of a table, with the half width of its interval where it has an error."""
    value, factor = level[key], PER_SI.get(column.unit, 1.0)
    if isinstance(value, str):
        return short(value)
    if column.error:
        return with_error(factor * value, factor * NORMAL_95 * level[column.error])
    return f"{value:g}" if value % 0.5 == 0.0 else number_text(factor * value, 3)


def short(source: str) -> str:
    """Return the name of a file without its folder; of a record from elsewhere all of it, whatever slashes it has."""
    path = PurePath(source)
    return visible(path.name if path.suffix else source)


def measured_caption(kind: str, coordinate: Coordinate) -> str:
    """Return a sentence on the columns of that table."""
    return sentence(worded(Finding(_CAPTIONS[kind]), coordinate))


def measured_block(basis: AnyBasis, levels: Levels, of: Coordinate) -> Block:
    """Return that table below its caption."""
    table = measured_table(basis, levels, of)
    return Block([measured_caption(basis.kind, of)] if table else [], table=table, grouped=True)


def _grouped(table: Sequence[Sequence[str]], width: int | None) -> list[str]:
    """Return the lines of a table with units below symbols; where its first column has several names, each above its
    lines."""
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
    """Return the verdicts on several parameters for a line of a table: "usable within 1.2 %", or "usable within 0.3 %:
    F_k, c; none: K_z", where the number that is known least decides."""
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
    """Return the first of findings in words, with those of its kind; empty where there is none."""
    first = [one for one in findings if one.kind == findings[0].kind]
    return worded(first, coordinate, remedy=False) if first else ""


def answer_in_words(found: Result[Any]) -> str:
    """Return the values with their intervals of 95 %, and how far they can be used, in a sentence: "F_k = 2.100 ± 0.010
    N, … at 95 %: usable within 0.6 %."; after a doubt its first reason. Where there is a lead, that."""
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
    """Return in sentences the mass, the natural frequency and the damping ratio, which a test engineer asks for first,
    unless they are shown elsewhere, and the damping of the smallest and the largest level."""
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
    """Return a line for each model that was weighed: what it has beyond the plain one, and of what size."""
    if len(found.weighed) < 2:
        return []
    lines = [
        (MODELS.get(name, name), f"{weight:.2g}", with_error(size, error) if error else "")
        for name, weight, size, error in found.weighed
    ]
    return [("model with", "weight", "size ± standard error (SI)"), *lines]


def laws_table(found: Result[Any], most: int | None = None) -> list[tuple[str, ...]]:
    """Return each law of a comparison with its weight and coefficients, a line each below a line of heads.   most : of
    them, the heaviest; default, all."""
    laws = found.laws.laws if found.laws else ()
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


def comparison(found: Result[Any], most: int | None = None) -> list[Block]:
    """Return what follows from a comparison of laws, and the table of them."""
    if found.laws is None:
        return []
    return [Block(found.in_sentences(found.laws.findings), table=laws_table(found, most))]


def implied(fit: OscillatorFit, given_mass: float | None = None) -> list[Finding]:
    """Return what a fit implies about the mass that is given, to compare; none where it is not, or the fit takes it."""
    if given_mass is None or fit.error("m") < _ROUNDING * fit.m:
        return []
    return [Finding("masses", {"masses": (fit.m, given_mass)})]


def value_of(parameter: ParameterEstimate) -> str:
    """Return "1.2807", the value alone; "> 30000" for a lower limit, a dash for none."""
    value, (low, high) = parameter.value, parameter.interval
    if math.isfinite(low) and not math.isfinite(high):
        return f"> {rounded(low, low)}"
    if not all(map(math.isfinite, (value, low, high))):
        return "–"
    return rounded(value, 0.5 * (high - low))


def interval_of(parameter: ParameterEstimate) -> str:
    """Return "[1.2784, 1.2831]", the interval alone; a dash where an end is not known."""
    if not all(map(math.isfinite, (parameter.value, *parameter.interval))):
        return "–"
    low, high = parameter.interval
    return f"[{rounded(low, 0.5 * (high - low))}, {rounded(high, 0.5 * (high - low))}]"
