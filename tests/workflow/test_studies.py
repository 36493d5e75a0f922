"""Parameter studies through the workflow: small variants of the shipped ones, resumed, on one core, and wrong ones."""

from __future__ import annotations

import shutil

import pytest

from folders import restored
from workflow.copies import EVERY, SMALL, dump, summaries

pytestmark = pytest.mark.slow

MAP = "results/small/studies/map"


@pytest.mark.parametrize("name", EVERY)
def test_everything_is_made(studied, name):
    files = studied.files(f"small/studies/{name}")
    assert {*files} == {
        *("cases.parquet", "manifest.json", "summary.csv"),
        *("summary.md", "figure.svg", "figure.png"),
    }
    page = files["summary.md"].decode()
    assert "{" not in page  # every number is filled in
    assert " nan " not in page


def test_an_interrupted_study_resumes_and_ends_in_the_same_bytes(studied):
    """Two of four chunks are there, from one core; the rest is computed, in another order, and nothing else."""
    assert studied.jobs(*SMALL, "--", "studies") == {}
    finished = studied.files("small/studies/map")
    folder = studied.folder / MAP
    aside = folder.rename(studied.folder / "map")
    chunks = [f"{MAP}/chunks/{i:05d}.parquet" for i in (2, 1)]
    studied.made(*SMALL, "--", *chunks, cores=1)
    jobs = studied.jobs(*SMALL, "--", f"{MAP}/cases.parquet")
    chunks = {f"Study map: chunk {i} of 4" for i in (1, 4)}
    assert jobs.keys() == chunks | {"Study map: all cases in one file"}
    studied.made(*SMALL, "--", f"{MAP}/cases.parquet", cores=1)
    again = studied.files("small/studies/map")
    assert again == {name: finished[name] for name in ("cases.parquet", "manifest.json")}
    shutil.rmtree(folder)
    aside.rename(folder)


def test_a_wrong_study_is_refused_and_stops_nothing_but_itself(studied):
    """The messages of one refusal by the schema and one by the size arrive; tests/studies has all of them."""
    over = {"zeta": {"from": 0.1, "to": 1}}
    drawn = {"method": "random", "count": 10**13, "seed": 1, "over": over}
    unknown = "line 2: axes[1].zetta: unknown key (did you mean zeta?)"
    for name, study, expected in (
        ("wrong", {"axes": [{"zetta": {"values": [0.1]}}]}, f"wrong.yaml: {unknown}"),
        ("wrong", {"axes": [{"sample": drawn}], "chunk_cases": 10**10}, "10,000,000,000,000 cases"),
        ("a" * 60, {"axes": [{"zeta": {"values": [0.1]}}]}, "with nothing 20 times in a row"),
    ):
        with restored(path := studied.folder / f"config/studies/{name}.yaml"):
            dump(path, study | {"title": "Wrong"})
            assert expected in studied.refused("--dry-run", *SMALL, "--", *summaries([name]))
    with restored(path):
        dump(path, {})
        said = studied.made("--dry-run", "--forceall", *SMALL, "--", *summaries(["map"]))
    assert "Study map: 3,500 cases × 3 levels = 10,500 responses, 4 chunks, up to" in said
    assert "rename the file" in said
