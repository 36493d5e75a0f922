"""Records of measurements as an identification takes them: from files of any format, tables of pandas, or arrays."""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from ..arguments import items, path
from ..findings.finding import Finding
from ..findings.words import sentence
from ..project.files import sha256
from ..project.wording import listed, visible
from .coordinate import ROTATION, TRANSLATION, Coordinate
from .errors import RecordError, RecordWarning
from .mapping import MappingLike, RecordMapping, mapping_file, mapping_for, parts_of
from .measurement import EXCITATIONS, Measurement, mean_rate
from .readers import read, table
from .recognise import recognise
from .table import Table, is_table, signals_file

if TYPE_CHECKING:
    import pandas as pd

    from .table import Signals

    RecordLike: TypeAlias = "str | Path | Signals | Table | Measurement | MeasuredRecord"


@dataclass(frozen=True, eq=False, repr=False)
class MeasuredRecord:
    """One record, of a steady response at one level of excitation or of free decays, as `read_records` makes it; a
    table of steady responses to a stepped sine is another kind, `joints.records.SteppedRecord`.

    name : what messages and tables call it; the path of a file.   label : of its level, for plots.
    quantities : that it holds, by the names of `Measurement`.   measurement : its channels in SI units; None where
    there are none.
    rules : what its mapping says.   warnings : what is odd about it.   files : digests of what it was read
    from.
    """

    name: str
    label: str
    quantities: tuple[str, ...]
    measurement: Measurement | None
    rules: RecordMapping
    warnings: tuple[Finding, ...] = ()
    files: Mapping[str, Any] | None = None

    @property
    def driven(self) -> bool:
        """Whether it has a channel that drives; without one it is of free decays."""
        return any(quantity in EXCITATIONS for quantity in self.quantities)

    @property
    def coordinate(self) -> Coordinate:
        """Whether it moves along a line or rotates; a table of steady responses moves along a line."""
        return TRANSLATION if self.measurement is None else self.measurement.coordinate

    def to_frame(self) -> pd.DataFrame:
        """Return the samples: a column for each channel, named with its SI unit, and their times, time_s, as index.

        Raises ValueError where the channels have different times.
        """
        import pandas as pd  # slow to import

        from .units import column_name

        channels = [self.recorded()[quantity] for quantity in self.quantities]
        t = channels[0].t
        if not all(np.array_equal(c.t, t) for c in channels):
            remedy = "take each from its measurement"
            raise ValueError(f"{self.name}: its channels have different times; {remedy}")
        columns = {column_name(c.quantity, c.coordinate): c.as_recorded for c in channels}
        return pd.DataFrame(columns, index=pd.Index(t, name="time_s"))

    def recorded(self) -> Measurement:
        """Return all channels as recorded: for harmonics, of which gain, delay and filters are divided out exactly."""
        assert self.measurement is not None
        return self.measurement

    def whole(self) -> Measurement:
        """Return all channels, with the gain, the delay and the filters that are known taken off their samples."""
        return self.recorded().corrected()

    def __repr__(self) -> str:
        """Return the contents of the record in a line."""
        held = listed([self.coordinate.noun(quantity) for quantity in self.quantities])
        t = max((self.recorded()[q].t for q in self.quantities), key=len)
        sampled = f"{t.size:,} samples from {t[0]:.4g} s to {t[-1]:.4g} s at {mean_rate(t):.6g} Hz"
        odd = [sentence(one, self.coordinate) for one in self.warnings]
        return f"<record {self.name}: {'; '.join([held, sampled, *odd])}>"


ReaderOfTables: TypeAlias = Callable[[Table, RecordMapping, str], MeasuredRecord | None]
"""Reader of the record in an open table, with what its mapping says and the label of a level without a name."""


def as_records(
    records: RecordLike | Sequence[RecordLike],
    *,
    mapping: MappingLike = None,
    free: bool = False,
    reader: ReaderOfTables | None = None,
) -> tuple[MeasuredRecord, ...]:
    """Return records as `dampbalance.read_records` does, whose arguments these are.

    reader : gives the record of an open table that is of its kind, and None for others; tried before channels are
    looked for.
    """
    single = isinstance(records, str | Path | Measurement | MeasuredRecord) or is_table(records)
    wanted = "the path of a file, a pandas DataFrame, a mapping of names to arrays, or a sequence of them"
    several = [records] if single else items("records", records, wanted)
    made: list[MeasuredRecord] = []
    for number, one in enumerate(several, start=1):
        if isinstance(one, str | Path):
            one = _of_file(path("each record", one, "a file"), mapping, free, reader)
        elif not isinstance(one, MeasuredRecord):
            taken = {record.name for record in made}
            one = _in_memory(one, number, taken, mapping, free, reader)
        made.append(one)
    return tuple(made)


def _in_memory(
    record: Signals | Table | Measurement,
    number: int,
    taken: set[str],
    mapping: MappingLike,
    free: bool,
    reader: ReaderOfTables | None,
) -> MeasuredRecord:
    """Return the record of signals in memory, the `number`-th of several, under a name that is not taken."""
    if not (is_table(record) or isinstance(record, Measurement)):
        remedy = "give the path of a file, a pandas DataFrame, or a mapping of names to arrays"
        raise RecordError(f"record {number} is a {type(record).__name__}; {remedy}")
    stated = getattr(record, "attrs", {}).get("name") or getattr(record, "source", None)
    stated = record.path if isinstance(record, Table) else stated
    own = visible(str(stated or f"record {number}"))
    names = itertools.chain([own], (f"{own} ({count})" for count in itertools.count(2)))
    name = next(name for name in names if name not in taken)
    rules = RecordMapping("mapping") if mapping is None else mapping_for("", mapping)
    rules = replace(rules, free=free)
    warned: list[Finding] = []
    if isinstance(record, Measurement):
        measurement = replace(record, source=name)
    else:
        signals = signals_file(name, record)
        of_its_kind = reader(signals, rules, name) if reader is not None else None
        if of_its_kind is not None:
            return of_its_kind
        with _collected_warnings(name) as warned:
            measurement = recognise(signals, rules)
    label = visible(rules.level or name)
    return MeasuredRecord(name, label, tuple(measurement), measurement, rules, tuple(warned))


def _of_file(
    path: Path, mapping: MappingLike, free: bool, reader: ReaderOfTables | None
) -> MeasuredRecord:
    rules, file = replace(mapping_for(path, mapping), free=free), None
    if reader is not None and not rules.channels:
        file = table(path, rules)
        of_its_kind = reader(file, rules, path.name)
        if of_its_kind is not None:
            return replace(of_its_kind, files=_digests(path, rules, mapping))
    with _collected_warnings(str(path)) as warned:
        measurement = read(path, rules, file)
    label, notes = visible(rules.level or path.name), tuple(warned)
    files = _digests(path, rules, mapping)
    return MeasuredRecord(str(path), label, tuple(measurement), measurement, rules, notes, files)


def _digests(path: Path, rules: RecordMapping, mapping: MappingLike) -> dict[str, Any]:
    """Return digests of a file, of the file that names its channels, and of others that hold some."""
    file = mapping_file(path, mapping)
    others = [part for part in parts_of(path, rules) if part != path]
    more = [{"file": str(part), "sha256": sha256(part)} for part in others]
    return ({"others": more} if more else {}) | {
        "sha256": sha256(path),
        "mapping": None if file is None else {"file": str(file), "sha256": sha256(file)},
    }


@contextmanager
def _collected_warnings(name: str) -> Iterator[list[Finding]]:
    """Collect the warnings of readers about a record, once each, without its name, when the block ends."""
    warned: list[Finding] = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RecordWarning)
        yield warned
    for one in (w.message for w in caught if isinstance(w.message, RecordWarning)):
        words = str(one).removeprefix(f"{name}: ")
        odd = one.finding or Finding("as read", {"words": words})
        if odd not in warned:
            warned.append(odd)


def require_different(records: Sequence[MeasuredRecord]) -> None:
    """Raise ValueError for no records, for records of both coordinates, and for a file named twice, also by a link or
    another spelling of its path."""
    if not records:
        raise ValueError("no records are given; name one for each level, or one of a free decay")
    first = {record.coordinate: record.name for record in reversed(records)}
    if len(first) > 1:
        rotating, other = first[ROTATION], first[TRANSLATION]
        raise RecordError(
            f"{rotating} rotates and {other} moves along a line: identify them separately"
        )
    known: dict[tuple[int, int], str] = {}
    for record in records:
        if record.files is None:
            continue
        found = Path(record.name).stat()
        other = known.setdefault((found.st_dev, found.st_ino), record.name)
        if other is not record.name:
            twice = f"{other} is named twice"
            named = twice if other == record.name else f"{other} and {record.name} are one file"
            raise ValueError(f"{visible(named)}: each record is one level")
