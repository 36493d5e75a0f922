"""Compare the results of two builds: which files have the same bytes, and how far the numbers of the others are apart.

    make compare WITH=OTHER/results                      the results here with those of another machine or Python
    python trials/same_results.py FIRST SECOND           two folders

Exit status: 0 if all files have the same bytes, except those that describe the run itself; 1 if not.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from dampbalance.project.files import sha256

DIGESTED = ("features/exact/*.csv", "estimates/exact/*.csv", "tables/approaches.csv", "tables/*.md")
"""Tables that no processor that was tried changes: those of the exact responses, and those with the paper's digits. Of
the read-outs of simulations the last digits change, and what follows from them."""


def names_of(*folders: Path) -> list[str]:
    """Return every file below any of the folders, by its path in it."""
    files = (path.relative_to(top) for top in folders for path in top.rglob("*") if path.is_file())
    return sorted({file.as_posix() for file in files})


def different(first: Path, second: Path) -> list[str]:
    """Return files of two folders that differ, or are in one of them only."""
    return [name for name in names_of(first, second) if not _same(first / name, second / name)]


def digests(folder: Path) -> str:
    """Return the SHA-256 digests of the tables of a case in its folder, as `sha256sum` writes and checks them."""
    files = sorted(file for pattern in DIGESTED for file in folder.glob(pattern))
    return "".join(f"{sha256(file)}  {file.relative_to(folder).as_posix()}\n" for file in files)


def furthest(first: Path, second: Path) -> tuple[float, str]:
    """Return the largest |a − b|/max(|a|, |b|) of the numbers of two files, and the column or pointer where it is; ∞
    where something else differs or the files are of another kind."""
    one, other = (dict(_values(path)) for path in (first, second))
    if not one or one.keys() != other.keys():
        return math.inf, ""
    return max((_apart(one[place], other[place]), place) for place in one)


def of_the_run(first: Path, second: Path) -> bool:
    """Return whether two files that differ may: manifests of a case with the same reproducible part."""
    if first.name != "manifest.json":
        return False
    parts = [json.loads(path.read_text(encoding="utf-8")) for path in (first, second)]
    return all("run" in part for part in parts) and (
        parts[0]["reproducible"] == parts[1]["reproducible"]
    )


def _same(first: Path, second: Path) -> bool:
    return first.is_file() and second.is_file() and first.read_bytes() == second.read_bytes()


def _values(path: Path) -> Iterator[tuple[str, Any]]:
    """Yield (column, its values) of a table, (pointer, value) of a document, nothing of other files."""
    if path.suffix == ".json":
        yield from _leaves(json.loads(path.read_text(encoding="utf-8")), "")
    elif path.suffix in (".csv", ".parquet"):
        frame = pd.read_csv(path) if path.suffix == ".csv" else pd.read_parquet(path)
        yield from ((str(name), column.to_numpy()) for name, column in frame.items())


def _leaves(document: Any, place: str) -> Iterator[tuple[str, Any]]:
    if isinstance(document, dict | list):
        items = document.items() if isinstance(document, dict) else enumerate(document)
        for key, value in items:
            yield from _leaves(value, f"{place}/{key}")
    else:
        yield place, document


def _apart(first: Any, second: Any) -> float:
    a, b = np.atleast_1d(first), np.atleast_1d(second)
    if a.shape != b.shape:
        return math.inf
    equal = (a == b) | (pd.isna(a) & pd.isna(b))
    if np.all(equal):
        return 0.0
    if not (np.issubdtype(a.dtype, np.number) and np.issubdtype(b.dtype, np.number)):
        return math.inf
    a, b = a[~equal], b[~equal]
    with np.errstate(invalid="ignore"):
        relative = np.abs(a - b) / np.maximum(np.abs(a), np.abs(b))
    return float(np.max(np.where(np.isnan(relative), math.inf, relative)))


def compare(first: Path, second: Path) -> int:
    """Return what differs, on stdout."""
    every, unequal = names_of(first, second), different(first, second)
    allowed = 0
    for name in unequal:
        a, b = first / name, second / name
        if not (a.is_file() and b.is_file()):
            print(f"{name}: only in {first if a.is_file() else second}")
        elif of_the_run(a, b):
            allowed += 1
            print(f"{name}: describes the run, which may differ")
        else:
            relative, place = furthest(a, b)
            numbers = f"numbers differ by up to {relative:.0e} of themselves, the most at {place}"
            print(f"{name}: {numbers if math.isfinite(relative) else 'other contents'}")
    print(f"{len(every)} files, {len(every) - len(unequal)} of them with the same bytes")
    return 1 if len(unequal) > allowed else 0


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("first", type=Path)
    parser.add_argument(
        "second", type=Path, nargs="?", help="without it: digests of the case's tables"
    )
    options = parser.parse_args()
    for folder in filter(None, (options.first, options.second)):
        if not folder.is_dir():
            parser.error(f"{folder} is no folder")
    if options.second is None:
        print(digests(options.first), end="")
    else:
        sys.exit(compare(options.first, options.second))
