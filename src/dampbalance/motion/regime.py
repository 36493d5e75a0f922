"""Kinds of steady orbits: the reason why a feature exists or does not."""

from __future__ import annotations

from enum import IntEnum


class Regime(IntEnum):
    """Pattern of slip and stick in the steady orbit; `str` gives it in words, the integer is what arrays hold."""

    NOT_FOUND = 0
    ONE_SLIP = 1
    SEVERAL_SLIPS = 2
    NO_SLIP = 3
    NO_FRICTION = 4

    def __str__(self) -> str:
        return _WORDS[self]


_WORDS = {
    Regime.NOT_FOUND: "no steady orbit found",
    Regime.ONE_SLIP: "one slip onset per half cycle",
    Regime.SEVERAL_SLIPS: "several slip onsets per half cycle",
    Regime.NO_SLIP: "no slip: the contact only sticks",
    Regime.NO_FRICTION: "no friction: the contact slips all the time",
}
