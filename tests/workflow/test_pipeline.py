"""The whole pipeline on a small case, one level of which sticks: what it makes, and what its manifest says."""

from __future__ import annotations

import hashlib
import json
import platform
import re
import shutil
from dataclasses import replace
from importlib import metadata

import pandas as pd
import pytest

from dampbalance.project.files import sha256
from folders import ROOT
from paper_case import PAPER, orbits_at
from processes import git
from same_results import digests
from workflow.copies import SMALL

pytestmark = pytest.mark.slow

RESULTS = "results/small"
MANIFEST = f"{RESULTS}/manifest.json"


def test_the_numbers_are_those_of_the_package_without_the_level_that_sticks(built):
    features, estimates = (
        pd.read_csv(built.folder / RESULTS / f"{kind}/exact/above.csv")
        for kind in ("features", "estimates")
    )
    (orbit,) = orbits_at(9.0, [0.008], replace(PAPER, F_k=1.0))
    # A CSV keeps 15 significant digits.
    assert features["X_m"][2] == pytest.approx(orbit.X, rel=1e-14)
    assert features["regime"][0] == "no slip: the contact only sticks"
    assert pd.isna(features["X_s_m"][0])
    fits = estimates[estimates["kind"] == "least_squares"].set_index(["approach", "phase"])
    # Exact integrals: what the 15 digits and a condition number of some 50 leave. What sticks still tells of c.
    direct = fits.loc["direct", "individual"]
    assert direct["F_k_N"] == pytest.approx(1.0, rel=1e-11)
    assert direct["c_N_s_per_m"] == pytest.approx(90.0, rel=1e-11)
    assert "without level 1" in fits["note"]["X_s", "individual"]
    assert fits["levels"]["X_s", "individual"] == 3


@pytest.mark.skipif(
    (platform.system(), platform.machine()) != ("Linux", "x86_64"),
    reason="digests of tables are on record for Linux on x86_64, as another compiler may round otherwise",
)
def test_the_tables_have_the_bytes_on_record(built):
    """Whatever the Python. After a change that is meant to change numbers, in a copy with the small case built:
    python trials/same_results.py results/small > tests/workflow/small.sha256"""
    record = (ROOT / "tests/workflow/small.sha256").read_text(encoding="utf-8")
    assert digests(built.folder / RESULTS).splitlines() == record.splitlines()


def test_a_wrong_configuration_is_refused_and_nothing_is_lost(built):
    before, text = built.files("small"), (built.folder / "small.yaml").read_text(encoding="utf-8")
    expected = []
    for old, new, message in (
        ("case: small", "case: small\nextra: 1", "wrong.yaml: line 3: extra: unknown key"),
        ("[0.0001, 0.004, 0.008, 0.012]", "[0.004]", "wrong.yaml: line 9: excitation.levels_m"),
    ):
        text = text.replace(old, new)
        expected.append(message)
    (built.folder / "wrong.yaml").write_text(text, encoding="utf-8")
    said = built.refused("--configfile", "wrong.yaml")
    assert [message for message in expected if message not in said] == []
    assert built.files("small") == before


def test_the_manifest_states_results_jobs_configuration_sources_and_packages(whole):
    stated = json.loads((whole.folder / MANIFEST).read_text(encoding="utf-8"))
    made, run = stated["reproducible"], stated["run"]
    there = {f"{RESULTS}/{name}": data for name, data in whole.files("small").items()}
    listed = {one["path"]: one["sha256"] for one in made["results"]}
    some = "orbits/above.json", "tables/table3_above.md", "figures/figure3.png", "report.html"
    assert {f"{RESULTS}/{name}" for name in some} <= listed.keys()
    assert listed == {
        path: hashlib.sha256(data).hexdigest()
        for path, data in there.items()
        if path != MANIFEST and "/studies/" not in path  # which this case does not cite
    }
    jobs = {file: job for job in made["jobs"] for file in job["outputs"]}
    job = jobs[f"{RESULTS}/estimates/exact/above.csv"]
    assert (job["rule"], job["script"]) == ("estimate", "workflow/scripts/estimates/estimate.py")
    features = [f"{RESULTS}/features/exact/{name}.csv" for name in ("above", "resonance")]
    assert job["inputs"] == features
    assert {file for job in made["jobs"] for file in job["inputs"]} <= {*there, *made["sources"]}
    assert made["configuration_files"] == ["config/config.yaml", "small.yaml"]
    merged = made["configuration"]
    assert (merged["as_published"]["cycles"], merged["oscillator"]["m_kg"]) == (6, 2.42)
    for file in ("Snakefile", "small.yaml", "src/dampbalance/motion/flow.py", "requirements.lock"):
        assert made["sources"][file] == sha256(whole.folder / file)
    assert run["packages"]["numpy"] == metadata.version("numpy")
    assert run["packages"].keys() == run["licences"].keys()
    assert (run["code"]["commit"], run["code"]["known_from"]) == (None, "nothing")


@pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")
def test_a_commit_renews_the_manifest_and_no_result(whole):
    git(whole.folder, "init", "--quiet")
    try:
        git(whole.folder, "add", "--all")
        git(whole.folder, "commit", "--quiet", "--message=all")
        jobs = whole.jobs(MANIFEST, *SMALL)  # the manifest depends on every result
    finally:
        shutil.rmtree(whole.folder / ".git")
    assert [message.partition(":")[0] for message in jobs] == ["Manifest"]


def test_the_report_of_snakemake_needs_no_network(whole):
    whole.made("--report", "report.html", *SMALL)
    html = (whole.folder / "report.html").read_text(encoding="utf-8")
    (whole.folder / "report.html").unlink()
    for title in ("The page of the case", "Table 1: amplitudes, slip onset and phase, at 9 Hz"):
        assert title in html
    assert re.findall(r"<(?:script|link|img)[^>]* (?:src|href)=[\"']https?:", html) == []
