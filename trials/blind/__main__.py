"""The blind set at any size (`make blind`).

make blind BLIND_ARGS="[PART] [--sets 900] [--first 0] [--processes 2] [--drawings 200]"
make blind BLIND_ARGS="field [--decays 200] [--forced 180] [--seed 2010] [--kinds 'hum,12 bits']"
"""

from __future__ import annotations

import argparse
import multiprocessing
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from . import (
    decay_laws,
    decrements,
    departures,
    efficiency,
    faults,
    field,
    field_score,
    files,
    folding,
    joints,
    laws,
    loops,
    score,
)
from .truths import SEED

Options = argparse.Namespace


class Part(NamedTuple):
    """A part: its runs by the options, the rows of a run, and the table of all rows.

    warm : what a process does before its first run, so that the times are those of later ones.
    """

    runs: Callable[[Options], Iterable[Any]]
    outcome: Callable[[Any], list[dict[str, object]]]
    table: Callable[[pd.DataFrame], str]
    warm: Callable[[], None] | None = None


def _sets(options: Options) -> range:
    return range(options.first, options.first + options.sets)


def _seeded(options: Options) -> Iterator[tuple[int, int]]:
    """Yield the numbers of the sets with the seed."""
    return ((index, options.seed) for index in _sets(options))


def _of_each(names: Iterable[Any]) -> Callable[[Options], Iterator[tuple[Any, int, int]]]:
    """Return runs of each of several names for each set, with the seed."""
    every = [*names]
    return lambda of: ((name, index, of.seed) for index in _sets(of) for name in every)


def _drawn(names: Iterable[Any]) -> Callable[[Options], Iterator[tuple[Any, int]]]:
    """Return runs of each of several names for each drawing."""
    every = [*names]
    return lambda of: ((name, i) for i in range(of.first, of.first + of.drawings) for name in every)


def _decays_on_laws(options: Options) -> Iterator[tuple[str, int, int, bool]]:
    for term, index, seed in _of_each(decay_laws.ALL)(options):
        yield term, index, seed, term in decay_laws.TERMS


def _decays_on_contacts(options: Options) -> Iterator[tuple[str, int, int, bool]]:
    for term, index, seed in _of_each(decay_laws.CONTACTS)(options):
        yield term, index, seed, False
    for index in range(2 * options.first, 2 * (options.first + options.sets)):
        yield "none", index, options.seed, False


def _in_the_field(options: Options) -> list[tuple[bool, int, int]]:
    wanted = _kinds(options, (*field.DECAYS, *field.FORCED))
    runs = [(False, i) for i in range(options.decays)] + [(True, i) for i in range(options.forced)]
    return [(forced, i, options.seed) for forced, i in runs if field.kind_of(i, forced) in wanted]


def _kinds(options: Options, known: Iterable[str]) -> list[str]:
    wanted, every = options.kinds.split(","), [*dict.fromkeys(known)]
    if options.kinds and not {*every} >= {*wanted}:
        raise SystemExit(f"--kinds {options.kinds!r}: choose from {', '.join(every)}")
    return wanted if options.kinds else every


PARTS = {
    "blind": Part(_sets, score.outcome, score.table),
    "efficiency": Part(
        _drawn(range(len(efficiency.TRUTHS))), efficiency.replicate, efficiency.table
    ),
    "faults": Part(lambda _: faults.RUNS, faults.tried, faults.table),
    "laws": Part(_drawn(laws.LAWS), laws.outcome, laws.table),
    "decays": Part(_seeded, decrements.tried, decrements.table),
    "decay_laws": Part(_decays_on_laws, decay_laws.outcome, decay_laws.table),
    "decay_contacts": Part(_decays_on_contacts, decay_laws.outcome, decay_laws.table),
    "joints": Part(_seeded, joints.outcome, joints.table),
    "loops": Part(_seeded, loops.outcome, loops.table),
    "departures": Part(_of_each(departures.DEPARTURES), departures.outcome, departures.table),
    "field": Part(_in_the_field, field_score.outcome, field_score.table, field_score.warm),
    "files": Part(
        lambda of: [(name, of.seed) for name in _kinds(of, files.SHAPES)],
        files.outcome,
        files.table,
    ),
    "folding": Part(_of_each(folding.FREQUENCIES), folding.outcome, folding.table),
}


def main(arguments: list[str] | None = None) -> None:
    """Run one part; its table goes to the screen and to the folder."""
    parser = argparse.ArgumentParser(prog="blind", description=__doc__)
    parser.add_argument("part", nargs="?", default="blind", choices=PARTS)
    parser.add_argument("--sets", type=int, default=900)
    parser.add_argument("--first", type=int, default=0, help="number of the first set, or drawing")
    parser.add_argument(
        "--seed", type=int, default=SEED, help="of the sets; not of blind, efficiency, faults, laws"
    )
    parser.add_argument("--decays", type=int, default=200, help="sets of decays of the field")
    parser.add_argument(
        "--forced", type=int, default=180, help="sets of forced records of the field"
    )
    parser.add_argument(
        "--kinds", default="", help="of the field or of files, separated by commas; default, all"
    )
    parser.add_argument("--drawings", type=int, default=200, help="of each truth or law")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--output", type=Path, default=Path("results/blind"))
    options = parser.parse_args(arguments)
    options.output.mkdir(parents=True, exist_ok=True)
    part, rows = PARTS[options.part], []
    with multiprocessing.get_context("spawn").Pool(options.processes, part.warm) as pool:
        for of_run in pool.imap(part.outcome, part.runs(options)):
            rows += of_run
    frame = pd.DataFrame(rows)
    frame.to_csv(options.output / f"{options.part}.csv", index=False)
    text = part.table(frame)
    (options.output / f"{options.part}.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
