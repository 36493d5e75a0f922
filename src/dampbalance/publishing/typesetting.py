"""Symbols and units as HTML, filters for the templates of pages (`project/wording.py` has plain characters)."""

from __future__ import annotations

import re

from markupsafe import Markup, escape

from ..project.wording import in_html

_INDEXED = re.compile(r"(\w)([₀-₉]+)")
_FROM_LOWERED = str.maketrans("₀₁₂₃₄₅₆₇₈₉", "0123456789")
# Single letters that are symbols: in the name of a quantity all but the article, in a reason those that are no unit.
_OF_QUANTITY = re.compile(r"(?<![\w’'])([b-zB-Z]|a(?=:))(?![\w’'])")
_OF_REASON = re.compile(r"(?<![\w’'.])([bcWXYk])(?![\w’'])")
_UNIT = re.compile(r"(?<=\d) (?=(?:%|N|Hz|mm|µm|m|ms|µs|s|rad)(?:\W|$))")  # the space before a unit


def rich_markup(text: str) -> Markup:
    """Return text with its symbols set in HTML: X_s an italic X with a lowered s, phi φ; units stay with numbers."""
    return Markup(in_html(_UNIT.sub("\N{NO-BREAK SPACE}", text)))


def symbol(text: str) -> Markup:
    """Return `rich_markup` for a column head, where a single letter is a symbol too: a, F_k, c by X_s."""
    head, by, approach = text.partition(" by ")
    shown = Markup(f"<i>{escape(head)}</i>") if len(head) == 1 else rich_markup(head)
    return shown + by + rich_markup(approach)


def quantity_markup(text: str) -> Markup:
    """Return `rich_markup` for the meaning of a printed number, single letters as symbols: a: friction travel."""
    return titled(_OF_QUANTITY.sub(r"*\1*", text))


def reason(text: str) -> Markup:
    """Return `rich_markup` for the reason of a verdict, with its symbols of one letter: c acts as c + mω²h."""
    return titled(_OF_REASON.sub(r"*\1*", text.replace("mω²h", "*m*ω²*h*")))


def titled(text: str) -> Markup:
    """Return `rich_markup`, with symbols between asterisks as well, *c*, and plain indices lowered: ω₁."""
    html = re.sub(r"\*(.+?)\*", r"<i>\1</i>", str(rich_markup(text)))
    return Markup(
        _INDEXED.sub(lambda m: f"<i>{m[1]}</i><sub>{m[2].translate(_FROM_LOWERED)}</sub>", html)
    )
