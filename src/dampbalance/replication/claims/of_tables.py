"""The claims of Tables 1, 2 and 3: every printed cell, what the routes give for it, and why it differs."""

from __future__ import annotations

import math
from typing import Any

from ..as_published import CORRECTED, SLIPPING_SAMPLE
from ..printed_tables import COLUMN_OF
from . import causes
from .judging import WRITTEN, Claim
from .published import Row
from .sources import Sources
from .tolerances import phase_read, propagated, simulated, velocity_read


def read_out(sources: Sources, row: Row) -> Claim:
    """Table 1: X and X_s are rounded, φ and V_s read off plots, t_s is cut off to whole tenths."""
    level, column, number = int(row.line), COLUMN_OF[row.symbol], row.number
    exact = sources.exact.feature(column, level)
    how: dict[str, Any] = {"route": "as_published", "reach": math.nan}
    if row.rule == "rounded":
        how = {}
    elif row.rule == "time":  # whole tenths, of which the exact time keeps the rest
        how |= {"reach": WRITTEN, "apart": ("exact",)}
        how["cause"] = causes.slip_time(exact, sources.case.numerics.step_s, number)
    elif row.rule == "phase":
        crossing = sources.exact.feature("phi_zero_crossing_rad", level)
        how["tolerances"] = phase_read(number, sources.case.omega("omega1"))
        how["cause"] = causes.phase(exact, crossing, number)
    else:
        onset, sample = (sources.unread.feature(name, level) for name in (column, SLIPPING_SAMPLE))
        how["tolerances"] = velocity_read(number, sample - onset)
        how["cause"] = causes.slip_velocity(sample, number)
    contradiction = sources.refuted.get(row.id, "")
    return Claim(row, sources.features(column, level), contradiction=contradiction, **how)


def integral(sources: Sources, row: Row) -> Claim:
    """Table 2, upper part: the integrals a, b and W of the five levels."""
    case, level = sources.case, int(row.line)
    values = sources.features(COLUMN_OF[row.symbol], level)
    note, evidence = "", ""
    if row.symbol == "b":
        note, evidence = causes.implied_b(sources.published, row.line)
    elif row.symbol == "a":
        note = causes.starting_sample(case, level)
    return Claim(
        row,
        values,
        "as_published",
        allowed=sources.allowed.get(row.id),
        tolerances=simulated(row.number, case),
        cause=f"{causes.backward_euler(case, values)} {note}".strip(),
        contradiction=sources.refuted.get(row.id, ""),
        evidence=evidence,
    )


def direct_pair(sources: Sources, row: Row) -> Claim:
    """Table 2, lower part: the pair-wise estimates by direct integration, from more digits than are printed."""
    case, published = sources.case, sources.published
    values = sources.estimates(COLUMN_OF[row.symbol], row.approach, pair=row.line)
    allowed = sources.allowed[row.id]
    damped = causes.backward_euler(case, values) if row.symbol == "c" else ""
    with_b = causes.other_b(published, sources.as_published, sources.allowed, row)
    implied = (causes.implied_b(published, level)[0] for level in row.line.split("-"))
    evidence = " ".join(filter(None, implied))
    return Claim(
        row,
        values,
        "as_published",
        allowed=allowed,
        tolerances=(*propagated(allowed, row.number), *simulated(row.number, case)),
        cause=f"{damped} {with_b}".strip(),
        contradiction=causes.outside(allowed, row.number, "Table 2"),
        evidence=evidence and f"Table 2 contradicts itself. {evidence} {with_b}".strip(),
    )


def harmonic_pair(sources: Sources, row: Row) -> Claim:
    """Table 3: the pair-wise estimates of the three harmonic approaches with common φ and t_s."""
    column = COLUMN_OF[row.symbol]
    values = sources.estimates(column, row.approach, pair=row.line)
    corrected = CORRECTED if row.approach == "V_s" else row.approach
    correct = sources.as_published.estimate(column, corrected, pair=row.line)
    slip = causes.sign(values["as_published"], correct, row.unit, sources.misfits)
    return Claim(
        row,
        values,
        "as_published",
        # The read-outs of Table 1 have fewer digits than those behind Table 3; without the slip exact is elsewhere.
        apart=("from_print",),
        nearby={"exact": correct} if slip else {},
        cause=f"{slip} {sources.rules_at_work(row)}".strip(),
        contradiction=causes.outside(sources.allowed.get(row.id), row.number, "Table 3"),
    )
