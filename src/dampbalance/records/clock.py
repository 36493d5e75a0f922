"""Sampling times: whether they are in about equal steps."""

from __future__ import annotations

import numpy as np

from ..arrays import Array

GRID_TOLERANCE = 0.05
"""Part of a step by which a time stamp may be off the uniform grid: room for times written with few digits, while a
missing or doubled sample (one whole step) is still found."""

_GAP = 1.5  # steps: from here on a sample is missing


def uneven(t: Array, jitter: float) -> tuple[str, str]:
    """Say why times, s, (n,), are not in about equal steps, and how to remedy that; "", "" where they are.

    jitter : by how much of a step a time may be off.
    """
    steps = np.diff(t)
    step, least, most = float(np.median(steps)), int(np.argmin(steps)), int(np.argmax(steps))
    off = np.abs(t - np.linspace(t[0], t[-1], t.size))
    worst = int(np.argmax(off))
    if steps[least] <= 0.0:
        times = f"({t[least]:.12g} s, {t[least + 1]:.12g} s)"
        remedy = "give sample_rate_hz instead if it has too few digits"
        return f"does not increase from sample {least} to {least + 1} {times}", remedy
    if steps[most] > _GAP * step:
        place = f"after {t[most]:.12g} s (sample {most})"
        gap = f"has a gap of {steps[most]:g} s {place}, its step is {step:g} s"
        return gap, "use the part before or after it"
    if off[worst] > jitter * step:
        place = (
            f"{t[worst]:.12g} s (sample {worst}) is {off[worst]:.2g} s off the grid of {step:g} s"
        )
        remedy = (
            "resample the record, or give sample_rate_hz instead if only the digits are too few"
        )
        return f"is not in equal steps: {place}", remedy
    return "", ""
