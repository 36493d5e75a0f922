"""Types of arguments of the command line: what the readers of `arguments` take, and lists of numbers with names."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from .. import arguments
from ..law.terms import term
from ..project.wording import shortened
from ..records.quantities import quantity as read_number

FILE: dict[str, Any] = {"type": Path, "metavar": "FILE"}


def read_by(reader: Callable[[str, Any], Any], name: str) -> Callable[[str], Any]:
    """Return a type of argument: a reader of `arguments`, for a name of its table."""

    def read(text: str) -> Any:
        try:
            return reader(name, text)
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error).removeprefix(f"{name} ")) from None

    return read


def number(name: str) -> Callable[[str], float]:
    """Return a type of argument: a number of the table of `arguments`, with a unit where it has one."""
    return read_by(read_number, name)


def whole(name: str, bounds: arguments.Bounds | None = None) -> Callable[[str], int]:
    """Return a type of argument: a whole number.   bounds : default, those of the table of `arguments`."""
    return read_by(lambda name, text: arguments.whole(name, _plain(text), bounds), name)


def _plain(text: str) -> float | str:
    """Return the number that a text holds, or the text."""
    for kind in (int, float):
        with suppress(ValueError):
            return kind(text)
    return text


def argument(words: str, **form: Any) -> dict[str, Any]:
    """Return an argument, with its help; one of which nothing else is said is a flag."""
    return {"help": words, **(form or {"action": "store_true"})}


def quantity(name: str, default: float | None, words: str, **more: Any) -> dict[str, Any]:
    """Return an option with a number of the table; without a default, the words say what stands for it."""
    if default is not None:
        words, more["default"] = f"{words} (default: %(default)s)", default
    return argument(words, **{"type": number(name), **more})


def coefficients(text: str) -> dict[str, float]:
    """Parse an argument: coefficients of the terms of a law by symbol, SI, as in c_2=40,eta=0.02."""
    values: dict[str, float] = {}
    for part in re.split(r",(?=[^,]*=|$)", text):  # other commas are decimal marks
        symbol, equals, value = (piece.strip() for piece in part.partition("="))
        if not (symbol and equals):
            raise argparse.ArgumentTypeError(
                f"must be symbols with their coefficients, as in c_2=40,eta=0.02, got {shortened(part)}"
            )
        try:
            # a grouped term is refused later, by the response
            bounds = arguments.NUMBERS["given"]._replace(unit=term(symbol).unit)
            if symbol in values:
                raise ValueError(f"{symbol} appears twice: give it once")
            values[symbol] = read_number("given", value, bounds)
        except ValueError as error:
            words = str(error)
            if words.startswith("given "):
                words = f"{symbol} {words.removeprefix('given ')}"
            raise argparse.ArgumentTypeError(words) from None
    return values


def sliders(text: str) -> list[tuple[float, float]]:
    """Parse an argument: (r, κ) of Jenkins elements, m and N/m, as in 1e-5:40000,5e-5:8000."""
    pairs: list[tuple[float, float]] = []
    for part in text.split(","):
        r, colon, kappa = part.partition(":")
        if not colon:
            raise argparse.ArgumentTypeError(
                f"must be pairs r:kappa, m and N/m, as in 1e-5:40000,5e-5:8000, got {shortened(part)}"
            )
        pairs.append((number("r")(r), number("kappa")(kappa)))
    return pairs
