"""The claims of Tables 1, 2 and 3: every printed cell, what the routes give for it, and why it differs."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from ...balance import Rows
from ...solver import pair
from ..claim_ids import of_cell
from ..printed import Printed
from ..tables import PRINTED_APPROACHES, TABLE_1, TABLE_2, UNKNOWNS
from . import causes
from .inputs import CORRECTED, PAIR_LABELS, PAIRS, Sources
from .judging import Claim, Resolution
from .published import Published, numbers
from .resolutions import integral_resolution, phase_resolution, time_resolution


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
                holds={"exact": causes.same(held[level], printed)},
                cause=causes.held(held[level], printed),
            )


def table1(sources: Sources) -> Iterator[Claim]:
    """Table 1: the read-outs X, X_s, V_s, φ and t_s of the five levels."""
    printed_table = sources.published.table1
    for level, q in itertools.product(printed_table.index, TABLE_1):
        printed = printed_table[q.column][level]
        values = sources.features(q.column, int(level))
        resolution, cause = None, ""
        if q.symbol == "phi":
            resolution = phase_resolution(values["exact"], sources.case.omega("omega1"))
            crossing = sources.exact.feature("phi_zero_crossing_rad", int(level))
            cause = causes.phase(values["exact"], crossing, printed)
        elif q.symbol == "t_s":
            resolution = time_resolution(values["exact"], sources.case.numerics.step_s)
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
            resolution=resolution,
            cause=cause,
        )


def table2_integrals(sources: Sources) -> Iterator[Claim]:
    """Table 2, upper part: the integrals a, b and W of the five levels."""
    printed_table = sources.published.table2_integrals
    for level, q in itertools.product(printed_table.index, TABLE_2):
        values = sources.features(q.column, int(level))
        V_s = sources.as_published.feature("V_s_m_per_s", int(level))
        note, contradiction = "", ""
        if q.symbol == "b":
            note, contradiction = causes.implied_b(sources.published, level)
        yield Claim(
            id=of_cell("table2", q.symbol, level),
            where=f"Table 2, level {level}",
            quantity=f"{q.symbol}: {q.words}",
            unit=q.unit,
            printed=printed_table[q.column][level],
            values=values,
            resolution=integral_resolution(q.symbol, values["as_published"], V_s, sources.case),
            cause=f"{causes.backward_euler(sources.case, values)} {note}".strip(),
            evidence=contradiction,
        )


def table2_pairs(sources: Sources) -> Iterator[Claim]:
    """Table 2, lower part: the pair-wise estimates by direct integration."""
    ranges = rounding_ranges(sources.published)
    for label, q in itertools.product(PAIR_LABELS, UNKNOWNS):
        values = sources.estimates(q.column, "direct", pair=label)
        low, high = ranges[label, q.column]
        yield Claim(
            id=of_cell("table2", q.symbol, label),
            where=f"Table 2, pair {label}",
            quantity=f"{q.symbol} by direct integration",
            unit=q.unit,
            printed=sources.published.table2_pairs[f"direct_{q.column}"][label],
            values=values,
            resolution=Resolution(
                low, high, "the printed a, b and W give it, within their rounding"
            ),
            cause=causes.backward_euler(sources.case, values) if q.symbol == "c" else "",
            evidence=f"The printed a, b and W allow {low:.6f} to {high:.6f} only.",
        )


def table3(sources: Sources) -> Iterator[Claim]:
    """Table 3: the pair-wise estimates of the three harmonic approaches with common φ and t_s."""
    for approach, label, q in itertools.product(PRINTED_APPROACHES[1:], PAIR_LABELS, UNKNOWNS):
        values = sources.estimates(q.column, approach, phase="common", pair=label)
        correct = sources.as_published.estimate(
            q.column, CORRECTED if approach == "V_s" else approach, phase="common", pair=label
        )
        yield Claim(
            id=of_cell("table3", q.symbol, label, approach),
            where=f"Table 3, pair {label}",
            quantity=f"{q.symbol} by {approach}, common phi and t_s",
            unit=q.unit,
            printed=sources.published.table3[f"{approach}_{q.column}"][label],
            values=values,
            cause=causes.two_point_readings(values, correct, q.unit),
        )


def rounding_ranges(published: Published) -> dict[tuple[str, str], tuple[float, float]]:
    """Lowest and highest F_k and c of each pair that the printed a, b, W allow, each within half a unit.

    The solution of two rows is a ratio of functions linear in each single input, hence monotone in each: the extremes
    lie at the corners.
    """
    frame = published.table2_integrals
    columns = [numbers(frame, q.column) for q in TABLE_2]
    halves = [0.5 * np.array([Printed(text).unit for text in frame[q.column]]) for q in TABLE_2]
    ranges = {}
    for (i, j), label in zip(PAIRS, PAIR_LABELS, strict=True):
        corners = []
        for signs in itertools.product((-1.0, 1.0), repeat=6):
            steps = np.reshape(signs, (3, 2))
            rows = [
                column[[i, j]] + half[[i, j]] * step
                for column, half, step in zip(columns, halves, steps, strict=True)
            ]
            a, b, W = rows
            estimate = pair(Rows({"F_k": a, "c": b}, W), 0, 1)
            corners.append([estimate[q.symbol] for q in UNKNOWNS])
        for q, ends in zip(UNKNOWNS, np.transpose(corners), strict=True):
            ranges[label, q.column] = (float(ends.min()), float(ends.max()))
    return ranges
