"""A result in plain characters: one screen, and all of it with tables and sentences."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from pathlib import PurePath
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from ..findings.finding import Finding
from ..findings.sentences import MODELS
from ..findings.words import PER_SI, in_a_sentence, limit, unit_of
from ..findings.words import sentence as worded
from ..fit.fit import OscillatorFit
from ..law.terms import FRICTION
from ..project.wording import (
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
from .answer import USABLE, ParameterEstimate, Verdict

if TYPE_CHECKING:
    from .level import Column
    from .result import Basis, Result

    AnyBasis: TypeAlias = Basis | type[Basis]
    Levels: TypeAlias = Sequence[Mapping[str, Any]]

_ROUNDING = 1e-12
_CAPTIONS = {"loops": "loops measured", "ring-down": "swings measured"}
"""Finding that says what the columns of the table of a kind of records are."""
_CAUSES = 3  # of doubt that a screen has room for


def screen(found: Result[Any], width: int, details: str) -> str:
    """Return one screen: see `Result.screen`."""
    coordinate, name = found.coordinate, found.answer.name
    others = {*found.approaches} - {name}
    own = [group for group in found.limits if not {one.of for one in group} <= others]
    answer, first = answer_in_words(found), next(iter(found.unanswered), [])
    cause = next((of for of in own if first and of[0].kind == first[0].kind), None)
    if cause is not None:  # with its remedy
        answer = sentence(f"no answer: {worded(cause, coordinate)}")
        own.remove(cause)
    left = max(0, len(own) - _CAUSES)
    causes = [sentence(named(found, of)) for of in own[:_CAUSES]]
    if found.hint and not first and len(causes) < _CAUSES:
        causes += found.in_sentences([found.hint])
    check = " ".join(found.in_sentences(found.check))
    numbers = wrapped([*damping_of(found), *filter(None, [check])], width)
    causes = wrapped([f"- {one}" for one in causes], width)
    parts = [causes, aligned(answers_table(found)), numbers] if first else [numbers, causes]
    more = f"{left} more and " * bool(left) + "all numbers"
    last = f"See {details} for {more}, and for what they depend on."
    tests = comparison(found, width)
    levels = found.level_documents
    # a screen has room for twelve loops
    shown = np.linspace(0, len(levels) - 1, min(len(levels), 12)).round().astype(int)
    table = measured_lines(found.basis, [levels[i] for i in shown], coordinate, width)
    return _page(wrapped([answer], width), table, *parts, tests, wrapped([last], width))


def details(found: Result[Any], width: int | None = None) -> str:
    """Return all sentences and tables: see `Result.text`."""
    said = wrapped(found.in_sentences([*found.check, *found.rig]), width)
    numbers = [*wrapped([found.head], width), "", *aligned(answers_table(found)), "", *said]
    for table in (weights(found), comparison(found, width)):
        numbers += ["", *table] if table else []
    heading = "Causes and remedies" if found.unanswered else "What limits the answer"
    limits = limiting(found)
    causes = [f"{heading}:", *wrapped(limits, width)] if limits else []
    parts = [causes, numbers] if found.unanswered else [numbers, causes]
    table = measured_lines(found.basis, found.level_documents, found.coordinate, width)
    return _page(wrapped([lead(found)], width), table, *parts)


def _page(*parts: Sequence[str]) -> str:
    """Return paragraphs of lines, without those that are empty."""
    return "\n\n".join(text for part in parts if (text := "\n".join(part))) + "\n"


def lead(found: Result[Any]) -> str:
    """Return the sentence before all numbers: that there is no answer and its first cause, or no friction; else an
    empty one."""
    coordinate, answer = found.coordinate, found.answer
    if why := found.unanswered:
        return sentence(f"no answer: {worded(why[0], coordinate, remedy=False)}")
    verdict, c = answer.verdicts.get(FRICTION), answer.parameters.get("c")
    if verdict is None or c is None or (verdict.verdict, verdict.within) != (USABLE, math.inf):
        return ""
    friction = limit(FRICTION, *answer.parameters[FRICTION].interval, coordinate)
    ratio = found.damping_ratio
    zeta = "" if math.isnan(ratio) else f", ζ = {percent(ratio, 2)}"
    return f"No friction ({friction} at 95 %); {measured('c', value_of(c), coordinate)}{zeta}."


def limiting(found: Result[Any]) -> list[str]:
    """Return what limits the answers, in sentences: "*" begins a note on answers, "warning:" all else."""
    return [
        ("* " if group[0].of in found.approaches else "warning: ")
        + in_a_sentence(group, found.sources, found.coordinate)
        for group in found.limits
    ]


def named(found: Result[Any], findings: Sequence[Finding]) -> str:
    """Return findings of one kind in a sentence that names what they are about, unless that is the answer."""
    if found.answer.name in {one.of for one in findings}:
        return worded(findings, found.coordinate)
    return in_a_sentence(findings, found.sources, found.coordinate)


def measured(symbol: str, text: str, coordinate: Coordinate) -> str:
    """Return F_k = 1.28 N for the text of a number."""
    unit = coordinate.unit(unit_of(symbol))
    return with_unit(f"{coordinate.symbol(symbol)} = {text}", unit)


def answers_table(found: Result[Any]) -> list[tuple[str, ...]]:
    """Return the values with their intervals and verdicts, a line for each answer below a line of heads."""
    answers, coordinate = found.approaches, found.coordinate
    symbols = dict.fromkeys(s for answer in answers.values() for s in answer.parameters)
    order = sorted(symbols, key=lambda symbol: symbol == "K_z")  # the contact last
    heads = [label_with_unit(coordinate.symbol(s), coordinate.unit(unit_of(s))) for s in order]
    lines = [("", *heads, "verdict")]
    for name, answer in answers.items():
        cells = (with_interval(p) if (p := answer.parameters.get(s)) else "" for s in order)
        verdict = in_one(answer.verdicts, coordinate)
        lines.append((name + " *" * bool(answer.notes), *cells, verdict))
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


def measured_lines(
    basis: AnyBasis, levels: Levels, coordinate: Coordinate, width: int | None = None
) -> list[str]:
    """Return that table as lines below its caption, units below symbols; where its first column has several names, each
    above its lines."""
    if not (table := measured_table(basis, levels, coordinate)):
        return []
    (what, *heads), *rows = table
    parts = zip(*(head.partition(" ")[::2] for head in heads), strict=True)
    symbols, units, *lines = aligned([*parts, *(row[1:] for row in rows)])
    told = [*wrapped([measured_caption(basis.kind, coordinate)], width), "", symbols, units]
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
    by_word: dict[str, list[str]] = {}
    for symbol, one in verdicts.items():
        by_word.setdefault(one.verdict, []).append(symbol)
    parts = []
    for word, symbols in by_word.items():
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
    values = [_with_half_width(s, p, coordinate) for s, p in answer.parameters.items()]
    doubts = [f for v in answer.verdicts.values() if v.verdict != USABLE for f in v.findings]
    why = worded_first(doubts, coordinate)
    verdict = in_one(answer.verdicts, coordinate) + (f", as {why}" if why else "")
    return f"{', '.join(filter(None, values))} at 95 %: {verdict}."


def _with_half_width(symbol: str, p: ParameterEstimate, coordinate: Coordinate) -> str:
    """Return F_k = 1.2803 ± 0.0011 N, with the interval itself where it is not symmetric; a limit; nothing for no
    value."""
    low, high = p.interval
    half, middle = 0.5 * (high - low), 0.5 * (high + low)
    if math.isnan(p.value):
        return ""
    if math.isinf(high) or low <= 0.0 < high:
        return limit(symbol, low, high, coordinate)
    # an interval is shown as ± if its value lies off the middle by less than a tenth of the half width
    symmetric = abs(p.value - middle) < 0.1 * half
    return measured(
        symbol, with_error(p.value, half) if symmetric else with_interval(p), coordinate
    )


def damping_of(found: Result[Any]) -> list[str]:
    """Return in sentences the mass, the natural frequency and the damping ratio, which a test engineer asks for first,
    and the damping of the smallest and the largest level."""
    k, m, error, sentences = found.k, found.mass, found.mass_error, []
    if not math.isnan(m):
        given = not error > _ROUNDING * m
        text = number_text(m, 5) if given else with_error(m, error)
        known = measured("m", text, found.coordinate) + " as given" * given
        ratio = found.damping_ratio
        zeta = "" if math.isnan(ratio) else f", ζ = {percent(ratio, 3)} from c alone"
        hertz = number_text(found.natural_frequency, 4)
        sentences.append(
            f"{known}, f_n = {hertz} Hz{zeta}. If your rig differs, check gains, units and k."
        )
    cycles = [of for of in found.level_documents if of.get("W_J", 0.0) > 0.0 and k > 0.0]
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


def wrapped(lines: Iterable[str], width: int | None) -> list[str]:
    """Return lines broken at a width, if there is one, but not between a number and its unit."""
    broken: list[str] = []
    for line in lines:
        tied = re.sub(r"(?<=[\d=±<>]) (?=\S)| (?==)", "\N{NO-BREAK SPACE}", line)
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


def weights(found: Result[Any]) -> list[str]:
    """Return a line for each model that was weighed: what it has beyond the plain one, and of what size."""
    if len(found.weighed) < 2:
        return []
    lines = [
        (MODELS.get(name, name), f"{weight:.2g}", with_error(size, error) if error else "")
        for name, weight, size, error in found.weighed
    ]
    return aligned([("model with", "weight", "size (SI)"), *lines])


def comparison(found: Result[Any], width: int | None) -> list[str]:
    """Return what follows from a comparison of laws, and a line for each law with its weight."""
    if found.laws is None:
        return []
    lines = [("law", "weight", "coefficients")]
    for one in found.laws.laws:
        values = ", ".join(
            f"{found.coordinate.symbol(key)} = {number_text(value, 5)} ± {number_text(error, 2)}"
            for key, (value, error) in one.coefficients.items()
        )
        law = ", ".join(map(found.coordinate.symbol, one.terms))
        lines.append((law, f"{one.weight:.2g}", values))
    return [*wrapped(found.in_sentences(found.laws.findings), width), "", *aligned(lines)]


def implied(fit: OscillatorFit, given_mass: float | None = None) -> list[Finding]:
    """Return what a fit implies about the rig: numbers that its owner can check.

    given_mass : kg, to compare with the mass of the fit, unless that is the one.
    """
    error = fit.error("m")
    # what rounding leaves of the error of a mass that is given
    given = error < _ROUNDING * fit.m
    of = {"given": given, "size": (fit.m, error), "hertz": fit.natural_frequency_hz}
    compared = {} if given or given_mass is None else {"masses": (fit.m, given_mass)}
    return [Finding("best fit", of), *([Finding("masses", compared)] if compared else [])]


def with_interval(parameter: ParameterEstimate) -> str:
    """Return "1.2807 [1.2784, 1.2831]": digits down to a tenth of the interval's half width."""
    value, interval = value_of(parameter), interval_of(parameter)
    return value if interval == "–" else f"{value} {interval}"


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
