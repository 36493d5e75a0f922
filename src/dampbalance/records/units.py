"""Units that laboratories write, and the one place where they are turned into SI.

A unit is read in its usual spellings: µm and um, m/s², m/s^2, m/s2, m s-2 and m_per_s2 are each one unit. A channel
has the unit that belongs to its quantity, or it is refused: a velocity in mm is a mistake, not a number.
"""

from __future__ import annotations

import difflib
import math
import re
from collections import Counter
from dataclasses import dataclass
from functools import cache

from ..model import named_with_unit
from ..project.wording import shortened
from .channel import ABSOLUTE, QUANTITIES, ROTATING
from .coordinate import ROTATION, TRANSLATION, Coordinate

_LENGTHS = {  # m, exactly
    **{"m": 1.0, "cm": 1e-2, "mm": 1e-3, "µm": 1e-6, "nm": 1e-9},
    **{"in": 0.0254, "ft": 0.3048, "mil": 25.4e-6},
}
_STANDARD_GRAVITY = 9.80665  # m/s², exactly
_POUND_FORCE = 4.4482216152605  # N, exactly
_INCH, _FOOT = 0.0254, 0.3048  # m, exactly
_MASSES = {  # kg; the pound-mass is exact
    **{"kg": 1.0, "g": 1e-3, "mg": 1e-6, "t": 1e3},
    **{"lb": 0.45359237, "oz": 0.45359237 / 16.0, "slug": _POUND_FORCE / _FOOT},
    **{"lbs": 0.45359237, "lbm": 0.45359237, "pound": 0.45359237, "pounds": 0.45359237},
}
_ANGLES = {"rad": 1.0, "mrad": 1e-3, "deg": math.pi / 180.0}  # rad
_TURN = 2.0 * math.pi  # rad
_LONGEST = 1000  # characters of a heading: the search for its unit takes their square


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit: a number in it times `factor` is the number in SI.

    name : as written here.   dimension : length, velocity, acceleration, force, time or frequency; of a rotation angle,
    angular velocity, angular acceleration or torque.
    """

    name: str
    dimension: str
    factor: float

    @property
    def coordinate(self) -> Coordinate:
        """Whether it is a unit of a rotation."""
        return ROTATION if self.dimension in _COUNTERPARTS else TRANSLATION

    @property
    def counterpart(self) -> str:
        """The dimension in whose place it stands in the equations: length for an angle, its own for others."""
        return _COUNTERPARTS.get(self.dimension, self.dimension)


_COUNTERPARTS = {
    "angle": "length",
    "angular velocity": "velocity",
    "angular acceleration": "acceleration",
    "torque": "force",
}


UNITS = tuple(
    Unit(name, dimension, factor)
    for dimension, units in {
        "length": _LENGTHS,
        "velocity": {f"{name}/s": factor for name, factor in _LENGTHS.items()},
        "acceleration": {f"{name}/s²": _LENGTHS[name] for name in ("m", "cm", "mm", "in", "ft")}
        | {"g": _STANDARD_GRAVITY, "mg": 1e-3 * _STANDARD_GRAVITY},
        "force": {
            **{"N": 1.0, "µN": 1e-6, "mN": 1e-3, "daN": 10.0, "kN": 1e3, "kgf": _STANDARD_GRAVITY},
            **{"lbf": _POUND_FORCE, "ozf": _POUND_FORCE / 16.0, "kip": 1e3 * _POUND_FORCE},
        },
        "time": {"s": 1.0, "ms": 1e-3, "µs": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0},
        "angle": _ANGLES,
        "angular velocity": {"rad/s": 1.0, "deg/s": _ANGLES["deg"], "rpm": _TURN / 60.0},
        "angular acceleration": {"rad/s²": 1.0, "deg/s²": _ANGLES["deg"]},
        "torque": {
            **{"N m": 1.0, "N cm": 1e-2, "N mm": 1e-3, "mN m": 1e-3, "kN m": 1e3},
            "ozf in": _POUND_FORCE / 16.0 * _INCH,
            "lbf in": _POUND_FORCE * _INCH,
            "lbf ft": _POUND_FORCE * _FOOT,
        },
        "frequency": {"Hz": 1.0, "kHz": 1e3, "MHz": 1e6, "rad/s": 1.0 / _TURN},
    }.items()
    for name, factor in units.items()
)
"""All units. `g` is the standard gravity, 9.80665 m/s²: the gram is no unit of a channel."""

_OTHER_SPELLINGS = {
    "µm": ["micron", "microns", "micrometer", "micrometre"],
    "mm": ["millimeter", "millimetre", "millimeters", "millimetres"],
    "m": ["meter", "metre", "meters", "metres"],
    "in": ["inch", "inches", '"'],
    "in/s": ["ips"],
    "ft": ["foot", "feet"],
    "mil": ["mils", "thou"],
    "g": ["g_n", "gn", "g0", "grav"],
    "N": ["newton", "newtons"],
    "lbf": ["lb", "lbs", "pound-force"],
    "kip": ["kips", "klbf"],
    "s": ["sec", "second", "seconds"],
    "ms": ["msec", "millisecond", "milliseconds"],
    "µs": ["usec", "microsecond", "microseconds"],
    "Hz": ["hertz", "1/s", "samples/s", "samples per second", "Sa/s", "S/s"],
    "rad": ["radian", "radians"],
    "deg": ["°", "degree", "degrees", "grad"],
    "deg/s": ["°/s", "degrees/s", "dps"],
    "deg/s²": ["°/s2"],
    "rpm": ["cpm", "1/min", "U/min", "r/min", "rev/min", "min-1"],
    "ozf in": ["oz in", "in ozf", "in oz"],
    "lbf in": ["lb in", "in lbf", "in lb"],
    "lbf ft": ["lb ft", "ft lbf", "ft lb"],
}


VOLTAGE = "a voltage"  # any transducer may give one: the `scale` of a mapping makes a motion of it

_OTHERS = {
    "a temperature": ("°C", "degC", "deg C", "C", "K", "°F", "degF", "deg F"),
    VOLTAGE: ("V", "mV", "Volt", "volt", "VOLT", "Volts", "VDC"),
    "a current": ("A", "mA", "Ampere"),
    "a pressure": ("bar", "mbar", "Pa", "kPa", "MPa"),
    "a part": ("%", "dB", "ppm", "µm/m"),
    "a power": ("W", "mW", "kW", "Nm/s"),
    "an impulse": ("Ns", "N·s"),
    "a speed in knots": ("kn",),
    "a conductance": ("S", "mS", "µS", "nS", "MS"),
    "an inductance": ("H", "mH", "µH"),
}


class UnitError(ValueError):
    """A unit that is not known, or that does not fit what the channel holds."""


def find_unit(text: str, dimension: str | None = None) -> Unit | None:
    """Return the unit that a text spells, or None.   dimension : of rad/s, which is a frequency unless it is asked for
    as an angular velocity."""
    plain = _plain(text)
    unit = _EXACT.get(plain) or _FOLDED.get(plain.casefold())
    return _RATE if unit and unit.name == _RATE.name and dimension == _RATE.dimension else unit


def find_motion(text: str) -> Unit | None:
    """Return the unit that a text spells, or None; rad/s is one of an angular velocity."""
    return find_unit(text, _RATE.dimension)


def find_other(text: str) -> str | None:
    """Name what is measured in a unit, if that is no motion, force or time: "a temperature"; or None.

    Upper and lower case count here: mS is a conductance, ms a time.
    """
    return _OTHER_UNITS.get(_plain(text))


def unit_for(text: str, quantity: str, dimension: str | None = None) -> Unit:
    """Return the unit that a text spells, fit for a quantity of `DIMENSIONS`, or for any other of the given dimension.

    Raises UnitError: not known (with the nearest known one), or of another dimension.
    """
    wanted = dimension or DIMENSIONS[quantity]
    fitting = [unit.name for unit in UNITS if unit.dimension == wanted]
    unit = find_unit(text, wanted)
    if unit is None:
        names = [unit.name for unit in UNITS]
        alike = [name for name in names if name.casefold() == text.strip().casefold()]
        near = alike or difflib.get_close_matches(text.strip(), names, n=1)
        hint = f" (did you mean {near[0]}?)" if near else ""
        other = find_other(text)
        what = f"{text!r} is a unit of {other}" if other else f"unknown unit {shortened(text)}"
        raise UnitError(f"{what}{hint}; known for {wanted}: {', '.join(fitting)}")
    if unit.dimension != wanted:
        raise UnitError(
            f"{text!r} is a unit of {unit.dimension}, but {quantity.replace('_', ' ')} needs one of {wanted}: "
            f"{', '.join(fitting)}"
        )
    return unit


def split_label(label: str) -> tuple[str, str | None]:
    """Name and unit of a column header: "x [mm]", "x (mm)", "x/mm", "x, mm", "x in mm" and "x_mm" give ("x", "mm").

    What stands in brackets is the unit, known or not, except a number, which counts; elsewhere only a known one is.
    The word "in" at the end is no unit: disp_in goes with disp_out. None stands for no unit.
    """
    label = label.strip()
    if len(label) > _LONGEST:
        return label, None
    if match := re.fullmatch(r"(.*?)\s*[\[({<]\s*(?!\d+[\])}>])([^\])}>]*?)\s*[\])}>]", label):
        return match[1].rstrip(" /,;:"), match[2] or None
    match = re.fullmatch(r"(.+?)\s*(?:[/,;:]|\bin\b(?=\s))\s*(\S.*)", label)
    if match and (find_unit(match[2]) or find_other(match[2])):
        return match[1].strip(), match[2].strip()
    parts = re.split(r"[_\s]", label)
    for start in range(1, len(parts)):  # the longest ending that is a unit: "m_per_s2" before "s2"
        ending = "_".join(parts[start:])
        # a single letter may be a place or a phase, x_A, x_C: only a unit of motion counts
        is_unit = find_unit(ending) or (len(ending) > 1 and find_other(ending))
        if is_unit and ending.lower() != "in":
            return label[: len("_".join(parts[:start]))], ending
    return label, None


def column_name(quantity: str, coordinate: Coordinate = TRANSLATION) -> str:
    """Return the column of a quantity in SI units, acceleration_m_per_s2 or angular_acceleration_rad_per_s2."""
    return coordinate.key(named_with_unit(quantity, QUANTITIES[quantity]))


def _plain(text: str) -> str:
    """Return one spelling for all ways to write powers, products and quotients."""
    text = re.sub(r"\s+", " ", text.strip().strip("[](){}"))
    text = text.replace("μ", "µ").replace("²", "2").replace("^", "").replace("**", "")
    text = text.replace("_per_", "/").replace(" per ", "/").replace("⁻¹", "-1").replace("⁻2", "-2")
    text = re.sub(r"[ ·*._]?(s|sec)-([12])$", r"/s\2", text)
    text = re.sub(r"^u(?=(m|s|N)\b)", "µ", text)
    text = re.sub(r"^([mk]?N|ozf?|lbf?|in|ft)[·*._-](m|cm|mm|in|ft|ozf?|lbf?)$", r"\1\2", text)
    text = re.sub(r"/(s|sec)1$", r"/s", text).replace("/sec", "/s")
    return text.replace("/s/s", "/s2").replace(" ", "")


_EXACT = {_plain(unit.name): unit for unit in UNITS} | {
    _plain(spelling): unit for unit in UNITS for spelling in _OTHER_SPELLINGS.get(unit.name, ())
}

_OTHER_UNITS = {_plain(unit): what for what, units in _OTHERS.items() for unit in units}

_RATE = next(unit for unit in UNITS if unit.dimension == "angular velocity")

# Without regard to case where no other unit differs in case alone: MM, Sec and G, but mN is not MN, nor nm Nm.
_ALIKE = "mn", "mhz", "mg", "mnm", "mrad"
_FOLDS = Counter(map(str.casefold, {*_EXACT, *_OTHER_UNITS})) + Counter(_ALIKE)
_FOLDED = {key.casefold(): unit for key, unit in _EXACT.items() if _FOLDS[key.casefold()] == 1}

DIMENSIONS = {q: _EXACT[_plain(unit)].dimension for q, unit in (QUANTITIES | {"time": "s"}).items()}
_ROTATIONAL = {other: own for own, other in _COUNTERPARTS.items()}
DIMENSIONS |= {q: _ROTATIONAL[DIMENSIONS[of]] for q, of in ROTATING.items()}
"""Dimension of what a channel may hold."""

SI = {**QUANTITIES, "base_velocity": "m/s", "frequency": "Hz", "phase": "rad"} | {
    **{"receptance": "m/N", "mobility": "m/s/N", "accelerance": "m/s²/N"}
}
"""SI unit of what a column may hold, of a translation."""

PER_FORCE = {"receptance": "length", "mobility": "velocity", "accelerance": "acceleration"}
TABLE_DIMENSIONS = {
    **{"frequency": "frequency", "force": "force"},
    **{f"base_{q}": DIMENSIONS[q] for q in ABSOLUTE},
    **{q: DIMENSIONS[q] for q in ABSOLUTE},
    **PER_FORCE,
    **{"phase": "angle", "level": ""},
}
"""Dimension of what a column of a table of steady responses may hold: of receptance, mobility and accelerance that of
the motion per force; a level is a number without one."""


def table_factor(text: str, quantity: str) -> float:
    """Return SI units per unit of a column of a table, as a text spells it: µm/N for a receptance, of which µm is
    enough. Raises UnitError as `unit_for`."""
    motion, _, force = text.strip().rpartition("/")
    unit = find_unit(force)
    if quantity in PER_FORCE and motion and unit and unit.dimension == "force":
        return unit_for(motion, quantity, PER_FORCE[quantity]).factor / unit.factor
    return unit_for(text, quantity, TABLE_DIMENSIONS[quantity]).factor


# --- products and quotients of units -----------------------------------------------------------------

_EXPONENTS = {  # kg, m and s in the SI unit of a dimension; an angle has none
    **{"length": (0, 1, 0), "velocity": (0, 1, -1), "acceleration": (0, 1, -2)},
    **{"angle": (0, 0, 0), "angular velocity": (0, 0, -1), "angular acceleration": (0, 0, -2)},
    **{"force": (1, 1, -2), "torque": (1, 2, -2), "time": (0, 0, 1), "frequency": (0, 0, -1)},
}
_POWERS = str.maketrans("²³⁴", "234")
_OUTSIDE = r"(?![^(]*\))"  # brackets


def factor_to(si: str, text: str) -> tuple[float, Coordinate]:
    """Return SI units per unit that a text spells, any product or quotient of units, lbf/in, N/(mm/s) or kg·m²; and
    whether that is the unit of a translation, or the one of a rotation in its place: N m/rad for N/m, kg m² for kg.

    si : the SI unit of a translation.   Raises UnitError for a unit of another dimension, or an unknown one.
    """
    unit, plain = find_unit(text), find_unit(si)
    if unit and plain and unit.dimension == plain.dimension:
        return unit.factor / plain.factor, TRANSLATION
    readings = _readings(text.strip())
    for coordinate in (TRANSLATION, ROTATION):
        for exponents, factor in _readings(coordinate.unit(si)).items():
            if exponents in readings:
                return readings[exponents] / factor, coordinate
    raise UnitError(f"{shortened(text)} is no unit for {si}")


@cache
def _readings(text: str) -> dict[tuple[int, ...], float]:
    """Return the meanings that a text may have: factor to SI by exponents of kg, m and s. "lb" is a mass and a force;
    Hz is 2π rad/s."""
    readings: dict[tuple[int, ...], float] = {}
    if unit := find_motion(text):
        turns = _TURN if unit.dimension == "frequency" else 1.0
        readings[_EXPONENTS[unit.dimension]] = unit.factor * turns
    if mass := _MASSES.get(text.casefold()):
        readings[1, 0, 0] = mass
    power = re.fullmatch(r"([^\W\d]+)\^?([234])", text.translate(_POWERS))
    if not readings and power:
        n = int(power[2])
        return {tuple(n * e for e in of): size**n for of, size in _readings(power[1]).items()}
    if readings or not text:
        return readings
    if re.fullmatch(r"\([^()]*\)", text):
        return _readings(text[1:-1].strip())
    text = re.sub(r"\s+per\s+|_per_", "/", text)
    marks = [m.span() for m in re.finditer(rf"\s*/\s*{_OUTSIDE}", text)] or [
        m.span() for m in re.finditer(rf"\s*[·*.⋅-]\s*{_OUTSIDE}|\s+{_OUTSIDE}", text)
    ]
    # the last quotient, or else the last product, or else letters written together: Nmm, kgm²
    places = marks[-1:] or [(i, i) for i in range(1, len(text))]
    for start, end in places:
        sign = -1 if "/" in text[start:end] else 1
        for left, p in _readings(text[:start]).items():
            for right, q in _readings(text[end:]).items():
                both = tuple(a + sign * b for a, b in zip(left, right, strict=True))
                readings.setdefault(both, p * q**sign)
    return readings
