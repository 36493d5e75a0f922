"""Checks of the arguments of public functions: one table of numbers, and one reader for each kind of argument.

A reader gives the value in one plain form, or raises ValueError naming the argument, what would be right and what was
given. A masked or missing element of an array (None, NA) is NaN, wherever an array is read.
"""

from __future__ import annotations

import math
import os
import reprlib
from collections.abc import Collection, Iterable, Iterator, Mapping
from decimal import Decimal
from numbers import Real
from pathlib import Path
from typing import Any, NamedTuple, NoReturn, TypeVar

import numpy as np

from .arrays import Array

Kind = TypeVar("Kind")

SMALLEST, LARGEST = 1e-30, 1e30  # SI units; beyond them, products of a few numbers overflow

_WORD = 2**63 - 1  # the largest integer of an array


class Bounds(NamedTuple):
    """Bounds of a number.   unit : SI.   low, high : both allowed.   remedy : advice for a wrong value."""

    unit: str = ""
    low: float = SMALLEST
    high: float = LARGEST
    remedy: str = ""

    def __str__(self) -> str:
        """Return the bounds in words, for a message."""
        whole = "whole " * isinstance(self.low, int)
        positive = "positive " * (self.low > 0 and not whole)
        of = f" of {self.unit}" * bool(self.unit)
        return f"a {positive}{whole}number{of}, {self.low:g} to {self.high:g}"


NUMBERS: Mapping[str, Bounds] = {
    "m": Bounds("kg"),
    "c": Bounds("N s/m", 0.0),
    "k": Bounds("N/m"),
    "K_z": Bounds("N/m", remedy="use a large finite K_z for a rigid contact"),
    "F_k": Bounds("N", 0.0),
    "Y": Bounds("m"),
    "omega": Bounds("rad/s"),
    "frequency": Bounds("Hz"),
    **dict.fromkeys(("x", "z", "X", "X_s"), Bounds("m", -LARGEST)),
    "r": Bounds("m"),
    "kappa": Bounds("N/m"),
    "v": Bounds("m/s", -LARGEST),
    **dict.fromkeys(("t", "start", "end"), Bounds("s", -LARGEST)),
    **dict.fromkeys(("step", "duration"), Bounds("s")),
    "held": Bounds("s", 0.0),
    "rate_hz": Bounds("samples per second"),
    **dict.fromkeys(("cycles", "keep_cycles"), Bounds("periods")),
    "c_over_m": Bounds("1/s", 0.0),
    "k_over_m": Bounds("1/s²"),
    "noise": Bounds(low=0.0, high=1e6, remedy="it is a part of the signal: 0.01 is 1 %"),
    "given": Bounds(low=0.0),
    "seed": Bounds("", 0, _WORD),
    "stick_samples": Bounds("", 0, _WORD),
    "threads": Bounds("", 1, _WORD),
    "count": Bounds("harmonics", 1, 10_000),
    "n": Bounds("", 1, 5),
    "decimals": Bounds("", -15, 30),
    "block": Bounds("samples", 3, _WORD),
}
"""Numbers that public functions take, by the name of the argument; bounds that are integers: whole numbers. Those of an
identification are in `project.options`."""


def number(name: str, value: object, bounds: Bounds | None = None) -> float:
    """Return a number as a float.   bounds : default, those of its name in the table."""
    bounds = bounds or NUMBERS[name]
    if type(value) is float and bounds.low <= value <= bounds.high:  # nearly always
        return value
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        refuse(name, bounds, value)
    try:
        plain = float(value)
    except OverflowError:
        plain = math.inf
    if not bounds.low <= plain <= bounds.high:
        refuse(name, bounds, value)
    return plain


def whole(name: str, value: object, bounds: Bounds | None = None) -> int:
    """Return a whole number, which may be written as 5e8.   bounds : default, those of its name in the table."""
    bounds = bounds or NUMBERS[name]
    if isinstance(value, float | np.floating) and float(value).is_integer():
        value = int(value)
    if isinstance(value, bool) or not (
        isinstance(value, int | np.integer) and bounds.low <= value <= bounds.high
    ):
        refuse(name, bounds, value)
    return int(value)


def numbers(name: str, value: object, *, missing: bool = False, signed: bool = False) -> Array:
    """Return a number, or an array of any shape, as floats within the bounds of its name in the table.

    missing : whether elements may be missing; they are NaN.   signed : whether negative values are allowed, too, as
    for the estimate of a positive number.
    """
    bounds = NUMBERS[name]
    if signed:
        bounds = bounds._replace(low=-bounds.high)
    try:
        array = floats(value)
    except ValueError:
        refuse(name, f"{bounds}, or an array of them", value)
    within = (array >= bounds.low) & (array <= bounds.high) | (np.isnan(array) & missing)
    if not within.all():
        wrong = float(array[~within].flat[0])
        refuse(name, bounds, wrong, " (missing or masked)" * math.isnan(wrong))
    return array


def floats(values: Any) -> Array:
    """Return real numbers as an array of floats, copied only if necessary; a masked or missing one is NaN.

    Raises ValueError saying what they are instead: "texts".
    """
    if isinstance(values, list | tuple):
        values = [math.nan if one is np.ma.masked else one for one in values]
        if any(isinstance(one, np.ma.MaskedArray) for one in values):
            values = np.ma.array(values)
    mask = np.ma.getmask(values)
    array = np.asarray(values)
    kind = array.dtype.kind
    if kind == "O" and array.ndim:
        masks = np.broadcast_to(mask, array.shape).ravel()
        pairs = zip(array.ravel(), masks, strict=True)
        flat = [math.nan if hidden else _float(one) for one, hidden in pairs]
        return np.array(flat, dtype=np.float64).reshape(array.shape)
    if kind not in "iuf":
        instead = {"c": "complex numbers", "S": "texts", "U": "texts"}
        raise ValueError(instead.get(kind, _NO_NUMBERS))
    with np.errstate(over="ignore"):  # a longer float
        plain = array.astype(np.float64, copy=False)
    return plain if mask is np.ma.nomask else np.where(mask, np.nan, plain)


_NO_NUMBERS = "what are not numbers"


def _float(value: Any) -> float:
    """Return an element of an array of objects."""
    if value is None or value is np.ma.masked or type(value).__name__ == "NAType":
        return math.nan
    if isinstance(value, str | bytes):
        raise ValueError("texts")
    if isinstance(value, bool) or not isinstance(value, Real | Decimal):
        raise ValueError(_NO_NUMBERS)
    try:
        return float(value)
    except OverflowError:
        return math.inf


def flag(name: str, value: object) -> bool:
    """Return True or False."""
    if not isinstance(value, bool | np.bool_):
        refuse(name, "True or False", value)
    return bool(value)


def one_of(name: str, value: object, known: Collection[str], hint: str = "") -> str:
    """Return one of several names.   hint : what follows a wrong one in the message."""
    if not isinstance(value, str) or value not in known:
        refuse(name, f"one of {', '.join(known)}", value, hint)
    return value


def names(name: str, value: object, known: Collection[str] = ()) -> tuple[str, ...]:
    """Return names in their order: a sequence, or a text with commas between them, as on the command line.

    known : the names that are allowed; default, any.
    """
    several = (
        value.split(",") if isinstance(value, str) else items(name, value, "a sequence of names")
    )
    found = []
    for one in several:
        if not isinstance(one, str):
            refuse(name, "a sequence of names, or a text with commas between them", value)
        found.append(one.strip() if type(one) is str else one)  # else it is more than a text
    unknown = sorted(set(found) - set(known or found))
    if unknown:
        raise ValueError(f"unknown {name} {shown(unknown)}; known are {', '.join(known)}")
    return tuple(found)


def items(name: str, value: object, wanted: str) -> Iterator[Any]:
    """Return the items of a sequence, or of anything else that has an order."""
    unordered = isinstance(value, str | bytes | Mapping | set | frozenset | type)
    if unordered or not isinstance(value, Iterable) or getattr(value, "shape", None) == ():
        refuse(name, wanted, value)
    return iter(value)


def mapping(name: str, value: object, wanted: str) -> dict[str, Any]:
    """Return a mapping whose keys are texts."""
    if not isinstance(value, Mapping) or not all(isinstance(key, str) for key in value):
        refuse(name, wanted, value)
    return dict(value)


def instance(name: str, value: object, kind: type[Kind]) -> Kind:
    """Return an object of a class of this package."""
    if not isinstance(value, kind):
        article = "an" if kind.__name__[0] in "AEIOU" else "a"
        refuse(name, f"{article} {kind.__name__}", value)
    return value


def path(name: str, value: object, wanted: str) -> Path:
    """Return the path of a file or a folder."""
    if not isinstance(value, str | os.PathLike):
        refuse(name, wanted, value)
    text = os.fspath(value)
    if not isinstance(text, str) or "\0" in text:
        refuse(name, wanted, value)
    return Path(text)


def text(name: str, value: object) -> str:
    """Return a text."""
    if not isinstance(value, str):
        refuse(name, "a text", value)
    return value


def shown(value: object) -> str:
    """Return a value as Python writes it, in one line of bounded length: for messages."""
    return " ".join(_REPR.repr(value).replace("\\n", " ").split())


_REPR = reprlib.Repr()
_REPR.maxstring = _REPR.maxother = 60


def refuse(label: str, wanted: object, value: object, more: str = "") -> NoReturn:
    """Raise ValueError naming the argument, what would be right and what was given."""
    remedy = f"; {wanted.remedy}" if isinstance(wanted, Bounds) and wanted.remedy else ""
    raise ValueError(f"{label} must be {wanted}, got {shown(value)}{more}{remedy}")
