"""Notes on the estimates, and on how they agree: misfits, contradictions, and numbers that no oscillator can have."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..balance import TERMS, Rows

if TYPE_CHECKING:
    from .result import ApproachResult, Microstick

YARDSTICK = "direct"
"""The approach that assumes no shape of x(t): the others are held against it."""

_CHANCE = 1e-4  # of a misfit this large in noise, below which it is reported
_APART = 3.0  # standard errors
_ALIKE = 0.02  # sine of the angle between the columns of A below which the levels hardly tell F_k and c apart


def with_notes(estimates: Mapping[str, ApproachResult]) -> dict[str, ApproachResult]:
    """Add to each estimate what a reader must know of it."""
    yardstick = estimates.get(YARDSTICK)
    return {
        name: replace(e, notes=(*e.notes, *_notes(e, None if e is yardstick else yardstick)))
        for name, e in estimates.items()
    }


def _notes(estimated: ApproachResult, yardstick: ApproachResult | None) -> list[str]:
    notes = []
    for symbol, parameter in estimated.coefficients.items():
        if parameter.value < -_APART * parameter.standard_error:
            notes.append(
                f"{symbol} = {parameter.value:.3g} {TERMS[symbol].unit} is negative: no such oscillator exists; "
                "check signs, channels and the stiffness"
            )
    apart = _apart(estimated, yardstick)
    if apart:
        notes.append(apart)
    elif _improbable(estimated.misfit, estimated.rows, len(estimated.coefficients)):
        notes.append(
            f"the rows lie {math.sqrt(estimated.misfit):.2g} times farther from the fit than noise explains: "
            f"{_listed(estimated, 'or')} is not the same at every level, or the oscillator is not of this kind; the "
            "intervals do not tell"
        )
    return notes


def _improbable(misfit: float, rows: Rows, parameters: int) -> bool:
    """Whether noise makes a χ² per degree of freedom as large as this hardly ever; False where it is not known."""
    from scipy import special  # slow to import, as scipy.stats with the same functions is

    freedom = int(rows.usable.sum()) - parameters
    if freedom < 1 or not math.isfinite(misfit):
        return False
    return bool(special.chdtrc(freedom, misfit * freedom) < _CHANCE)


def _apart(estimated: ApproachResult, yardstick: ApproachResult | None) -> str:
    """A sentence where an approach contradicts the direct balance, whose noise it shares: its shape is then wrong."""
    if yardstick is None:
        return ""
    parts = []
    for symbol, own in estimated.coefficients.items():
        other = yardstick.coefficients.get(symbol)
        if other is None:
            continue
        error = max(own.standard_error, other.standard_error)
        if abs(own.value - other.value) > _APART * error and other.value:
            parts.append(f"{symbol} by {100.0 * (own.value / other.value - 1.0):+.2g} %")
    if not parts:
        return ""
    return (
        f"off the direct balance, {' and '.join(parts)}: the shape of x(t) that this approach assumes does not hold, "
        "and its intervals do not tell"
    )


def agreement(microstick: Microstick, estimates: Mapping[str, ApproachResult]) -> list[str]:
    """Warnings on all records together."""
    warnings = []
    if not math.isfinite(microstick.bound):
        warnings.append(
            "no record shows harmonics above its noise: nothing may slip, or there may be no friction; K_z is unknown, "
            "and the contact is taken as rigid, which costs F_k an unknown part: excite it more, or reduce the noise"
        )
    elif not microstick.resolved:
        warnings.append(
            "the records together do not resolve the slip onset: K_z has no upper limit, and the contact is taken as "
            f"rigid; F_k is then too small by up to {100.0 * abs(microstick.rigid_bias):.2g} % (97.5 % confidence); "
            "sample faster, measure acceleration, or reduce the noise"
        )
    if _improbable(microstick.misfit, next(iter(estimates.values())).rows, 1):
        warnings.append(
            f"the microstick lines of the records differ {math.sqrt(microstick.misfit):.2g} times more than their "
            "noise explains: 2F_k/K_z is not the same at every level"
        )
    first = next((e for e in estimates.values() if e.rows.usable.sum() >= 2), None)
    if first is not None and _sine(first.rows) < _ALIKE:
        warnings.append(
            f"the levels are so alike that {_listed(first, 'and')} can hardly be told apart: add a record at a much "
            "higher or lower amplitude"
        )
    return warnings


def _sine(rows: Rows) -> float:
    """The smallest sine of the angle that a column of the balance makes with those before it."""
    columns = [g[rows.usable] / np.linalg.norm(g[rows.usable]) for g in rows.terms.values()]
    return float(np.min(np.abs(np.diag(np.linalg.qr(np.column_stack(columns))[1]))))


def _listed(estimated: ApproachResult, word: str) -> str:
    """ "F_k or c" """
    return f" {word} ".join(estimated.coefficients)
