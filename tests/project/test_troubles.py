"""What a machine lacks is told in one sentence; every other error keeps its traceback."""

from __future__ import annotations

import errno
import sys

import pytest

from dampbalance.project.troubles import trouble
from processes import run


def script(body):
    begin = "from dampbalance.project.troubles import brief_troubles; brief_troubles();"
    done = run(sys.executable, "-c", f"{begin} {body}")
    assert done.returncode != 0
    return done.stderr


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EACCES])
def test_a_file_that_cannot_be_written(code):
    said = trouble(OSError(code, "…", "results/a.csv"))
    assert said.startswith("results/a.csv cannot be written")
    assert ("disk is full" in said) == (code in (errno.ENOSPC, errno.EDQUOT))


def test_another_error_is_no_trouble_of_the_machine():
    assert trouble(FileNotFoundError(errno.ENOENT, "…", "results/a.csv")) is None
    assert trouble(ValueError("disk is full")) is None


def test_a_script_tells_a_trouble_in_one_line():
    assert script("raise MemoryError").count("\n") == 1
    said = script("f = open('/dev/full', 'w', buffering=1); f.write('x\\n')")
    assert said == (
        "error: a file cannot be written, as the disk is full: make room, then repeat the same command\n"
    )


def test_a_script_keeps_the_traceback_of_any_other_error():
    assert "Traceback" in script("1 / 0")


def test_an_interrupted_script_says_nothing():
    assert script("raise KeyboardInterrupt") == ""


def test_a_log_takes_what_a_script_and_its_children_say_and_errors_are_seen(tmp_path):
    log = tmp_path / "job.log"
    begin = "import subprocess, sys; from dampbalance.project.troubles import brief_troubles;"
    body = "print('one', flush=True); subprocess.run(['echo', 'two']); sys.exit('error: three')"
    done = run(sys.executable, "-c", f"{begin} brief_troubles([{str(log)!r}]); {body}")
    assert (done.stdout, done.stderr) == ("", "error: three\n")
    assert log.read_text(encoding="utf-8") == "one\ntwo\nerror: three\n"
