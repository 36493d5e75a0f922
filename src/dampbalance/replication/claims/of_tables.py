"""The claims of Tables 1, 2 and 3: every printed cell, what the routes give for it, and why it differs."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from ...balance import Rows
from ...solver import pair
from . import causes
from .inputs import CORRECTED, PAIR_LABELS, PAIRS, Sources
from .published import Printed, Published, numbers
from .resolutions import integral_resolution, phase_resolution, time_resolution
from .verdict import Claim, Resolution

# Columns of the printed tables, in the paper's order: symbol, what it is, unit.
TABLE_1 = {
    "X_m": ("X", "peak displacement", "m"),
    "X_s_m": ("X_s", "displacement at forward slip onset", "m"),
    "V_s_m_per_s": ("V_s", "velocity at forward slip onset", "m/s"),
    "phi_rad": ("phi", "phase between input and output", "rad"),
    "t_s_s": ("t_s", "time of forward slip onset", "s"),
}
TABLE_2 = {
    "a_m": ("a", "friction travel", "m"),
    "b_m2_per_s": ("b", "viscous integral", "m^2/s"),
    "W_J": ("W", "input work", "J"),
}
UNKNOWNS = {"F_k_N": ("F_k", "N"), "c_N_s_per_m": ("c", "N s/m")}


def levels(sources: Sources) -> Iterator[Claim]:
    """The first column of Tables 1 and 2: the amplitudes Y, which the configuration must hold."""
    tables = {1: sources.published.table1, 2: sources.published.table2_integrals}
    for number, table in tables.items():
        held = dict(zip(table.index, sources.case.levels_m, strict=True))
        for level, printed in table["Y_m"].items():
            yield Claim(
                id=f"table{number}.Y.{level}",
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
    for level, (column, (symbol, quantity, unit)) in itertools.product(
        printed_table.index, TABLE_1.items()
    ):
        printed = printed_table[column][level]
        values = {
            "exact": sources.exact.feature(column, int(level)),
            "as_published": sources.as_published.feature(column, int(level)),
        }
        resolution, cause = None, ""
        if symbol == "phi":
            resolution = phase_resolution(values["exact"], sources.case.omega("omega1"))
            crossing = sources.exact.feature("phi_zero_crossing_rad", int(level))
            cause = causes.phase(values["exact"], crossing, printed)
        elif symbol == "t_s":
            resolution = time_resolution(values["exact"], sources.case.numerics.step_s)
            cause = causes.slip_time(values["exact"], sources.case.numerics.step_s, printed)
        elif symbol == "V_s":
            cause = causes.slip_velocity(values["exact"], printed)
        yield Claim(
            id=f"table1.{symbol}.{level}",
            where=f"Table 1, level {level}",
            quantity=f"{symbol}: {quantity}",
            unit=unit,
            printed=printed,
            values=values,
            resolution=resolution,
            cause=cause,
        )


def table2_integrals(sources: Sources) -> Iterator[Claim]:
    """Table 2, upper part: the integrals a, b and W of the five levels."""
    printed_table = sources.published.table2_integrals
    for level, (column, (symbol, quantity, unit)) in itertools.product(
        printed_table.index, TABLE_2.items()
    ):
        values = {
            "exact": sources.exact.feature(column, int(level)),
            "as_published": sources.as_published.feature(column, int(level)),
        }
        V_s = sources.as_published.feature("V_s_m_per_s", int(level))
        known, contradicted = (
            causes.implied_b(sources.published, level) if symbol == "b" else ("", "")
        )
        yield Claim(
            id=f"table2.{symbol}.{level}",
            where=f"Table 2, level {level}",
            quantity=f"{symbol}: {quantity}",
            unit=unit,
            printed=printed_table[column][level],
            values=values,
            resolution=integral_resolution(symbol, values["as_published"], V_s, sources.case),
            cause=f"{causes.backward_euler(sources.case, values)} {known}".strip(),
            evidence=contradicted,
        )


def table2_pairs(sources: Sources) -> Iterator[Claim]:
    """Table 2, lower part: the pair-wise estimates by direct integration."""
    ranges = rounding_ranges(sources.published)
    for label, (column, (symbol, unit)) in itertools.product(PAIR_LABELS, UNKNOWNS.items()):
        values = {
            name: route.estimate(column, "direct", pair=label)
            for name, route in sources.routes.items()
        }
        low, high = ranges[label, column]
        yield Claim(
            id=f"table2.{symbol}.{label}",
            where=f"Table 2, pair {label}",
            quantity=f"{symbol} by direct integration",
            unit=unit,
            printed=sources.published.table2_pairs[f"direct_{column}"][label],
            values=values,
            resolution=Resolution(
                low, high, "the printed a, b and W give it, within their rounding"
            ),
            cause=causes.backward_euler(sources.case, values) if symbol == "c" else "",
            evidence=f"The printed a, b and W allow {low:.6f} to {high:.6f} only.",
        )


def table3(sources: Sources) -> Iterator[Claim]:
    """Table 3: the pair-wise estimates of the three harmonic approaches with common φ and t_s."""
    cells = itertools.product(("t_s", "X_s", "V_s"), PAIR_LABELS, UNKNOWNS.items())
    for approach, label, (column, (symbol, unit)) in cells:
        values = {
            name: route.estimate(column, approach, phase="common", pair=label)
            for name, route in sources.routes.items()
        }
        correct = sources.as_published.estimate(
            column, CORRECTED if approach == "V_s" else approach, phase="common", pair=label
        )
        yield Claim(
            id=f"table3.{approach}.{symbol}.{label}",
            where=f"Table 3, pair {label}",
            quantity=f"{symbol} by {approach}, common phi and t_s",
            unit=unit,
            printed=sources.published.table3[f"{approach}_{column}"][label],
            values=values,
            cause=causes.two_point_readings(values, correct, unit),
        )


def rounding_ranges(published: Published) -> dict[tuple[str, str], tuple[float, float]]:
    """Lowest and highest F_k and c of each pair that the printed a, b, W allow, each within half a unit.

    The solution of two rows is a ratio of functions linear in each single input, hence monotone in each: the extremes
    lie at the corners.
    """
    frame = published.table2_integrals
    columns = [numbers(frame, column) for column in TABLE_2]
    halves = [0.5 * np.array([Printed(text).unit for text in frame[column]]) for column in TABLE_2]
    ranges = {}
    for (i, j), label in zip(PAIRS, PAIR_LABELS, strict=True):
        corners = []
        for signs in itertools.product((-1.0, 1.0), repeat=6):
            steps = np.reshape(signs, (3, 2))
            rows = [
                column[[i, j]] + half[[i, j]] * step
                for column, half, step in zip(columns, halves, steps, strict=True)
            ]
            estimate = pair(Rows(*rows), 0, 1)
            corners.append((estimate.F_k, estimate.c))
        for column, ends in zip(UNKNOWNS, np.transpose(corners), strict=True):
            ranges[label, column] = (float(ends.min()), float(ends.max()))
    return ranges
