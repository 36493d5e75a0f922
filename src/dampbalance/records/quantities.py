"""Numbers as people write them: 29.7 lbf/in, 5,2e3, 2310 ± 10 N/m, 3.1 kg ± 0.5 %, 210 rpm.

A number may have any unit that `units.factor_to` reads, and is converted to SI. Comma and point are decimal marks; a
number whose comma may separate thousands, as in "2,310", is refused.
"""

from __future__ import annotations

import re
from contextlib import suppress
from decimal import Decimal
from numbers import Real
from typing import Any, NamedTuple, NoReturn

from ..arguments import NUMBERS, Bounds, number, refuse, shown
from .coordinate import Coordinate
from .units import UnitError, factor_to

_UNCERTAIN = r"\s*(?:±|\+/?[-−])\s*"  # between a number and its standard uncertainty
_THOUSAND = r"[ '_\u00a0\u202f]"  # marks of thousands that are no decimal marks
_NUMBER = re.compile(
    rf"(?P<sign>[-+−]?)(?P<digits>\d+(?:{_THOUSAND}\d{{3}}(?!\d))*[.,\d]*|[.,]\d+)"
    r"(?:[eE](?P<e>[-+−]?\d+)|\s*[·×*]\s*10\^?(?P<ten>[-−⁻]?[\d⁰¹²³⁴⁵⁶⁷⁸⁹]+))?"
)
_PLAIN = str.maketrans("−⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "--0123456789")
_EXAMPLES = {
    "N/m": '"5.2 N/mm" or "29.7 lbf/in"',
    "kg": '"6.8 lb" or "2.42 ± 0.01 kg"',
    "Hz": '"3.5 Hz" or "210 rpm"',
    "m": '"4 mm" or "0.16 in"',
    "N": '"1.3 N" or "0.3 lbf"',
    "s": '"200 µs" or "0.1 s"',
    "N s/m": '"0.09 N s/mm" or "0.5 lbf s/in"',
}


class Quantity(NamedTuple):
    """A number in SI.

    error : its standard uncertainty; None if none is written.
    coordinate : of its unit; None if none is written.
    """

    value: float
    error: float | None
    coordinate: Coordinate | None


def read_quantity(name: str, text: str, bounds: Bounds | None = None) -> Quantity:
    """Read a number with its unit and uncertainty: "5.2 N/mm ± 1 %", "(2310 ± 10) N/m", "3,1±0,01".

    bounds : default, those of the name in `arguments.NUMBERS`.

    Raises ValueError naming the argument, the text, and what can be read.
    """
    bounds = bounds or NUMBERS[name]
    end = ")" if text.strip()[:1] == "(" else "\0"
    inner, _, behind = re.sub(r"^\s*\(", "", text).partition(end)
    written = [(_NUMBER.match(part), part) for part in re.split(_UNCERTAIN, inner.strip())]
    parts = [(_decimal(of, name), part[of.end() :] or behind) for of, part in written if of]
    if not len(parts) == len(written) <= 2:
        _refuse_text(name, bounds, text)
    (plain, of_value), (error, of_error) = parts[0], parts[-1]
    of_value, of_error = of_value.strip(), of_error.strip()
    relative = len(parts) == 2 and of_error == "%"
    of_value = of_value or of_error * (not relative)
    try:
        factor, coordinate = _factor(bounds.unit, of_value)
        of_its_error = 0.01 if relative else _factor(bounds.unit, of_error or of_value)[0]
    except UnitError as unfit:
        _refuse_text(name, bounds, text, f": {unfit}")
    value = number(name, float(plain) * factor, bounds)
    uncertainty = float(error) * of_its_error * (value if relative else 1.0)
    return Quantity(value, uncertainty if len(parts) == 2 else None, coordinate)


def _factor(si: str, unit: str) -> tuple[float, Coordinate | None]:
    """Return SI units per unit and the coordinate of the unit; 1 without a unit, 0.01 for "%"."""
    if not unit or (unit == "%" and not si):
        return 0.01 if unit else 1.0, None
    return factor_to(si, unit)


def readings(text: str, decimal: str) -> list[float]:
    """Return the numbers that a text may mean: none, one, or two if its only mark, which is not the decimal mark of the
    file, may separate thousands or decimals."""
    marks = {mark for mark in ".," if re.fullmatch(rf"[1-9]\d{{0,2}}[{mark}]\d{{3}}", text)}
    texts = [text.replace(",", ".")] if marks else [text]
    texts += [re.sub("[.,]", "", text)] * bool(marks - {decimal})
    with suppress(ValueError):
        return [float(_decimal(of, text)) for text in texts if (of := _NUMBER.fullmatch(text))]
    return []


def _decimal(of: re.Match[str], name: str) -> Decimal:
    """Return the number that a text spells. Raises ValueError if its comma may separate thousands as well."""
    digits = re.sub(_THOUSAND, "", of["digits"])
    if re.fullmatch(r"[1-9]\d{0,2},\d{3}", digits):
        raise ValueError(
            f"{name} = {of[0]} is ambiguous: write {digits.replace(',', '.')} or {digits.replace(',', '')}"
        )
    marks = re.findall("[.,]", digits)
    whole, part = digits, ""
    if marks and marks.count(marks[-1]) == 1:  # or else it separates thousands
        whole, _, part = digits.rpartition(marks[-1])
    if re.search("[.,]", whole) and not re.fullmatch(r"\d{1,3}([.,])\d{3}(\1\d{3})*", whole):
        raise ValueError(f"{name} = {of[0]} is no number: write it with one decimal mark")
    power = (of["e"] or of["ten"] or "0").translate(_PLAIN)
    plain = re.sub("[.,]", "", whole) + (f".{part}" if part else "")
    return Decimal(f"{of['sign'].translate(_PLAIN)}{plain}e{power}")


def _refuse_text(name: str, bounds: Bounds, text: str, why: str = "") -> NoReturn:
    """Raise ValueError for a text that cannot be read as a number with a unit."""
    wanted = str(bounds).split(",")[0]
    if bounds.unit in _EXAMPLES:
        wanted += f", or one with its unit, {_EXAMPLES[bounds.unit]}"
    raise ValueError(f"{name} must be {wanted}, got {shown(text)}{why}")


def quantity(name: str, value: object, bounds: Bounds | None = None) -> float:
    """Return a number, or a text that `read_quantity` reads and that has no uncertainty, as a float in SI."""
    if not isinstance(value, str):
        return number(name, value, bounds)
    read = read_quantity(name, value, bounds)
    if read.error is not None:
        raise ValueError(f"{name} takes no uncertainty, got {shown(value)}: give the number alone")
    return read.value


def with_error(
    name: str, value: object, bounds: Bounds | None = None, uncertainty: float = 0.0
) -> tuple[float, float]:
    """Return a number and its standard uncertainty in SI, from 2310.0, (2310.0, 10.0), or a text that `read_quantity`
    reads, "2310±10" or "5.2 N/mm ± 1 %".

    uncertainty : relative one of a number that states none: with 0.005, that of 3.1 and "3.1" is 0.0155, while
    (3.1, 0.0) and "3.1±0" are exact.
    """
    bounds = bounds or NUMBERS[name]
    pair: Any = value
    if isinstance(value, str):
        plain, error, _ = read_quantity(name, value, bounds)
        pair = plain if error is None else (plain, error)
    if not isinstance(pair, list | tuple) or len(pair) != 2:
        plain = number(name, pair, bounds)
        return plain, uncertainty * plain
    plain, error = number(name, pair[0], bounds), pair[1]
    if isinstance(error, bool) or not (isinstance(error, Real) and 0.0 <= float(error) < plain):
        refuse(name, f"{bounds}, with an uncertainty below it, (2310, 10) or 2310±10", value)
    return plain, float(error)
