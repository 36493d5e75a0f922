"""The steady response of an oscillator under a law that a user states."""

from __future__ import annotations

from collections.abc import Mapping

from ..arguments import NUMBERS, instance, mapping, number
from ..law.terms import FRICTION, term
from ..model import BaseMotion, Oscillator
from .law_steady import Response, steady_response


def law_response(oscillator: Oscillator, motion: BaseMotion, law: Mapping[str, float]) -> Response:
    """Return the steady response of an oscillator under a law; use it to sample a motion with `measured_orbit`.

    law : term, or symbol of one, → coefficient of the terms besides friction and c, which are the oscillator's, SI.

    Raises NoSteadyOrbit as `steady_response`, ValueError naming a term that is unknown, or the oscillator's own, or
    whose coefficient is negative or not a number.
    """
    instance("oscillator", oscillator, Oscillator)
    instance("motion", motion, BaseMotion)
    coefficients = mapping("law", law, "a mapping of symbols to coefficients")
    for symbol, p in coefficients.items():
        of = term(symbol)
        words = of.words
        if of.group is not None:
            raise ValueError(f"{symbol} is the {words} of a group of records: name the term alone")
        if symbol in (FRICTION, "c"):
            raise ValueError(f"the {words} belongs to the oscillator: set Oscillator.{symbol}")
        coefficients[symbol] = number(f"{symbol} ({words})", p, NUMBERS["given"])
    return steady_response(oscillator, motion, coefficients)
