"""Whether sampling times are in equal steps."""

from __future__ import annotations

import numpy as np

from ..arrays import Array

GRID_TOLERANCE = 0.05
"""Part of a step by which a time stamp may deviate from equal steps: large enough for times with few digits, and small
enough to reveal a missing or doubled sample."""

HALF_A_STEP = 0.5
"""Part of a step by which a sample moves to the place of the next."""


def uneven(t: Array, jitter: float) -> str:
    """Return where times, s, (n,), are not in equal steps; "" if they are.

    jitter : part of a step by which a time may deviate.
    """
    steps = np.diff(t)
    step, off = float(np.median(steps)), np.abs(t - np.linspace(t[0], t[-1], t.size))
    if steps.min() > 0.0 and off.max() <= jitter * step:
        return ""
    i = int(np.argmin(steps) if steps.min() <= 0.0 else np.argmax(np.abs(steps - step)))
    between = f"from sample {i} to {i + 1} ({t[i]:.12g} s, {t[i + 1]:.12g} s)"
    return f"is not in equal steps: {steps[i]:.6g} s {between}, others {step:.6g} s"
