"""The blind set at any size (`make blind`): python -m blind [PART] [--sets 900] [--first 0] [--processes 2] [--output DIR]."""

from __future__ import annotations

import argparse
import multiprocessing
import time
from pathlib import Path

import pandas as pd

from .score import outcome, table


def blind(options: argparse.Namespace) -> str:
    """Identify all sets; the table of aims."""
    began = time.perf_counter()
    rows: list[dict[str, object]] = []
    context = multiprocessing.get_context("spawn")
    with context.Pool(options.processes) as pool:
        wanted = range(options.first, options.first + options.sets)
        for done, of_set in enumerate(pool.imap(outcome, wanted, chunksize=4), 1):
            rows += of_set
            if done % 50 == 0:
                print(f"{done} sets, {time.perf_counter() - began:.0f} s", flush=True)
    frame = pd.DataFrame(rows)
    frame.to_csv(options.output / "blind.csv", index=False)
    return table(frame, options.yardstick)


PARTS = {"blind": blind}


def main(arguments: list[str] | None = None) -> None:
    """Run one part; its table goes to the screen and to the folder."""
    parser = argparse.ArgumentParser(prog="blind", description=__doc__)
    parser.add_argument("part", nargs="?", default="blind", choices=PARTS)
    parser.add_argument("--sets", type=int, default=900)
    parser.add_argument("--first", type=int, default=0, help="number of the first set")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--yardstick", default="direct", help="approach held against the aims")
    parser.add_argument("--output", type=Path, default=Path("results/blind"))
    options = parser.parse_args(arguments)
    options.output.mkdir(parents=True, exist_ok=True)
    text = PARTS[options.part](options)
    (options.output / f"{options.part}.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
