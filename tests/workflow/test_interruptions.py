"""Kills, Ctrl-C, two runs at once, a full disk, a folder that cannot be written: one sentence, nothing lost."""

from __future__ import annotations

import os
import shlex
import shutil
import signal
import subprocess
import sys
import time
from contextlib import contextmanager

import psutil
import pytest

from folders import ROOT
from processes import run
from workflow.copies import SMALL

pytestmark = pytest.mark.slow

PATIENCE = 120.0  # s, for a machine under load: reached by nothing that works
RUN = (sys.executable, "workflow/run.py", "--cores", "2", "=".join(SMALL))
SNAKEMAKE = (sys.executable, "-m", "snakemake", "--cores", "2", "=".join(SMALL))


@pytest.fixture
def copy(checkout):
    """The project with the small case, nothing built."""
    made = checkout()
    shutil.copy2(ROOT / "tests/workflow/small.yaml", made.folder)
    return made


def environment(copy):
    return os.environ | {"PYTHONPATH": str(copy.folder / "src")}


def finished(copy, *command):
    return run(*command, folder=copy.folder, timeout=PATIENCE, PYTHONPATH=f"{copy.folder / 'src'}")


@contextmanager
def started(copy, *command):
    """A run in a session of its own, so that a signal to its group reaches all of it, as one from a terminal does."""
    run = subprocess.Popen(
        command,
        cwd=copy.folder,
        env=environment(copy),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    try:
        yield run
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
    found = psutil.process_iter(["name", "cwd"])
    jobs = [one for one in found if one.info["name"].startswith("job ")]
    return [one for one in jobs if one.info["cwd"] == str(copy.folder)]


def test_after_a_kill_the_same_command_suffices(copy, built):
    with started(copy, *RUN, "features") as run:
        wait_for(lambda: jobs_in(copy))
        os.killpg(run.pid, signal.SIGKILL)
    assert (copy.folder / ".snakemake/locks").exists()
    half_written = copy.folder / "results/small/features/.~above-abcdefgh.csv"
    half_written.parent.mkdir(parents=True, exist_ok=True)
    half_written.write_text("level", encoding="utf-8")
    done = finished(copy, *RUN, "features")
    assert done.returncode == 0, done.stderr
    assert "The last run was interrupted" in done.stdout
    made, whole = copy.files("small"), built.files("small")
    assert "features/exact/above.csv" in made
    assert made == {name: whole[name] for name in made}


def test_a_second_run_in_the_same_folder_is_refused(copy):
    with started(copy, *RUN, "studies") as run:  # which takes long
        wait_for(lambda: (copy.folder / ".snakemake/locks").exists())
        second = finished(copy, *RUN, "features")
        assert run.poll() is None, "the first run ended before it could be in the way"
        os.killpg(run.pid, signal.SIGINT)
        run.communicate(timeout=PATIENCE)
    assert second.returncode == 1
    (line,) = second.stderr.splitlines()
    assert line.startswith(f"error: another run is at work in this folder (process {run.pid}, for ")
    # Ctrl-C reached jobs that were yet to start: it waited for none of their chunks, which take ten seconds
    assert not list((copy.folder / "results/studies").glob("*/chunks/*"))


def test_ctrl_c_leaves_no_process_and_no_lock(copy):
    with started(copy, *RUN, "records") as run:
        wait_for(lambda: jobs_in(copy))
        os.killpg(run.pid, signal.SIGINT)
        run.communicate(timeout=PATIENCE)
        wait_for(lambda: not jobs_in(copy))
    assert run.returncode != 0
    assert not (copy.folder / ".snakemake/locks").exists()


def test_a_job_killed_for_want_of_memory_is_told(copy):
    with started(copy, *RUN, "records") as run:
        wait_for(lambda: jobs_in(copy))[0].kill()
        half_written = copy.folder / "results/small/records/.~above-abcdefgh.parquet"
        half_written.parent.mkdir(parents=True, exist_ok=True)
        half_written.touch()
        said, _ = run.communicate(timeout=PATIENCE)
    assert run.returncode != 0
    assert "A job was killed, as a rule because memory ran out: use fewer cores" in said
    assert not half_written.exists()
    assert said.splitlines()[-1].endswith("the same command goes on from there.")


@pytest.fixture
def mounting(copy):
    """Runs commands in a copy with file systems mounted that nobody else sees."""
    unshare = ("unshare", "--mount")
    if not shutil.which("unshare") or subprocess.run([*unshare, "true"], check=False).returncode:
        pytest.skip("file systems cannot be mounted here: sudo make test")
    return lambda script: finished(copy, *unshare, "bash", "-c", script)


def test_a_full_disk(mounting):
    done = mounting(
        f"mount -t tmpfs -o size=16k none results && {shlex.join(SNAKEMAKE)} records; find results -type f"
    )
    assert "as the disk is full: make room" in done.stderr
    assert "Traceback" not in done.stderr
    assert "results/small" not in done.stdout.rpartition("goes on from there.")[2]


def test_a_disk_that_is_too_full_to_begin(mounting, copy):
    done = mounting(
        f"mount -t tmpfs -o size=64k none results && cd results && ln -s ../* . && {shlex.join(RUN)} records"
    )
    assert done.stderr.startswith("error: 0 MB are free on this disk and 100 are needed")
    assert len(done.stderr.splitlines()) == 1


def test_results_that_cannot_be_written(mounting, copy):
    done = mounting(
        f"mount --bind results results && mount -o remount,bind,ro results && {shlex.join(RUN)} records"
    )
    assert done.returncode == 1
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"error: {copy.folder}/results cannot be written")
    assert copy.files(".").keys() == {"README.md"}
