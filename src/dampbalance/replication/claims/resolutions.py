"""How finely each quantity of the paper can have been read: the one table behind the verdict "reading".

    quantity  resolution                    reason
    φ         ± 0.13 ms, 0.004 rad          the printed phases scatter by this much about the phase of the velocity
                                            reversal; t_s, read on the same axis, is printed in steps of 0.1 ms
    t_s       0.1 ms and two steps below    whole tenths of a millisecond between the first and the last sample inside
                                            the microstick phase
    a         ± 2 samples, 4 V_s h          slip onset may be seen one or two samples late, and a counts it twice
    b, W      ± half a unit of k/m          the digits of k/m in the paper's program are inferred; W goes with k/m, b
                                            with its square

The pairs of Table 2 need no entry: the rounding of the printed a, b and W bounds them (`of_tables.rounding_ranges`).
"""

from __future__ import annotations

import math

from ...project.case import Case
from ..as_published import coefficients
from ..printed import Printed
from .judging import Resolution

PHASE_READING_S = 0.13e-3
TIME_UNIT_S = 1e-4
VELOCITY_MARK = 5e-5  # m/s; the printed V_s of levels 2 to 5 are whole multiples of it
TRAVEL_SAMPLES = 2


def phase_resolution(phi: float, omega: float) -> Resolution:
    """φ read on the time axis to ± 0.13 ms."""
    step = omega * PHASE_READING_S
    return Resolution(
        phi - step,
        phi + step,
        f"phi was read on the time axis, to {1e3 * PHASE_READING_S:.2f} ms or {step:.3f} rad",
    )


def time_resolution(t_s: float, step: float) -> Resolution:
    """t_s in whole tenths of a millisecond, a step of the simulation lost at each end."""
    return Resolution(
        t_s - TIME_UNIT_S - 2.0 * step,
        t_s,
        "t_s was read in whole tenths of a millisecond, the rest dropped",
    )


def integral_resolution(symbol: str, value: float, V_s: float, case: Case) -> Resolution | None:
    """a, b or W about the as-published `value`; None when there is none. V_s : m/s, the as-published one."""
    if math.isnan(value):
        return None
    if symbol == "a":
        half = 2.0 * TRAVEL_SAMPLES * V_s * case.numerics.step_s
        each = f"2 V_s h = {half / TRAVEL_SAMPLES:.1e} m each"
        reason = f"slip onset may be seen {TRAVEL_SAMPLES} samples earlier or later, {each}"
        return Resolution(value - half, value + half, reason)
    coefficient = Printed(repr(coefficients(case)["k_over_m"]))
    power = 2.0 if symbol == "b" else 1.0
    relative = power * 0.5 * coefficient.unit / coefficient.value
    return Resolution(
        value * (1.0 - relative),
        value * (1.0 + relative),
        f"half a unit in the last digit of k/m = {coefficient.text} moves {symbol} by about {relative:.0e} of itself",
    )
