"""Put errors into the package, one at a time, and see whether its tests notice.

    make mutants MUTANTS_ARGS="[MODULE …] [--number 100] [--seed 1] [--budget 60] [--processes 2] [--output .mutants]"

A sample of all mutants of the package is drawn by a seed and tried in copies of the project, one for each process.
First the tests of `make test` run without an error, except those of folders that start Snakemake or compare files:
how long each takes, which functions it calls, and which fail; these are left out. A mutant meets the tests that call
its function, quickest first, until one fails. One that no test notices has survived: either a statement about
behaviour is missing from the tests, or the code is not needed, or nobody could observe a difference: the mutant is
equivalent, and `equivalent.yaml` says why. The table by room is written to `table.md`.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from itertools import accumulate
from multiprocessing.pool import ThreadPool
from pathlib import Path
from queue import Queue
from typing import Any

import pandas as pd
import yaml

from benchmarks.measuring import markdown

from .mutants import Mutant, mutants

ROOT = Path(__file__).parents[2]
PACKAGE = "src/dampbalance"
LEFT_OUT = (
    "repository",
    "workflow",
)  # folders of tests that call the package in other processes, or never
# An error in these has all kernels compiled anew.
KERNELS = ("arguments.py", "arrays.py", "model.py", "record.py", "motion/")
# Tests may take so many seconds, so many times what they took without an error, and so many to compile kernels.
SHORTEST, FACTOR, COMPILING = 120.0, 8.0, 500.0
GOAL = 0.9  # the share of the mutants that are not equivalent that tests should kill
EQUIVALENT = yaml.safe_load(Path(__file__).with_name("equivalent.yaml").read_text("utf-8"))
VERDICTS = ["killed", "timed out", "equivalent", "survived"]


class Bench:
    """A copy of the project in `folder`, whose tests run with and without a mutant."""

    def __init__(self, folder: Path) -> None:
        self.project, self.report = folder / "project", folder / "report.json"
        shutil.rmtree(self.project, ignore_errors=True)
        ignore = shutil.ignore_patterns(".*", "results", "*.pyc", "kernels-*")
        shutil.copytree(ROOT, self.project, ignore=ignore)
        paths = sorted(self.project.glob("tests/*/**/test_*.py"))
        names = [path.relative_to(self.project) for path in paths]
        self.files = [name.as_posix() for name in names if name.parts[1] not in LEFT_OUT]

    def run(self, *tests: str, calls: bool = False, limit: float | None = None) -> tuple[int, Any]:
        """Return (pytest's exit status, what `watch` recorded); TimeoutExpired after `limit` seconds."""
        self.report.unlink(missing_ok=True)
        environment = os.environ | {
            "PYTHONPATH": f"{self.project / 'src'}{os.pathsep}{Path(__file__).parents[1]}",
            "PYTHONDONTWRITEBYTECODE": "1",  # a mutant must never be taken for the original
            "MUTATION_PACKAGE": str(self.project / PACKAGE),
            "MUTATION_REPORT": str(self.report),
            "MUTATION_CALLS": "yes" if calls else "",
        }
        command = [sys.executable, "-m", "pytest", "-q", "-p", "mutation.watch"]
        command += [
            "-m",
            "(not slow or computing) and not nightly",
            "-p",
            "no:cacheprovider",
            *tests,
        ]
        done = subprocess.run(
            command, cwd=self.project, env=environment, timeout=limit, capture_output=True
        )
        text = self.report.read_text("utf-8") if self.report.exists() else "{}"
        return done.returncode, json.loads(text)

    def passing(self, file: str) -> dict[str, Any]:
        """Return the records of the tests of a file that pass without an error in the package."""
        status, records = self.run(file, calls=True)
        if status not in (0, 5):
            failed = [name for name, test in records.items() if "failed" in test["outcomes"]]
            print("left out, as they fail without any error:", *(failed or [file]), flush=True)
        return {name: test for name, test in records.items() if {*test["outcomes"]} == {"passed"}}

    def trial(self, mutant: Mutant, tests: dict[str, Any], budget: float) -> tuple[str, str]:
        """Return ("killed", the test that failed), ("timed out", "") or ("survived", the number of tests).

        tests : name → record of the tests that pass. Those that call the function of the mutant, or else its module,
        come first, then the others in their files.
        """
        own, module = f"{mutant.module}:{mutant.where}", f"{mutant.module}:"
        in_module = {n for n, t in tests.items() if any(c.startswith(module) for c in t["called"])}
        calling = {name for name in in_module if own in tests[name]["called"]} or in_module
        order = [name for name in tests if _file(name) in {*map(_file, calling)}]
        order.sort(key=lambda name: (name not in calling, tests[name]["seconds"]))
        total = accumulate(tests[name]["seconds"] for name in order)
        chosen = [name for name, seconds in zip(order, total, strict=True) if seconds < budget]
        limit = SHORTEST + FACTOR * sum(tests[name]["seconds"] for name in chosen)
        limit += COMPILING * mutant.module.startswith(KERNELS)
        path = self.project / PACKAGE / mutant.module
        original, times = path.read_bytes(), path.stat()
        path.write_bytes(mutant.source(original))
        try:
            if chosen:
                status, records = self.run("-x", *chosen, limit=limit)
                if status:
                    return "killed", next(reversed(records), "(import)")
        except subprocess.TimeoutExpired:
            return "timed out", ""
        finally:
            path.write_bytes(original)  # with its time, by which compiled kernels are known
            os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))
        return "survived", f"{len(chosen)} tests"


def _file(test: str) -> str:
    return test.partition("::")[0]


def modules() -> list[str]:
    """Return the modules of the package, below its folder."""
    package = ROOT / PACKAGE
    return sorted(path.relative_to(package).as_posix() for path in package.rglob("*.py"))


def mutants_of(module: str) -> list[Mutant]:
    """Return all mutants of a module."""
    return [*mutants(module, (ROOT / PACKAGE / module).read_bytes())]


def equivalent(mutant: Mutant) -> str:
    """Return why nobody could notice the mutant, according to `equivalent.yaml`; empty where somebody could."""
    for entry in EQUIVALENT.get(mutant.module, []):
        if all(getattr(mutant, key) == entry[key] for key in entry.keys() - {"reason"}):
            return entry["reason"]
    return ""


def table(trials: list[tuple[Mutant, str, str]], seed: int) -> str:
    """Return the number of mutants by room and verdict, and the survivors, as Markdown."""
    rooms = [mutant.module.rpartition("/")[0] or mutant.module for mutant, _, _ in trials]
    verdicts = [verdict for _, verdict, _ in trials]
    counts = pd.crosstab(rooms, verdicts, margins=True, margins_name="all")
    counts = counts.reindex(columns=["all", *VERDICTS], fill_value=0)
    rows = [[*map(str, row)] for row in counts.itertuples()]
    of = counts.loc["all"]
    killed, telling = of["killed"] + of["timed out"], of["all"] - of["equivalent"]
    survivors = [f"- {mutant} ({by})\n" for mutant, verdict, by in trials if verdict == "survived"]
    return (
        f"Seed {seed}.\n\n{markdown(['room', 'mutants', *VERDICTS], rows)}\n"
        f"Killed: {killed} of {telling} that are not equivalent; the goal is {GOAL:.0%}.\n\n"
        f"{''.join(survivors)}"
    )


def main(arguments: list[str] | None = None) -> int:
    """Try the mutants, print what became of them; 1 if fewer than `GOAL` were killed."""
    parser = argparse.ArgumentParser(prog="mutation", description="Mutation testing.")
    parser.add_argument("modules", nargs="*", help="such as motion/flow.py (default: all)")
    parser.add_argument("--number", type=int, default=100, help="of mutants (%(default)s)")
    parser.add_argument("--seed", type=int, default=int(time.time()), help="default: by the clock")
    parser.add_argument("--budget", type=float, default=60.0, help="seconds of tests (%(default)s)")
    parser.add_argument("--processes", type=int, default=1, help="at a time (%(default)s)")
    parser.add_argument("--output", type=Path, default=ROOT / ".mutants")
    options = parser.parse_args(arguments)
    if unknown := {*options.modules} - {*modules()}:
        parser.error(f"no modules of the package: {unknown}; known are {', '.join(modules())}")
    every = [mutant for module in options.modules or modules() for mutant in mutants_of(module)]
    drawn = sorted(every, key=lambda mutant: mutant.rank(options.seed))[: options.number]
    print(f"{len(drawn)} of {len(every)} mutants, seed {options.seed}", flush=True)
    benches: Queue[Bench] = Queue()
    for i in range(options.processes):
        benches.put(bench := Bench(options.output / str(i)))

    def lent(work: Callable[[Bench], Any]) -> Any:
        bench = benches.get()
        try:
            return work(bench)
        finally:
            benches.put(bench)

    trials, tests = [], {}
    with ThreadPool(options.processes) as pool:
        for found in pool.imap(lambda file: lent(lambda b: b.passing(file)), bench.files):
            tests |= found

        def tried(mutant: Mutant) -> tuple[Mutant, str, str]:
            if reason := equivalent(mutant):
                return mutant, "equivalent", reason
            return (mutant, *lent(lambda b: b.trial(mutant, tests, options.budget)))

        for mutant, verdict, by in pool.imap(tried, drawn):
            trials.append((mutant, verdict, by))
            print(f"{verdict:10} {mutant} ({by})", flush=True)
            (options.output / "table.md").write_text(table(trials, options.seed), encoding="utf-8")
    print(f"\n{table(trials, options.seed)}")
    of = Counter(verdict for _, verdict, _ in trials)
    return int(of["survived"] > (1.0 - GOAL) * (len(trials) - of["equivalent"]))


if __name__ == "__main__":
    sys.exit(main())
