"""The blind set at any size (`make blind`).

make blind BLIND_ARGS="[PART] [--sets 900] [--first 0] [--processes 2] [--drawings 200] [--approach direct]"
make blind BLIND_ARGS="field [--decays 200] [--forced 180] [--seed 2010] [--kinds 'hum,12 bits']"
"""

from __future__ import annotations

import argparse
import multiprocessing
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

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
    others,
    score,
)
from .truths import SEED


def _rows(
    work: Callable[[Any], list[dict[str, object]]], runs: Sequence[Any], processes: int
) -> pd.DataFrame:
    """Return rows of all runs, in their order."""
    rows: list[dict[str, object]] = []
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        for of_run in pool.imap(work, runs, chunksize=1):
            rows += of_run
    return pd.DataFrame(rows)


def blind(options: argparse.Namespace) -> str:
    """Identify all sets; the table of aims."""
    wanted = range(options.first, options.first + options.sets)
    rows = _rows(score.outcome, wanted, options.processes)
    rows.to_csv(options.output / "blind.csv", index=False)
    return score.table(rows)


def efficient(options: argparse.Namespace) -> str:
    """Draw the noise of the fixed truths again and again; the share of the information that is used."""
    drawings = range(options.first, options.first + options.drawings)
    runs = [efficiency.Run(i, j) for j in drawings for i in range(len(efficiency.TRUTHS))]
    rows = _rows(efficiency.replicate, runs, options.processes)
    rows.to_csv(options.output / "efficiency.csv", index=False)
    return efficiency.table(rows)


def faulty(options: argparse.Namespace) -> str:
    """Identify records with faults, one at a time."""
    rows = _rows(faults.tried, faults.RUNS, options.processes)
    rows.to_csv(options.output / "faults.csv", index=False)
    return faults.table(rows, options.approach)


def other(options: argparse.Namespace) -> str:
    """Return other ways to the same numbers, on three sets."""
    rows = _rows(others.compared, others.SETS, options.processes)
    rows.to_csv(options.output / "others.csv", index=False)
    return others.table(rows)


def confused(options: argparse.Namespace) -> str:
    """Identify records of six laws; which law is chosen for each."""
    drawings = range(options.first, options.first + options.drawings)
    runs = [(law, drawing) for drawing in drawings for law in laws.LAWS]
    rows = _rows(laws.outcome, runs, options.processes)
    rows.to_csv(options.output / "laws.csv", index=False)
    return laws.table(rows)


def decays(options: argparse.Namespace) -> str:
    """Identify free decays and compare the decrements of laboratories; resume an interrupted run of the same seed."""
    file = options.output / f"decays_{options.seed}.csv"
    done = pd.read_csv(file) if file.exists() else pd.DataFrame({"set": []})
    wanted = range(options.first, options.first + options.sets)
    for index in sorted(set(wanted) - set(done["set"].astype(int))):
        rows = pd.DataFrame(decrements.tried(index, options.seed))
        done = pd.concat([done, rows], ignore_index=True)
        done.to_csv(file, index=False)
    return decrements.table(done[done["set"].isin(wanted)])


def departing_decays(options: argparse.Namespace) -> str:
    """Identify free decays with a further term; what is said of it, and which law is chosen."""
    wanted = range(options.first, options.first + options.sets)
    runs = [(i, term, term in decay_laws.TERMS) for i in wanted for term in decay_laws.ALL]
    runs = [(term, i, options.seed, compared) for i, term, compared in runs]
    rows = _rows(decay_laws.outcome, runs, options.processes)
    rows.to_csv(options.output / "decay_laws.csv", index=False)
    return decay_laws.table(rows)


def decays_of_contacts(options: argparse.Namespace) -> str:
    """Identify free decays on contacts that yield gradually, and twice as many of one that yields at once."""
    wanted = range(options.first, options.first + options.sets)
    runs = [(term, i, options.seed, False) for i in wanted for term in decay_laws.CONTACTS]
    sound = range(2 * options.first, 2 * (options.first + options.sets))
    runs += [("none", i, options.seed, False) for i in sound]
    rows = _rows(decay_laws.outcome, runs, options.processes)
    rows.to_csv(options.output / "decay_contacts.csv", index=False)
    return decay_laws.table_of_contacts(rows)


def jointed(options: argparse.Namespace) -> str:
    """Identify stepped-sine tables of joints: single sliders and Iwan's four-parameter model."""
    runs = [(index, options.seed) for index in range(options.first, options.first + options.sets)]
    rows = _rows(joints.outcome, runs, options.processes)
    rows.to_csv(options.output / "joints.csv", index=False)
    return joints.table(rows)


def looped(options: argparse.Namespace) -> str:
    """Identify measured loops of seven contacts and motions."""
    runs = [(index, options.seed) for index in range(options.first, options.first + options.sets)]
    rows = _rows(loops.outcome, runs, options.processes)
    rows.to_csv(options.output / "loops.csv", index=False)
    return loops.table(rows)


def departing(options: argparse.Namespace) -> str:
    """Identify forced records that depart from the model; what is wrong, and whether that is said."""
    wanted = range(options.first, options.first + options.sets)
    runs = [(name, i, options.seed) for i in wanted for name in departures.DEPARTURES]
    rows = _rows(departures.outcome, runs, options.processes)
    rows.to_csv(options.output / "departures.csv", index=False)
    return departures.table(rows)


def in_the_field(options: argparse.Namespace) -> str:
    """Identify records as laboratories have them, beside a simple analysis; resume an interrupted run of the seed."""
    file = options.output / f"field_{options.seed}.csv"
    empty = pd.DataFrame({"records": [], "set": []})
    done = pd.read_csv(file) if file.exists() else empty
    runs = [(False, i) for i in range(options.decays)] + [(True, i) for i in range(options.forced)]
    kinds = dict.fromkeys((*field.DECAYS, *field.FORCED))
    wanted = options.kinds.split(",") if options.kinds else kinds
    runs = [(forced, i) for forced, i in runs if field.kind_of(i, forced) in wanted]
    if not runs or not kinds.keys() >= set(wanted):
        raise SystemExit(f"--kinds {options.kinds!r} names no set: choose from {', '.join(kinds)}")
    drawn = pd.MultiIndex.from_tuples([("forced" if forced else "decays", i) for forced, i in runs])
    places = pd.MultiIndex.from_frame(done[["records", "set"]])
    left = [(*run, options.seed) for run, key in zip(runs, drawn, strict=True) if key not in places]
    context = multiprocessing.get_context("spawn")
    with context.Pool(options.processes, field_score.warm) as pool:
        for row in pool.imap(field_score.outcome, left):
            done = pd.concat([done, pd.DataFrame(row)], ignore_index=True)
            done.to_csv(file, index=False)
    return field_score.table(done.set_index(["records", "set"]).loc[drawn].reset_index())


def filed(options: argparse.Namespace) -> str:
    """Identify files in the shapes of loggers, apps and test machines."""
    shapes = {**files.SHAPES, **files.OTHERS}
    wanted = options.kinds.split(",") if options.kinds else shapes
    rows = _rows(files.outcome, [(name, options.seed) for name in wanted], options.processes)
    rows.to_csv(options.output / "files.csv", index=False)
    return files.table(rows)


def folded(options: argparse.Namespace) -> str:
    """Identify records with a whole number of samples to the cycle, or nearly, behind a filter and without."""
    wanted = range(options.first, options.first + options.sets)
    runs = [(hertz, i, options.seed) for hertz in folding.FREQUENCIES for i in wanted]
    rows = _rows(folding.outcome, runs, options.processes)
    rows.to_csv(options.output / "folding.csv", index=False)
    return folding.table(rows)


PARTS = {"decays": decays, "blind": blind, "efficiency": efficient, "faults": faulty}
PARTS |= {"others": other, "laws": confused, "decay_laws": departing_decays, "joints": jointed}
PARTS |= {
    "departures": departing,
    "decay_contacts": decays_of_contacts,
    "field": in_the_field,
    "files": filed,
    "loops": looped,
    "folding": folded,
}


def main(arguments: list[str] | None = None) -> None:
    """Run one part; its table goes to the screen and to the folder."""
    parser = argparse.ArgumentParser(prog="blind", description=__doc__)
    parser.add_argument("part", nargs="?", default="blind", choices=PARTS)
    parser.add_argument("--sets", type=int, default=900)
    parser.add_argument("--first", type=int, default=0, help="number of the first set, or drawing")
    parser.add_argument(
        "--seed", type=int, default=SEED, help="of the sets of decays, departures or joints"
    )
    parser.add_argument("--decays", type=int, default=200, help="sets of decays of the field")
    parser.add_argument(
        "--forced", type=int, default=180, help="sets of forced records of the field"
    )
    parser.add_argument(
        "--kinds", default="", help="of the field, separated by commas; default, all"
    )
    parser.add_argument("--drawings", type=int, default=200, help="of each truth or law")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--approach", default=score.FIRST, help="whose errors faults shows")
    parser.add_argument("--output", type=Path, default=Path("results/blind"))
    options = parser.parse_args(arguments)
    options.output.mkdir(parents=True, exist_ok=True)
    text = PARTS[options.part](options)
    (options.output / f"{options.part}.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
