"""Sampling times: whether they are in equal steps."""

from __future__ import annotations

import numpy as np

from ..arrays import Array

GRID_TOLERANCE = 0.05
"""Part of a step by which a time stamp may be off the uniform grid: room for times written with few digits, while a
missing or doubled sample (one whole step) is still found."""

HALF_A_STEP = 0.5
"""Part of a step from which on a sample is in another one's place."""


def uneven(t: Array, jitter: float) -> str:
    """Say where times, s, (n,), are not in equal steps; "" where they are.   jitter : by how much of a step a time may
    be off."""
    steps = np.diff(t)
    step, off = float(np.median(steps)), np.abs(t - np.linspace(t[0], t[-1], t.size))
    if steps.min() > 0.0 and off.max() <= jitter * step:
        return ""
    i = int(np.argmin(steps) if steps.min() <= 0.0 else np.argmax(np.abs(steps - step)))
    between = f"from sample {i} to {i + 1} ({t[i]:.12g} s, {t[i + 1]:.12g} s)"
    return f"is not in equal steps: {steps[i]:.6g} s {between}, others {step:.6g} s"
