"""The coordinate of a record, a displacement or an angle: this is the one place that knows both sets of units.

An oscillator that rotates obeys the equations of one that moves along a line, with an angle for the displacement, a
torque for the force and a moment of inertia for the mass. Both sets of units are coherent, so that every number keeps
its digits, and only names change. Inside the package the names of a translation stand for both; names are exchanged
where units are read and where results are shown.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from ..model import named_with_unit

# a unit behind a number, within brackets, or behind "in"; not one that is exchanged already
_UNIT_IN_TEXT = re.compile(
    r"(?:(?<=[\d⁰¹²³⁴⁵⁶⁷⁸⁹)\]∞–][ \u00a0])|(?<=\()|(?<=\bin ))"
    r"(k?N(?: s[²³]?)?(?:/m?m[²³]?)?|kg|[µmn]?m[²³]?(?:/s[²³]?)?|s/m)"
    r"(?=[\s.,;:)\]<?]|$)(?!\s[ms](?![a-z]))"
)
_TOKEN = re.compile(r"kg|(?<![a-zµ])k?N|(?<![a-zµ])([µmn]?)m(?=[²³/ ]|$)")
_UNIT_IN_KEY = re.compile(
    r"_(N_s_per_m|N_s2_per_m2|N_s3_per_m3|N_per_m[23]?|N|kg|m_per_s2?|m2_per_s|m3_per_s2|m4_per_s3|m)$"
)
_SYMBOL = re.compile(r"(?<![A-Za-z])F_k(?![A-Za-z])|(?<![\w/°])m(?= = [\d−-])")
_IN_HTML = re.compile(r"<i>F</i><sub>k</sub>")
_WORDS = {
    "displacement": "angle",
    "displacements": "angles",
    "velocity": "angular velocity",
    "acceleration": "angular acceleration",
    "force": "torque",
    "forces": "torques",
    "a mass": "an inertia",
    "mass": "inertia",
    "mm taken for m": "mrad taken for rad",
    **dict.fromkeys(
        ("cm taken for m", "mm taken for inches", "mm taken for cm"), "degrees taken for rad"
    ),
}
_WORD = re.compile(
    rf"(?<![A-Za-z-])(?<!angular[ _])({'|'.join(sorted(_WORDS, key=len, reverse=True))})(?![A-Za-z])(?!=)",
    re.IGNORECASE,
)
_DRAWN = {r"\ddot x": r"\ddot\theta", r"\dot x": r"\dot\theta", "$x": r"$\theta"}


@dataclass(frozen=True, slots=True)
class Coordinate:
    """The kind of a coordinate, `TRANSLATION` or `ROTATION`, which names quantities, symbols and units.

    name : "translation" or "rotation".
    """

    name: str

    def unit(self, unit: str) -> str:
        """Return the unit that belongs to a unit of a translation: N m for N, N m/rad for N/m, kg m² for kg, mrad for
        mm."""
        if self == TRANSLATION or "rad" in unit or unit in ("N m", "kN m", "kg m²"):
            return unit
        return _TOKEN.sub(_rotating, unit)

    def symbol(self, symbol: str) -> str:
        """Return the symbol of a number: T_k for F_k, J for m."""
        if self == TRANSLATION:
            return symbol
        return "J" if symbol == "m" else f"T{symbol[1:]}" if symbol.startswith("F_k") else symbol

    def noun(self, noun: str) -> str:
        """Return a noun, or the name of a quantity: angle for displacement, base_angle for base_displacement; anything
        else as it is."""
        if self == TRANSLATION:
            return noun
        if "_" not in noun:
            return _WORDS.get(noun, noun)
        return "_".join(_WORDS.get(one, one) for one in noun.split("_")).replace(" ", "_")

    def key(self, name: str) -> str:
        """Return the name of a column or key: T_k_N_m for F_k_N, angular_velocity_rad_per_s for velocity_m_per_s."""
        if self == TRANSLATION:
            return name
        if name in ("m", "m_kg"):
            return "J" if name == "m" else "J_kg_m2"
        if name.startswith(("m_standard_error", "m_percent")):
            name = f"J{name[1:]}"
        ended = _UNIT_IN_KEY.search(name)
        if ended and not re.search(r"_(N_m|rad)", name):
            unit = next(unit for unit in _KEYED if named_with_unit("", unit) == ended[0])
            name = named_with_unit(name[: ended.start()], self.unit(unit))
        return _SYMBOL.sub("T_k", _WORD.sub(lambda of: _of_word(of[1]).replace(" ", "_"), name))

    def text(self, text: str, names: Iterable[str] = ()) -> str:
        """Return a sentence with the words, symbols and units of the coordinate.

        names : of records and the like, which stay.
        """
        if self == TRANSLATION:
            return text
        kept = sorted({n for n in names if self._exchanged(n) != n}, key=len, reverse=True)
        pieces = re.split(f"({'|'.join(map(re.escape, kept))})", text) if kept else [text]
        return "".join(self._exchanged(p) if i % 2 == 0 else p for i, p in enumerate(pieces))

    def _exchanged(self, text: str) -> str:
        text = _WORD.sub(_in_place, text)  # "mm taken for m" before its units
        text = _UNIT_IN_TEXT.sub(lambda of: self.unit(of[1]), text)
        text = _SYMBOL.sub(lambda of: "T_k" if of[0] == "F_k" else "J", text)
        return _IN_HTML.sub("<i>T</i><sub>k</sub>", text)

    def drawn(self, text: str, names: Iterable[str] = ()) -> str:
        """Return a text of a figure: like `text`, with θ for x."""
        if self == ROTATION:
            for x, theta in _DRAWN.items():
                text = text.replace(x, theta)
        return self.text(text, names)

    def document(self, value: Any, names: Collection[str] = ()) -> Any:
        """Return plain data with the keys and the sentences of the coordinate."""
        if self == TRANSLATION:
            return value
        if isinstance(value, Mapping):
            keys = [key if key in names else self.key(str(key)) for key in value]
            return dict(zip(keys, (self.document(v, names) for v in value.values()), strict=True))
        if isinstance(value, list | tuple):
            return [self.document(v, names) for v in value]
        return self.text(value, names) if isinstance(value, str) else value


TRANSLATION = Coordinate("translation")
"""A displacement in m, a force in N, a mass in kg."""

ROTATION = Coordinate("rotation")
"""An angle in rad, a torque in N m, a moment of inertia in kg m²."""

_KEYED = (
    *("N", "N/m", "N/m²", "N/m³", "N s/m", "N s²/m²", "N s³/m³", "kg", "m", "m/s", "m/s²"),
    *("m²/s", "m³/s²", "m⁴/s³"),
)
"""Units that columns and keys are named with."""


def _rotating(token: re.Match[str]) -> str:
    if token[0] == "kg":
        return "kg m²"
    return f"{token[0]} m" if token[0].endswith("N") else f"{token[1]}rad"


def _of_word(word: str) -> str:
    of = _WORDS[word.lower()]
    return of[0].upper() + of[1:] if word[0].isupper() else of


def _in_place(word: re.Match[str]) -> str:
    """Return a word of a sentence in the coordinate; a part of a name such as relative_velocity has no blank."""
    whole, (start, end) = word.string, word.span()
    named = whole[start - 1 : start] == "_" or whole[end : end + 1] == "_"
    return _of_word(word[1]).replace(" ", "_") if named else _of_word(word[1])
