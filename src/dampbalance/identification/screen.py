"""Answers in plain characters: tables of values with their intervals, and sentences on what a fit implies."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Mapping, Sequence

from ..findings.finding import Finding
from ..findings.words import limit, sentence, unit_of
from ..fit.oscillator_fit import OscillatorFit
from ..project import wording
from ..project.wording import listed, number_text, part, percent, rounded, with_error
from ..records.coordinate import TRANSLATION, Coordinate
from .answer import USABLE, Answer, ParameterEstimate, Verdict
from .law_comparison import LawComparison, Probability
from .level import Level, damping_ratio

_ROUNDING = 1e-12
_SKEW = 0.1  # of the half width, by which a value may lie off the middle of an interval that is shown as ±


def answers_table(answers: Mapping[str, Answer]) -> list[tuple[str, ...]]:
    """Return the values with their intervals and verdicts, a line for each answer below a line of heads."""
    symbols = dict.fromkeys(s for answer in answers.values() for s in answer.parameters)
    order = sorted(symbols, key=lambda symbol: symbol == "K_z")  # the contact last
    lines = [("", *map(headed, order), "verdict")]
    for name, answer in answers.items():
        cells = (with_interval(p) if (p := answer.parameters.get(s)) else "" for s in order)
        lines.append((name + " *" * bool(answer.notes), *cells, in_one(answer.verdicts)))
    return lines


def aligned(table: Sequence[Sequence[str]]) -> list[str]:
    """Return the lines of a table with columns of equal width."""
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    return ["  ".join(map(str.ljust, line, widths)).rstrip() for line in table]


def in_one(verdicts: Mapping[str, Verdict]) -> str:
    """Return the verdicts on several parameters for a line of a table: "usable within 1.2 %", or "usable within 0.3 %:
    F_k, c; none: K_z", where the number that is known least decides."""
    by_word: dict[str, list[str]] = {}
    for symbol, one in verdicts.items():
        by_word.setdefault(one.verdict, []).append(symbol)
    parts = []
    for word, symbols in by_word.items():
        sizes = [within for s in symbols if math.isfinite(within := verdicts[s].within)]
        size = f" within {part(max(sizes))}" if word == USABLE and sizes else ""
        named = f": {', '.join(symbols)}" if len(by_word) > 1 else ""
        parts.append(f"{word}{size}{named}")
    return "; ".join(parts)


def answer_in_words(answer: Answer, coordinate: Coordinate) -> str:
    """Return the values with their intervals of 95 %, and how far they can be used, in a sentence: "F_k = 2.100 ± 0.010
    N, … at 95 %: usable within 0.6 %."; after a doubt its first reason."""
    values = [_with_half_width(symbol, p) for symbol, p in answer.parameters.items()]
    doubts = [f for v in answer.verdicts.values() if v.verdict != USABLE for f in v.findings]
    first = [one for one in doubts if one.kind == doubts[0].kind]
    why = f", as {sentence(first, coordinate, remedy=False)}" if first else ""
    return f"{', '.join(filter(None, values))} at 95 %: {in_one(answer.verdicts)}{why}."


def _with_half_width(symbol: str, p: ParameterEstimate) -> str:
    """Return F_k = 1.2803 ± 0.0011 N, with the interval itself where it is not symmetric; a limit; nothing for no
    value."""
    low, high = p.interval
    half, middle = 0.5 * (high - low), 0.5 * (high + low)
    if math.isnan(p.value):
        return ""
    if math.isinf(high) or low <= 0.0 < high:
        return limit(symbol, low, high, TRANSLATION)
    symmetric = abs(p.value - middle) < _SKEW * half
    shown = with_error(p.value, half) if symmetric else with_interval(p)
    return wording.with_unit(f"{symbol} = {shown}", unit_of(symbol))


def agreement_of(answers: Mapping[str, Answer]) -> str:
    """Return by how much the next answer with values differs from the first one, in a sentence."""
    answer, *others = answers.values()
    for other in others:
        apart = [
            f"{part(abs(other.values[symbol] / p.value - 1.0))} in {symbol}"
            for symbol, p in answer.coefficients.items()
            if p.value and math.isfinite(other.values.get(symbol, math.nan) / p.value)
        ]
        if apart:
            kind = "fit" if other.balance is None else "energy balance"
            name = "" if other.name == "balance" else f" ({other.name})"
            return f"Check: the {kind}{name} differs by {listed(apart)}."
    return "Check: none, as no other evaluation of these records has values."


def damping_of(k: float, mass: tuple[float, float], c: float, levels: Sequence[Level]) -> list[str]:
    """Return in sentences the mass, the natural frequency and the damping ratio, which a test engineer asks for first,
    and the damping of the smallest and the largest level.

    k : N/m.   mass : with its standard error, kg; NaN where it is not known.   c : N s/m.
    """
    (m, error), sentences = mass, []
    if not math.isnan(m):
        given = not error > _ROUNDING * m
        known = (
            f"m = {number_text(m, 5)} kg as given" if given else f"m = {with_error(m, error)} kg"
        )
        ratio = damping_ratio(c, k, m)
        zeta = "" if math.isnan(ratio) else f", ζ = {percent(ratio, 3)} from c alone"
        hertz = number_text(math.sqrt(k / m) / (2.0 * math.pi), 4)
        sentences.append(
            f"{known}, f_n = {hertz} Hz{zeta}. If your rig differs, check gains, units and k."
        )
    sizes = sorted(
        (level for level in levels if level.W > 0.0 and k > 0.0), key=lambda level: level.X
    )
    if sizes:
        ends = sizes[:: len(sizes) - 1 or 1]
        at = [
            f"η = {number_text(level.loss_factor(k), 3)}"
            + (f", ζ_eq = {percent(damping_ratio(level.equivalent_damping, k, m), 3)}" * (m == m))
            + f" at X = {number_text(1e3 * level.X, 3)} mm"
            for level in ends
        ]
        sentences.append(f"With friction: {'; '.join(at)}.")
    return sentences


def wrapped(lines: Sequence[str], width: int) -> list[str]:
    """Return lines broken at a width, but not between a number and its unit; those of a table, which have two spaces
    between columns, are not."""
    broken = []
    for line in lines:
        if "  " in line:
            broken.append(line)
            continue
        tied = re.sub(r"(?<=[\d=±<>]) (?=\S)| (?==)", "\N{NO-BREAK SPACE}", line)
        indent = "  " * line.startswith("- ")
        pieces = textwrap.wrap(
            tied, width, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False
        )
        broken += [piece.replace("\N{NO-BREAK SPACE}", " ") for piece in pieces or [""]]
    return broken


def comparison(laws: LawComparison | None) -> list[str]:
    """Return what follows from a comparison of laws, then a line for each law with its tests."""
    if laws is None:
        return []
    table = [["law", *laws.names, "", "coefficients"]]
    for test in laws.tests:
        rejected = test.rejected_by_balance if laws.by_balance else test.rejected
        word = "chosen" if laws.chosen == test.terms else "rejected" if rejected else "possible"
        values = ", ".join(
            f"{key} = {number_text(value, 5)} ± {number_text(error, 2)}"
            for key, (value, error) in test.coefficients.items()
        )
        tests = [_in_noise(test.tests.get(name)) for name in laws.names]
        table.append([", ".join(test.terms), *tests, word, "" if word == "rejected" else values])
    return [
        *(f"{words[0].upper()}{words[1:]}." for words in laws.words()),
        f"p-value of the residual of each law in the {' and in the '.join(laws.names)}:",
        "",
        *aligned(table),
    ]


def _in_noise(test: Probability | None) -> str:
    if test is None:
        return "–"
    if math.isnan(test.p):
        return "no degrees of freedom left"
    return "< 1e-6" if test.p < 1e-6 else f"{test.p:.2g}"


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


def headed(symbol: str) -> str:
    """Return F_k (N): the head of a column of a table."""
    return wording.label_with_unit(symbol, unit_of(symbol))
