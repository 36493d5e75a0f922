"""Features of forced records, what is required of them, and their samples for pictures."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ..arguments import NUMBERS, number
from ..arrays import Array
from ..findings.finding import Finding
from ..findings.words import sentence
from ..law.law import Law
from ..records.channel import EXCITATIONS, Channel, Correction
from ..records.record import Record
from ..signals.checks import Unsettled, is_clipped
from ..signals.conditioning import SteadyRecord, condition
from ..signals.drive import stands_still
from ..signals.dwells import Dwell, Swept, dwells_of
from ..signals.mean_harmonics import Reading

# leading samples of each channel for a picture; of a slow drive, three cycles
EXCERPT = 16_384


def keeps_moving(record: Record) -> bool:
    """Return whether the excitation channel of a record keeps moving; in a free decay it is missing or constant, or it
    strikes."""
    return record.driven and not stands_still(record.excitation.values)


def levels_of(record: Record) -> tuple[Record, ...]:
    """Return a record for each dwell of the drive of a forced record, as in a staircase of levels; the record itself
    if its drive does not step.

    Raises ValueError naming the record for a drive that sweeps.
    """
    if not keeps_moving(record):
        return (record,)
    drive = record.excitation
    try:
        dwells = dwells_of(drive.t, drive.values)
    except Swept as error:
        raise ValueError(f"{record.name}: {error}") from None
    if not dwells:
        return (record,)
    said = Finding("several levels", {"levels": len(dwells)})
    return tuple(
        replace(
            record,
            name=f"{record.name} (level {number})",
            label=f"{record.label} (level {number})",
            channels=_between(record, dwell),
            warnings=(*record.warnings, said),
        )
        for number, dwell in enumerate(dwells, start=1)
    )


def _between(record: Record, dwell: Dwell) -> dict[str, Channel]:
    """Return the part of all channels in a dwell."""
    ends = (dwell.start, dwell.end)
    channels = record.channels.items()
    return {q: of.part(slice(*np.searchsorted(of.t, ends))) for q, of in channels}


def load(
    record: Record,
    k: float,
    *,
    frequency_hz: float | None = None,
    skip_cycles: int = 0,
    base_mass: float | None = None,
) -> Reading:
    """Return the features of a record.

    k : stiffness, N/m.   frequency_hz : the known drive frequency, compared with the one in the record; default, that
    of the mapping.   skip_cycles : left out at the start.   base_mass : as for `condition`.

    A motion that settles within its record is read from there on. The warnings of the reading include those of the
    reader of the file.

    Raises ValueError naming the record for a free decay, and for one that cannot be used.
    """
    if not keeps_moving(record):
        why = Finding("not forced", {"drives": ", ".join(map(record.coordinate.noun, EXCITATIONS))})
        raise ValueError(f"{record.name}: {sentence(why, record.coordinate)}")
    nominal = record.rules.frequency_hz if frequency_hz is None else frequency_hz

    def read(skipped: int) -> SteadyRecord:
        return condition(record, k, frequency_hz=nominal, skip_cycles=skipped, base_mass=base_mass)

    skipped = skip_cycles
    # a start is left out up to three times: a slow mode shows when a fast one has decayed
    for _ in range(3):
        settled, steady = _settled(read, skipped)
        if not settled:
            break
        skipped = settled
    if skipped > skip_cycles:
        steady = read(skipped) if steady is None or settled else steady
        said = Finding("settles", {"cycles": skipped})
        steady = replace(steady, warnings=(*steady.warnings, said))
    assert steady is not None
    return Reading(replace(steady, warnings=(*record.warnings, *steady.warnings)))


def _settled(read: Callable[[int], SteadyRecord], skipped: int) -> tuple[int, SteadyRecord | None]:
    """Return the cycles after which the motion has settled, 0 if it has from the first one read on; and the record,
    None if it changes too much to be read."""
    try:
        steady = read(skipped)
    except ValueError as error:
        if isinstance(cause := error.__cause__, Unsettled) and cause.skip:
            return cause.skip, None
        raise
    of_start = (one.numbers["skip"] for one in steady.warnings if one.code == "unsettled")
    return max(of_start, default=0), steady


def require_different_levels(readings: Sequence[Reading], k: float, law: Law) -> None:
    """Raise ValueError if readings cannot distinguish the terms of a law, were read with another stiffness, or two of
    them are of the same signals."""
    number("stiffness", k, NUMBERS["k"])
    law.require([r.steady.frequency_hz for r in readings], by_balance=False)
    for steady in (reading.steady for reading in readings):
        if steady.k != k:
            raise ValueError(f"{steady.source} was read with k = {steady.k:g}, not with {k:g}")
    for one, other in itertools.combinations((reading.steady for reading in readings), 2):
        # copies have the same harmonics, apart from rounding by another format
        bound = 1e-9 * abs(one.X[0, 1])
        if one.X.shape == other.X.shape and np.abs(one.X - other.X).max() < bound:
            raise ValueError(
                f"{one.source} and {other.source} contain the same signals: each record is one level"
            )


def unclipped(
    records: tuple[Record, ...], readings: list[Reading], law: Law
) -> tuple[tuple[Record, ...], list[Reading], list[Finding]]:
    """Return the records that are not clipped, with their readings, and a finding on each other one; all records if too
    few would remain to show how well they fit."""
    clipped = [any(map(is_clipped, one.steady.channels.values())) for one in readings]
    if not any(clipped) or law.groups or clipped.count(False) <= max(2, len(law.unknowns)):
        return records, readings, []
    kept = [i for i, is_out in enumerate(clipped) if not is_out]
    out = [one.steady.source for one, is_out in zip(readings, clipped, strict=True) if is_out]
    said = [Finding("left out", of=source) for source in out]
    return tuple(records[i] for i in kept), [readings[i] for i in kept], said


def excerpt(record: Record, quantity: str, steady: SteadyRecord) -> tuple[Array, Array]:
    """Return the leading steady samples of a channel, t (s) and values (SI units), for pictures.

    steady : the steady state of the record.
    """
    channel = record.corrected()[quantity]
    t = channel.t
    cycles = int(np.searchsorted(t, t[0] + 6.0 * np.pi / steady.omega))
    count = max(EXCERPT, cycles)
    begin = min(int(np.searchsorted(t, steady.start)), max(0, t.size - count))
    part = slice(begin, begin + count)
    return t[part], channel.values[part]


def correction_of(record: Record, quantity: str) -> Correction:
    """Return the known gain, delay and filters of a channel; those of a table are none."""
    channel = record.channels.get(quantity)
    return (channel and channel.correction) or Correction()
