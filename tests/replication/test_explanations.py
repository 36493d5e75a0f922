"""The explanations of the claims against the numbers of their rows, and each quantity with the cause that it has."""

from __future__ import annotations

import math
import re

import pytest

from dampbalance.replication.authors_route import CORRECTED, SLIPPING_SAMPLE
from dampbalance.replication.claims.printed import Printed
from paper_case import PAPER, orbits_at
from replication.routes import PRINT, sources_of, unrounded

ROUTES = {"exact": "exact", "as published": "as_published", "from print": "from_print"}


@pytest.fixture(scope="module")
def orbits():
    return orbits_at()


def rows_of(computed, start):
    """The rows of some claims, whatever their verdicts."""
    rows = computed[computed.index.str.startswith(start)]
    assert len(rows) > 0
    return rows


def test_every_distance_is_that_of_its_row(computed):
    found = 0
    pattern = r"(?i)(exact|as published|from print): ([\d.]+) (units? of the last digit|%) (above|below) print"
    for _, row in computed.iterrows():
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


@pytest.mark.parametrize(
    ("words", "start"),
    [
        ("velocity reversal", "table1.phi"),
        ("The microstick phase lasts", "table1.t_s"),
        ("Leaving out these steps", "table1.t_s.4"),  # which alone would be a tenth more
        ("Read at the corner", "table1.V_s"),
        ("This start was chosen", "table2.a."),
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


def test_read_outs_of_table_1_are_those_of_the_orbits_and_of_the_first_slipping_sample(
    computed, orbits
):
    """Phases of the reversal, not of the zero crossing; times that lose a step at each end; velocities that miss print
    as published at every level, of which those of the first slipping sample, on marks of 0.05 mm/s, give four."""
    for level, orbit in enumerate(orbits, 1):
        phi, t_s, V_s = (computed.loc[f"table1.{name}.{level}"] for name in ("phi", "t_s", "V_s"))
        for words, of_orbit in (("reversal", orbit.phi), ("names", orbit.phi_zero_crossing)):
            off = float(phi["printed"]) - of_orbit
            assert f"{words} ({off:+.4f} rad)" in phi["explanation"]
        lasts = 1e3 * orbit.t_s
        words = f"lasts {lasts:.3f} ms, without a step of 5 µs at each end {lasts - 0.01:.3f} ms"
        assert words in t_s["explanation"]
        assert math.floor(10.0 * (lasts - 0.01)) == round(1e4 * float(t_s["printed"]))
        sample = 1e3 * unrounded()[SLIPPING_SAMPLE].iloc[level - 1]
        read = 0.05 * round(sample / 0.05)
        assert math.isclose(read, 1e3 * float(V_s["printed"])) == (level > 1)
        words = f"{sample:.3f} mm/s, to the nearest 0.05 mm/s {read:.2f}, {'not ' * (level == 1)}as"
        assert f"{words} printed; at level 1 the print is no multiple" in V_s["explanation"]
        assert float(V_s["as_published"]) != float(V_s["printed"])


def test_backward_euler_acts_on_integrals_and_damping(computed):
    """c + mω²h: of Table 2 all integrals, and of its pairs c alone, lie off by what it adds."""
    for name, row in rows_of(computed, "table2.").query("verdict != 'differs'").iterrows():
        acts = not name.startswith("table2.F_k")
        share = float(row["as_published"]) / float(row["exact"]) - 1.0
        words = f"as published deviates from exact by a relative {share:+.1e}"
        assert ("Backward Euler" in row["explanation"]) == (words in row["explanation"]) == acts


def test_with_the_minus_of_19_the_columns_would_be_those_of_the_corrected_rows(computed):
    for name, row in rows_of(computed, "table3.V_s.").iterrows():
        corrected = PRINT.rows[name].key._replace(approach=CORRECTED)
        right = sources_of().numbers[corrected]["as_published"]
        shown = re.search(r"it would be ([\d.]+) (N|N s/m)\.", row["explanation"])
        assert shown[2] == row["unit"]
        assert float(shown[1]) == pytest.approx(right, abs=0.51 * Printed(shown[1]).unit)


def test_what_moves_an_estimate_of_table_3_adds_up(computed, orbits):
    """Of X_s and t_s: the causes named, in the order of their size, leave less than they explain. What is read is close
    to what there is to read: X, and the microstick line, 2Z_m long, to a micrometre."""
    moved = lengths = peaks = 0
    for name, row in rows_of(computed, "table3.").iterrows():
        words = row["explanation"]
        moves = [float(m) for m in re.findall(r"\(([+-][\d.]+) N(?: s/m)?\)", words)]
        if moves and not name.startswith("table3.V_s"):
            off = float(row["as_published"]) - float(row["exact"])
            assert moves == sorted(moves, key=abs, reverse=True)
            assert abs(off - sum(moves)) < 0.5 * max(abs(off), Printed(row["printed"]).unit), name
            moved += 1
        for length in re.findall(r"X \+ X_s read as (\d+) µm", words):
            assert abs(float(length) - 2e6 * PAPER.Z_m) < 1.0
            lengths += 1
        for both in re.findall(r"X read as ([\d.]+) mm and ([\d.]+) mm", words):
            for level, read in zip(name.split(".")[-1].split("-"), both, strict=True):
                assert abs(1e-3 * float(read) - orbits[int(level) - 1].X) < 2e-6
                peaks += 1
    assert moved >= 15
    assert lengths > 0
    assert peaks > 20
