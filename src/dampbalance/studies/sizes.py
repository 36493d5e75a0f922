"""The size of a study before anything runs: cases, chunks, bytes; and how much of it is done while it runs."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import NamedTuple

from ..project.documents import ConfigurationError
from .axes import Sampled
from .columns import columns_of
from .settings import Study

PART = 131_072
"""Cases that are in memory at a time, and a row group of the file: 0.8 kB each while they are worked on."""

MOST_CHUNKS = 20_000
"""More jobs than this keep the scheduler busier than the processors: make the chunks larger."""

_SPARE = 0.05  # share of the free disk that a study leaves free


class StudySize(NamedTuple):
    """Size of a study: cases, responses (cases × levels), chunks, bytes of the finished table, and bytes of disk that
    are in use at the worst moment, while the finished chunks are joined."""

    cases: int
    responses: int
    chunks: int
    table_bytes: int
    disk_bytes: int

    def __str__(self) -> str:
        chunks = f"{self.chunks:,} chunk{'s' if self.chunks > 1 else ''}"
        return (
            f"{self.cases:,} cases × {self.responses // self.cases} levels = {self.responses:,} responses, {chunks}, "
            f"up to {size_in_words(self.table_bytes)} (while it runs {size_in_words(self.disk_bytes)})"
        )


def size_of(study: Study) -> StudySize:
    """The size of a study. Bytes are an upper bound: constant columns and repeated words pack to next to nothing."""
    cases = study.cases
    table = 20_000 + cases * _bytes_per_case(study)
    chunks = -(-cases // study.chunk_cases)
    return StudySize(cases, cases * len(study.levels), chunks, table, 2 * table)


def _bytes_per_case(study: Study) -> int:
    """Eight bytes for every number that can differ from case to case, one or two for words and case numbers."""
    varied = sum(len(b.names) for b in study.blocks if isinstance(b, Sampled))
    columns = [c for c in columns_of(study) if c.words or c.name not in study.axis_names]
    return 8 * varied + 2 + sum(1 if column.words else 8 for column in columns)


def chunk_bounds(study: Study, chunk: int) -> tuple[int, int]:
    """First case of a chunk and the one after its last."""
    start = chunk * study.chunk_cases
    return start, min(start + study.chunk_cases, study.cases)


def check_size(study: Study, size: StudySize, folder: str | Path, file: str | Path) -> None:
    """Raise ConfigurationError, with the number of cases and bytes, for a study that does not fit on the disk of
    `folder` or falls into too many chunks."""
    if size.chunks > MOST_CHUNKS:
        enough = -(-size.cases // MOST_CHUNKS)
        raise ConfigurationError(
            f"{file}: chunk_cases: {size.cases:,} cases in chunks of {study.chunk_cases:,} are {size.chunks:,} jobs; "
            f"take chunks of at least {enough:,} cases"
        )
    path = Path(folder).absolute()
    existing = next(place for place in (path, *path.parents) if place.exists())
    free = int((1.0 - _SPARE) * shutil.disk_usage(existing).free)
    if size.disk_bytes > free:
        raise ConfigurationError(
            f"{file}: axes: {size.cases:,} cases would take {size_in_words(size.disk_bytes)} of disk while they are "
            f"computed, and {size_in_words(free)} are free; take fewer cases or fewer columns"
        )


def size_in_words(count: float) -> str:
    """A number of bytes with a unit that suits it, e.g. 1.2 GB."""
    unit = "bytes"
    for larger in ("kB", "MB", "GB", "TB", "PB"):
        if count < 1000.0:
            break
        count, unit = count / 1000.0, larger
    return f"{count:.3g} {unit}"


def progress(study: Study, folder: str | Path, chunks: int, started: float, now: float) -> str:
    """How many chunks of a study are done, and how long the rest takes at the rate of this run.

    folder : of the finished chunks.   started, now : s since the epoch, of the run and of this moment; NaN for unknown.
    """
    done = list(Path(folder).glob("[0-9]*.parquet"))
    text = f"Study {study.name}: {len(done)} of {chunks} chunks"
    recent = sum(path.stat().st_mtime >= started for path in done)
    if len(done) >= chunks or not recent:
        return text
    left = (chunks - len(done)) * (now - started) / recent
    return f"{text}, about {duration_in_words(left)} left"


def duration_in_words(seconds: float) -> str:
    """A duration in a unit that suits it, e.g. 12 s, 4 min, 3.5 h."""
    if seconds < 100.0:
        return f"{seconds:.0f} s"
    if seconds < 6000.0:
        return f"{seconds / 60.0:.0f} min"
    return f"{seconds / 3600.0:.1f} h"
