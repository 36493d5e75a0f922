"""Trials: a mutant is written into a copy of the project, and the tests that call its function are run there."""

from __future__ import annotations

import contextlib
import hashlib
import json
import multiprocessing
import os
import shutil
import signal
import threading
from collections import Counter
from collections.abc import Iterable, Iterator
from itertools import groupby
from pathlib import Path
from typing import Any

from .child import Run, run_tests
from .mutants import Mutant

ROOT = Path(__file__).parents[2]
PACKAGE = "src/dampbalance"
SHOWN = (
    "commands",
    "figures",
    "project",
    "publishing",
    "article",
    "notebook",
    "page",
    "recipe",
    "site",
)
"""Words in the paths of tests that answer for what is shown, not for the method."""
HEAVY = ["jsonschema", "matplotlib.pyplot", "numba", "pandas", "pytest", "scipy.optimize"]
KERNELS = ("arguments.py", "arrays.py", "model.py", "record.py", "motion/")
"""An error in these has all kernels compiled anew, which takes a minute: tests that can do without come first."""
LONGEST = 1.0
"""Seconds that a test may take without compiling."""
SHORTEST, FACTOR, COMPILING = 10.0, 5.0, 120.0
"""A test may take so many seconds and so many times the longest of its file, and so many more to compile kernels."""


class Bench:
    """A copy of the project in `folder`, with what is known of its tests when nothing is wrong.

    known : outcomes by file of tests, shared by all benches, used as long as package and tests are the same.
    """

    def __init__(self, folder: Path, known: dict[str, dict[str, Any]], budget: float) -> None:
        self.folder, self.known, self.budget = folder, known, budget
        self.project = folder / "project"
        for path in self.project.rglob("*.py"):
            path.unlink()
        ignore = shutil.ignore_patterns(".*", "results", "*.pyc", "kernels-*")
        shutil.copytree(ROOT, self.project, ignore=ignore, dirs_exist_ok=True)
        self.processes = multiprocessing.get_context("forkserver")
        self.processes.set_forkserver_preload(HEAVY)
        tests = self.project / "tests"
        found = [
            path
            for room in ("unit", "analytic", "paper")
            for path in sorted((tests / room).rglob("test_*.py"))
            if not any(word in str(path.relative_to(tests)) for word in SHOWN)
        ]
        self.files = [path.relative_to(self.project).as_posix() for path in found]
        digest = hashlib.sha256()
        helpers = {p for p in tests.rglob("*.py") if p.parent.name != "mutation"} - {*found}
        for path in sorted({*(self.project / PACKAGE).rglob("*.py")} | helpers):
            digest.update(path.read_bytes())
        self.digest = digest.hexdigest()

    def _run(
        self, *files: str, interpreted: bool, stop: bool, limits: Any
    ) -> tuple[int, dict[str, Any]]:
        """(pytest's exit status or minus the signal that ended the run, outcome by test)."""
        report = self.folder / f"report-{threading.get_ident()}.json"
        report.unlink(missing_ok=True)
        run = Run(self.project, files, interpreted, stop, limits, report)
        process = self.processes.Process(target=run_tests, args=(run,))
        process.start()
        process.join(60.0 + 10.0 * sum(limits.values()) if stop else None)
        status = -signal.SIGPROF if process.exitcode is None else process.exitcode
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.join()
        return status, json.loads(report.read_text(encoding="utf-8")) if report.exists() else {}

    def measure(self, files: Iterable[str], interpreted: bool = False) -> None:
        """Run the tests of some files together, nothing being wrong, and keep what `baseline` gives."""
        if missing := [file for file in files if self._key(file, interpreted) not in self.known]:
            limits = None
            if interpreted:
                tests = self.baseline(missing[0])
                limits = dict.fromkeys(tests, LONGEST)
            status, tests = self._run(*missing, interpreted=interpreted, stop=False, limits=limits)
            if status not in (0, 1, 5):  # all passed, some failed, there are none
                print(f"left out, as pytest ends with {status}:", *missing, flush=True)
            for file in missing:
                outcome = {n: test for n, test in tests.items() if _file(n) == file}
                self.known[self._key(file, interpreted)] = {
                    name: test for name, test in outcome.items() if test["passed"]
                }
                failed = [name for name, test in outcome.items() if test["failed"]]
                if failed and not interpreted:
                    print("left out, as they fail without any error:", *failed, flush=True)

    def baseline(self, file: str, interpreted: bool = False) -> dict[str, dict[str, Any]]:
        """Seconds and called functions of each test of a file that passes, nothing being wrong.

        interpreted : in Python, of those alone that take few calls of kernels.
        """
        self.measure([file], interpreted)
        return self.known[self._key(file, interpreted)]

    def _key(self, file: str, interpreted: bool) -> str:
        digest = hashlib.sha256((self.project / file).read_bytes() + self.digest.encode())
        return f"{file} {'interpreted' if interpreted else 'compiled'} {digest.hexdigest()[:16]}"

    def stages(self, mutant: Mutant) -> Iterator[tuple[bool, dict[str, float]]]:
        """(interpreted, limits by test) for each run of a trial: a file, then two, four …, quickest first.

        First come the tests that call the function of the mutant; where none does, as outside of functions, those that
        call any of its module. The others in their files follow, which may share what those have set up.
        """
        tests = {n: t for file in self.files for n, t in self.baseline(file).items()}
        own, module = f"{mutant.module}:{mutant.where}", f"{mutant.module}:"
        calling = {name for name, test in tests.items() if own in test["called"]} or {
            name
            for name, test in tests.items()
            if any(f.startswith(module) for f in test["called"])
        }
        total: Counter[str] = Counter()
        for name in calling:
            total[_file(name)] += tests[name]["seconds"]
        order = sorted(
            (name for name in tests if _file(name) in total),
            key=lambda n: (n not in calling, total[_file(n)], _file(n), tests[n]["seconds"]),
        )
        kernels, left, done = mutant.module.startswith(KERNELS), self.budget, set[str]()
        for interpreted in [True, False] if kernels else [False]:
            more = COMPILING if kernels and not interpreted else 0.0
            limits, size = dict[str, float](), 1
            for file, names in groupby(order, _file):
                known = self.baseline(file, interpreted)
                # whichever test comes first pays for what they share
                longest = max((test["seconds"] for test in known.values()), default=0.0)
                for name in [n for n in names if n in known and n not in done]:
                    left -= known[name]["seconds"]
                    if left > 0.0:
                        done.add(name)
                        limits[name] = SHORTEST + FACTOR * longest + more
                if len({*map(_file, limits)}) >= size:
                    yield interpreted, limits
                    limits, size = {}, 2 * size
            if limits:
                yield interpreted, limits

    def trial(self, mutant: Mutant) -> tuple[str, str]:
        """("killed", the test that failed), ("timed out", "") or ("survived", the number of tests)."""
        path = self.project / PACKAGE / mutant.module
        original, times = path.read_bytes(), path.stat()
        number = 0
        for interpreted, limits in self.stages(mutant):
            files = dict.fromkeys(map(_file, limits))
            path.write_text(mutant.source(original.decode()), encoding="utf-8")
            try:
                status, tests = self._run(*files, interpreted=interpreted, stop=True, limits=limits)
            finally:
                path.write_bytes(original)  # with its time, by which compiled kernels are known
                os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))
            if status == -signal.SIGPROF:
                return "timed out", ""
            if status != 0:
                return "killed", next(reversed(tests), "(import)")
            number += len(limits)
        return "survived", f"{number} tests"


def _file(name: str) -> str:
    """The file of a test."""
    return name.partition("::")[0]
