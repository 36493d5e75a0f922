"""A study through a real SLURM of one node gives the bytes of the run on this machine alone."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
import yaml

from folders import ROOT
from processes import run

CLUSTER = ROOT / "trials/cluster"
PATHS = os.pathsep.join(str(ROOT / name) for name in ("trials", "tests"))
UNAVAILABLE = 69  # loopback.sh: SLURM cannot be started here, with the reason on stderr


def loopback(*command: str, timeout: float) -> subprocess.CompletedProcess[str]:
    return run(CLUSTER / "loopback.sh", *command, timeout=timeout, PYTHONPATH=PATHS)


@pytest.fixture(scope="module")
def slurm():
    """Skips, with the reason, where SLURM is not installed or may not be started."""
    answer = loopback("sinfo", "--noheader", timeout=90)
    if answer.returncode == UNAVAILABLE:
        pytest.skip(answer.stderr.strip().splitlines()[-1])
    assert answer.returncode == 0, answer.stderr


def test_profile_asks_for_no_account_or_partition_of_one_cluster():
    profile = yaml.safe_load((ROOT / "workflow/profiles/slurm/config.yaml").read_text())
    assert profile["executor"] == "slurm"
    assert not {"slurm_account", "slurm_partition"} & profile["default-resources"].keys()


def test_exit_status_of_the_command_is_kept(slurm):
    assert loopback("false", timeout=90).returncode == 1
    assert loopback("srun", "--ntasks=1", "true", timeout=90).returncode == 0


def test_a_job_that_takes_more_memory_than_it_asked_for_is_ended(slurm):
    """What makes the runs below a proof that the memory in the profile is enough."""
    hog = "x = b'1' * 600_000_000; import time; time.sleep(20)"
    done = loopback("srun", "--mem=100", sys.executable, "-c", hog, timeout=90)
    assert done.returncode != 0
    assert "exceeded memory limit" in done.stderr


@pytest.mark.slow
def test_slurm_gives_the_bytes_of_the_local_run(slurm, tmp_path):
    """A study of two chunks; a million cases the same way: config/studies/CLUSTER.md."""
    small = (ROOT / "tests/workflow/studies/quadratic.yaml").read_text(encoding="utf-8")
    (tmp_path / "quadratic.yaml").write_text(f"{small}chunk_cases: 5\n", encoding="utf-8")
    done = loopback(
        sys.executable,
        "-m",
        "cluster.same_bytes",
        "--config-of",
        str(tmp_path),
        "quadratic",
        timeout=550,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.splitlines()[-1].endswith(": the same")
