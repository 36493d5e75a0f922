"""A study through a real SLURM of one node gives the bytes of the run on this machine alone."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from folders import ROOT
from processes import run
from workflow.copies import SNAKEMAKE, copied, dump, read

SUMMARY = "results/studies/quadratic/summary.md"
UNAVAILABLE = 69  # loopback.sh: SLURM cannot be started here, with the reason on stderr


def loopback(*command: str, timeout: float = 90, **options) -> subprocess.CompletedProcess[str]:
    return run(ROOT / "tests/workflow/loopback.sh", *command, timeout=timeout, **options)


@pytest.fixture(scope="module")
def slurm():
    """Skips, with the reason, where SLURM is not installed or may not be started."""
    answer = loopback("sinfo", "--noheader")
    if answer.returncode == UNAVAILABLE:
        pytest.skip(answer.stderr.strip().splitlines()[-1])
    assert answer.returncode == 0, answer.stderr


def test_a_job_that_takes_more_memory_than_it_asked_for_is_ended(slurm):
    """What makes the runs below a proof that the memory in the profile is enough."""
    hog = "x = b'1' * 600_000_000; import time; time.sleep(20)"
    done = loopback("srun", "--mem=100", sys.executable, "-c", hog)
    assert done.returncode != 0
    assert "exceeded memory limit" in done.stderr


@pytest.mark.slow
def test_slurm_gives_the_bytes_of_the_local_run(slurm, checkout, tmp_path):
    """A study of two chunks."""
    file = checkout.folder / "config/studies/quadratic.yaml"
    small = read(ROOT / "tests/workflow/studies/quadratic.yaml")
    dump(file, read(file) | small | {"chunk_cases": 5})
    cluster = copied(checkout.folder, tmp_path / "cluster")
    checkout.made(SUMMARY)
    done = loopback(
        *(*SNAKEMAKE, "--profile", "workflow/profiles/slurm", SUMMARY),
        *("--slurm-init-seconds-before-status-checks", "2"),
        folder=cluster.folder,
        timeout=550,
        PYTHONPATH=str(ROOT / "src"),
        PATH=f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert cluster.files("studies/quadratic") == checkout.files("studies/quadratic")
