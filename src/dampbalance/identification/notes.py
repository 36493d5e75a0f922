"""What the estimates say of each other: misfits, contradictions, and numbers that no oscillator can have."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy import special  # scipy.stats has the same functions, and takes seconds to import

if TYPE_CHECKING:
    from .result import Estimated, Microstick

YARDSTICK = "direct"
"""The approach that assumes no shape of x(t): the others are held against it."""

_CHANCE = 1e-4  # of a misfit this large in noise, below which it is reported
_APART = 3.0  # standard errors
_ALIKE = 0.02  # sine of the angle between the columns of A below which the levels hardly tell F_k and c apart


def judged(estimates: Mapping[str, Estimated]) -> dict[str, Estimated]:
    """The estimates, with notes on each."""
    yardstick = estimates.get(YARDSTICK)
    return {
        name: replace(e, notes=(*e.notes, *_notes(e, None if e is yardstick else yardstick)))
        for name, e in estimates.items()
    }


def _notes(estimated: Estimated, yardstick: Estimated | None) -> list[str]:
    found = []
    for symbol, unit in (("F_k", "N"), ("c", "N s/m")):
        parameter = getattr(estimated, symbol)
        if parameter.value < -_APART * parameter.standard_error:
            found.append(
                f"{symbol} = {parameter.value:.3g} {unit} is negative: no such oscillator exists; check signs, "
                "channels and the stiffness"
            )
    apart = _apart(estimated, yardstick)
    if apart:
        found.append(apart)
    elif _misfits(estimated):
        found.append(
            f"the rows lie {math.sqrt(estimated.misfit):.2g} times farther from the fit than noise explains: F_k or c "
            "is not the same at every level, or the oscillator is not of this kind; the intervals do not tell"
        )
    return found


def _misfits(estimated: Estimated) -> bool:
    freedom = int(estimated.rows.usable.sum()) - 2
    if freedom < 1 or not math.isfinite(estimated.misfit):
        return False
    return bool(special.chdtrc(freedom, estimated.misfit * freedom) < _CHANCE)


def _apart(estimated: Estimated, yardstick: Estimated | None) -> str:
    """A sentence where an approach contradicts the direct balance, whose noise it shares: its shape is then wrong."""
    if yardstick is None:
        return ""
    parts = []
    for symbol in ("F_k", "c"):
        own, other = getattr(estimated, symbol), getattr(yardstick, symbol)
        error = max(own.standard_error, other.standard_error)
        if abs(own.value - other.value) > _APART * error and other.value:
            parts.append(f"{symbol} by {100.0 * (own.value / other.value - 1.0):+.2g} %")
    if not parts:
        return ""
    return (
        f"off the direct balance, {' and '.join(parts)}: the shape of x(t) that this approach assumes does not hold, "
        "and its intervals do not tell"
    )


def agreement(microstick: Microstick, estimates: Mapping[str, Estimated]) -> list[str]:
    """Warnings on all records together."""
    found = []
    if not math.isfinite(microstick.bound):
        found.append(
            "no record shows harmonics above its noise: nothing may slip, or there may be no friction; K_z is unknown, "
            "and the contact is taken as rigid, which costs F_k an unknown part: excite it more, or reduce the noise"
        )
    elif not microstick.resolved:
        found.append(
            "the records together do not resolve the slip onset: K_z has no upper limit, and the contact is taken as "
            f"rigid; F_k is then too small by up to {100.0 * abs(microstick.rigid_bias):.2g} % (97.5 % confidence); "
            "sample faster, measure acceleration, or reduce the noise"
        )
    if microstick.misfit > 1.0 and math.isfinite(microstick.misfit):
        freedom = sum(math.isfinite(a) for a in next(iter(estimates.values())).rows.a) - 1
        if freedom > 0 and special.chdtrc(freedom, microstick.misfit * freedom) < _CHANCE:
            found.append(
                f"the microstick lines of the records differ {math.sqrt(microstick.misfit):.2g} times more than their "
                "noise explains: 2F_k/K_z is not the same at every level"
            )
    rows = next((e.rows for e in estimates.values() if e.rows.usable.sum() >= 2), None)
    if rows is not None:
        a, b = rows.a[rows.usable], rows.b[rows.usable]
        cosine = float(a @ b) / float(np.linalg.norm(a) * np.linalg.norm(b))
        if math.sqrt(max(0.0, 1.0 - cosine**2)) < _ALIKE:
            found.append(
                "the levels are so alike that F_k and c can hardly be told apart: add a record at a much higher or "
                "lower amplitude"
            )
    return found
