"""Kills and Ctrl-C: nothing is lost."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import time
from contextlib import contextmanager

import psutil
import pytest

from folders import ROOT
from workflow.copies import PROFILE, SMALL, SNAKEMAKE

pytestmark = pytest.mark.slow

PATIENCE = 120.0  # s, for a machine under load: reached by nothing that works
RUN = (*SNAKEMAKE, *PROFILE, "--cores", "2", "=".join(SMALL), "features")


@pytest.fixture
def copy(checkout):
    """The project with the small case, nothing built."""
    shutil.copy2(ROOT / "tests/workflow/small.yaml", checkout.folder)
    return checkout


@contextmanager
def started(copy):
    """A run in a session of its own, so that a signal to its group reaches all of it, as one from a terminal does, and
    one of its jobs."""
    run = subprocess.Popen(
        RUN,
        cwd=copy.folder,
        env=os.environ | {"PYTHONPATH": str(ROOT / "src")},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    try:
        yield run, wait_for(lambda: jobs_in(copy))[0]
    finally:
        if run.poll() is None:
            os.killpg(run.pid, signal.SIGKILL)
        run.communicate()


def wait_for(condition):
    """The first true value of the condition."""
    end = time.monotonic() + PATIENCE
    while not (found := condition()):
        assert time.monotonic() < end, "it never came"
        time.sleep(0.05)
    return found


def jobs_in(copy):
    """The processes of jobs that run in a copy."""
    all_of = psutil.process_iter(["cmdline", "cwd"])
    here = [one for one in all_of if one.info["cwd"] == str(copy.folder)]
    return [one for one in here if ".snakemake/scripts/" in (one.info["cmdline"] or [""])[-1]]


def test_after_a_kill_the_same_command_suffices(copy, built):
    with started(copy) as (run, _):
        os.killpg(run.pid, signal.SIGKILL)
    assert "--unlock" in copy.run("features", *SMALL).stderr
    copy.made("--unlock")
    copy.made("features", *PROFILE, *SMALL)
    made, whole = copy.files("small"), built.files("small")
    assert "features/exact/above.csv" in made
    assert made == {name: whole[name] for name in made}


def test_ctrl_c_leaves_no_process_and_no_lock(copy):
    with started(copy) as (run, _):
        os.killpg(run.pid, signal.SIGINT)
        run.communicate(timeout=PATIENCE)
        wait_for(lambda: not jobs_in(copy))
    assert run.returncode != 0
    assert not (copy.folder / ".snakemake/locks").exists()


def test_a_job_killed_for_want_of_memory_is_told(copy):
    with started(copy) as (run, job):
        job.kill()
        half_written = copy.folder / "results/small/records/.~above-abcdefgh.parquet"
        half_written.parent.mkdir(parents=True, exist_ok=True)
        half_written.touch()
        said, _ = run.communicate(timeout=PATIENCE)
    assert run.returncode != 0
    assert "A job was killed, usually because memory ran out: use fewer cores" in said
    assert not half_written.exists()
    assert said.splitlines()[-1].endswith("repeat the command: it continues from there.")
