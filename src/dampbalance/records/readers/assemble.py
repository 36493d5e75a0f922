"""From the columns of a file to a Measurement in SI: finite, within bounds, in equal steps, not constant, no overflow;
at once or in blocks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...arrays import Array
from ...record import GRID_TOLERANCE
from ..errors import (
    FINEST,
    HIGHEST_RATE,
    LARGEST,
    LARGEST_VALUE,
    LATEST,
    LOWEST_RATE,
    SMALLEST_RANGE,
    RecordError,
    require_size,
)
from ..measurement import QUANTITIES, Channel
from .plan import Pick
from .record_file import RecordFile
from .times import in_equal_steps, times

_GAP = 1.5  # steps
_BITS = (8, 16, 24, 32, 64)  # of the integers that converters and files have
# of their range: no oscillation passes through so much of it from one sample to the next
_WRAPPED = 0.9


def stated_size(file: RecordFile, picks: Sequence[Pick], largest: int) -> int:
    """How many numbers the picked channels are, as far as the file tells before it is read.

    Raises RecordError when they are more than `largest`.
    """
    numbers = sum(file.channels[i].size or 0 for i in wanted_of(picks))
    require_size(file.path, numbers, largest)
    return numbers


def whole(file: RecordFile, picks: Sequence[Pick], largest: int) -> list[Channel]:
    """All samples of the picked channels, `largest` numbers at most, which not every file tells beforehand.

    Raises RecordError naming channel and line or sample: a value that is missing, not finite or beyond all bounds,
    times that do not increase, have a gap or unequal steps, a constant channel, an integer that ran over, channels of
    unequal lengths.
    """
    stated_size(file, picks, largest)
    wanted = wanted_of(picks)
    blocks = list(file.blocks(wanted, max(file.channels[i].size or LARGEST for i in wanted)))
    arrays = [*map(_joined, zip(*blocks, strict=True))] or [np.empty(0)] * len(wanted)
    require_size(file.path, sum(len(array) for array in arrays), largest)
    columns = dict(zip(wanted, arrays, strict=True))
    first_of: dict[tuple[object, ...], Pick] = {}  # of the channels that share their times
    channels = []
    for pick in picks:
        samples = _without_padding(file, pick, columns)
        first = first_of.setdefault((pick.time, pick.rate_hz, pick.start), pick)
        sizes = [columns[one.index].size for one in (first, pick)]
        if len({*sizes}) > 1:
            raise RecordError(
                f"{file.path}: channel {first.name!r} has {sizes[0]} samples, {pick.name!r} has {sizes[1]}; channels "
                "that share their times have equal lengths"
            )
        stretch = Stretch(file, pick, entire=True)
        channels.append(stretch.channel(samples))
        stretch.finish()
    return channels


def in_blocks(file: RecordFile, pick: Pick, size: int, largest: int) -> Iterator[Channel]:
    """One channel, `size` samples at a time; the last block may be shorter, but has at least 2.

    Raises RecordError as `whole`, when the block that is wrong comes up, a constant channel after the last; and when
    there are more than `largest` samples, which not every file tells beforehand.
    """
    wanted = wanted_of([pick])
    if len({file.channels[i].size for i in wanted}) > 1:
        named = ", ".join(f"{file.channels[i].name!r} {file.channels[i].size}" for i in wanted)
        raise RecordError(
            f"{file.path}: its channels have unequal lengths ({named}); such a file is read only as a whole"
        )
    stretch = Stretch(file, pick)
    # One block is kept back, so that a last one of a single sample can join it.
    waiting: list[Array] = []
    raw = file.blocks(wanted, size)
    for block in raw if pick.time is None else _without_empty_end(raw):
        if waiting and block[0].size < 2:
            waiting = [np.concatenate(pair) for pair in zip(waiting, block, strict=True)]
            continue
        if waiting:
            yield stretch.channel(dict(zip(wanted, waiting, strict=True)))
            require_size(file.path, stretch.count * len(wanted), largest)
        waiting = block
    yield stretch.channel(dict(zip(wanted, waiting or [np.empty(0)] * len(wanted), strict=True)))
    stretch.finish()


@dataclass
class Stretch:
    """A channel as far as it has come: number of samples, last time and step (s), lowest and highest value.

    entire : whether it comes in one piece; rounded times are then put in equal steps.
    """

    file: RecordFile
    pick: Pick
    entire: bool = False
    count: int = 0
    last: float | None = None
    step: float | None = None
    low: float = np.inf
    high: float = -np.inf

    def channel(self, columns: Mapping[int, Array]) -> Channel:
        """The next block of the channel, checked on its own and against what came before."""
        pick, values = self.pick, columns[self.pick.index]
        if self.count + values.size < 3:
            raise RecordError(
                f"{self.file.path}: channel {pick.name!r} has {self.count + values.size} samples; that is no record"
            )
        signal = self._in_si(
            pick.index, values, pick.factor, LARGEST_VALUE, QUANTITIES[pick.quantity]
        )
        self._require_no_overflow(values)
        if pick.time is None:
            t = times(pick.rate_hz, pick.start, self.count, values.size)
        else:
            where = f"{self.file.path}: time channel {self.file.channels[pick.time].name!r}"
            t = self._in_si(pick.time, columns[pick.time], pick.time_factor, LATEST, "s")
            if self.entire:
                t = in_equal_steps(t, where)
            self._require_uniform(pick.time, t, where)
        self.count += values.size
        self.last = float(t[-1])
        self.low = min(self.low, float(values.min()))
        self.high = max(self.high, float(values.max()))
        try:
            return Channel(pick.quantity, t, signal, pick.name, pick.correction)
        except ValueError as error:
            raise RecordError(f"{self.file.path}: {error}") from None

    def finish(self) -> None:
        """Check what only the whole channel shows: that it is not constant, nor as good as that."""
        channel = f"{self.file.path}: channel {self.pick.name!r}"
        span, constant = self.high - self.low, f"{self.low:g} in all {self.count} samples"
        if not span:
            raise RecordError(f"{channel} is constant, {constant}; check transducer and mapping")
        if (swing := span * abs(self.pick.factor)) < SMALLEST_RANGE:
            raise RecordError(
                f"{channel} moves by {swing:.3g} {QUANTITIES[self.pick.quantity]} in all, too little to mean anything; "
                "check its unit and scale"
            )
        if span < FINEST * max(abs(self.low), abs(self.high)):
            raise RecordError(
                f"{channel} is constant except for rounding, {constant}; check transducer and mapping, or take off its"
                " offset"
            )

    def _in_si(self, index: int, values: Array, factor: float, bound: float, unit: str) -> Array:
        """The values in SI, finite and within the bound either way."""
        with np.errstate(over="ignore"):
            signal = values * factor
        bad = np.flatnonzero(~(np.abs(signal) <= bound))
        if not bad.size:
            return signal
        i, file, remedy = int(bad[0]), self.file, "cut the record before it"
        what = "empty or not a number (NaN)" if np.isnan(values[i]) else "infinite"
        if np.isfinite(values[i]):
            what, remedy = f"{values[i]:.6g}, beyond {bound:g} {unit}", "check its unit and scale"
        more = f", and so are {bad.size - 1} more" if bad.size > 1 else ""
        raise RecordError(
            f"{file.path}: {file.place(index, self.count + i)}: channel {file.channels[index].name!r} is {what}{more}; "
            f"{remedy}, or repair it"
        )

    def _require_no_overflow(self, values: Array) -> None:
        """No jump through nearly the whole range of an integer type, from its one end to the other."""
        if values.size < 2:
            return
        jumps = np.abs(np.diff(values))
        i = int(np.argmax(jumps))
        bits = next((bits for bits in _BITS if np.ptp(values) < 2.0**bits), 0)
        if not bits or jumps[i] <= _WRAPPED * 2.0**bits or np.any(values != np.round(values)):
            return
        raise RecordError(
            f"{self.file.path}: {self.file.place(self.pick.index, self.count + i + 1)}: channel {self.pick.name!r} "
            f"goes from {values[i]:g} to {values[i + 1]:g}: an integer of {bits} bits ran over; record "
            "with a wider range"
        )

    def _require_uniform(self, index: int, t: Array, where: str) -> None:
        line = t if self.last is None else np.concatenate([[self.last], t])

        def place(i: int) -> str:
            return self.file.place(index, self.count - (line.size - t.size) + i)

        steps = np.diff(line)
        if self.step is None:
            self.step = float(np.median(steps))
        if self.step > 0.0 and not LOWEST_RATE <= 1.0 / self.step <= HIGHEST_RATE:
            raise RecordError(
                f"{where} has steps of {self.step:g} s, which no recorder has; check its unit, or give sample_rate_hz"
            )
        i = int(np.argmin(steps))
        if steps[i] <= 0.0:
            raise RecordError(
                f"{where} does not increase: {line[i]:.12g} s, then {line[i + 1]:.12g} s ({place(i + 1)}); give "
                "sample_rate_hz instead if it has too few digits"
            )
        i = int(np.argmax(steps))
        if steps[i] > _GAP * self.step:
            raise RecordError(
                f"{where} has a gap of {steps[i]:g} s after {line[i]:.12g} s ({place(i)}), its step is {self.step:g} s;"
                " use the part before or after it"
            )
        off = np.abs(line - np.linspace(line[0], line[-1], line.size))
        i = int(np.argmax(off))
        if off[i] > GRID_TOLERANCE * self.step:
            raise RecordError(
                f"{where} is not in equal steps: {line[i]:.12g} s ({place(i)}) is {off[i]:.2g} s off the grid of "
                f"{self.step:g} s; resample the record, or give sample_rate_hz instead if only the digits are too few"
            )


def wanted_of(picks: Sequence[Pick]) -> list[int]:
    """The channels to read, signals and times."""
    return sorted({i for pick in picks for i in (pick.index, pick.time) if i is not None})


def _without_padding(
    file: RecordFile, pick: Pick, columns: Mapping[int, Array]
) -> Mapping[int, Array]:
    """The columns of a channel without the empty cells that a shorter time base leaves at its end in a table."""
    if pick.time is None:
        return columns
    values, time = columns[pick.index], columns[pick.time]
    if time.size != values.size:
        raise RecordError(
            f"{file.path}: channel {pick.name!r} has {values.size} samples, its time "
            f"{file.channels[pick.time].name!r} has {time.size}; each sample needs its time"
        )
    end = _end([values, time])
    return {pick.index: values[:end], pick.time: time[:end]}


def _without_empty_end(blocks: Iterator[list[Array]]) -> Iterator[list[Array]]:
    """The blocks without the rows at the end of the table that are empty in every column."""
    empty = 0  # rows that are, so far, the end
    for block in blocks:
        end = _end(block)
        if end:
            if empty:  # they were not the end: an error, which the checks will find
                yield [np.full(empty, np.nan) for _ in block]
            empty = 0
            yield [column[:end] for column in block]
        empty += block[0].size - end


def _joined(parts: Sequence[Array]) -> Array:
    """The parts of a column as one array, which is not copied where it is one already."""
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


def _end(columns: Sequence[Array]) -> int:
    """The number of rows up to the last that is not empty in every column."""
    present = np.flatnonzero(~np.all([np.isnan(column) for column in columns], axis=0))
    return int(present[-1]) + 1 if present.size else 0
