"""Put errors into the method, one at a time, and see whether its tests notice (`make mutants`).

    make mutants MUTANTS_ARGS="[MODULE …] [--number 100] [--seed 1] [--jobs 1] [--budget 60]"

A sample of all mutants of the method (`METHOD`) is drawn by a seed and tried in copies of the project. The first run
finds out how long each test takes, which functions it calls, and which tests fail without any error: these are left
out. A mutant meets the tests that call its function, quickest first, until one fails. One that no test notices has
survived: either a statement about behaviour is missing from the tests, or the code is not needed, or the mutant is
equivalent: nothing that anyone could observe differs, and `equivalent.yaml` says why.

Results go to .mutants: `trials.jsonl`, a line for each trial, and `table.md`. Trials of an earlier run that killed a
mutant count as long as its module is unchanged.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from itertools import groupby
from pathlib import Path
from queue import Queue
from typing import Any

import yaml

from .mutants import Mutant, mutants
from .trials import PACKAGE, ROOT, Bench

METHOD = (
    "*.py",
    *(f"{room}/*.py" for room in ("motion", "law", "reading", "likelihood", "identification")),
    "records/**/*.py",
    "replication/claims/*.py",
    "replication/verdicts.py",
    "studies/evaluate.py",
)
"""Modules that errors are put into, but for those that draw."""
GOAL = 0.9
"""Of the mutants that are not equivalent, the share to be killed."""
EQUIVALENT = Path(__file__).with_name("equivalent.yaml")

Description = tuple[str, str, str, str, int]
"""Module, text of the line, what was there before and after, its occurrence in the line."""


def modules() -> list[str]:
    """The modules of the method, below the package."""
    package = ROOT / PACKAGE
    found = sorted({path for pattern in METHOD for path in package.glob(pattern)})
    return [
        path.relative_to(package).as_posix()
        for path in found
        if not path.name.startswith("__") and "drawing" not in path.stem
    ]


def mutants_of(module: str) -> list[Mutant]:
    """All mutants of a module."""
    return mutants(module, (ROOT / PACKAGE / module).read_text(encoding="utf-8"))


def equivalents() -> dict[Description, str]:
    """Reason why a mutant is equivalent, by its description."""
    listed = yaml.safe_load(EQUIVALENT.read_text(encoding="utf-8")) or {}
    return {
        (module, e["line"], str(e["before"]), str(e["after"]), e.get("occurrence", 1)): e["reason"]
        for module, entries in listed.items()
        for e in entries
    }


def described(mutant: Mutant) -> Description:
    """What a mutant is listed by."""
    return mutant.module, mutant.line, mutant.before, mutant.after, mutant.occurrence


def table(trials: list[dict[str, Any]], seed: int) -> str:
    """What became of the mutants, by room, and the survivors, as Markdown."""
    lines = [
        f"Seed {seed}.\n",
        "| room | mutants | killed | timed out | equivalent | survived |",
        "|---|--:|--:|--:|--:|--:|",
    ]
    counts: dict[str, Counter[str]] = {}
    for trial in trials:
        room = trial["module"].rpartition("/")[0] or trial["module"]
        counts.setdefault(room, Counter())[trial["verdict"]] += 1
    for room, of in [*counts.items(), ("all", sum(counts.values(), Counter()))]:
        numbers = [of.total(), *(of[v] for v in ("killed", "timed out", "equivalent", "survived"))]
        lines.append(f"| {room} | {' | '.join(map(str, numbers))} |")
    survivors = [trial for trial in trials if trial["verdict"] == "survived"]
    telling = len(trials) - sum(trial["verdict"] == "equivalent" for trial in trials)
    killed = telling - len(survivors)
    lines.append(
        f"\nKilled: {killed} of {telling} that are not equivalent; the goal is {GOAL:.0%}.\n"
    )
    for trial in survivors:
        place = f"{trial['module']}:{trial['number']}"
        change = f"`{trial['before']}` → `{trial['after']}`"
        lines.append(f"- {place} {change} in `{trial['line']}` ({trial['by']})")
    return "\n".join(lines) + "\n"


def main(arguments: list[str] | None = None) -> int:
    """Try the mutants, print what became of them; 1 if fewer than `GOAL` were killed."""
    parser = argparse.ArgumentParser(prog="mutation", description="Mutation testing of the method.")
    parser.add_argument("modules", nargs="*", help="such as motion/flow.py (default: all)")
    parser.add_argument("--number", type=int, default=100, help="of mutants (%(default)s)")
    parser.add_argument("--seed", type=int, help="of the sample (default: by the clock)")
    parser.add_argument("--jobs", type=int, default=1, help="trials at a time (%(default)s)")
    parser.add_argument(
        "--budget", type=float, default=60.0, help="seconds of tests a mutant meets (%(default)s)"
    )
    parser.add_argument("--output", type=Path, default=ROOT / ".mutants")
    options = parser.parse_args(arguments)
    if unknown := {*options.modules} - {*modules()}:
        parser.error(f"no modules of the method: {unknown}; known are {', '.join(modules())}")
    seed = int(time.time()) if options.seed is None else options.seed
    options.output.mkdir(parents=True, exist_ok=True)
    journal, tests = options.output / "trials.jsonl", options.output / "tests.json"
    earlier: dict[str, dict[str, Any]] = {}
    if journal.exists():
        lines = journal.read_text(encoding="utf-8").splitlines()
        earlier = {trial["key"]: trial for trial in map(json.loads, lines)}
    known = json.loads(tests.read_text(encoding="utf-8")) if tests.exists() else {}
    reasons = equivalents()
    every = [mutant for module in options.modules or modules() for mutant in mutants_of(module)]
    drawn = sorted(every, key=lambda mutant: mutant.rank(seed))[: options.number]
    print(f"{len(drawn)} of {len(every)} mutants, seed {seed}", flush=True)

    benches: Queue[Bench] = Queue()

    def tried(mutant: Mutant) -> dict[str, Any]:
        text = (ROOT / PACKAGE / mutant.module).read_bytes()
        key = f"{mutant.rank(0)[:16]} {mutant.start} {hashlib.sha256(text).hexdigest()[:16]}"
        if earlier.get(key, {}).get("verdict") in ("killed", "timed out"):
            return earlier[key]
        names = ("module", "number", "line", "before", "after", "occurrence")
        trial: dict[str, Any] = {"key": key} | {name: getattr(mutant, name) for name in names}
        if described(mutant) in reasons:
            return {**trial, "verdict": "equivalent"}
        bench, start = benches.get(), time.perf_counter()
        try:
            trial["verdict"], trial["by"] = bench.trial(mutant)
        finally:
            benches.put(bench)
        seconds = time.perf_counter() - start
        with journal.open("a", encoding="utf-8") as file:
            file.write(json.dumps(trial, ensure_ascii=False) + "\n")
        place = f"{mutant.module}:{mutant.number}"
        change = f"{mutant.before} → {mutant.after}"
        print(
            f"{trial['verdict']:9} {seconds:5.0f} s  {place}  {change}  {trial['by']}", flush=True
        )
        return trial

    def measured(files: list[str]) -> None:
        bench = benches.get()
        bench.measure(files)
        benches.put(bench)

    with ThreadPoolExecutor(options.jobs) as pool:
        for i in range(options.jobs):
            bench = Bench(options.output / str(i), known, options.budget)
            benches.put(bench)
        folders = groupby(bench.files, lambda file: file.rpartition("/")[0])
        for _ in pool.map(measured, [[*files] for _, files in folders]):
            tests.write_text(json.dumps(known), encoding="utf-8")
        trials = list(pool.map(tried, drawn))
    tests.write_text(json.dumps(known), encoding="utf-8")
    text = table(trials, seed)
    (options.output / "table.md").write_text(text, encoding="utf-8")
    print(f"\n{text}")
    of = Counter(trial["verdict"] for trial in trials)
    return int(of["survived"] > (1.0 - GOAL) * (len(trials) - of["equivalent"]))


if __name__ == "__main__":
    sys.exit(main())
