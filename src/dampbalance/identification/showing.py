"""An identification for a screen and for a notebook: a table of the answers, and sentences around it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from typing import Protocol

from .answers import Answer
from .lawtable import aligned
from .result import ParameterEstimate, unit_of
from .verdicts import in_one

LIMITS = "What limits the answer:"

_SMALLEST, _LARGEST = -6, 9  # powers of ten between which a number is written out
_DIGITS, _MANTISSA = (
    15,
    6,
)  # significant digits of a float; decimals of a number with a power of ten


class _Swinging(Protocol):
    """The fit of an oscillator."""

    @property
    def m(self) -> float: ...
    @property
    def natural_frequency_hz(self) -> float: ...
    def error(self, name: str, /) -> float: ...


@dataclass(frozen=True)
class Shown:
    """What is shown of an identification.

    head : of what it is made.   table : its first line names the columns.   implied : of the oscillator.   laws : lines
    on the laws compared.   limits : what limits the answer, a sentence each.
    """

    head: str
    table: tuple[tuple[str, ...], ...]
    implied: tuple[str, ...]
    laws: tuple[str, ...]
    limits: tuple[str, ...]

    def text(self) -> str:
        """For a screen."""
        lines = [self.head, "", *aligned(self.table), "", *self.implied]
        lines += ["", *self.laws] if self.laws else []
        lines += ["", LIMITS, *self.limits] if self.limits else []
        return "\n".join(lines) + "\n"

    def html(self) -> str:
        """For a notebook."""
        heads, *lines = self.table
        named = "".join(f'<th scope="col">{escape(head)}</th>' for head in heads)
        rows = "".join(
            f'<tr><th scope="row">{escape(name)}</th>'
            + "".join(f"<td>{escape(cell)}</td>" for cell in cells)
            + "</tr>"
            for name, *cells in lines
        )
        parts = [
            f"<p>{escape(self.head)}</p>",
            f"<table><thead><tr>{named}</tr></thead><tbody>{rows}</tbody></table>",
        ]
        parts += [f"<p>{escape(' '.join(self.implied))}</p>"] if self.implied else []
        parts += [f"<pre>{escape(chr(10).join(self.laws))}</pre>"] if self.laws else []
        if self.limits:
            items = "".join(f"<li>{escape(words)}</li>" for words in self.limits)
            parts.append(f"<p>{escape(LIMITS)}</p><ul>{items}</ul>")
        return f"<div>{''.join(parts)}</div>"


def table_of(answers: Mapping[str, Answer]) -> tuple[tuple[str, ...], ...]:
    """The values with their intervals and what they are worth, a line for each answer below one of heads."""
    symbols = dict.fromkeys(s for answer in answers.values() for s in answer.parameters)
    order = sorted(symbols, key=lambda symbol: symbol == "K_z")  # the contact last
    lines = [("", *map(_headed, order), "verdict")]
    for name, answer in answers.items():
        known = answer.parameters
        cells = (with_interval(known[s]) if s in known else "" for s in order)
        lines.append((name + " *" * bool(answer.notes), *cells, in_one(answer.verdicts)))
    return tuple(lines)


def implied(fit: _Swinging, mass_given: bool) -> list[str]:
    """What a fit says of the rig, which its owner knows better."""
    mass = "the mass given" if mass_given else f"m = {with_error(fit.m, fit.error('m'))} kg"
    return [
        f"The oscillator of largest likelihood has {mass} and a natural frequency of {fit.natural_frequency_hz:.4g} Hz "
        "with the contact loose.",
        "If that is not your rig, a gain, a unit or the stiffness is wrong.",
    ]


def with_error(value: float, error: float) -> str:
    """2.4197 ± 0.0003"""
    return f"{_rounded(value, error)} ± {_rounded(error, error)}"


def with_interval(parameter: ParameterEstimate) -> str:
    """1.2807 [1.2784, 1.2831]: digits down to a tenth of the interval's half width."""
    value, (low, high) = parameter.value, parameter.interval
    if math.isfinite(low) and not math.isfinite(high):
        return f"> {_rounded(low, low)}"
    if not all(map(math.isfinite, (value, low, high))):
        return "–"
    half = 0.5 * (high - low)
    return f"{_rounded(value, half)} [{_rounded(low, half)}, {_rounded(high, half)}]"


def marked(kind: str, words: str) -> str:
    """A sentence on what limits an answer: "*" for a note on approaches, "warning:" for all else."""
    return f"{'* ' if kind == 'approaches' else 'warning: '}{words}"


def _headed(symbol: str) -> str:
    """F_k (N): the head of a column of a table."""
    unit = unit_of(symbol)
    return f"{symbol} ({unit})" if unit else symbol


def _rounded(value: float, spread: float) -> str:
    """The value with two digits of the spread, as a power of ten where either is far from one."""
    if not spread > 0.0:
        return f"{value:.6g}"
    size = math.floor(math.log10(max(abs(value), spread)))
    # what a float holds
    decimals = min(1 - math.floor(math.log10(spread)), _DIGITS - size)
    value = round(value, decimals)
    if _SMALLEST <= size < _LARGEST:
        return f"{value:.{max(0, decimals)}f}"
    return f"{value:.{min(max(0, size + decimals), _MANTISSA)}e}" if value else "0"
