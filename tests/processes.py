"""Processes that tests start: `output_of` for one that must succeed, `run` for one that may fail, and git; `in_time`
for what must not hang."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from folders import ROOT


def run(
    *command: str | Path,
    folder: Path = ROOT,
    given: str | None = None,
    timeout: float | None = None,
    **variables: str | None,
) -> subprocess.CompletedProcess[str]:
    """A process that has ended, with its output.

    given : its standard input.   variables : of its environment, in addition to those here; None takes one away.
    """
    environment = {
        key: value for key, value in (os.environ | variables).items() if value is not None
    }
    return subprocess.run(
        [*map(str, command)],
        cwd=folder,
        env=environment,
        input=given,
        capture_output=True,
        text=True,
        check=False,
        timeout=timeout,
    )


def output_of(*command: str | Path, **options: Any) -> str:
    """The standard output of a process, which must succeed; options as for `run`."""
    done = run(*command, **options)
    assert done.returncode == 0, done.stderr
    return done.stdout


@contextmanager
def in_time(seconds: int) -> Iterator[None]:
    """What is still at it after so many seconds fails."""

    def late(*_: Any) -> None:
        raise AssertionError(f"still at it after {seconds} s")

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def git(folder: Path, *arguments: str) -> str:
    """The output of git in a folder, with an identity that belongs to nobody."""
    identity = ["-c", "user.name=tester", "-c", "user.email=tester@example.org"]
    return output_of("git", *identity, "-c", "commit.gpgsign=false", *arguments, folder=folder)
