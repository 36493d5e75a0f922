"""How `make` starts runs: which processes count as another run, and how large an environment the scripts may have."""

from __future__ import annotations

import subprocess
import sys
import time
from contextlib import contextmanager

import psutil
import pytest
from forks import __file__ as FORKS
from run import other_run

from processes import output_of

SLEEPING = "import time; time.sleep(60)"
WORKFLOW = """
rule show:
    output: "size.txt"
    script: "show.py"
"""
SCRIPT = "import os; open('size.txt', 'w').write(str(sum(map(len, os.environ.values()))))"
START = f"""
import sys
sys.path.append({FORKS.rpartition("/")[0]!r})
from forks import scripts_as_forks
from snakemake.cli import main
with scripts_as_forks():
    main(["--cores", "1"])
"""


@contextmanager
def at_work(folder, *command):
    """A process that runs in a folder."""
    process = subprocess.Popen(command, cwd=folder)
    try:
        while psutil.Process(process.pid).cmdline() != [*command]:  # until the fork has become it
            time.sleep(0.01)
        yield process
    finally:
        process.kill()
        process.wait()


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with files of the names that runs have, in which the test is."""
    for name in ("snakemake", "snakemake.py", "workflow/run.py", ".snakemake/scripts/tmp1.x.py"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(SLEEPING, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    # a run that only begins counts if it began before this one
    monkeypatch.setattr("run._age", lambda process: -process.create_time())
    return tmp_path


@pytest.mark.parametrize(
    "command",
    [
        ["snakemake"],
        ["-m", "snakemake", "--cores", "all"],
        [".snakemake/scripts/tmp1.x.py"],
        ["workflow/run.py"],
    ],
)
def test_a_run_is_one_of_python(folder, command):
    with at_work(folder, sys.executable, *command) as process:
        assert other_run() == psutil.Process(process.pid)
    with at_work(folder, sys.executable, *command, "--dry-run"):
        assert other_run() is None


@pytest.mark.parametrize("file", ["snakemake", "workflow/run.py", ".snakemake/scripts/tmp1.x.py"])
def test_a_manual_a_pager_and_an_editor_are_no_run(folder, file):
    with at_work(folder, "tail", "-f", file):
        assert other_run() is None
    # nor is a script of one's own that is given such a name
    with at_work(folder, sys.executable, "-c", SLEEPING, file):
        assert other_run() is None


@pytest.mark.slow
def test_scripts_have_an_environment_of_any_size(tmp_path):
    (tmp_path / "Snakefile").write_text(WORKFLOW, encoding="utf-8")
    (tmp_path / "show.py").write_text(SCRIPT, encoding="utf-8")
    # more than a message between processes may hold, of the kind that module systems of clusters define
    modules = {f"LOADED_MODULES_{i}": "x" * 100_000 for i in range(6)}
    output_of(sys.executable, "-c", START, folder=tmp_path, **modules)
    assert int((tmp_path / "size.txt").read_text(encoding="utf-8")) > 600_000
