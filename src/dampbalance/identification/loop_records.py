"""The loops in measured records: their channels at common times, their sign, and their normal forces."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..findings.finding import Finding
from ..project.wording import listed, visible
from ..records.channel import ACCOMPANYING
from ..records.record import Record
from ..signals.loops import Loop
from .loading import correction_of

_CUT = 1e-3  # of a record: less time that is left out, as by a delay, is not reported


def read_loops(
    records: Sequence[Record], series: float | None, skipped: int
) -> tuple[tuple[Loop, ...], tuple[float, float] | None, list[Finding]]:
    """Return the loops of records, the mean normal force with its standard uncertainty, N, if all records have one, and
    findings on the records.

    series : stiffness of the fixture, N/m.   skipped : cycles left out at the start of each.
    """
    loops, odd = list[Loop](), list[Finding]()
    for record in records:
        loop, cut = _loop(record, series, skipped)
        loops.append(loop)
        odd += [one.about(record.name) for one in (*record.warnings, *cut)]
    cycles = [loop.means(loop.N) for loop in loops if loop.N is not None]
    if len(cycles) < len(loops):
        return tuple(loops), None, odd
    N = float(np.concatenate(cycles).mean())
    if not all(of.mean() > 0.0 for of in cycles):
        raise ValueError(
            f"{listed([record.name for record in records])}: the normal force is zero: check its transducer, or leave "
            "the channel out"
        )
    # the uncertainty is that of the scatter between cycles of a record, and of the gain
    off = np.concatenate([of / of.mean() for of in cycles])
    gain = max(correction_of(record, "normal_force").gain_error for record in records)
    scatter = float(off.std(ddof=1)) / math.sqrt(off.size) if off.size > 1 else 0.0
    error = N * math.hypot(scatter, gain)
    pairs = zip(loops, cycles, strict=True)
    return tuple(replace(loop, load=float(of.mean()) / N) for loop, of in pairs), (N, error), odd


def _loop(record: Record, series: float | None, skipped: int) -> tuple[Loop, list[Finding]]:
    """Return the loop of a record for the time in which all its channels are recorded, and a finding on other times.

    series : stiffness of the fixture, N/m.   skipped : cycles left out at its start.
    """
    from scipy.integrate import cumulative_trapezoid  # slow to import
    from scipy.signal import detrend  # slow to import

    channels = record.corrected()
    moving = [q for q in ("displacement", "velocity")[: 1 + record.timed] if q in record.quantities]
    if "force" not in record.quantities or not moving:
        raise ValueError(
            f"{record.name} has {listed([*record.quantities])}: a measured loop needs the force and the displacement "
            "or velocity across the contact; name them in its mapping"
        )
    used = [channels[q] for q in (moving[0], "force", *ACCOMPANYING) if q in record.quantities]
    motion, force, *_ = used
    begin, end = max(of.t[0] for of in used), min(of.t[-1] for of in used)
    own = (motion.t >= begin) & (motion.t <= end)
    if np.count_nonzero(own) < 3:
        raise ValueError(
            f"{record.name}: {listed([of.name for of in used])} are not recorded at the same time; check their times "
            "in the mapping"
        )
    lost, cut = max(float(np.ptp(of.t)) for of in used) - float(end - begin), list[Finding]()
    if lost > _CUT * (end - begin):
        names = listed([visible(of.name) for of in used])
        cut.append(Finding("cut off", {"lost": lost, "channels": names}))
    t, x = motion.t[own], motion.values[own]
    f = np.interp(t, force.t, force.values)
    if moving[0] == "velocity":
        x = detrend(cumulative_trapezoid(x, t, initial=0))
    if series:
        # the deflection of the fixture has the sign of the force that the contact makes
        way = math.copysign(1.0, float(np.trapezoid(f - f.mean(), x)))
        x = x - way * (f - f.mean()) / series
    N = channels["normal_force"] if "normal_force" in record.quantities else None
    gaps = [np.interp(t, of.t, of.missing) > 0.0 for of in used if of.missing is not None]
    missing = np.any(gaps, axis=0) if gaps else None
    loop = Loop.of(record.name, t, x, f, missing, skipped)
    pressed = None if N is None else np.abs(np.interp(t, N.t, N.values))
    return replace(loop, N=pressed, timed=record.timed), cut
