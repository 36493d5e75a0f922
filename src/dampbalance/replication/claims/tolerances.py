"""How far off a rebuilt number may lie, and why: the one table behind "reading", "propagated", "unexplained".

    quantity      range                                   reason                                             verdict
    φ             ± 0.1 ms                                the difference of two instants, each read to       reading
                                                          the nearest tenth of a millisecond
    V_s           ± 0.025 mm/s about the first            read off an axis to the nearest 0.05 mm/s          reading
                  slipping sample
    φ, V_s        twice as far                            a whole mark misread where half of one is due      unexplained
    F_k, c of     what the rest of Table 2 allows         computed from inputs with digits that are          propagated
    a pair        (`allowed.py`)                          not printed
    Table 2       less than ten units of the last digit,  the last digit alone is wrong; two programs of     unexplained
                  and less than a step in a period        one scheme may differ by where a cycle begins

Everything else has no range: whole tenths, rounded read-outs and the arithmetic on printed numbers leave nothing open.
The bounds of "unexplained" state what nearness means for a kind of quantity; no number that they judge enters them.
"""

from __future__ import annotations

import math

from ...project.case import Case
from ..claim_verdicts import PROPAGATED, READING, UNEXPLAINED, ClaimVerdict
from ..printed import Printed
from .judging import Range, Tolerance

TIME_UNIT_S = 1e-4
VELOCITY_MARK = 5e-5  # m/s; the printed V_s of levels 2 to 5 are whole multiples of it

NEAR_READINGS = 2.0
"""A reading is near up to so many times what its resolution explains: a whole mark misread instead of half of one."""

NEAR_UNITS = 10.0
"""Units of the last digit: a simulated number that is less far off is right in all digits but the last."""

NOTHING = "nothing says why"


def phase_read(number: Printed, omega: float) -> tuple[Tolerance, ...]:
    """φ as the difference of two instants that were each read to the nearest unit of time.   omega : rad/s."""
    step = omega * TIME_UNIT_S
    how = f"a difference of two instants, each to the nearest {1e3 * TIME_UNIT_S:g} ms, is known to {step:.4f} rad"
    return _read(number.value, step, how)


def velocity_read(number: Printed, to_sample: float) -> tuple[Tolerance, ...]:
    """V_s as the velocity of the first slipping sample, read to the nearest mark.

    to_sample : by how much it exceeds that of the onset itself, which the route gives, m/s.
    """
    half = 0.5 * VELOCITY_MARK
    how = f"the first slipping sample, to the nearest {1e3 * VELOCITY_MARK:g} mm/s, is known to {1e3 * half:g} mm/s"
    return _read(number.value - to_sample, half, how)


def propagated(allowed: Range | None, number: Printed) -> tuple[Tolerance, ...]:
    """F_k or c of a pair in the range that the rest of Table 2 allows, if any."""
    if allowed is None:
        return ()
    reason = f"digits that are not printed leave {shown(allowed, number)}"
    return (Tolerance(*allowed, reason, PROPAGATED),)


def simulated(number: Printed, case: Case) -> tuple[Tolerance, ...]:
    """A number of Table 2 close to print without a reason.   case : for ω1 and the step of the simulation."""
    share = case.numerics.step_s * case.omega("omega1") / (2.0 * math.pi)
    far = min(NEAR_UNITS * number.unit, share * abs(number.value))
    reason = (
        f"less than {NEAR_UNITS:g} units and {share:.1e} of itself, a step in a period; {NOTHING}"
    )
    return (_about(number.value, far, reason, UNEXPLAINED),)


def shown(ends: Range, number: Printed) -> str:
    """A range as text, with two digits more than are printed."""
    return " to ".join(number.show(end, 2) for end in ends)


def _read(value: float, step: float, how: str) -> tuple[Tolerance, ...]:
    beyond = f"{how}; it is less than {NEAR_READINGS:g} times as far off, and {NOTHING}"
    return (
        _about(value, step, how, READING),
        _about(value, NEAR_READINGS * step, beyond, UNEXPLAINED),
    )


def _about(value: float, far: float, reason: str, verdict: ClaimVerdict) -> Tolerance:
    return Tolerance(value - far, value + far, reason, verdict)
