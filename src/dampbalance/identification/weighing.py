"""Weighed models as findings, one for each departure that the records show or that may matter, and as rows.

Only `DEPARTURES` become findings here. Other candidates, such as another contact, are no imperfection of the records;
the modules of their kind report them.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from typing import NamedTuple

import numpy as np

from ..findings.finding import Finding
from ..fit.select import CLEAR, Model, Selection
from ..solver import NORMAL_95
from .answer import USELESS

DEPARTURES = (
    *("delay", "gain", "corner", "frame", "friction_level", "friction_speed"),
    *("falling", "fading", "gradual", "k_3", "c_2"),
)
"""Departures that are reported: a new one needs its name here and its words in the table of findings."""

_EITHER_WAY = ("delay", "gain", "falling")
"""Departures whose words state the sign."""

_ROUNDING = 1e-6
"""Relative change of numbers that counts as none: the last digit of most files changes them by more."""


class Weighed(NamedTuple):
    """A departure that was weighed; the name "" stands for none.

    weight : the probability that the records have it.   size, error : its size and standard error, SI units; zero where
    it has no size, or one within rounding.
    """

    name: str
    weight: float
    size: float
    error: float


def departure(name: str, size: float, error: float) -> Finding:
    """Return the finding of a departure, whose words are a noun phrase."""
    shown = (abs(size) if name in _EITHER_WAY else size, error)
    return Finding(name, {"size": shown, "less": size < 0.0, "unsure": not error < abs(size)})


def weighed_of(selection: Selection, plain: str = "") -> tuple[Weighed, ...]:
    """Return all models: first the departures that became clear in turn, which all further models have, then these
    models, the heaviest first.   plain : name of the plain one."""
    rows = [Weighed(name, 1.0, *_size(selection, name)) for name in selection.departures]
    pairs = zip(selection.models, selection.weights, strict=True)
    models = [Weighed(one.name or plain, w, *_sized(selection, one)) for one, w in pairs]
    return (*rows, *sorted(models, key=lambda one: -one.weight))


def said_of(selection: Selection, words: Mapping[str, Finding] | None = None) -> list[Finding]:
    """Return a finding for each departure that is clear, or that changes a number by more than `USELESS` by its weight.

    Numbers and intervals include it already, so that the finding has no effect on verdicts.   words : by name, findings
    that state more than a size, or a doubt that no fit shows.
    """
    words, found = words or {}, []
    for one in weighed_of(selection):
        clear = one.weight > CLEAR
        named = one.name in (*words, *DEPARTURES)
        if named and (clear or _most_moved(selection, one.name) > USELESS):
            what = words.get(one.name) or departure(one.name, one.size, one.error)
            numbers = {"what": (what,), "weight": one.weight, "clear": clear}
            found.append(Finding("weighs", numbers, what.effect))
    return found


def _sized(selection: Selection, model: Model) -> tuple[float, float]:
    """Return size and standard error of the departure of a model; zeros if it changes each number by no more than
    rounding or, where the number may be zero, its standard error."""
    plain = selection.models[0]
    sizes, errors = np.abs(plain.values), np.sqrt(np.diag(plain.covariance))
    least = np.where(sizes > NORMAL_95 * errors, _ROUNDING * sizes, errors)
    return model.size if (np.abs(model.values - plain.values) > least).any() else (0.0, 0.0)


def _most_moved(selection: Selection, name: str) -> float:
    """Return the largest relative change of a number by a model with its weight; of ρ, that of K_z = ρ^{−2}."""
    moved = selection.moved_by(name).items()
    return max((abs(by) * (2.0 if key == "rho" else 1.0) for key, by in moved), default=0.0)


def _size(selection: Selection, name: str) -> tuple[float, float]:
    """Return size and standard error of a departure that all models have."""
    with suppress(KeyError):  # another frame has none
        return selection.fit.value(name), selection.fit.error(name) * selection.noise**0.5
    return 0.0, 0.0
