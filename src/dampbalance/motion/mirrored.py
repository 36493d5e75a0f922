"""Steady orbits that are their own mirror image half a period later, from any map of states over half a period.

`motion/period_map.py` shows why there is no other. What is here finds it by Newton's method on s ↦ −Φ(s), and its
reversal at −X, however the motion is followed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from ..arrays import Array
from .events import PHASE_T, PHASE_V, PHASE_X

ACCEPTED = 1e-12
"""Energy norm of s + Φ(s), relative to that of s, where rounding stops the descent."""


def mirrored_state(
    closure: Callable[[Array], tuple[Array, Array]], start: Array, weights: Array, most: int
) -> Array | None:
    """Return the state s with Φ(s) = −s; None if it is not found within `most` steps, or any amplitude would do.

    A Newton step that leads away is replaced by −Φ(s), which is never farther from the orbit than s.

    closure : gives s + Φ(s), (n,), and its derivative, (n, n).   weights : whose product with a state has the root of
    twice its energy as its norm, (n,).
    """
    s, (residual, derivative) = start, closure(start)
    for _ in range(most):
        size, error = np.linalg.norm(weights * s), np.linalg.norm(weights * residual)
        # relative energy norm, to rounding
        if error <= 1e-14 * size:
            break
        trial = s - np.linalg.lstsq(derivative, residual)[0]
        nearer = closure(trial)
        left = np.linalg.norm(weights * nearer[0])
        if error <= ACCEPTED * size and left >= 0.5 * error:
            break  # rounding keeps it from going lower
        if left < error:
            s, (residual, derivative) = trial, nearer
        else:
            s = s - residual
            residual, derivative = closure(s)
    else:
        return None
    scaled = derivative * weights[:, None] / weights
    # least singular value of 1 + ∂Φ/∂s, about π times the damping ratio: less is rounding
    return s if np.linalg.svd(scaled, compute_uv=False)[-1] >= 1e-9 else None


def reversal(phases: Sequence[Array], period: float) -> tuple[float, list[float]] | None:
    """Return (t, state) of the reversal at −X, s, among the phases of a period; None where the velocity has no zero at
    the start of one.   phases : rows (t, s, x, ẋ, z …).

    Within a period both extremes occur, unless one is at its start: the other, mirrored, gives the reversal at −X.
    """
    turns = [row for row in phases[1:] if row[PHASE_V] == 0.0]
    if not turns:
        return None
    row = max(turns, key=lambda row: abs(row[PHASE_X]))
    side = math.copysign(1.0, row[PHASE_X])
    t = float(row[PHASE_T]) + 0.5 * period * (side > 0.0)
    return t % period, (-side * row[PHASE_X:]).tolist()
