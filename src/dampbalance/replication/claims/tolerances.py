"""How far off a printed number may lie, and for what reason: the one table behind "reading", "propagated", "scatter".

    quantity    range                           reason                                                     verdict
    φ           ± 0.1 ms                        the difference of two instants, each read to the nearest   reading
                                                tenth of a millisecond, the unit of the printed t_s
    t_s         0.1 ms and two steps below      whole tenths between the first and the last sample in the  reading
                                                microstick phase
    F_k, c of   what the rest of its table      computed from inputs with digits that are not printed        propagated
    a pair      allows (`allowed.py`)
    a           the next best cycle, δ of a     a begins at a sample, and where the samples fall depends   propagated
                step aside                      on the cycle
    φ, W        the scatter of the other four   nothing outside the five values bounds them                scatter

Each range comes from elsewhere than the number that it judges: a unit of print, the step, the periods simulated, other
printed numbers, or the other levels.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ...project.case import Numerics
from ...reading.clean import CYCLES_TO_READ
from ..printed import Printed
from ..verdicts import PROPAGATED, SCATTER
from .judging import Tolerance

TIME_UNIT_S = 1e-4
VELOCITY_MARK = 5e-5  # m/s; the printed V_s of levels 2 to 5 are whole multiples of it
CONFIDENCE = 0.95


def phase_read(phi: float, omega: float) -> Tolerance:
    """φ as the difference of two instants that were each read to the nearest unit of time.

    phi : exact, rad.   omega : rad/s.
    """
    step = omega * TIME_UNIT_S
    return Tolerance(
        phi - step,
        phi + step,
        f"phi is a difference of two instants, each to the nearest {1e3 * TIME_UNIT_S:g} ms as t_s is: "
        f"{phi - step:.3f} to {phi + step:.3f} is one reading",
    )


def time_read(t_s: float, step: float) -> Tolerance:
    """t_s in whole tenths of a millisecond, a step of the simulation lost at each end.   t_s, step : s."""
    low = t_s - TIME_UNIT_S - 2.0 * step
    return Tolerance(
        low,
        t_s,
        f"t_s was read in whole tenths of a millisecond, the rest dropped: {low:.2e} to {t_s:.2e} is one reading",
    )


def propagated(
    allowed: tuple[float, float] | None, printed: str, table: str
) -> tuple[Tolerance, ...]:
    """F_k or c of a pair: the values that the rest of its table allows, if any, rounded as the printed one is."""
    if allowed is None:
        return ()
    number = Printed(printed)
    low, high = allowed
    reason = f"the rest of {table}, within its rounding, allows {number.show(low, 2)} to {number.show(high, 2)}"
    half = 0.5 * number.unit
    return (Tolerance(low - half, high + half, reason, PROPAGATED),)


def cycle_chosen(
    a: float, V_s: float, omega: float, numerics: Numerics, printed: str
) -> tuple[Tolerance, ...]:
    """a of the as-published simulation, as far as the choice of the cycle moves it.

    From period to period the samples move against the motion by the fraction of a step that a period exceeds whole
    steps by. Of the periods simulated, those whose samples fall closest to the ones read are δ = min |n T/h − integer|
    apart, and none lies between: a, which begins at a sample, is known to 2 V_s h δ.

    a : m.   V_s : velocity where slip begins, m/s.   omega : rad/s.
    """
    if math.isnan(a):
        return ()
    periods = np.arange(1, max(numerics.cycles - CYCLES_TO_READ, 1) + 1)
    places = periods * (2.0 * math.pi / omega / numerics.step_s)
    distances = np.abs(places - np.round(places))
    nearest, delta = int(periods[np.argmin(distances)]), float(np.min(distances))
    reach = 2.0 * V_s * numerics.step_s * delta
    number = Printed(printed)
    reason = (
        f"the samples of the cycle {nearest} periods away lie {delta:.3f} of a step aside, and none lie closer: "
        f"{number.show(a - reach, 1)} to {number.show(a + reach, 1)} by the choice of the cycle"
    )
    reach += 0.5 * number.unit
    return (Tolerance(a - reach, a + reach, reason, PROPAGATED),)


def of_the_others(
    computed: Sequence[float], printed: Sequence[str], level: int, *, relative: bool
) -> tuple[Tolerance, ...]:
    """How far print may lie from a computation if it scatters about it as the other levels do about their mean,

        ± t₀.₉₇₅ s √(1 + 1/n),   t with n − 1 degrees of freedom, s the standard deviation of the n other levels.

    A shift of all levels alike widens nothing: the range is about the computed number itself.

    computed, printed : the quantity at every level, by a computation and in print.   level : counted from 0.
    relative : deviations of themselves, or in the unit of the quantity.

    Nothing where a value is NaN or there are fewer than three levels.
    """
    from scipy.special import stdtrit  # slow to import, and not needed to read or to check claims

    values = np.asarray(computed)
    scale = values if relative else np.ones_like(values)
    deviations = (np.array([Printed(text).value for text in printed]) - values) / scale
    others = np.delete(deviations, level)
    if others.size < 2 or not np.all(np.isfinite(deviations)):
        return ()
    reach = stdtrit(others.size - 1, 0.5 + 0.5 * CONFIDENCE) * np.std(others, ddof=1)
    reach *= math.sqrt(1.0 + 1.0 / others.size)
    value, far = float(values[level]), float(abs(reach * scale[level]))
    of = " of itself" if relative else ""
    reason = (
        f"no tolerance from outside explains it; the other levels deviate by {np.min(others):+.1e} to "
        f"{np.max(others):+.1e}{of}, this one by {deviations[level]:+.1e}"
    )
    return (Tolerance(value - far, value + far, reason, SCATTER),)
