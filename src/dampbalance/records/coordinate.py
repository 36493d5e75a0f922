"""The coordinate of a record, a displacement or an angle, with the names and units that belong to it.

An oscillator that rotates obeys the equations of one that moves along a line, with an angle for the displacement, a
torque for the force and a moment of inertia for the mass. Both sets of units are coherent, so that only names change
and every number keeps its digits. Inside the package the names of a translation stand for both; names are exchanged
where units are read and where results are shown.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

from ..model import named_with_unit

_LENGTH = re.compile(r"(?<![a-zµ])([µmn]?)m(?=[²³/ ]|$)")
_FORCE = re.compile(r"(?<![a-zµ])(k?N)")
_FRICTION = re.compile(r"(?<![A-Za-z])F_k(?![A-Za-z])")
_FORCES = ("F_k", "F+", "F−")
_NOUNS = {
    "displacement": "angle",
    "displacements": "angles",
    "velocity": "angular velocity",
    "acceleration": "angular acceleration",
    "force": "torque",
    "forces": "torques",
    "a mass": "an inertia",
    "mass": "inertia",
}


@dataclass(frozen=True, slots=True)
class Coordinate:
    """The coordinate of a motion, `TRANSLATION` or `ROTATION`, and its names of quantities, symbols and units.

    name : "translation" or "rotation".
    """

    name: str

    def unit(self, unit: str) -> str:
        """Return the unit that replaces one of a translation: N m for N, N m/rad for N/m, kg m² for kg, mrad for
        mm."""
        if self == TRANSLATION or "rad" in unit or unit in ("N m", "kN m", "kg m²"):
            return unit
        return _FORCE.sub(r"\1 m", _LENGTH.sub(r"\1rad", unit)).replace("kg", "kg m²")

    def symbol(self, symbol: str) -> str:
        """Return the symbol of a number: T_k for F_k, J for m."""
        if self == TRANSLATION:
            return symbol
        return "J" if symbol == "m" else f"T{symbol[1:]}" if symbol.startswith(_FORCES) else symbol

    def noun(self, noun: str) -> str:
        """Return the noun or quantity that replaces one of a translation: angle for displacement, base_angle for
        base_displacement; any other noun unchanged."""
        if self == TRANSLATION or "angular" in noun:
            return noun
        if "_" not in noun:
            return _NOUNS.get(noun, noun)
        return "_".join(_NOUNS.get(one, one) for one in noun.split("_")).replace(" ", "_")

    def key(self, name: str) -> str:
        """Return the name of a column or key: T_k_N_m for F_k_N, angular_velocity_rad_per_s for velocity_m_per_s."""
        if self == TRANSLATION:
            return name
        if name in ("m", "m_kg"):
            return "J" if name == "m" else "J_kg_m2"
        if name.startswith(("m_standard_error", "m_percent", "m_interval")):
            name = f"J{name[1:]}"
        ends = [end for end in _KEYED if name.endswith(end)]
        if ends and not re.search(r"_(N_m|rad)", name):
            end = max(ends, key=len)
            name = named_with_unit(name.removesuffix(end), self.unit(_KEYED[end]))
        return _FRICTION.sub("T_k", self.noun(name).replace(" ", "_"))

    def label(self, symbol: str, unit: str) -> str:
        """Return the label of an axis, $x$ (mm) or $\\theta$ (mrad)."""
        drawn = symbol if self == TRANSLATION else self.symbol(symbol).replace("x", r"\theta")
        return f"${drawn}$ ({self.unit(unit)})"

    def document(self, value: Any, names: Collection[str] = ()) -> Any:
        """Return a document with the keys and symbols of the coordinate.   names : keys that stay, such as names of
        records."""
        if self == TRANSLATION:
            return value
        if isinstance(value, Mapping):
            keys = [key if key in names else self.key(str(key)) for key in value]
            return dict(zip(keys, (self.document(v, names) for v in value.values()), strict=True))
        if isinstance(value, list | tuple):
            return [self.document(v, names) for v in value]
        of_friction = isinstance(value, str) and re.fullmatch(r"F_k(\[.*\])?", value)
        return self.symbol(value) if of_friction else value


TRANSLATION = Coordinate("translation")
"""A displacement in m, a force in N, a mass in kg."""

ROTATION = Coordinate("rotation")
"""An angle in rad, a torque in N m, a moment of inertia in kg m²."""

_UNITS = "N, N/m, N/m², N/m³, N s/m, N s²/m², N s³/m³, kg, m, m/s, m/s², m²/s, m³/s², m⁴/s³"
_KEYED = {named_with_unit("", unit): unit for unit in _UNITS.split(", ")}
"""Units by the way in which names of columns and keys end."""
