"""The claims of Tables 1, 2 and 3: every printed cell, what the routes give for it, and why it differs."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

from ..as_published import SLIPPING_SAMPLE
from ..claim_ids import of_cell
from ..printed_tables import PRINTED_APPROACHES, TABLE_1, TABLE_2, UNKNOWNS
from . import causes
from .allowed import by_table_2, by_table_3, misfits
from .checksums import refuted
from .inputs import CORRECTED, PAIR_LABELS, Sources
from .judging import HALF, WRITTEN, Claim, Tolerance
from .reading_rules import rules_at_work
from .tolerances import phase_read, propagated, simulated, velocity_read


def levels(sources: Sources) -> Iterator[Claim]:
    """The first column of Tables 1 and 2: the amplitudes Y, which the configuration must hold."""
    tables = {1: sources.published.table1, 2: sources.published.table2_integrals}
    for number, table in tables.items():
        held = dict(zip(table.index, sources.case.levels_m, strict=True))
        for level, printed in table["Y_m"].items():
            yield Claim(
                id=of_cell(f"table{number}", "Y", str(level)),
                where=f"Table {number}, level {level}",
                quantity="Y: amplitude of the base",
                unit="m",
                printed=printed,
                values={"exact": held[level]},
                kind="given",
                holds=causes.same(held[level], printed),
                cause=causes.held(held[level], printed),
            )


def table1(sources: Sources) -> Iterator[Claim]:
    """Table 1: the read-outs of the five levels. X and X_s are rounded, φ and V_s read off plots, t_s is cut off."""
    printed_table = sources.published.table1
    refutations = refuted(sources.published, sources.case, "table1")
    omega, step = sources.case.omega("omega1"), sources.case.numerics.step_s
    for level, q in itertools.product(printed_table.index, TABLE_1):
        printed = printed_table[q.column][level]
        values = sources.features(q.column, int(level))
        route, reach, cause = "as_published", math.nan, ""
        tolerances: tuple[Tolerance, ...] = ()
        apart: tuple[str, ...] = ()
        if q.symbol == "phi":
            tolerances = phase_read(printed, omega)
            crossing = sources.exact.feature("phi_zero_crossing_rad", int(level))
            cause = causes.phase(values["exact"], crossing, printed)
        elif q.symbol == "V_s":
            onset, sample = (sources.unread(c, int(level)) for c in (q.column, SLIPPING_SAMPLE))
            tolerances = velocity_read(printed, sample - onset)
            cause = causes.slip_velocity(sample, printed)
        elif q.symbol == "t_s":
            reach, apart = (
                WRITTEN,
                ("exact",),
            )  # whole tenths, of which the exact time keeps the rest
            cause = causes.slip_time(values["exact"], step, printed)
        else:
            route, reach = "exact", HALF
        yield Claim(
            id=of_cell("table1", q.symbol, level),
            where=f"Table 1, level {level}",
            quantity=f"{q.symbol}: {q.words}",
            unit=q.unit,
            printed=printed,
            values=values,
            route=route,
            reach=reach,
            tolerances=tolerances,
            apart=apart,
            cause=cause,
            contradiction=refutations.get((q.column, level), ""),
        )


def table2_integrals(sources: Sources) -> Iterator[Claim]:
    """Table 2, upper part: the integrals a, b and W of the five levels."""
    printed_table = sources.published.table2_integrals
    refutations = refuted(sources.published, sources.case, "table2_integrals")
    _, viscous = by_table_2(sources.published)
    omega, step = sources.case.omega("omega1"), sources.case.numerics.step_s
    for (place, level), q in itertools.product(enumerate(printed_table.index), TABLE_2):
        values = sources.features(q.column, int(level))
        note, evidence = "", ""
        if q.symbol == "b":
            note, evidence = causes.implied_b(sources.published, level)
        elif q.symbol == "a":
            note = causes.starting_sample(sources.case, place)
        printed = printed_table[q.column][level]
        yield Claim(
            id=of_cell("table2", q.symbol, level),
            where=f"Table 2, level {level}",
            quantity=f"{q.symbol}: {q.words}",
            unit=q.unit,
            printed=printed,
            values=values,
            route="as_published",
            allowed=viscous[int(level)] if q.symbol == "b" else None,
            tolerances=simulated(printed, omega, step),
            cause=f"{causes.backward_euler(sources.case, values)} {note}".strip(),
            contradiction=refutations.get((q.column, level), ""),
            evidence=evidence,
        )


def table2_pairs(sources: Sources) -> Iterator[Claim]:
    """Table 2, lower part: the pair-wise estimates by direct integration, from more digits than are printed."""
    pairs, viscous = by_table_2(sources.published)
    omega, step = sources.case.omega("omega1"), sources.case.numerics.step_s
    for label, q in itertools.product(PAIR_LABELS, UNKNOWNS):
        values = sources.estimates(q.column, "direct", pair=label)
        printed = sources.published.table2_pairs[f"direct_{q.column}"][label]
        allowed = pairs[label, q.symbol]
        damped = causes.backward_euler(sources.case, values) if q.symbol == "c" else ""
        with_b = causes.other_b(sources, viscous, label, q.symbol, printed)
        implied = (causes.implied_b(sources.published, level)[0] for level in label.split("-"))
        evidence = " ".join(filter(None, implied))
        yield Claim(
            id=of_cell("table2", q.symbol, label),
            where=f"Table 2, pair {label}",
            quantity=f"{q.symbol} by direct integration",
            unit=q.unit,
            printed=printed,
            values=values,
            route="as_published",
            allowed=allowed,
            tolerances=(*propagated(allowed, printed), *simulated(printed, omega, step)),
            cause=f"{damped} {with_b}".strip(),
            contradiction=causes.outside(allowed, printed, "Table 2"),
            evidence=evidence and f"Table 2 contradicts itself. {evidence} {with_b}".strip(),
        )


def table3(sources: Sources) -> Iterator[Claim]:
    """Table 3: the pair-wise estimates of the three harmonic approaches with common φ and t_s."""
    at_work = rules_at_work(sources)
    allowed = by_table_3(sources.published, sources.case)
    premise = causes.premise_of_sign(misfits(sources.published, sources.case))
    for approach, label, q in itertools.product(PRINTED_APPROACHES[1:], PAIR_LABELS, UNKNOWNS):
        values = sources.estimates(q.column, approach, phase="common", pair=label)
        printed = sources.published.table3[f"{approach}_{q.column}"][label]
        correct = sources.as_published.estimate(
            q.column, CORRECTED if approach == "V_s" else approach, phase="common", pair=label
        )
        slip = causes.sign(values, correct, q.unit, premise)
        yield Claim(
            id=of_cell("table3", q.symbol, label, approach),
            where=f"Table 3, pair {label}",
            quantity=f"{q.symbol} by {approach}, common phi and t_s",
            unit=q.unit,
            printed=printed,
            values=values,
            route="as_published",
            # The read-outs of Table 1 have fewer digits than those behind Table 3; without the slip exact is elsewhere.
            apart=("from_print",),
            nearby={"exact": correct} if slip else {},
            cause=f"{slip} {at_work(approach, label, q)}".strip(),
            contradiction=causes.outside(
                allowed.get((approach, label, q.symbol)), printed, "Table 3"
            ),
        )
