"""Put errors into the method, one at a time, and see whether its tests notice (`make mutants`).

    cd tests && python -m mutation [MODULE …] [--share 0.02] [--seed 1] [--jobs 1] [--quick] [--afresh]

A sample of all mutants of each module of the method (`trials.METHOD`), drawn by a seed, is tried in copies of the
project. One that no test notices has survived. It shows that a statement about behaviour is missing from the tests,
or it is equivalent: nothing that anyone could observe differs, and `equivalent.yaml` says why.

Results go to results/mutation: `trials.jsonl`, a line for each trial, and `table.md`. An interrupted run goes on where
it stopped: killed mutants of an unchanged module are not tried again, survivors are.

A copy holds the project as it stands. Kernels of `motion/` and the solver take half a minute to compile after each
error; such mutants therefore meet, first, the tests that bear it without compiling (`trials.KERNELS`).

Why no tool from the shelf: mutmut lets all mutants of a function live in one module and switches between them when
the function is called, which compiled kernels cannot do; cosmic-ray has one test command for all modules, and neither
draws a sample that stays the same while other lines are edited.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
import tempfile
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import Queue
from typing import Any

import yaml

from .mutants import Mutant, mutants
from .trials import PACKAGE, ROOT, Bench, modules

FEWEST = 3
"""Mutants of a module, at least, where it has as many."""
GOAL = 0.9
"""Of the mutants that are not equivalent, the share to be killed."""
EQUIVALENT = Path(__file__).with_name("equivalent.yaml")


Description = tuple[str, str, str, str, int]
"""Module, text of the line, what was there before and after, its occurrence in the line."""


def equivalents() -> dict[Description, str]:
    """Reason why a mutant is equivalent, by its description."""
    listed = yaml.safe_load(EQUIVALENT.read_text(encoding="utf-8")) or {}
    return {
        (
            module,
            entry["line"],
            str(entry["before"]),
            str(entry["after"]),
            entry.get("occurrence", 1),
        ): entry["reason"]
        for module, entries in listed.items()
        for entry in entries
    }


def sample(module: str, share: float, seed: int) -> list[Mutant]:
    """A share of the mutants of a module, `FEWEST` at least, drawn by a seed."""
    every = mutants(module, (ROOT / PACKAGE / module).read_text(encoding="utf-8"))
    number = max(FEWEST, round(share * len(every)))
    drawn = sorted(every, key=lambda mutant: mutant.rank(seed))[:number]
    return sorted(drawn, key=lambda mutant: mutant.start)


def described(mutant: Mutant) -> Description:
    """What a mutant is listed by."""
    return mutant.module, mutant.line, mutant.before, mutant.after, mutant.occurrence


def _key(mutant: Mutant) -> str:
    """By which a trial is found again: the mutant and the text of its module."""
    text = (ROOT / PACKAGE / mutant.module).read_bytes()
    return f"{mutant.rank(0)[:16]} {mutant.start} {hashlib.sha256(text).hexdigest()[:16]}"


def table(trials: list[dict[str, Any]]) -> str:
    """Modules and what became of their mutants, as Markdown."""
    lines = ["| module | mutants | killed | equivalent | survived |", "|---|--:|--:|--:|--:|"]
    counts: dict[str, Counter[str]] = {}
    for trial in trials:
        counts.setdefault(trial["module"], Counter())[trial["verdict"]] += 1
    for module, of in [*counts.items(), ("all", sum(counts.values(), Counter()))]:
        killed = of["killed"] + of["timed out"]
        numbers = [of.total(), killed, of["equivalent"], of["survived"]]
        lines.append(f"| {module} | {' | '.join(map(str, numbers))} |")
    return "\n".join(lines) + "\n"


def main(arguments: list[str] | None = None) -> int:
    """Try the mutants, print what became of them; 1 if fewer than `GOAL` were killed."""
    parser = argparse.ArgumentParser(prog="mutation", description="Mutation testing of the method.")
    parser.add_argument("modules", nargs="*", help="such as motion/flow.py (default: all)")
    parser.add_argument("--share", type=float, default=0.02, help="of the mutants (%(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of the sample (%(default)s)")
    parser.add_argument("--jobs", type=int, default=1, help="trials at a time (%(default)s)")
    parser.add_argument("--quick", action="store_true", help="kernels are never compiled")
    parser.add_argument("--afresh", action="store_true", help="forget earlier trials")
    parser.add_argument("--output", type=Path, default=ROOT / "results/mutation")
    options = parser.parse_args(arguments)
    for module in options.modules:
        if module not in modules():
            parser.error(f"{module} is no module of the method; known are {', '.join(modules())}")

    journal, known = options.output / "trials.jsonl", options.output / "tests.json"
    options.output.mkdir(parents=True, exist_ok=True)
    if options.afresh:
        journal.unlink(missing_ok=True)
        known.unlink(missing_ok=True)
    earlier: dict[str, dict[str, Any]] = {}
    if journal.exists():
        lines = journal.read_text(encoding="utf-8").splitlines()
        earlier = {trial["key"]: trial for trial in map(json.loads, lines)}
    reasons = equivalents()
    drawn = [
        m
        for module in options.modules or modules()
        for m in sample(module, options.share, options.seed)
    ]

    with tempfile.TemporaryDirectory() as name, ThreadPoolExecutor(options.jobs) as pool:
        benches: Queue[Bench] = Queue()
        for i in range(options.jobs):
            benches.put(Bench(Path(name) / str(i), known))

        def tried(mutant: Mutant) -> dict[str, Any]:
            key = _key(mutant)
            if key in earlier and earlier[key]["verdict"] in ("killed", "timed out"):
                return earlier[key]
            shown = {"module": mutant.module, "number": mutant.number, "line": mutant.line}
            shown |= {"before": mutant.before, "after": mutant.after}
            shown["occurrence"] = mutant.occurrence
            if described(mutant) in reasons:
                return {"key": key, **shown, "verdict": "equivalent"}
            bench, start = benches.get(), time.perf_counter()
            try:
                verdict, by = bench.trial(mutant, options.quick)
            finally:
                benches.put(bench)
            seconds = round(time.perf_counter() - start, 1)
            trial = {"key": key, **shown, "verdict": verdict, "by": by, "seconds": seconds}
            with journal.open("a", encoding="utf-8") as file:
                file.write(json.dumps(trial, ensure_ascii=False) + "\n")
            place = f"{mutant.module}:{mutant.number}"
            print(
                f"{verdict:9} {seconds:5.0f} s  {place}  {mutant.before} → {mutant.after}  {by}",
                flush=True,
            )
            return trial

        trials = list(pool.map(tried, drawn))

    text = table(trials)
    (options.output / "table.md").write_text(text, encoding="utf-8")
    print(f"\n{text}")
    survivors = [trial for trial in trials if trial["verdict"] == "survived"]
    for trial in survivors:
        print(
            f"{trial['module']}:{trial['number']}  {trial['before']} → {trial['after']}\n    {trial['line']}"
        )
    telling = sum(trial["verdict"] != "equivalent" for trial in trials)
    share = 1.0 - len(survivors) / max(telling, 1)
    print(
        f"Killed: {share:.1%} of {telling} that are not equivalent (seed {options.seed}); the goal is {GOAL:.0%}."
    )
    return int(share < GOAL)


if __name__ == "__main__":
    sys.exit(main())
