"""Numbers, symbols, units and names as people read them, in plain characters: the only place for them."""

from __future__ import annotations

import difflib
import math
import re
import unicodedata
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from html import escape
from typing import Any

MINUS, TIMES, NO_NUMBER = "−", "·", "–"
GREEK = {"phi": "φ", "omega": "ω", "zeta": "ζ"}
SYMBOL = re.compile(r"\b(?:(phi|omega|zeta)(?:_(\w))?|([A-Za-zζω])_([kszmn]|\d|eq))\b")
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_LOWERED = str.maketrans("0123456789ksmn", "₀₁₂₃₄₅₆₇₈₉ₖₛₘₙ")
_SMALLEST, _LARGEST = -6, 9  # powers of ten between which a number is written out
_NAME = 40  # characters of a name that are compared
_MANY_TIMES = 1000  # larger factors are not distinguished
_FRACTIONS = {
    **{2.0: "twice", 1 / 2: "half", 1 / 3: "a third of", 1 / 4: "a quarter of"},
    **{1 / 5: "a fifth of", 0.1: "a tenth of", 1e-2: "a hundredth of", 1e-3: "a thousandth of"},
}


def ten_to(exponent: int) -> str:
    """Return a power of ten, 10⁻³."""
    return f"10{str(exponent).translate(_RAISED)}"


def scientific(mantissa: str, exponent: int) -> str:
    """Return a number with its power of ten, 1.2·10⁻³."""
    return f"{mantissa}{TIMES}{ten_to(exponent)}"


def power_of_ten(bound: float) -> str:
    """Return the least power of ten that is not below a bound, 10⁻¹¹."""
    return ten_to(math.ceil(math.log10(bound))) if bound > 0.0 else "0"


def percent(share: float, digits: int = 3) -> str:
    """Return a share as a percentage to this many significant digits, 0.0150 %; a bound where it is mere rounding.

    Percentages below a thousandth and from ten thousand on are powers of ten with two digits, 1.2·10⁴ %.
    """
    value = 100.0 * abs(share)
    if not math.isfinite(value):
        return NO_NUMBER
    if value < 1e-6:
        return f"{power_of_ten(value)} %"
    value = min(value, 99.99) if value < 100.0 else value
    while value < 100.0 <= float(f"{value:.{digits}g}"):  # do not round 99.97 % up to 100 %
        digits += 1
    far = not -3 <= _split(value, digits)[1] < 4
    return f"{number_text(value, 2 if far else digits, -3, 4)} %"


def signed_percent(share: float, plus: str = "+", digits: int = 3) -> str:
    """Return a share as a percentage with its sign, +1.37 % or −65.8 %.   plus : the sign of a positive one."""
    sign = MINUS if share < 0.0 else plus if share > 0.0 else ""
    text = percent(share, digits)
    return text if text == NO_NUMBER else sign + text


def number_text(value: float, digits: int = 7, least: int = -5, most: int = 7) -> str:
    """Return a number to this many significant digits, trailing zeros kept; – for none.

    least, most : powers of ten between which it is written out; others become 1.2·10⁻³.
    """
    if not math.isfinite(value):
        return NO_NUMBER
    if value == 0.0:
        return "0"
    mantissa, exponent = _split(value, digits)
    if not least <= exponent < most:
        return minus(scientific(mantissa, exponent))
    return minus(f"{value:.{max(0, digits - 1 - exponent)}f}")


def _split(value: float, digits: int) -> tuple[str, int]:
    """Return the mantissa to this many digits, and its power of ten: 9.97 is 1.0·10¹ to two digits."""
    mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
    return mantissa, int(exponent)


def signed(value: float, decimals: int = 0) -> str:
    """Return a number with its sign and so many decimals, +1.4 or −0.3; no sign where only zeros are shown."""
    text = f"{value:+.{decimals}f}"
    return minus(text) if float(text) else text[1:]


def factor(value: float) -> str:
    """Return a factor for a sentence: 3.2, 450, more than 1,000."""
    if value > _MANY_TIMES:
        return f"more than {_MANY_TIMES:,}"
    return f"{value:.2g}" if value < 99.5 else f"{value:.0f}"


def part(share: float) -> str:
    """Return a share as a percentage of two digits for a sentence, 4.7 % or 1 %."""
    return percent(share, 2).replace(".0 %", " %")


def larger_by(share: float) -> str:
    """Return by how much something is larger, for a sentence: 4.7 %; from twice as large on, "a factor of 3.2"."""
    return f"a factor of {factor(1.0 + share)}" if share >= 1.0 else part(share)


def change_text(value: float, by: float, unit: str = "") -> str:
    """Return by how much a number changes, for a sentence: +4.7 %, −0.38 %, a factor of 3.2.

    A value of nearly zero has no relative change, and no positive one falls by more than itself: then the change itself
    with its unit, +0.031 N.
    """
    if math.isnan(value) or not by > -math.inf:
        return NO_NUMBER
    share = by / value if value else math.copysign(math.inf, by)
    if -1.0 <= share < 1.0:
        return signed_percent(share, digits=2).replace(".0 %", " %")
    if 0.0 < share <= _MANY_TIMES or math.isinf(by):
        return larger_by(share)
    return with_unit(f"{'+' * (by > 0.0)}{number_text(by, 2, -3, 4)}", unit)


def times(value: float) -> str:
    """Return a positive factor before what it multiplies: 1,730 times, 9.81 times, twice, half, a quarter of."""
    for known, words in _FRACTIONS.items():
        # three digits of one that is less off are those of this
        if abs(value / known - 1.0) < 5e-3:
            return words
    shown = f"{float(f'{value:.3g}'):,.15g}" if value >= 1.0 else written(value, ".3g")
    return f"{shown} times"


def written(value: float, spec: str) -> str:
    """Return a number in a form such as ".3g" as people write it, −0.5 or 1.65·10³."""
    text = minus(format(value, spec))
    return re.sub(r"e([+-]\d+)", lambda match: f"{TIMES}{ten_to(int(match[1]))}", text)


def rounded(value: float, spread: float) -> str:
    """Return the value with two digits of the spread, as a power of ten where either is far from one."""
    if not spread > 0.0:
        return written(value, ".6g")
    size = math.floor(math.log10(max(abs(value), spread)))
    # a float has 15 significant digits
    decimals = min(1 - math.floor(math.log10(spread)), 15 - size)
    value = round(value, decimals)
    if _SMALLEST <= size < _LARGEST:
        return minus(f"{value:.{max(0, decimals)}f}")
    # a number with a power of ten has six decimals at most
    return number_text(value, 1 + min(max(0, size + decimals), 6), 0, 0)


def with_error(value: float, error: float) -> str:
    """Return a number with its error, 2.4197 ± 0.0003"""
    return f"{rounded(value, error)} ± {rounded(error, error)}"


def listed(words: Sequence[str], last: str = "and") -> str:
    """Return words in a row: "a", "a and b", "a, b and c"."""
    return f" {last} ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def dotted(values: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Yield every value of nested mappings with its dotted key, e.g. ("excitation.levels_m", …)."""
    for name, value in values.items():
        if isinstance(value, Mapping):
            yield from dotted(value, f"{above}{name}.")
        else:
            yield f"{above}{name}", value


def minus(text: str) -> str:
    """Return text whose numbers have a true minus sign, and zeros none."""
    return re.sub(
        r"(?<![\w.])-(\d[\d.]*)", lambda match: MINUS * bool(match[1].strip("0.")) + match[1], text
    )


def sentence(text: str) -> str:
    """Return words as a sentence, with one mark at its end; a symbol or a file at its start keeps its letter."""
    first = text.split(" ")[0].rstrip(":,")
    capital = first.isalpha() and (len(first) > 1 or first == "a")
    end = "" if text.endswith(("?", "!")) else "."
    return (text[0].upper() if capital else text[0]) + text[1:].rstrip(".") + end


def unit_text(text: str) -> str:
    """Return a unit as it is read: m^2/s becomes m²/s, the unit of a pure number becomes nothing."""
    return "" if text in ("", "1") else text.replace("^2", "²")


def with_unit(text: str, unit: str) -> str:
    """Return a number with its unit, if it has one."""
    return f"{text} {unit_text(unit)}".rstrip()


def label_with_unit(name: str, unit: str) -> str:
    """Return a name with its unit in brackets, for a column or an axis, F_k (N); that of a pure number alone."""
    return f"{name} ({unit})" if unit_text(unit) else name


def _symbols(text: str, form: Callable[[str, str], str]) -> str:
    """Return text with its symbols in another form.   form : of a name, φ, and its index, "" if it has none."""

    def symbol(match: re.Match[str]) -> str:
        return form(GREEK.get(match[1]) or match[3], match[2] or match[4] or "")

    return SYMBOL.sub(symbol, text)


def plain_text(text: str) -> str:
    """Return text with its symbols in plain characters, for axis titles: X_s becomes Xₛ, phi becomes φ."""

    def form(name: str, index: str) -> str:
        lowered = index.translate(_LOWERED)
        return name + (lowered if lowered != index or not index else f"_{index}")

    return _symbols(text, form)


def in_html(text: str) -> str:
    """Return text as HTML, its symbols set: X_s becomes an italic X with a lowered s, phi an italic φ."""
    return _symbols(
        escape(text), lambda name, i: f"<i>{name}</i>" + (f"<sub>{i}</sub>" if i else "")
    )


def shortened(value: object, most: int = 60) -> str:
    """Return a value as Python writes it, cut to this many characters: for messages, which are one line each."""
    return cut(repr(value), most)


def cut(text: str, most: int) -> str:
    """Return text of this many characters at the most."""
    return text if len(text) <= most else f"{text[: most - 1]}…"


def did_you_mean(name: object, known: Iterable[str]) -> str:
    """Return the known name that a wrong one resembles as " (did you mean zeta?)"; "" where it resembles none."""
    near = difflib.get_close_matches(cut(str(name), _NAME), known, n=1)
    return f" (did you mean {near[0]}?)" if near else ""


def visible(text: str) -> str:
    """Return text of a user as one line that can be written and does nothing to a screen.

    Line ends, control characters, turns of direction, half surrogates and the like stand as Python spells them, \\n.
    """
    if text.isprintable():
        return text
    return "".join(
        c if c.isprintable() or unicodedata.category(c) == "Zs" else repr(c)[1:-1] for c in text
    )


def frequency_name(name: str) -> str:
    """Return a frequency of the configuration as a symbol: omega1 becomes ω₁; other names stay."""
    index = name.removeprefix("omega")
    return f"ω{index.translate(_LOWERED)}" if name.startswith("omega") and index.isdigit() else name


# Characters that Markdown acts upon: its marks, underscores at edges of words, and starts of headings and lists.
_MARKS = re.compile(
    r"[\\`*\[\]<>|$&~]|(?<![^\W_])_|_(?![^\W_])|^(?:#+|[+-])(?=\s|$)|^[=-](?=[=-]*$)|^\d+(?=[.)](?:\s|$))",
    re.MULTILINE,
)


def in_markdown(text: str) -> str:
    """Return text of a user as Markdown shows it, mark by mark, in a paragraph or a cell of a table."""
    lines = "\n".join(line.strip() for line in text.splitlines())
    return _MARKS.sub(lambda mark: f"{mark[0]}\\" if mark[0].isdigit() else rf"\{mark[0]}", lines)


def markdown_table(heads: Sequence[str], rows: Iterable[Sequence[str]], align: str = "") -> str:
    """Return a table in GitHub-flavoured Markdown.

    heads : a heading for each column.   rows : their cells, ready for Markdown (`in_markdown` for text of a user).
    align : a letter for each column, l (text) or r (numbers); by default all l.
    """
    rule = "".join("---:|" if side == "r" else "---|" for side in align or "l" * len(heads))
    head = "".join(f" {word} |" if word else " |" for word in heads)
    return "\n".join([f"|{head}", f"|{rule}", *(f"| {' | '.join(cells)} |" for cells in rows)])


def in_figure(text: str) -> str:
    """Return text of a user as matplotlib shows it: a dollar is a dollar and begins no formula."""
    return text.replace("$", r"\$")
