"""What a number on the command line may be: within bounds, or an error that says which."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable
from typing import Any

from ..arguments import mass_with_error
from ..law.terms import term
from ..project.wording import shortened

SMALLEST, LARGEST = 1e-15, 1e15
"""Bounds of a quantity in SI units: no oscillator goes beyond them, and their squares and cubes are numbers yet."""


def number(low: float = SMALLEST, high: float = LARGEST) -> Callable[[str], float]:
    """A type of argument: a number within bounds."""
    return _within(float, low, high, f"a {'positive ' * (low > 0)}number, {low:g} to {high:g}")


def quantity(
    default: float | None, words: str, low: float = SMALLEST, high: float = LARGEST, **more: Any
) -> dict[str, Any]:
    """An option with a number; without a default, the words say what stands for it."""
    if default is not None:
        words, more["default"] = f"{words} (default: %(default)s)", default
    return {"type": number(low, high), "help": words, **more}


def with_error(text: str) -> tuple[float, float]:
    """A type of argument: a positive number, alone or with its standard uncertainty, 2310±10 or 2310+-10."""
    value, *error = re.split(r"±|\+/?-", text, maxsplit=1)
    one = number()(value)
    uncertainty = number(0.0)(error[0]) if error else 0.0
    if not uncertainty < one:
        raise argparse.ArgumentTypeError(
            f"must have an uncertainty below the number itself, got {shortened(text)}"
        )
    return one, uncertainty


def mass(text: str) -> tuple[float, float]:
    """A type of argument: a mass like `with_error`; alone, with the uncertainty that its digits state."""
    with_error(text)
    return mass_with_error(text)


def whole(low: int = 0, high: int = 2**63 - 1) -> Callable[[str], int]:
    """A type of argument: a whole number within bounds."""
    return _within(int, low, high, f"a whole number, {low} to {high}")


def count(text: str) -> int:
    """A type of argument: a positive whole number that may be written as 5e8."""
    return int(number(1.0, 1e12)(text))


def coefficients(text: str) -> dict[str, float]:
    """A type of argument: coefficients of the terms of a law by symbol, SI, as in c_2=40,eta=0.02."""
    values: dict[str, float] = {}
    for part in text.split(","):
        symbol, equals, value = (piece.strip() for piece in part.partition("="))
        if not (symbol and equals):
            raise argparse.ArgumentTypeError(
                f"must be symbols with their coefficients, as in c_2=40,eta=0.02, got {shortened(part)}"
            )
        try:
            term(symbol)  # one of a group is refused where the response is computed
            if symbol in values:
                raise ValueError(f"{symbol} stands there twice: give it once")
            values[symbol] = float(number(0.0)(value))
        except argparse.ArgumentTypeError as error:
            raise argparse.ArgumentTypeError(f"{symbol} {error}") from None
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error)) from None
    return values


def sliders(text: str) -> list[tuple[float, float]]:
    """A type of argument: (r, κ) of Jenkins elements, m and N/m, as in 1e-5:40000,5e-5:8000."""
    read, pairs = number(), list[tuple[float, float]]()
    for part in text.split(","):
        r, colon, kappa = part.partition(":")
        if not colon:
            raise argparse.ArgumentTypeError(
                f"must be pairs r:kappa, m and N/m, as in 1e-5:40000,5e-5:8000, got {shortened(part)}"
            )
        pairs.append((read(r), read(kappa)))
    return pairs


def _within(
    kind: Callable[[str], Any], low: float, high: float, wanted: str
) -> Callable[[str], Any]:
    def read(text: str) -> Any:
        try:
            value = kind(text)
        except ValueError:
            value = None
        if value is None or not low <= value <= high:
            raise argparse.ArgumentTypeError(f"must be {wanted}, got {shortened(text)}")
        return value

    return read
