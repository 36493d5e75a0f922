"""Reads the features of a record, and gives its samples for pictures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import Array
from ..law.law import Law
from ..project.wording import Remark
from ..records.measured import MeasuredRecord
from ..records.measurement import EXCITATIONS, Correction
from ..signals.checks import SETTLES, Unsettled, is_clipped
from ..signals.conditioning import SteadyRecord, condition
from ..signals.drive import stands_still
from ..signals.mean_harmonics import Reading

EXCERPT = (
    16_384  # leading samples of each channel that are plotted, or three cycles of a slow drive
)

_SETTLING = 1e-3  # standard deviation of an amplitude while it settles; less is a drift, which the intervals hold

_LEFT_OUT = "a channel is clipped: the record is left out; raise the measuring range"


def keeps_moving(record: MeasuredRecord) -> bool:
    """Whether the excitation channel of a record keeps moving; in a free decay it is missing, constant or strikes."""
    return record.driven and not stands_still(record.whole().excitation.values)


def load(
    record: MeasuredRecord,
    k: float,
    *,
    frequency_hz: float | None = None,
    skip_cycles: int = 0,
    base_mass: float | None = None,
) -> Reading:
    """The features of a record.

    k : stiffness, N/m.   frequency_hz : the known drive frequency, compared with the one in the record; default, that
    of the mapping.   skip_cycles : left out at the start.   base_mass : as for `condition`.

    A motion that settles within its record is read from there on. What the reader of the file found odd is among the
    warnings of the reading.

    Raises ValueError naming the record for a free decay, and for one that cannot be used.
    """
    if not keeps_moving(record):
        raise ValueError(
            f"{record.name}: the excitation channel is missing or constant, or only strikes: a forced record needs one "
            f"that keeps moving ({', '.join(EXCITATIONS)}); a free decay is identified by itself (--kind ring-down)"
        )
    nominal = record.rules.frequency_hz if frequency_hz is None else frequency_hz
    whole = record.whole()

    def read(skipped: int) -> SteadyRecord:
        return condition(whole, k, frequency_hz=nominal, skip_cycles=skipped, base_mass=base_mass)

    try:
        steady = read(skip_cycles)
        of_start = [
            one.of[-1]
            for one in steady.warnings
            if SETTLES in one.template and one.doubts[""] > _SETTLING
        ]
        settled = max(of_start, default=0)
    except ValueError as error:
        cause = error.__cause__
        settled = cause.skip if isinstance(cause, Unsettled) else 0
        if not settled:
            raise
    if settled:
        said = f"{settled} cycles left out at the start, in which the motion had not settled"
        steady = read(settled)
        steady = replace(steady, warnings=(*steady.warnings, Remark(said)))
    return Reading(replace(steady, warnings=(*record.warnings, *steady.warnings)))


def unclipped(
    records: tuple[MeasuredRecord, ...], readings: list[Reading], law: Law
) -> tuple[tuple[MeasuredRecord, ...], list[Reading], list[Remark]]:
    """Return the records that are not clipped, with their readings, and a sentence on each other one; all of them where
    too few would be left to show how well they fit."""
    clipped = [any(map(is_clipped, one.steady.channels.values())) for one in readings]
    if not any(clipped) or law.groups or clipped.count(False) <= max(2, len(law.unknowns)):
        return records, readings, []
    kept = [i for i, is_out in enumerate(clipped) if not is_out]
    out = [one.steady.source for one, is_out in zip(readings, clipped, strict=True) if is_out]
    said = [Remark(_LEFT_OUT, source=source) for source in out]
    return tuple(records[i] for i in kept), [readings[i] for i in kept], said


def excerpt(record: MeasuredRecord, quantity: str, steady: SteadyRecord) -> tuple[Array, Array]:
    """Return the leading steady samples of a channel, t (s) and values (SI units), with the known gain and delay taken
    off, for pictures.

    steady : the steady state of the record.
    """
    channel, known = record.whole()[quantity], correction_of(record, quantity)
    t = channel.t
    cycles = int(np.searchsorted(t, t[0] + 6.0 * np.pi / steady.omega))
    count = max(EXCERPT, cycles)
    begin = min(int(np.searchsorted(t, steady.start)), max(0, t.size - count))
    part = slice(begin, begin + count)
    return t[part] - known.delay, channel.values[part] / known.gain


def correction_of(record: MeasuredRecord, quantity: str) -> Correction:
    """Gain, delay and filters of a channel as they are known: its own, or what the mapping states."""
    own = None if record.measurement is None else record.measurement[quantity].correction
    rule = record.rules.channels.get(quantity)
    return own or (rule.correction if rule else None) or Correction()
