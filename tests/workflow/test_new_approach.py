"""A new approach is one function and one entry, a new term of the balance likewise: everything else follows.

A copy of the project gets an approach of its own, with a third term, at the end of `balance.py`. Tables, figures, page,
a study and an identification then show it, and nothing else was edited.
"""

from __future__ import annotations

import json
import subprocess
import sys

import pandas as pd
import pytest
import yaml

pytestmark = pytest.mark.slow

# Direct integration beside a quadratic damper, which takes 8/3 ω² X³ c_2 a cycle of a harmonic motion. There is none.
ADDED = """

TERMS["c_2"] = Term("c_2", "N s²/m²", "quadratic damping", "d", "m³/s²")


def quadratic(features: Features, k: ArrayLike) -> Rows:
    rows = direct(features, k)
    d = 8.0 / 3.0 * features.omega**2 * features.X**3
    return Rows({**rows.terms, "c_2": d}, rows.W)


APPROACHES["toy"] = Approach(
    quadratic, "with a toy", takes_phase=False, terms=("F_k", "c", "c_2")
)
"""
CASE = {
    "case": "toy",
    "excitation": {
        "frequencies": [{"name": "resonance", "hz": 4.92}],
        "levels_m": [0.004, 0.006, 0.008, 0.012],
    },
    "estimation": {"pairs": [[1, 2]]},
    "as_published": {"step_s": 2.0e-5, "cycles": 6},
    "published": None,
}
STUDY = {
    "title": "A toy",
    "axes": [{"zeta": {"from": 0.1, "to": 0.9, "count": 5}}],
    "levels_m": [0.004, 0.006, 0.008, 0.012],
    "estimation": {"approaches": ["direct", "toy"]},
    "columns": ["parameters", "estimates", "errors", "residuals"],
    "figure": {"kind": "curves", "x": "zeta"},
    "facts": {"worst": {"of": "F_k", "take": "max", "approach": "toy"}},
    "shows": "F_k is off by {worst} at most.",
}


@pytest.fixture(scope="module")
def extended(checkout):
    copy = checkout()
    with (copy.folder / "src/dampbalance/balance.py").open("a", encoding="utf-8") as module:
        module.write(ADDED)
    for file, document in (("toy.yaml", CASE), ("config/studies/toy.yaml", STUDY)):
        text = yaml.safe_dump(document, allow_unicode=True)
        (copy.folder / file).write_text(text, encoding="utf-8")
    return copy


def test_the_pipeline_shows_it(extended):
    done = extended.run("--configfile", "toy.yaml")
    assert done.returncode == 0, done.stderr
    results = extended.folder / "results/toy"
    table = pd.read_csv(results / "estimates/exact/resonance.csv")
    fit = table[(table["approach"] == "toy") & (table["kind"] == "least_squares")].iloc[0]
    # the exact balance closes without the third term
    assert fit["F_k_N"] == pytest.approx(1.28, rel=1e-9)
    assert fit["c_N_s_per_m"] == pytest.approx(90.0, rel=1e-9)
    assert abs(fit["c_2_N_s2_per_m2"]) < 1e-6
    pairs = table[(table["approach"] == "toy") & (table["kind"] == "pair")]
    assert pairs["F_k_N"].isna().all()
    assert pairs["note"].str.contains("two levels do not tell F_k, c and c_2 apart").all()
    assert "toy" in (results / "tables/approaches.md").read_text(encoding="utf-8")
    assert "with a toy" in (results / "figures/estimation_error.svg").read_text(encoding="utf-8")
    assert "with a toy" in (results / "report.html").read_text(encoding="utf-8")


def test_a_study_can_ask_for_it(extended):
    done = extended.run("results/studies/toy/summary.md")
    assert done.returncode == 0, done.stderr
    folder = extended.folder / "results/studies/toy"
    cases = pd.read_parquet(folder / "cases.parquet")
    assert cases["F_k_relative_error__toy__least_squares"].abs().max() < 1e-6
    assert cases["c_2_N_s2_per_m2__toy__least_squares"].abs().max() < 1e-3
    # there is none to be off from
    assert "c_2_relative_error__toy__least_squares" not in cases
    assert "with a toy" in (folder / "figure.svg").read_text(encoding="utf-8")
    assert "toy" in (folder / "summary.md").read_text(encoding="utf-8")


def test_measured_records_are_identified_with_it(extended):
    records = [f"config/records/example/level{level}.csv" for level in range(1, 6)]
    options = ["--stiffness", "2310", "--approach", "toy", "--approach", "direct"]
    done = subprocess.run(
        [sys.executable, "-m", "dampbalance", "identify", *records, *options, "--output", "found"],
        cwd=extended.folder,
        env={"PYTHONPATH": str(extended.folder / "src"), "MPLBACKEND": "Agg"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "c_2 (N s²/m²)" in done.stdout
    document = json.loads((extended.folder / "found/identification.json").read_text("utf-8"))
    toy = document["approaches"]["toy"]
    low, high = toy["c_2_interval_N_s2_per_m2"]
    assert low < 0.0 < high
    assert set(toy["rows"]) == {"a_m", "b_m2_per_s", "d_m3_per_s2", "W_J", "standard_error_J"}


def test_an_approach_that_is_not_there_is_named(extended):
    wrong = STUDY | {"estimation": {"approaches": ["toi"]}}
    file = extended.folder / "config/studies/wrong.yaml"
    file.write_text(yaml.safe_dump(wrong, allow_unicode=True), encoding="utf-8")
    done = extended.run("--dry-run", "results/studies/wrong/summary.md")
    file.unlink()
    assert done.returncode != 0
    assert "'toi' is not an approach (did you mean toy?)" in done.stdout + done.stderr
