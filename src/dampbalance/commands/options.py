"""Types of arguments of the command line: what the readers of `arguments` take, and lists of numbers with names."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Iterator
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
    """Return an argument with its help; without a form it is a flag."""
    return {"help": words, **(form or {"action": "store_true"})}


def quantity(name: str, default: float | None, words: str, **more: Any) -> dict[str, Any]:
    """Return an option with a number of the table; if it has no default, the words say what is used instead."""
    if default is not None:
        words, more["default"] = f"{words} (default: %(default)s)", default
    return argument(words, **{"type": number(name), **more})


def pairs(text: str, mark: str, wanted: str) -> Iterator[tuple[str, str]]:
    """Yield the parts of a text before and after a mark, as in c_2=40,eta=0.02; a comma that no mark follows is part of
    a value.   wanted : what it must be, for an error."""
    for part in re.split(rf",(?=[^,]*{mark}|$)", text):
        name, found, value = (piece.strip() for piece in part.partition(mark))
        if not (name and found):
            raise argparse.ArgumentTypeError(f"must be {wanted}, got {shortened(part or text)}")
        yield name, value


def coefficients(text: str) -> dict[str, float]:
    """Parse an argument: coefficients of the terms of a law by symbol, SI, as in c_2=40,eta=0.02."""
    values: dict[str, float] = {}
    wanted = "symbols with their coefficients, as in c_2=40,eta=0.02"
    for symbol, value in pairs(text, "=", wanted):
        try:
            # a grouped term is refused later, by the response
            bounds = arguments.NUMBERS["given"]._replace(unit=term(symbol).unit)
            if symbol in values:
                raise ValueError(f"{symbol} appears twice: give it once")
            values[symbol] = read_number(symbol, value, bounds)
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error)) from None
    return values


def labels(text: str) -> dict[str, str]:
    """Parse an argument: terms, with a label for each record, as in F_k=A,A,B."""
    return dict(pairs(text, "=", "TERM=LABELS with a label for each record, as in F_k=A,A,B"))


def sliders(text: str) -> list[tuple[float, float]]:
    """Parse an argument: (r, κ) of Jenkins elements, m and N/m, as in 1e-5:40000,5e-5:8000."""
    wanted = "pairs r:kappa, m and N/m, as in 1e-5:40000,5e-5:8000"
    return [(number("r")(r), number("kappa")(kappa)) for r, kappa in pairs(text, ":", wanted)]
