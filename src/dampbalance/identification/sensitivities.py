"""Effect of faults of calibration and timing, which records hardly show, on an identification.

The data are changed by the fault and by its opposite and fitted again from the optimum; the effect is half the
difference of the two (GUM 5.1.3, note 2). A gain of the drive multiplies Y, one of the response all x_n; a response
that is late by τ has x_n e^{−inωτ}; a phase error at the drive frequency is a delay by that part of a cycle. Each kind
of records implements the change and the fit (`Basis.with_fault`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import partial
from typing import TYPE_CHECKING, Any

from ..signals.one_thread import one_thread

if TYPE_CHECKING:
    from .result import Result


@dataclass(frozen=True, slots=True)
class Fault:
    """A fault that is the same in all records.

    words : what is wrong, and by how much.   drive, response : relative errors of gain.   late : delay of the response,
    s.   angle : lag of the response at the drive frequency, rad.   stiffness, mass : relative errors of k and of m, if
    it is given.
    """

    words: str
    drive: float = 0.0
    response: float = 0.0
    late: float = 0.0
    angle: float = 0.0
    stiffness: float = 0.0
    mass: float = 0.0

    def opposite(self) -> Fault:
        """Return the fault with the other sign."""
        sizes = {of.name: -getattr(self, of.name) for of in fields(self) if of.name != "words"}
        return replace(self, **sizes)


FAULTS: Mapping[str, Fault] = {
    "drive_gain_1_percent": Fault("the drive reads 1 % too large", drive=0.01),
    "response_gain_1_percent": Fault("the response reads 1 % too large", response=0.01),
    "response_phase_1_degree": Fault("the response lags by 1° too much", angle=math.radians(1.0)),
    "response_late_100_us": Fault("the response is 100 µs late", late=1e-4),
    "stiffness_1_percent": Fault("k is given 1 % too large", stiffness=0.01),
}


_ALONE = "loops", "friction-speed"
"""Kinds of records of a contact alone, without an oscillator."""


def told(found: Result[Any], words: str) -> str:
    """Return the words of a fault for these records: of a contact alone, the drive is its force and the response its
    motion."""
    if found.basis.kind in _ALONE:
        words = words.replace("drive", found.coordinate.noun("force")).replace("response", "motion")
    return words


@one_thread
def effects_of(
    found: Result[Any], faults: Mapping[str, Fault], name: str
) -> dict[str, dict[str, float]]:
    """Return the relative changes of the numbers of an answer by each fault, to first order: fault → symbol → change,
    "m" for the mass; empty where they are not known.   name : of the answer."""
    with_fault = partial(found.basis.with_fault, found, name)
    here, effects = with_fault(Fault("none")), dict[str, dict[str, float]]()
    for what, fault in faults.items() if here else ():
        less, more = with_fault(fault.opposite()), with_fault(fault)
        effects[what] = {s: 0.5 * (more[s] - less[s]) / p for s, p in here.items() if p}
    return effects
