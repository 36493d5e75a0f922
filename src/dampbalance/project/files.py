"""Writing results: complete or not at all, and the same bytes for the same numbers."""

from __future__ import annotations

import csv
import hashlib
import io
import json
import math
import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd


ROUTES = ("exact", "as_published")  # routes by which a case is computed, and their folders
SIGNIFICANT_DIGITS = 15
"""Digits of a float in a table: all that survive a round trip through decimal text. Exact responses agree in them on
every processor that was tried, and differences of two responses need them."""

EVERY_DIGIT = 17
"""Digits that keep every bit of a float, for a table that is compared with printed numbers."""

READ_OUT_DIGITS = 13
"""Digits of features read off a sampled response. In the paper's case another processor changes them by up to 5e-14,
relative; where the truth is zero, as for harmonics of a response that sticks, it changes every digit."""

STATISTICAL_DIGITS = 6
"""Digits of statistics of noisy records, which another processor changes by up to 3e-7, and chance by far more."""
# Rounding lets the steps that read a table start from equal numbers on every processor, except at a tie between
# roundings. Orbits, records and cases of studies (JSON, Parquet) keep every bit: so many numbers would have ties.

UNFINISHED = ".~"  # how the name of a temporary file or folder begins


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Yield a temporary path next to `path`, which takes that name when the block ends, and vanishes if it fails."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(
        dir=path.parent, prefix=f"{UNFINISHED}{path.stem}-", suffix=path.suffix
    )
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        os.umask(mask := os.umask(0))
        temporary.chmod(0o666 & ~mask)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def remove_unfinished(folder: str | Path) -> None:
    """Remove the temporary files that killed runs left below a folder, in which no run may be active."""
    for path in list(Path(folder).rglob(f"{UNFINISHED}*")):
        if path.is_dir():
            shutil.rmtree(path)
        else:
            path.unlink(missing_ok=True)


def write_text(path: str | Path, text: str) -> None:
    """Write UTF-8 text with Unix line ends."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="\n")


def plain(value: Any) -> Any:
    """Return a value as JSON knows it: null for NaN and infinity, lists for arrays and tuples."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, str):
        return str(value)  # a term becomes its symbol
    return None if isinstance(value, float) and not math.isfinite(value) else value


def json_text(data: Any) -> str:
    """Return data as JSON; floats keep every bit."""
    return json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def write_json(path: str | Path, data: Any) -> None:
    """Write JSON; floats keep every bit."""
    write_text(path, json_text(data))


def write_csv(path: str | Path, frame: pd.DataFrame, digits: int = SIGNIFICANT_DIGITS) -> None:
    """Write a table without its index; floats with so many significant digits, a missing value as an empty field."""
    text = partial(_digits, digits=digits)
    write_text(path, frame.to_csv(index=False, float_format=text, lineterminator="\n"))


def write_rows(path: str | Path, rows: Sequence[Mapping[str, object]]) -> None:
    """Write a table given as its rows, by column, as `write_csv` would, whose library takes longer to import than a
    small table to write."""
    out = io.StringIO()
    cells = ([_digits(v) if isinstance(v, float) else v for v in row.values()] for row in rows)
    csv.writer(out, lineterminator="\n").writerows([rows[0], *cells])
    write_text(path, out.getvalue())


NAMES = ("id", "frequency", "phase", "sharing", "line", "unit", "printed", "verdict")
"""Columns that hold names or printed digits, which may look like a number, or like no value (01, 1e3, nan)."""


def read_csv(path: str | Path, dtype: Any = None) -> pd.DataFrame:
    """Read a table that `write_csv` wrote: floats come back as they were written, NAMES and empty text as text.

    dtype : str for a table of nothing but text.
    """
    import pandas as pd  # slow to import, and needed for tables only

    kinds = dtype or dict.fromkeys(NAMES, str)
    frame = pd.read_csv(path, dtype=kinds, keep_default_na=False, na_values=[""])
    text = frame.select_dtypes(exclude="number").columns
    return frame.fillna(dict.fromkeys(text, ""))


def read_routes(
    results: str | Path, kind: str, frequencies: Iterable[str], routes: Iterable[str] = ROUTES
) -> dict[str, dict[str, pd.DataFrame]]:
    """Return route → frequency → table of the features or the estimates (`kind`) in the folder `results`."""
    names = list(frequencies)
    return {
        route: {name: read_csv(f"{results}/{kind}/{route}/{name}.csv") for name in names}
        for route in routes
    }


def write_parquet(path: str | Path, frame: pd.DataFrame) -> None:
    """Write a table as Parquet, without anything that depends on when or where it was made."""
    with replacing(path) as temporary:
        frame.to_parquet(temporary, index=False, compression="zstd")


def sha256(path: str | Path) -> str:
    """Return the SHA-256 digest of a file, in hexadecimal."""
    with open(path, "rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _digits(value: float, digits: int = SIGNIFICANT_DIGITS) -> str:
    return "" if math.isnan(value) else repr(float(f"{value:.{digits}g}"))
