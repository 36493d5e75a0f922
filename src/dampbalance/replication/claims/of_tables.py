"""The claims of Tables 1, 2 and 3: every printed cell, what the routes give for it, and why it differs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from ..as_published import SLIPPING_SAMPLE
from ..printed_tables import COLUMN_OF
from . import causes
from .allowed import by_table_2, by_table_3, misfits
from .checksums import refuted
from .inputs import CORRECTED, Sources
from .judging import WRITTEN, Claim
from .published import Row
from .reading_rules import rules_at_work
from .tolerances import phase_read, propagated, simulated, velocity_read


def read_outs(sources: Sources, rows: Sequence[Row]) -> Iterator[Claim]:
    """Table 1: the read-outs of the five levels. X and X_s are rounded, φ and V_s read off plots, t_s is cut off."""
    refutations = refuted(sources.published, sources.case, "table1")
    for row in rows:
        yield row.claim(
            sources.features(COLUMN_OF[row.symbol], int(row.line)),
            contradiction=refutations.get(row.id, ""),
            **_how_read(sources, row),
        )


def _how_read(sources: Sources, row: Row) -> dict[str, Any]:
    """How a number of Table 1 was read, by the rule of its row: fields of the claim."""
    level, column = int(row.line), COLUMN_OF[row.symbol]
    exact = sources.exact.feature(column, level)
    if row.rule == "rounded":
        return {}
    if row.rule == "time":  # whole tenths, of which the exact time keeps the rest
        cause = causes.slip_time(exact, sources.case.numerics.step_s, row.printed)
        return {"route": "as_published", "reach": WRITTEN, "apart": ("exact",), "cause": cause}
    if row.rule == "phase":
        tolerances = phase_read(row.printed, sources.case.omega("omega1"))
        crossing = sources.exact.feature("phi_zero_crossing_rad", level)
        cause = causes.phase(exact, crossing, row.printed)
    else:
        onset, sample = (sources.unread(name, level) for name in (column, SLIPPING_SAMPLE))
        tolerances = velocity_read(row.printed, sample - onset)
        cause = causes.slip_velocity(sample, row.printed)
    return {"route": "as_published", "reach": math.nan, "tolerances": tolerances, "cause": cause}


def integrals(sources: Sources, rows: Sequence[Row]) -> Iterator[Claim]:
    """Table 2, upper part: the integrals a, b and W of the five levels."""
    refutations = refuted(sources.published, sources.case, "table2")
    allowed = by_table_2(sources.published)
    omega, step = sources.case.omega("omega1"), sources.case.numerics.step_s
    for row in rows:
        values = sources.features(COLUMN_OF[row.symbol], int(row.line))
        note, evidence = "", ""
        if row.symbol == "b":
            note, evidence = causes.implied_b(sources.published, row.line)
        elif row.symbol == "a":
            note = causes.starting_sample(sources.case, int(row.line) - 1)
        yield row.claim(
            values,
            route="as_published",
            allowed=allowed.get(row.id),
            tolerances=simulated(row.printed, omega, step),
            cause=f"{causes.backward_euler(sources.case, values)} {note}".strip(),
            contradiction=refutations.get(row.id, ""),
            evidence=evidence,
        )


def direct_pairs(sources: Sources, rows: Sequence[Row]) -> Iterator[Claim]:
    """Table 2, lower part: the pair-wise estimates by direct integration, from more digits than are printed."""
    of_print = by_table_2(sources.published)
    omega, step = sources.case.omega("omega1"), sources.case.numerics.step_s
    for row in rows:
        values = sources.estimates(COLUMN_OF[row.symbol], row.approach, pair=row.line)
        allowed = of_print[row.id]
        damped = causes.backward_euler(sources.case, values) if row.symbol == "c" else ""
        with_b = causes.other_b(sources, of_print, row)
        implied = (causes.implied_b(sources.published, level)[0] for level in row.line.split("-"))
        evidence = " ".join(filter(None, implied))
        yield row.claim(
            values,
            route="as_published",
            allowed=allowed,
            tolerances=(*propagated(allowed, row.printed), *simulated(row.printed, omega, step)),
            cause=f"{damped} {with_b}".strip(),
            contradiction=causes.outside(allowed, row.printed, "Table 2"),
            evidence=evidence and f"Table 2 contradicts itself. {evidence} {with_b}".strip(),
        )


def harmonic_pairs(sources: Sources, rows: Sequence[Row]) -> Iterator[Claim]:
    """Table 3: the pair-wise estimates of the three harmonic approaches with common φ and t_s."""
    at_work = rules_at_work(sources)
    allowed = by_table_3(sources.published, sources.case)
    premise = causes.premise_of_sign(misfits(sources.published, sources.case))
    for row in rows:
        column, which = COLUMN_OF[row.symbol], {"phase": "common", "pair": row.line}
        values = sources.estimates(column, row.approach, **which)
        corrected = CORRECTED if row.approach == "V_s" else row.approach
        correct = sources.as_published.estimate(column, corrected, **which)
        slip = causes.sign(values, correct, row.unit, premise)
        yield row.claim(
            values,
            route="as_published",
            # The read-outs of Table 1 have fewer digits than those behind Table 3; without the slip exact is elsewhere.
            apart=("from_print",),
            nearby={"exact": correct} if slip else {},
            cause=f"{slip} {at_work(row)}".strip(),
            contradiction=causes.outside(allowed.get(row.id), row.printed, "Table 3"),
        )
