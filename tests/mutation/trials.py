"""Trials: a mutant is written into a copy of the project, and the tests of its module are run there."""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
import multiprocessing
import os
import shutil
import signal
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .child import ENDED, LONGEST_INTERPRETED, Run, run_tests
from .mutants import Mutant

ROOT = Path(__file__).parents[2]
PACKAGE = "src/dampbalance"
NOT_COPIED = (".*", "results", "__pycache__", "build", "dist")
HEAVY = ["jsonschema", "matplotlib.pyplot", "numba", "pandas", "pytest", "scipy.optimize"]

_MOTION = ("unit/motion", "unit/test_features.py", "analytic")
_CLAIMS = (
    "unit/replication",
    "paper/test_claims.py",
    "paper/test_explanations.py",
    "paper/test_from_print.py",
)
TESTS: dict[str, tuple[str, ...]] = {
    "model.py": ("unit/test_model.py", "unit/motion", "paper/test_equation_by_equation.py"),
    "record.py": ("unit/test_record.py", "unit/test_features.py"),
    "motion/": _MOTION,
    "features.py": ("unit/test_features.py", "unit/test_balance.py"),
    "balance.py": ("unit/test_balance.py", "paper/test_equation_by_equation.py"),
    "solver.py": ("unit/test_solver.py", "paper/test_equation_by_equation.py"),
    "factorisation.py": ("unit/test_solver.py",),
    "estimates.py": ("unit/test_solver.py", "unit/test_balance.py"),
    "reading/clean.py": ("unit/test_features.py", "paper/test_as_published.py"),
    "reading/climb.py": ("unit/reading/test_climb.py", "unit/reading/test_waveforms.py"),
    "reading/noisy.py": ("unit/reading", "unit/identification"),
    "reading/turning.py": ("unit/reading/test_turning.py", "unit/reading/test_noisy.py"),
    "reading/lines.py": ("unit/reading/test_lines.py", "unit/reading/test_waveforms.py"),
    "reading/waveforms.py": ("unit/reading/test_waveforms.py", "unit/reading/test_noisy.py"),
    "reading/quadrature.py": ("unit/test_features.py", "unit/reading/test_simpson.py"),
    "reading/": ("unit/reading",),
    "likelihood/": ("unit/likelihood",),
    "records/units.py": ("unit/records/test_units.py", "unit/records/test_readers.py"),
    "replication/": _CLAIMS,
    "studies/evaluate.py": ("unit/studies",),
    "identification/": ("unit/identification", "unit/studies/test_noisy.py"),
}
"""Module, or room, of the method → the tests that answer for it."""

KERNELS = ("model.py", "record.py", "motion/")
"""Modules that compiled code is made of: one change compiles all of it anew, which takes longer than most tests do
without compiling. Their mutants meet the tests that bear it interpreted, and only those that survive are compiled."""

METHOD = (
    "*.py",
    "motion/*.py",
    "reading/*.py",
    "likelihood/*.py",
    "records/units.py",
    "replication/claims/*.py",
    "replication/verdicts.py",
    "studies/evaluate.py",
    "identification/identify.py",
    "identification/microstick.py",
    "identification/oscillator.py",
)


def answering(module: str) -> tuple[str, ...]:
    """Tests that answer for a module, files and folders below tests/."""
    for name, tests in TESTS.items():
        if module == name or (name.endswith("/") and module.startswith(name)):
            return tests
    raise ValueError(f"no tests are named for {module}: give it a line in TESTS")


def modules() -> list[str]:
    """The modules of the method, below the package."""
    package = ROOT / PACKAGE
    found = sorted(path for pattern in METHOD for path in package.glob(pattern))
    return [
        path.relative_to(package).as_posix() for path in found if not path.name.startswith("__")
    ]


def files_in(folder: Path, tests: Iterable[str]) -> list[str]:
    found: list[Path] = []
    for name in tests:
        path = folder / "tests" / name
        found += sorted(path.rglob("test_*.py")) if path.is_dir() else [path]
    return [path.relative_to(folder / "tests").as_posix() for path in found]


@dataclass
class Bench:
    """A copy of the project in `folder`, with what is known of its tests when nothing is wrong.

    known : file of earlier outcomes of tests, used as long as package and tests are the same.
    """

    folder: Path
    known: Path
    tests: dict[str, dict[str, Any]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        ignore = shutil.ignore_patterns(*NOT_COPIED)
        shutil.copytree(ROOT, self.folder / "project", ignore=ignore)
        self.processes = multiprocessing.get_context("forkserver")
        self.processes.set_forkserver_preload(HEAVY)
        if self.known.exists():
            self.tests = json.loads(self.known.read_text(encoding="utf-8"))

    @property
    def project(self) -> Path:
        """The copy."""
        return self.folder / "project"

    def _run(
        self,
        files: Iterable[str],
        chosen: Iterable[str] | None,
        interpreted: bool,
        stop: bool,
        seconds: float,
    ) -> tuple[int | None, dict[str, Any]]:
        """(pytest's exit status, None if the time ran out; outcome by test).

        seconds : of processor time; ten times as long by the clock, on a machine that others use, too.
        """
        report = self.folder / "report.json"
        report.unlink(missing_ok=True)
        ids = None if chosen is None else tuple(chosen)
        run = Run(self.project, tuple(files), ids, interpreted, stop, math.ceil(seconds), report)
        process = self.processes.Process(target=run_tests, args=(run,))
        process.start()
        process.join(10.0 * seconds)
        ended = process.exitcode
        if process.pid is not None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
        process.join()
        if ended is not None and ended >= ENDED:
            ended -= ENDED
        elif ended is not None and ended >= 0:
            raise RuntimeError("the tests of a mutant could not be started: see above")
        elif ended == -signal.SIGXCPU:
            ended = None
        return ended, json.loads(report.read_text(encoding="utf-8")) if report.exists() else {}

    def _baseline(self, file: str, interpreted: bool) -> dict[str, Any]:
        """Outcome and seconds of each test of a file, nothing being wrong."""
        digest = hashlib.sha256((self.project / "tests" / file).read_bytes())
        for path in sorted((self.project / PACKAGE).rglob("*.py")):
            digest.update(path.read_bytes())
        key = f"{file} {'interpreted' if interpreted else 'compiled'} {digest.hexdigest()[:16]}"
        if key not in self.tests:
            # interpreted, a test that works in threads cannot be stopped alone: what comes after it is left out, too
            limit = 60.0 if interpreted else 900.0
            status, outcome = self._run([file], None, interpreted, False, limit)
            if not interpreted and status != 0:
                log = (self.folder / "report.log").read_text(encoding="utf-8")
                raise RuntimeError(f"tests/{file} fails without any mutant:\n{log[-3000:]}")
            self.tests[key] = outcome
            self.known.parent.mkdir(parents=True, exist_ok=True)
            self.known.write_text(json.dumps(self.tests), encoding="utf-8")
        return self.tests[key]

    def _stages(
        self, module: str, quick: bool
    ) -> Iterable[tuple[bool, list[str], list[str], float]]:
        """(interpreted, files, tests in order of their time, seconds they take) for each stage of a trial."""
        files = files_in(self.project, answering(module))
        borne: set[str] = set()
        kernel = module.startswith(KERNELS)
        for interpreted in (True, False) if kernel else (False,):
            if quick and kernel and not interpreted:
                return
            outcomes = {file: self._baseline(file, interpreted) for file in files}
            longest = LONGEST_INTERPRETED if interpreted else float("inf")
            kept = {
                file: {
                    name: test["seconds"]
                    for name, test in outcome.items()
                    if test["passed"] and test["seconds"] <= longest and name not in borne
                }
                for file, outcome in outcomes.items()
            }
            order = sorted(
                (file for file in files if kept[file]), key=lambda f: sum(kept[f].values())
            )
            chosen = [
                name for file in order for name in sorted(kept[file], key=kept[file].__getitem__)
            ]
            if interpreted:
                borne = set(chosen)
            yield interpreted, order, chosen, sum(sum(of.values()) for of in kept.values())

    def trial(self, mutant: Mutant, quick: bool) -> tuple[str, str]:
        """("killed", the test that failed), ("timed out", "") or ("survived", "")."""
        path = self.project / PACKAGE / mutant.module
        original = path.read_bytes()
        stages = self._stages(mutant.module, quick)
        for interpreted, files, chosen, seconds in stages:
            if not chosen:
                continue
            path.write_text(mutant.source(original.decode()), encoding="utf-8")
            try:
                status, tests = self._run(files, chosen, interpreted, True, 60.0 + 3.0 * seconds)
            finally:
                path.write_bytes(original)
            if status is None:
                return "timed out", ""
            if status != 0:
                failed = [name for name, test in tests.items() if not test["passed"]]
                return "killed", failed[0] if failed else "(import)"
        return "survived", ""
