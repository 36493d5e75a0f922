"""Reads the features of a record; large files a block at a time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from ..arrays import Array
from ..likelihood.mean_harmonics import Reading, read_features
from ..reading.conditioning import condition_blocks
from ..reading.cycles import stands_still
from ..records.measured import MeasuredRecord
from ..records.measurement import EXCITATIONS, Correction
from ..records.readers import open_channels

EXCERPT = 16_384  # leading samples of each channel that are kept for plots


class NotDriven(ValueError):
    """A record whose excitation channel is missing or constant: a free decay."""


@dataclass(frozen=True, eq=False)
class Loaded:
    """A record, its features, and its leading samples (t, values) by quantity, s and SI units, with known
    gains and delays taken off, for pictures."""

    record: MeasuredRecord
    reading: Reading
    excerpt: Mapping[str, tuple[Array, Array]]


def load(
    record: MeasuredRecord,
    k: float,
    *,
    frequency_hz: float | None = None,
    skip_cycles: int = 0,
) -> Loaded:
    """The features of a record.

    k : stiffness, N/m.   frequency_hz : the known drive frequency, compared with the one in the record; default, that
    of the mapping.   skip_cycles : left out at the start.

    What the reader of the file found odd is among the warnings of the reading.

    Raises NotDriven for a free decay, ValueError naming the record for one that cannot be used.
    """
    nominal = record.rules.frequency_hz if frequency_hz is None else frequency_hz
    measurement = record.measurement
    if not record.driven or (
        measurement is not None and stands_still(measurement.excitation.values)
    ):
        raise NotDriven(
            f"{record.name}: the excitation channel is missing or constant: a forced record needs one that moves "
            f"({', '.join(EXCITATIONS)}); a free decay is identified by itself (--kind ring-down)"
        )
    if measurement is None:
        channels = open_channels(record.name, record.rules, largest=record.largest)
        steady = condition_blocks(
            record.name,
            channels,
            k,
            frequency_hz=nominal,
            skip_cycles=skip_cycles,
            corrections={q: rule.correction for q, rule in record.rules.channels.items()},
        )
        first = {q: next(iter(blocks())) for q, blocks in channels.items()}
    else:
        reading = read_features(measurement, k, frequency_hz=nominal, skip_cycles=skip_cycles)
        steady = reading.steady
        first = {q: (measurement[q].t, measurement[q].values) for q in measurement}
    reading = Reading(replace(steady, warnings=(*record.warnings, *steady.warnings)))
    excerpt = {}
    for q, (t, values) in first.items():
        own = measurement[q].correction if measurement is not None else None
        rule = record.rules.channels.get(q)
        known = own or (rule.correction if rule else None) or Correction()
        excerpt[q] = t[:EXCERPT] - known.delay, values[:EXCERPT] / known.gain
    return Loaded(record, reading, excerpt)
