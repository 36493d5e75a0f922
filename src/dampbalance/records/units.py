"""Units that laboratories write, and their conversion to SI by the table `units.toml`.

Usual spellings are read: µm and um are one unit, and so are m/s², m/s^2, m/s2, m s-2 and m_per_s2. A channel whose unit
does not fit its quantity, such as a velocity in mm, is refused.
"""

from __future__ import annotations

import difflib
import itertools
import math
import re
import tomllib
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import NamedTuple

from ..model import named_with_unit
from ..project.wording import shortened
from .channel import ABSOLUTE, QUANTITIES, ROTATING
from .coordinate import ROTATION, TRANSLATION, Coordinate

VOLTAGE = "a voltage"  # of any transducer; the `scale` of a mapping turns it into a motion
VOLTS = {"V": 1.0, "mV": 1e-3, "µV": 1e-6, "μV": 1e-6, "uV": 1e-6}
"""Volts per unit in which a sensitivity is stated."""


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit: a number in it times `factor` is the number in SI.

    name : its usual spelling.   dimension : length, velocity, acceleration, force, time or frequency; in a rotation
    angle, angular velocity, angular acceleration or torque.
    """

    name: str
    dimension: str
    factor: float

    @property
    def coordinate(self) -> Coordinate:
        """The coordinate to which it belongs."""
        return ROTATION if self.dimension in _COUNTERPARTS else TRANSLATION

    @property
    def counterpart(self) -> str:
        """The dimension that it replaces in the equations: length for an angle; for a translation its own."""
        return _COUNTERPARTS.get(self.dimension, self.dimension)


class UnitError(ValueError):
    """A unit that is unknown or does not fit the quantity."""


def find_unit(text: str, dimension: str = "") -> Unit | None:
    """Return the unit that a text spells, or None.

    dimension : preferred for rad/s, which is a frequency unless an angular velocity is wanted.
    """
    units = next(filter(None, map(_UNITS.get, _products(text))), {})
    return units.get(dimension) or next(iter(units.values()), None)


def find_motion(text: str) -> Unit | None:
    """Return the unit that a text spells, or None; rad/s is an angular velocity."""
    return find_unit(text, "angular velocity")


def find_other(text: str) -> str | None:
    """Return what is measured in a unit of no motion, force or time, "a temperature"; None for other units."""
    return _OTHERS.get(_plain(text).replace(" ", ""))


def unit_for(text: str, quantity: str, dimension: str | None = None) -> Unit:
    """Return the unit that a text spells for a quantity.

    dimension : of the quantity; default, that in `DIMENSIONS`.

    Raises UnitError for an unknown unit, naming the nearest known one, and for a unit of another dimension.
    """
    wanted = dimension or DIMENSIONS[quantity]
    unit = find_unit(text, wanted)
    if unit and unit.dimension == wanted:
        return unit
    other = unit.dimension if unit else find_other(text)
    what = f"{text!r} is a unit of {other}" if other else f"unknown unit {shortened(text)}"
    folded = {known.name.casefold(): known.name for known in UNITS}
    near = difflib.get_close_matches(text.strip().casefold(), folded, n=1)
    hint = f" (did you mean {folded[near[0]]}?)" if near and not unit else ""
    fitting = ", ".join(unit.name for unit in UNITS if unit.dimension == wanted)
    raise UnitError(
        f"{what}{hint}, but {quantity.replace('_', ' ')} needs one of {wanted}: {fitting}"
    )


def split_label(label: str) -> tuple[str, str | None]:
    """Return name and unit of a heading: "x [mm]", "x (mm)", "x/mm", "x, mm", "x in mm" and "x_mm" give ("x", "mm").

    Brackets hold a unit, known or not, unless they hold a number; elsewhere only a known unit counts. "in" at the end
    is no unit, since disp_in goes with disp_out. The unit is None if there is none.
    """
    label = label.strip().translate(_BRACKETS)
    # the time of the search for a unit grows with the square of the length
    if len(label) > 1000:
        return label, None
    if match := re.fullmatch(r"(.*?)\s*[\[({<]\s*(?!\d+[\])}>])([^\])}>]*?)\s*[\])}>]", label):
        return match[1].rstrip(" /,;:"), match[2] or None
    match = re.fullmatch(r"(.+?)\s*[\[(]\s*([^\])]+?)\s*[\])]\s*(\S.*)", label)
    if match and find_unit(match[2]):  # Position (m) Run #1
        return f"{match[1]} {match[3]}", match[2]
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
    """Return the name of the column of a quantity in SI units, acceleration_m_per_s2 for an acceleration."""
    return coordinate.key(named_with_unit(quantity, QUANTITIES[quantity]))


def factor_to(si: str, text: str) -> tuple[float, Coordinate]:
    """Return the size in SI of a product or quotient of units, lbf/in, N/(mm/s) or kg·m², and its coordinate: a unit of
    a rotation may stand for one of a translation, N m/rad for N/m and kg m² for kg.

    si : the SI unit of a translation.   Raises UnitError for a unit that is unknown or of another dimension.
    """
    given = dict(map(_in_si, _products(text)))
    for coordinate in (TRANSLATION, ROTATION):
        for exponents, size in map(_in_si, _products(coordinate.unit(si))):
            if exponents in given:
                return given[exponents] / size, coordinate
    raise UnitError(f"{shortened(text)} is no unit for {si}")


class _Single(NamedTuple):
    """A unit that is no product of others."""

    name: str
    dimension: str
    size: float


_Product = frozenset[tuple[_Single, int]]  # powers
_Spelled = Mapping[str, list[_Single]]


@cache
def _products(text: str) -> list[_Product]:
    """Return the products of powers that a text may spell, N/(mm/s) or m s-2; two for "lb", a force or a mass."""
    plain = re.sub(r"(\s+|_)per(\s+|_)", "/", _plain(text))
    plain = _ALONE.get(plain.casefold(), plain)
    plain = re.sub(r"/\s*\(([^()/]*)/([^()/]*)\)?$", r"·\2/\1", plain)
    plain = re.sub("[()]", "", plain)
    known, factors = _EXACT, _factors(plain, _EXACT)
    if not factors and re.sub(r"[^\w/]|_", "", plain.casefold()) not in _CASED:
        known, factors = _FOLDED, _factors(plain.casefold(), _FOLDED)
    sign, powers = 1, list[int]()
    for mark, _, power in factors:
        sign = -1 if "/" in mark else sign
        powers.append(sign * int(power or 1))
    products = []
    for singles in itertools.product(*(known[unit] for _, unit, _ in factors)):
        product = Counter[_Single]()
        for single, n in zip(singles, powers, strict=True):
            product[single] += n
        products.append(frozenset(product.items()))
    return products if factors else []


def _factors(text: str, known: _Spelled) -> list[tuple[str, str, str]]:
    """Return the factors of a product of units, each with the mark before it and its power; none if a text is no such
    product."""
    units = "|".join(map(re.escape, sorted(known, key=len, reverse=True)))
    mark, power = r"(\s*[/·*._⋅-]\s*|[\s_]+|)", r"(?:(?:\^|\*\*)?(-[1-4]|[2-4]))?"
    factor = rf"(?>{mark}({units}){power})"
    factors = re.findall(factor, text) if re.fullmatch(f"(?:{factor})+", text) else []
    return [] if factors and factors[0][0] else factors


def _in_si(product: _Product) -> tuple[tuple[int, ...], float]:
    """Return the exponents of kg, m and s of a product (an angle has none), and its size in SI."""
    exponents = ([n * e for e in _TABLE["exponents"][of.dimension]] for of, n in product)
    return tuple(map(sum, zip(*exponents, strict=True))), math.prod(of.size**n for of, n in product)


def _plain(text: str) -> str:
    return text.translate(_CHARACTERS).strip("[](){} \t\n")


_BRACKETS = str.maketrans("（）［］", "()[]")  # of Chinese and Japanese
_CHARACTERS = str.maketrans("μ²³⁴¹⁻", "µ2341-")
_TABLE = tomllib.loads(files(__package__).joinpath("units.toml").read_text(encoding="utf-8"))
_OTHERS = {unit: what for what, units in _TABLE["others"].items() for unit in units}
_CASED = {text.casefold() for text in _TABLE["case"]["decides"]}
_ROWS = [(of, name, row) for of in _TABLE["exponents"] for name, row in _TABLE[of].items()]
_ALONE = {text: name for _, name, row in _ROWS for text in row.get("alone", ())}
_SINGLES = [
    (text, _Single(name, of, row["size"]))
    for of, name, row in _ROWS
    if "size" in row
    for text in (name, *row.get("also", ()))
]
_EXACT, _FOLDED = (
    {spell(text): [of for one, of in _SINGLES if spell(one) == spell(text)] for text, _ in _SINGLES}
    for spell in (str, str.casefold)
)
_UNITS: dict[_Product, dict[str, Unit]] = {}  # by dimension
_SI: dict[str, float] = {}  # sizes of the units of SI
for _of, _name, _ in _ROWS:
    if _of != "mass":
        _product, *_ = _products(_name)
        _size = _in_si(_product)[1]
        _unit = Unit(_name, _of, _size / _SI.setdefault(_of, _size))
        _UNITS.setdefault(_product, {})[_of] = _unit

UNITS = tuple(unit for units in _UNITS.values() for unit in units.values())
"""All units of channels. `g` is the standard gravity, 9.80665 m/s²: the gram is no unit of a channel."""


def _dimension(si: str) -> str:
    return next(u.dimension for u in UNITS if u.name == si and u.dimension != "frequency")


_COUNTERPARTS = {
    _dimension(ROTATION.unit(unit)): _dimension(unit) for unit in ("m", "m/s", "m/s²", "N")
}
DIMENSIONS = {q: _dimension(unit) for q, unit in (QUANTITIES | {"time": "s"}).items()}
DIMENSIONS |= {q: _dimension(ROTATION.unit(QUANTITIES[of])) for q, of in ROTATING.items()}
"""Dimension of each quantity that a channel may hold."""

SI = {of.dimension: of.name for of in reversed(UNITS)}
"""SI unit of each dimension, the first in the table."""

PER_FORCE = {"receptance": "length", "mobility": "velocity", "accelerance": "acceleration"}
TABLE_DRIVES = {"force": "force"} | {f"base_{q}": DIMENSIONS[q] for q in ABSOLUTE}
TABLE_RESPONSES = {q: DIMENSIONS[q] for q in ABSOLUTE} | PER_FORCE
TABLE_DIMENSIONS = {"frequency": "frequency"} | TABLE_DRIVES | TABLE_RESPONSES
TABLE_DIMENSIONS |= {"phase": "angle", "level": "", "coherence": "", "averages": ""}
"""Dimension of each column that a table of steady responses may have; for receptance, mobility and accelerance that of
the motion. A level, a coherence γ² and its number of averaged spectra have none."""


def slot(quantity: str) -> str:
    """Return the part of a table that a quantity fills: every table has one drive and one response."""
    if quantity in TABLE_DRIVES:
        return "drive"
    return "response" if quantity in TABLE_RESPONSES else quantity


_DECIBEL = re.compile(r"db\b\s*(?:re[lf]?\b\.?)?\s*(\d[\d.]*(?:e[+-]?\d+)?)?\s*(.*)", re.IGNORECASE)


def reference_of(text: str) -> tuple[float, str] | None:
    """Return number and unit of the reference of an amplitude in decibels (20 lg), dB re 1 m/s²/N; None for other
    units."""
    found = _DECIBEL.fullmatch(text.strip())
    return found and (float(found[1] or 1.0), found[2])


def per_force(text: str) -> str | None:
    """Return the response per force that is measured in a unit, in decibels or not; None for other units."""
    motion, _, force = (reference_of(text) or (1.0, text))[1].strip().rpartition("/")
    unit, of = find_unit(motion), find_unit(force)
    fits = unit is not None and of is not None and of.dimension == "force"
    return next((q for q, d in PER_FORCE.items() if fits and unit and unit.dimension == d), None)


def table_factor(text: str, quantity: str) -> float:
    """Return the size in SI of the unit of a column of a table; a receptance may have µm/N or µm alone.

    Raises UnitError as `unit_for`, and for decibels without a reference.
    """
    if reference := reference_of(text):
        if not reference[1]:
            raise UnitError("dB of what? State the unit with its reference, as dB re 1 m/s²/N")
        return reference[0] * table_factor(reference[1], quantity)
    motion, _, force = text.strip().rpartition("/")
    unit = find_unit(force)
    if quantity in PER_FORCE and motion and unit and unit.dimension == "force":
        return unit_for(motion, quantity, PER_FORCE[quantity]).factor / unit.factor
    return unit_for(text, quantity, TABLE_DIMENSIONS[quantity]).factor
