"""Symbols, units and numbers as the page writes them: HTML for text, plain characters where no markup is possible."""

from __future__ import annotations

import math
import re

from markupsafe import Markup, escape

_GREEK = {"phi": "φ", "omega": "ω", "zeta": "ζ"}
_SUBSCRIPTS = str.maketrans("0123456789ksmn", "₀₁₂₃₄₅₆₇₈₉ₖₛₘₙ")
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_SYMBOL = re.compile(r"\b(?:(phi|omega|zeta)(?:_(\w))?|([A-Za-zω])_([kszmn]|\d))\b")
_UNIT = re.compile(r"(?<=\d) (?=(?:%|N|Hz|mm|µm|m|ms|µs|s|rad)(?:\W|$))")  # the space before a unit


def rich(text: str) -> Markup:
    """Text with its symbols set in HTML: X_s an italic X with a lowered s, phi φ; a unit stays with its number."""

    def symbol(match: re.Match[str]) -> str:
        name = _GREEK.get(match[1]) or match[3]
        index = match[2] or match[4]
        return f"<i>{name}</i>" + (f"<sub>{index}</sub>" if index else "")

    return Markup(_SYMBOL.sub(symbol, str(escape(_UNIT.sub("\N{NO-BREAK SPACE}", text)))))


def plain(text: str) -> str:
    """Text with its symbols in plain characters, for axis titles: X_s becomes Xₛ, phi becomes φ."""

    def symbol(match: re.Match[str]) -> str:
        name = _GREEK.get(match[1]) or match[3]
        index = match[2] or match[4] or ""
        lowered = index.translate(_SUBSCRIPTS)
        return name + (lowered if lowered != index or not index else f"_{index}")

    return _SYMBOL.sub(symbol, text)


def one_letter(text: str) -> Markup:
    """`rich`, and a single letter is a symbol too: c, a, X."""
    return Markup(f"<i>{escape(text)}</i>") if len(text) == 1 else rich(text)


def unit_of(text: str) -> str:
    """A unit as it is read: m^2/s becomes m²/s, the unit of a pure number becomes nothing."""
    return "" if text in ("", "1") else text.replace("^2", "²")


def number(value: float, digits: int = 7) -> str:
    """A number to this many significant digits, trailing zeros kept, powers of ten as 1.2·10⁻³; – for none."""
    if not math.isfinite(value):
        return "–"
    if value == 0.0:
        return "0"
    exponent = math.floor(math.log10(abs(value)))
    if not -5 <= exponent < 7:
        mantissa = f"{value / 10.0**exponent:.{digits - 1}f}"
        return minus(f"{mantissa}·10{str(exponent).translate(_RAISED)}")
    return minus(f"{value:.{max(0, digits - 1 - exponent)}f}")


def power_of_ten(bound: float) -> str:
    """The least power of ten that is not below a bound, 10⁻¹¹."""
    return f"10{str(math.ceil(math.log10(bound))).translate(_RAISED)}" if bound > 0.0 else "0"


def minus(text: str) -> str:
    """A number with a true minus sign."""
    return re.sub(r"(?<![\w.])-(?=\d)", "−", text)


def frequency_name(name: str) -> str:
    """A frequency of the configuration as a symbol: omega1 becomes ω₁; other names stay."""
    index = name.removeprefix("omega")
    return (
        f"ω{index.translate(_SUBSCRIPTS)}" if name.startswith("omega") and index.isdigit() else name
    )
