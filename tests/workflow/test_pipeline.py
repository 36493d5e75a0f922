"""The whole pipeline on a small case, one level of which sticks: what it makes, and what reruns."""

from __future__ import annotations

import os
import platform
import time
from contextlib import ExitStack
from dataclasses import replace

import pandas as pd
import pytest

from folders import ROOT, restored
from paper_case import PAPER, orbits_at
from same_results import digests
from workflow.copies import SMALL

pytestmark = pytest.mark.slow


def test_everything_is_made(built):
    files = built.files("small")
    for frequency in ("resonance", "above"):
        assert f"orbits/{frequency}.json" in files
        for route in ("exact", "as_published"):
            assert f"features/{route}/{frequency}.csv" in files
            assert f"estimates/{route}/{frequency}.csv" in files
    for table in ("table1", "table2", "table3", "statistics"):
        assert f"tables/{table}.csv" in files
        assert f"tables/{table}_above.md" in files
    for figure in ("figure1", "figure2", "figure3", "estimation_error"):
        assert files[f"figures/{figure}.svg"].startswith(b"<?xml")
        assert files[f"figures/{figure}.png"].startswith(b"\x89PNG")
    assert "claims.csv" not in files  # nothing printed to compare with


def test_the_numbers_are_those_of_the_package(built):
    features = pd.read_csv(built.folder / "results/small/features/exact/above.csv")
    (orbit,) = orbits_at(9.0, [0.008], replace(PAPER, F_k=1.0))
    # A CSV keeps 15 significant digits.
    assert features["X_m"][2] == pytest.approx(orbit.X, rel=1e-14)
    estimates = pd.read_csv(built.folder / "results/small/estimates/exact/above.csv")
    direct = estimates[(estimates["approach"] == "direct") & (estimates["kind"] == "least_squares")]
    # Exact integrals: what the 15 digits and a condition number of some 50 leave.
    assert direct["F_k_N"].iloc[0] == pytest.approx(1.0, rel=1e-11)
    assert direct["c_N_s_per_m"].iloc[0] == pytest.approx(90.0, rel=1e-11)


def test_a_level_that_sticks_is_named_and_left_out(built):
    assert "Y = 0.0001 m: no slip" in built.run("--dry-run", *SMALL).stdout
    features = pd.read_csv(built.folder / "results/small/features/exact/resonance.csv")
    assert features["regime"][0] == "no slip: the contact only sticks"
    assert pd.isna(features["X_s_m"][0])
    estimates = pd.read_csv(built.folder / "results/small/estimates/exact/resonance.csv")
    fits = estimates[estimates["kind"] == "least_squares"].set_index(["approach", "phase"])
    # Direct integration: exact but for the 15 digits of the file. The level that sticks still tells of c.
    assert fits["F_k_N"]["direct", "individual"] == pytest.approx(1.0, rel=1e-10)
    assert "without level 1" in fits["note"]["X_s", "individual"]
    assert fits["levels"]["X_s", "individual"] == 3


def test_an_edited_room_or_script_reruns_what_depends_on_it_and_no_more(built):
    later = time.time() + 2
    files = (
        "src/dampbalance/replication/rebuilt_tables.py",
        "workflow/scripts/estimates/estimate.py",
    )
    with ExitStack() as edited:
        for file in files:
            path = built.folder / file
            edited.enter_context(restored(path))
            path.write_text(f"{path.read_text('utf-8')}\n# changed\n", encoding="utf-8")
            os.utime(path, (later, later))
        jobs = built.jobs(*SMALL)
    assert {"response_as_published", "estimate", "tables"} <= jobs.keys()
    assert "response_exact" not in jobs


WRONG = {
    "case: small": ("case: small\nextra: 1", "wrong.yaml: line 3: extra: unknown key"),
    "[0.0001, 0.004, 0.008, 0.012]": ("[0.004]", "wrong.yaml: line 9: excitation.levels_m"),
    "step_s: 2.0e-5": ("step_s: 2e-5", "line 13: as_published.step_s: '2e-5' is text"),
    "hz: 9.0": ("hz: 0", "wrong.yaml: line 8: excitation.frequencies[2].hz: 0"),
}


@pytest.mark.parametrize(
    "wrong", [WRONG, {"step_s: 2.0e-5": ("step_s: 2.0e-3", "line 12: as_published.step_s: ")}]
)
def test_a_wrong_configuration_is_refused_and_nothing_is_lost(built, wrong):
    before = built.files("small")
    text = (built.folder / "small.yaml").read_text(encoding="utf-8")
    for old, (new, _) in wrong.items():
        text = text.replace(old, new)
    (built.folder / "wrong.yaml").write_text(text, encoding="utf-8")
    said = built.refused("--configfile", "wrong.yaml")
    for _, expected in wrong.values():
        assert expected in said
    assert built.files("small") == before


@pytest.mark.skipif(
    (platform.system(), platform.machine()) != ("Linux", "x86_64"),
    reason="digests of tables are on record for Linux on x86_64, as another compiler may round otherwise",
)
def test_the_tables_have_the_bytes_on_record(built):
    """Whatever the Python. After a change that is meant to change numbers, in a copy with the small case built:
    python trials/same_results.py results/small > tests/workflow/small.sha256"""
    record = (ROOT / "tests/workflow/small.sha256").read_text(encoding="utf-8")
    assert digests(built.folder / "results/small").splitlines() == record.splitlines()
