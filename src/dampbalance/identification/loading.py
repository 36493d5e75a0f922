"""From a file to what was read off it; large files a block at a time."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from ..arrays import Array
from ..project.wording import visible
from ..reading.conditioning import condition_blocks
from ..reading.frequency import stands_still
from ..reading.noisy import Reading, read_features
from ..records.limits import LARGEST
from ..records.mapping import MappingLike, mapping_for, parts_of
from ..records.measurement import EXCITATIONS, Measurement
from ..records.readers import RecordWarning, open_channels, read, stated_numbers

LARGE = 256_000_000
"""Size of a file, bytes, packed or not, from which it is not taken into memory as a whole."""

_NUMBER = 8  # bytes

EXCERPT = 16_384  # leading samples of each channel that are kept for plots


class NotDriven(ValueError):
    """A record without a drive, or with one that stands still: a free decay."""


@dataclass(frozen=True, eq=False)
class Loaded:
    """One record: where it is, its name, its features, and its leading samples (t, values) by quantity, s and SI.

    measurement : the whole of it; None for a large file.
    """

    path: Path
    label: str
    reading: Reading
    excerpt: Mapping[str, tuple[Array, Array]]
    measurement: Measurement | None = None


def load(
    path: str | Path,
    k: float,
    *,
    mapping: MappingLike = None,
    frequency_hz: float | None = None,
    skip_cycles: int = 0,
    largest: int = LARGEST,
) -> Loaded:
    """The features of a record in a file.

    k : stiffness, N/m.   mapping : what the file does not say of its channels.   frequency_hz : the drive frequency as
    known, or that of the mapping; compared with the one found.   skip_cycles : left out at the start.
    largest : numbers (samples × channels) that may be read.

    What its reader finds odd is among the warnings of the reading. Raises RecordError for a file that cannot be read,
    ValueError for a record that cannot be used; both name the file.
    """
    path = Path(path)
    rules = mapping_for(path, mapping)
    nominal = rules.frequency_hz if frequency_hz is None else frequency_hz
    measurement: Measurement | None = None
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RecordWarning)
        stated = _NUMBER * stated_numbers(path, rules, largest)
        stored = sum(file.stat().st_size for file in parts_of(path, rules))
        if max(stated, stored) > LARGE:
            channels = open_channels(path, rules, largest=largest)
            _require_driven(path, any(q in EXCITATIONS for q in channels))
            steady = condition_blocks(
                str(path),
                channels,
                k,
                frequency_hz=nominal,
                skip_cycles=skip_cycles,
                corrections={q: rule.correction for q, rule in rules.channels.items()},
            )
            reading = Reading(steady)
            first = {q: next(iter(blocks())) for q, blocks in channels.items()}
        else:
            measurement = replace(read(path, rules, largest), source=str(path))
            moves = measurement.driven and not stands_still(measurement.excitation.values)
            _require_driven(path, moves)
            reading = read_features(measurement, k, frequency_hz=nominal, skip_cycles=skip_cycles)
            first = {q: (measurement[q].t, measurement[q].values) for q in measurement}
    messages = (w.message for w in caught if issubclass(w.category, RecordWarning))
    notes = dict.fromkeys(str(message).removeprefix(f"{path}: ") for message in messages)
    steady = reading.steady
    reading = Reading(replace(steady, warnings=(*notes, *steady.warnings)))
    excerpt = {q: (t[:EXCERPT], values[:EXCERPT]) for q, (t, values) in first.items()}
    return Loaded(path, visible(rules.level or path.name), reading, excerpt, measurement)


def _require_driven(path: Path, driven: bool) -> None:
    """NotDriven for a record of a free decay."""
    if not driven:
        raise NotDriven(
            f"{path}: nothing drives it: a record at a level of excitation needs a drive that moves "
            f"({', '.join(EXCITATIONS)}); a free decay is identified by itself (--kind ring-down)"
        )
