"""The explanations of the claims against the numbers of their rows, and each quantity with the cause that it has."""

from __future__ import annotations

import math
import re

import pytest

from dampbalance.motion.orbit import steady_orbit
from dampbalance.replication.authors_route import CORRECTED, SLIPPING_SAMPLE
from dampbalance.replication.claims.printed import Printed
from replication.routes import CASE, PAPER, PRINT, sources_of, unrounded

ROUTES = {"exact": "exact", "as published": "as_published", "from print": "from_print"}


@pytest.fixture(scope="module")
def computed(claims):
    return claims[claims["kind"] == "computed"].set_index("id")


@pytest.fixture(scope="module")
def orbits():
    return [steady_orbit(PAPER, motion) for motion in CASE.motions("omega1")]


def rows_of(computed, start):
    """The rows of some claims, whatever their verdicts."""
    rows = computed[computed.index.str.startswith(start)]
    assert len(rows) > 0
    return rows


def test_every_distance_is_that_of_its_row(computed):
    found = 0
    pattern = r"(?i)(exact|as published|from print): ([\d.]+) (units? of the last digit|%) (above|below) print"
    for row in computed.to_dict("records"):
        for route, far, measure, side in re.findall(pattern, row["explanation"]):
            printed, value = Printed(row["printed"]), float(row[ROUTES[route.lower()]])
            off = (value - printed.value) / printed.unit
            assert (side == "above") == (off > 0.0)
            share = 100.0 * abs(value / printed.value - 1.0)
            distance = abs(off) if measure.startswith("unit") else share
            # two digits, or whole per cents; the value is shown to 1e-4 of a unit
            assert float(far) == pytest.approx(distance, rel=0.051, abs=6e-5)
            assert (abs(off) < 20.0) == measure.startswith("unit")
            found += 1
    assert found > 60


def test_phases_are_those_of_the_reversal_and_not_of_the_zero_crossing(computed, orbits):
    for name, row in rows_of(computed, "table1.phi").iterrows():
        orbit, printed = orbits[int(name[-1]) - 1], float(row["printed"])
        reversal, crossing = (printed - phi for phi in (orbit.phi, orbit.phi_zero_crossing))
        assert f"phase of the velocity reversal ({reversal:+.4f} rad)" in row["explanation"]
        assert (
            f"not of the zero crossing that the text names ({crossing:+.4f} rad)"
            in row["explanation"]
        )


def test_times_lose_a_step_at_each_end(computed, orbits):
    for name, row in rows_of(computed, "table1.t_s").iterrows():
        t_s = 1e3 * orbits[int(name[-1]) - 1].t_s
        words = f"lasts {t_s:.3f} ms, without a step of 5 µs at each end {t_s - 0.01:.3f} ms"
        assert words in row["explanation"]
        assert math.floor(10.0 * (t_s - 0.01)) == round(1e4 * float(row["printed"]))


def test_velocities_are_those_of_the_first_slipping_sample(computed):
    """As published V_s misses print at every level; the first slipping sample, on marks of 0.05 mm/s, gives four."""
    given = []
    for name, row in rows_of(computed, "table1.V_s").iterrows():
        assert float(row["as_published"]) != float(row["printed"])
        sample, read = re.search(
            r"sample has ([\d.]+) mm/s, to the nearest 0.05 mm/s ([\d.]+),", row["explanation"]
        ).groups()
        of_level = unrounded()[SLIPPING_SAMPLE].iloc[int(name[-1]) - 1]
        assert float(sample) == pytest.approx(1e3 * of_level, abs=5e-4)
        assert float(read) == pytest.approx(0.05 * round(float(sample) / 0.05))
        same = float(read) == pytest.approx(1e3 * float(row["printed"]))
        assert bool(re.search(", as printed[.;]", row["explanation"])) == same
        assert "; at level 1 the print is no multiple of this." in row["explanation"]
        given += [name[-1]] * same
    assert given == ["2", "3", "4", "5"]


@pytest.mark.parametrize(
    ("words", "start"),
    [
        ("velocity reversal", "table1.phi"),
        ("The microstick phase lasts", "table1.t_s"),
        ("Read at the corner", "table1.V_s"),
        ("The integral begins ", "table2.a."),
        ("Slip of sign", "table3.V_s."),
        ("Over the five", "text."),
    ],
)
def test_a_cause_is_named_where_it_acts_and_nowhere_else(computed, words, start):
    named = computed.index[computed["explanation"].str.contains(words)]
    assert len(named) > 0
    assert named.str.startswith(start).all()
    if start.startswith("table"):
        assert set(rows_of(computed, start).index) == set(named)


def test_backward_euler_acts_on_integrals_and_damping(computed):
    """c + mω²h: of Table 2 all integrals, and of its pairs c alone, lie off by what it adds."""
    for name, row in rows_of(computed, "table2.").query("verdict != 'differs'").iterrows():
        acts = not name.startswith("table2.F_k")
        assert ("Backward Euler" in row["explanation"]) == acts, name
        if acts:
            share = float(row["as_published"]) / float(row["exact"]) - 1.0
            assert f"deviates from exact by a relative {share:+.1e}" in row["explanation"]


def test_with_the_minus_of_19_the_columns_would_be_those_of_the_corrected_rows(computed):
    for name, row in rows_of(computed, "table3.V_s.").iterrows():
        corrected = PRINT.rows[name].key._replace(approach=CORRECTED)
        right = sources_of().numbers[corrected]["as_published"]
        shown = re.search(r"it would be ([\d.]+) (N|N s/m)\.", row["explanation"])
        assert shown[2] == row["unit"]
        assert float(shown[1]) == pytest.approx(right, abs=0.51 * Printed(shown[1]).unit)


def test_what_moves_an_estimate_of_table_3_adds_up(computed):
    """Of X_s and t_s: the causes named, in the order of their size, leave less than they explain."""
    checked = 0
    for name, row in rows_of(computed, "table3.").iterrows():
        moves = [float(m) for m in re.findall(r"\(([+-][\d.]+) N(?: s/m)?\)", row["explanation"])]
        if name.startswith("table3.V_s") or not moves:
            continue
        off = float(row["as_published"]) - float(row["exact"])
        assert moves == sorted(moves, key=abs, reverse=True)
        assert abs(off - sum(moves)) < 0.5 * max(abs(off), Printed(row["printed"]).unit), name
        checked += 1
    assert checked >= 15


def test_what_is_read_is_close_to_what_there_is_to_read(computed, orbits):
    """X to the nearest micrometre below, and the microstick line, 2Z_m long, a micrometre off at most."""
    lengths, peaks = 0, 0
    for name, row in rows_of(computed, "table3.").iterrows():
        levels = [int(level) - 1 for level in name.split(".")[-1].split("-")]
        for length in re.findall(r"X \+ X_s read as (\d+) µm", row["explanation"]):
            assert abs(float(length) - 2e6 * PAPER.Z_m) < 1.0
            lengths += 1
        for both in re.findall(r"X read as ([\d.]+) mm and ([\d.]+) mm", row["explanation"]):
            for level, read in zip(levels, both, strict=True):
                assert abs(1e-3 * float(read) - orbits[level].X) < 2e-6
                peaks += 1
    assert lengths > 0
    assert peaks > 20
