"""The claims of Tables 1, 2 and 3: every printed cell, what the routes give for it, and why it differs."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

from ..claim_ids import of_cell
from ..tables import PRINTED_APPROACHES, TABLE_1, TABLE_2, UNKNOWNS
from . import causes
from .allowed import by_table_2, by_table_3
from .checksums import refuted
from .inputs import CORRECTED, PAIR_LABELS, Sources
from .judging import Claim, Tolerance
from .reading_rules import rules_at_work
from .tolerances import cycle_chosen, of_the_others, phase_read, propagated, time_read


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
                holds={"exact": causes.same(held[level], printed)},
                cause=causes.held(held[level], printed),
            )


def table1(sources: Sources) -> Iterator[Claim]:
    """Table 1: the read-outs X, X_s, V_s, φ and t_s of the five levels."""
    printed_table = sources.published.table1
    refutations = refuted(sources.published, sources.case, "table1")
    phases = [sources.exact.feature("phi_rad", int(level)) for level in printed_table.index]
    for (place, level), q in itertools.product(enumerate(printed_table.index), TABLE_1):
        printed = printed_table[q.column][level]
        values = sources.features(q.column, int(level))
        tolerances: tuple[Tolerance, ...] = ()
        cause = ""
        if q.symbol == "phi":
            column = [str(text) for text in printed_table[q.column]]
            tolerances = (
                phase_read(values["exact"], sources.case.omega("omega1")),
                *of_the_others(phases, column, place, relative=False),
            )
            crossing = sources.exact.feature("phi_zero_crossing_rad", int(level))
            cause = causes.phase(values["exact"], crossing, printed)
        elif q.symbol == "t_s":
            tolerances = (time_read(values["exact"], sources.case.numerics.step_s),)
            cause = causes.slip_time(values["exact"], sources.case.numerics.step_s, printed)
        elif q.symbol == "V_s":
            cause = causes.slip_velocity(values["exact"], printed)
        yield Claim(
            id=of_cell("table1", q.symbol, level),
            where=f"Table 1, level {level}",
            quantity=f"{q.symbol}: {q.words}",
            unit=q.unit,
            printed=printed,
            values=values,
            tolerances=tolerances,
            cause=cause,
            contradiction=refutations.get((q.column, level), ""),
        )


def table2_integrals(sources: Sources) -> Iterator[Claim]:
    """Table 2, upper part: the integrals a, b and W of the five levels."""
    printed_table = sources.published.table2_integrals
    refutations = refuted(sources.published, sources.case, "table2_integrals")
    for (place, level), q in itertools.product(enumerate(printed_table.index), TABLE_2):
        values = sources.features(q.column, int(level))
        note, evidence = "", ""
        tolerances: tuple[Tolerance, ...] = ()
        if q.symbol == "b":
            note, evidence = causes.implied_b(sources.published, level)
        elif q.symbol == "a":
            note = causes.starting_sample(sources.case, place)
            tolerances = cycle_chosen(
                values["as_published"],
                sources.as_published.feature("V_s_m_per_s", int(level)),
                sources.case.omega("omega1"),
                sources.case.numerics,
                printed_table[q.column][level],
            )
        else:
            simulated = [
                sources.as_published.feature(q.column, int(each)) for each in printed_table.index
            ]
            column = [str(text) for text in printed_table[q.column]]
            tolerances = of_the_others(simulated, column, place, relative=True)
        yield Claim(
            id=of_cell("table2", q.symbol, level),
            where=f"Table 2, level {level}",
            quantity=f"{q.symbol}: {q.words}",
            unit=q.unit,
            printed=printed_table[q.column][level],
            values=values,
            tolerances=tolerances,
            cause=f"{causes.backward_euler(sources.case, values)} {note}".strip(),
            contradiction=refutations.get((q.column, level), ""),
            evidence=evidence,
        )


def table2_pairs(sources: Sources) -> Iterator[Claim]:
    """Table 2, lower part: the pair-wise estimates by direct integration."""
    pairs, viscous = by_table_2(sources.published)
    for label, q in itertools.product(PAIR_LABELS, UNKNOWNS):
        values = sources.estimates(q.column, "direct", pair=label)
        printed = sources.published.table2_pairs[f"direct_{q.column}"][label]
        tolerances = propagated(pairs[label, q.symbol], printed, "Table 2")
        damped = causes.backward_euler(sources.case, values) if q.symbol == "c" else ""
        yield Claim(
            id=of_cell("table2", q.symbol, label),
            where=f"Table 2, pair {label}",
            quantity=f"{q.symbol} by direct integration",
            unit=q.unit,
            printed=printed,
            values=values,
            tolerances=tolerances,
            cause=f"{damped} {causes.other_b(sources, viscous, label, q.symbol, printed)}".strip(),
            contradiction=causes.outside(tolerances, printed),
        )


def table3(sources: Sources) -> Iterator[Claim]:
    """Table 3: the pair-wise estimates of the three harmonic approaches with common φ and t_s."""
    at_work = rules_at_work(sources)
    allowed = by_table_3(sources.published, sources.case)
    for approach, label, q in itertools.product(PRINTED_APPROACHES[1:], PAIR_LABELS, UNKNOWNS):
        values = sources.estimates(q.column, approach, phase="common", pair=label)
        printed = sources.published.table3[f"{approach}_{q.column}"][label]
        rest = propagated(allowed.get((approach, label, q.symbol)), printed, "Table 3")
        correct = sources.as_published.estimate(
            q.column, CORRECTED if approach == "V_s" else approach, phase="common", pair=label
        )
        yield Claim(
            id=of_cell("table3", q.symbol, label, approach),
            where=f"Table 3, pair {label}",
            quantity=f"{q.symbol} by {approach}, common phi and t_s",
            unit=q.unit,
            printed=printed,
            values=values,
            # With Table 1 as printed the columns come out otherwise: where one number does not, it is by chance.
            compared=("exact", "as_published"),
            cause=f"{causes.sign(values, correct, q.unit)} {at_work(approach, label, q)}".strip(),
            contradiction=causes.outside(rest, printed),
        )
