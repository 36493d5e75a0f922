"""Kills, Ctrl-C, a full disk, a configuration that cannot be read: nothing is lost."""

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
from workflow.copies import PROFILE, SMALL

pytestmark = pytest.mark.slow

PATIENCE = 120.0  # s, for a machine under load: reached by nothing that works
SNAKEMAKE = (sys.executable, "-m", "snakemake")
RUN = (*SNAKEMAKE, *PROFILE, "--cores", "2", "=".join(SMALL))


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
    here = [
        one
        for one in psutil.process_iter(["cmdline", "cwd"])
        if one.info["cwd"] == str(copy.folder)
    ]
    return [one for one in here if ".snakemake/scripts/" in (one.info["cmdline"] or [""])[-1]]


def test_after_a_kill_the_same_command_suffices(copy, built):
    with started(copy, *RUN, "features") as run:
        wait_for(lambda: jobs_in(copy))
        os.killpg(run.pid, signal.SIGKILL)
    assert (copy.folder / ".snakemake/locks").exists()
    assert "--unlock" in finished(copy, *RUN, "features").stderr
    for command in ([*SNAKEMAKE, "--unlock"], [*RUN, "features"]):
        done = finished(copy, *command)
        assert done.returncode == 0, done.stderr
    made, whole = copy.files("small"), built.files("small")
    assert "features/exact/above.csv" in made
    assert made == {name: whole[name] for name in made}


def test_ctrl_c_leaves_no_process_and_no_lock(copy):
    with started(copy, *RUN, "features") as run:
        wait_for(lambda: jobs_in(copy))
        os.killpg(run.pid, signal.SIGINT)
        run.communicate(timeout=PATIENCE)
        wait_for(lambda: not jobs_in(copy))
    assert run.returncode != 0
    assert not (copy.folder / ".snakemake/locks").exists()


def test_a_job_killed_for_want_of_memory_is_told(copy):
    with started(copy, *RUN, "features") as run:
        wait_for(lambda: jobs_in(copy))[0].kill()
        half_written = copy.folder / "results/small/records/.~above-abcdefgh.parquet"
        half_written.parent.mkdir(parents=True, exist_ok=True)
        half_written.touch()
        said, _ = run.communicate(timeout=PATIENCE)
    assert run.returncode != 0
    assert "A job was killed, usually because memory ran out: use fewer cores" in said
    assert not half_written.exists()
    assert said.splitlines()[-1].endswith("repeat the command: it continues from there.")


@pytest.fixture
def mounting(copy):
    """Runs commands in a copy with file systems mounted that nobody else sees."""
    unshare = ("unshare", "--mount")
    if not shutil.which("unshare") or subprocess.run([*unshare, "true"], check=False).returncode:
        pytest.skip("file systems cannot be mounted here: sudo make test")
    return lambda script: finished(copy, *unshare, "bash", "-c", script)


def test_a_full_disk(mounting):
    done = mounting(
        f"mount -t tmpfs -o size=8k none results && {shlex.join(RUN)} features; find results -type f"
    )
    assert "No space left on device" in done.stderr
    assert "results/small" not in done.stdout.rpartition("continues from there.")[2]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (None, "cannot be read (No such file or directory); name a YAML file"),
        ("case: [small", "line 1: not readable as YAML"),
    ],
)
def test_an_unreadable_configuration_is_refused_in_one_line(tmp_path, text, message):
    file = tmp_path / "case.yaml"
    if text:
        file.write_text(text, encoding="utf-8")
    done = run(sys.executable, "-m", "dampbalance.project.documents", str(file), folder=tmp_path)
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"error: {file}: ")
    assert message in line
    assert done.returncode == 1
