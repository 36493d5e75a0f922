"""A process of its own that runs tests in a copy of the project.

Nothing of the project is imported here: the process must find the package and the helpers of the tests in its copy.
"""

from __future__ import annotations

import json
import os
import resource
import signal
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numba
import pytest

Config: Any = numba.config

LONGEST_INTERPRETED = 0.3
"""Seconds of processor time that a test may take where kernels are interpreted; a longer one meets compiled kernels."""

ENDED = 100
MEMORY = 6 << 30
"""Bytes that the tests of a mutant may ask for."""


@dataclass(frozen=True)
class Run:
    """Tests to run in the copy `folder`.

    files : of tests, below tests/.   chosen : ids of those to run, in this order; all if None.
    interpreted : kernels are not compiled.   stop : at the first failure.   seconds : of processor time at the most.
    report : file that receives the outcome.
    """

    folder: Path
    files: tuple[str, ...]
    chosen: tuple[str, ...] | None
    interpreted: bool
    stop: bool
    seconds: int
    report: Path


class Watch:
    """Chooses the tests, limits their time, and writes down how each of them ended."""

    def __init__(self, run: Run) -> None:
        self.run = run
        self.tests: dict[str, dict[str, Any]] = {}

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, config, items):
        if self.run.chosen is not None:
            place = {name: i for i, name in enumerate(self.run.chosen)}
            config.hook.pytest_deselected(items=[i for i in items if i.nodeid not in place])
            items[:] = sorted(
                (item for item in items if item.nodeid in place),
                key=lambda item: place[item.nodeid],
            )

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item):
        self.tests[item.nodeid] = {"passed": True, "seconds": 0.0}
        start = time.process_time()
        try:
            return (yield)
        finally:
            self.tests[item.nodeid]["seconds"] = time.process_time() - start
            # after each test: the process may be ended amid the next
            self.run.report.write_text(json.dumps(self.tests), encoding="utf-8")

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_setup(self):
        return (yield from self._limited())

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self):
        return (yield from self._limited())

    def _limited(self):
        if not (self.run.interpreted or self.run.stop):
            return (yield)
        signal.signal(signal.SIGPROF, self._too_long)
        # a mutant that runs on for ever fails its first test; one that is slow only has time enough
        factor = 40.0 if self.run.stop else 4.0
        longest = LONGEST_INTERPRETED if self.run.interpreted else 2.0
        signal.setitimer(signal.ITIMER_PROF, factor * longest)
        try:
            return (yield)
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0.0)

    def _too_long(self, *_: object) -> None:
        if self.run.stop:  # at once: a thread that runs on for ever lets nobody out
            self.tests[next(reversed(self.tests))]["passed"] = False
            self.run.report.write_text(json.dumps(self.tests), encoding="utf-8")
            os._exit(ENDED + 1)
        raise TimeoutError("too long for interpreted kernels")

    def pytest_runtest_logreport(self, report):
        if not report.passed:
            self.tests[report.nodeid]["passed"] = False


def run_tests(run: Run) -> None:
    """Run the tests and leave with `ENDED` more than pytest's exit status: any other status is an error of ours."""
    os.setsid()  # whatever the tests start ends with this process
    resource.setrlimit(resource.RLIMIT_CPU, (run.seconds, run.seconds + 5))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    with run.report.with_suffix(".log").open("w") as log:
        for stream in (1, 2):
            os.dup2(log.fileno(), stream)
    os.chdir(run.folder)
    sys.path[:0] = [str(run.folder / "src"), str(run.folder / "tests")]
    os.environ["PYTHONPATH"] = os.pathsep.join(sys.path[:2])
    if run.stop:  # a mutant: its bytes must never be taken for those of the original
        sys.dont_write_bytecode = True
        os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
    arguments = ["-q", "--no-header", "--tb=line", "-p", "no:cacheprovider", "-p", "no:xdist"]
    if run.interpreted:
        os.environ["NUMBA_DISABLE_JIT"] = "1"
        Config.DISABLE_JIT = True
        # compiled code divides and overflows without a word
        arguments += ["-W", "ignore::RuntimeWarning"]
    if run.stop:
        arguments.append("-x")
    status = pytest.main(
        [*arguments, *(f"tests/{file}" for file in run.files)], plugins=[Watch(run)]
    )
    sys.stdout.flush()
    os._exit(ENDED + int(status))
