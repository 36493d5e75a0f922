"""Measured records as an identification takes them: from files of any format, tables of pandas, or arrays."""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from ..arguments import items, path
from ..project.files import sha256
from ..project.wording import Remark, listed, visible
from .errors import RecordError, RecordWarning
from .mapping import MappingLike, RecordMapping, mapping_file, mapping_for, parts_of
from .measurement import EXCITATIONS, Measurement, mean_rate
from .readers import opened, read, read_signals
from .stepped_sine import SteppedTable, is_table_of_lines, read_table
from .table import Table, is_table, signals_file

if TYPE_CHECKING:
    import pandas as pd

    from .table import Signals

    RecordLike: TypeAlias = "str | Path | Signals | Table | Measurement | MeasuredRecord"


@dataclass(frozen=True, eq=False, repr=False)
class MeasuredRecord:
    """One record, of a steady response at one level of excitation or of free decays, or a table of steady responses to
    a stepped sine, as `read_records` makes it.

    name : what messages and tables call it; the path of a file.   label : of its level, for plots.
    quantities : that it holds, by the names of `Measurement`.   measurement : its channels in SI units; None for
    a table.
    rules : what its mapping says.   warnings : what is odd about it, in words.   files : digests of what it was read
    from.   table : its lines, where it is a table of steady responses; it has no samples then.
    """

    name: str
    label: str
    quantities: tuple[str, ...]
    measurement: Measurement | None
    rules: RecordMapping
    warnings: tuple[Remark, ...] = ()
    files: Mapping[str, Any] | None = None
    table: SteppedTable | None = None

    @property
    def driven(self) -> bool:
        """Whether it has a channel that drives; without one it is of free decays."""
        return any(quantity in EXCITATIONS for quantity in self.quantities)

    def to_frame(self) -> pd.DataFrame:
        """The samples: a column for each channel, named with its SI unit, and their times, time_s, as index; of a table
        of steady responses its lines.

        Raises ValueError where the channels have times of their own.
        """
        import pandas as pd  # slow to import

        from .units import column_name

        if self.table is not None:
            return self.table.to_frame()
        channels = [self.whole()[quantity] for quantity in self.quantities]
        t = channels[0].t
        if not all(np.array_equal(c.t, t) for c in channels):
            remedy = "take each from its measurement"
            raise ValueError(f"{self.name}: its channels have times of their own; {remedy}")
        columns = {column_name(c.quantity): c.values for c in channels}
        return pd.DataFrame(columns, index=pd.Index(t, name="time_s"))

    def whole(self) -> Measurement:
        """All its channels. Raises RecordError for a table."""
        if self.measurement is None:
            raise RecordError(
                f"{self.name}: is a table of steady responses, without samples; take its lines, `table`"
            )
        return self.measurement

    def __repr__(self) -> str:
        """What it holds, in a line."""
        held = listed(self.quantities)
        if self.table is not None:
            sizes = [of.X.size for of in self.table.levels]
            levels = f"{sum(sizes)} lines at {len(sizes)} level{'s' * (len(sizes) > 1)}"
            return f"<table {self.name}: {levels}; {self.table.convention}>"
        t = max((self.whole()[q].t for q in self.quantities), key=len)
        sampled = f"{t.size:,} samples from {t[0]:.4g} s to {t[-1]:.4g} s at {mean_rate(t):.6g} Hz"
        return f"<record {self.name}: {'; '.join([held, sampled, *self.warnings])}>"


def read_records(
    records: RecordLike | Sequence[RecordLike],
    *,
    mapping: MappingLike = None,
    tables: bool | None = None,
    free: bool = False,
) -> tuple[MeasuredRecord, ...]:
    """Measured records, ready for `identify`: from files, tables of pandas, or arrays.

    records : one, or several. Each is the path of a file in any format (`config/records/README.md`); a pandas
    DataFrame; a mapping of names to arrays; an array with named fields, or a plain one of columns; a `Table`, as
    `records.readers.table` makes it; a `Measurement`; or a record already read. Columns and arrays are named like
    those of a file, displacement_mm or force_N, with time_s among them, or sample_rate_hz as a number. A masked sample
    is missing, as an empty cell of a file is.
    mapping : what the names do not say, for all records: a document as in the YAML file of a record, or the path of
    one; default, for a file, the one next to it.
    tables : whether they are tables of steady responses to a stepped sine (frequency, amplitudes, phase); default,
    those that have columns of frequency and phase and none of times.   free : whether they are known to be free decays,
    so that no channel that nothing names, and no unit of a drive, is in the way.

    A record in memory is called "record 1" by its place, or as `name` in the `attrs` of its table says.

    Raises RecordError (a ValueError) naming record, key and remedy: a channel that is missing or unclear, a wrong unit,
    times that do not increase or have a gap, a value that is not finite, a constant channel.

    >>> import numpy as np
    >>> from dampbalance import read_records
    >>> t = np.arange(0.0, 2.0, 1e-3)
    >>> base, mass = 4.0 * np.cos(22.0 * t), 2.0 * np.sin(22.0 * t)
    >>> (record,) = read_records({"time_s": t, "base_displacement_mm": base, "displacement_mm": mass})
    >>> record
    <record record 1: base_displacement and displacement; 2,000 samples from 0 s to 1.999 s at 1000 Hz>
    >>> float(record.measurement["base_displacement"].values[0])  # m
    0.004
    """
    single = isinstance(records, str | Path | Measurement | MeasuredRecord) or is_table(records)
    wanted = "the path of a file, a pandas DataFrame, a mapping of names to arrays, or a sequence of them"
    several = [records] if single else items("records", records, wanted)
    made: list[MeasuredRecord] = []
    for number, one in enumerate(several, start=1):
        if isinstance(one, str | Path):
            one = _of_file(path("each record", one, "a file"), mapping, tables, free)
        elif not isinstance(one, MeasuredRecord):
            taken = {record.name for record in made}
            one = _in_memory(one, number, taken, mapping, tables, free)
        made.append(one)
    return tuple(made)


def _in_memory(
    record: Signals | Table | Measurement,
    number: int,
    taken: set[str],
    mapping: MappingLike,
    tables: bool | None,
    free: bool,
) -> MeasuredRecord:
    """The record of signals in memory, the `number`-th of several, under a name that is not taken."""
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
    if not isinstance(record, Measurement) and tables is not False:
        file = signals_file(name, record)
        if tables or is_table_of_lines(file, rules):
            return _of_lines(file, name, rules)
    with _told(name) as said:
        if isinstance(record, Measurement):
            measurement = replace(record, source=name)
        else:
            measurement = read_signals(name, record, rules)
    label = visible(rules.level or name)
    return MeasuredRecord(name, label, tuple(measurement), measurement, rules, tuple(said))


def _of_lines(
    file: Table,
    label: str,
    rules: RecordMapping,
    files: Mapping[str, Any] | None = None,
) -> MeasuredRecord:
    """The record of a table of steady responses."""
    table = read_table(file, rules, visible(rules.level or label))
    held, name = tuple(table.quantities), str(file.path)
    return MeasuredRecord(name, label, held, None, rules, files=files, table=table)


def _of_file(path: Path, mapping: MappingLike, tables: bool | None, free: bool) -> MeasuredRecord:
    rules, file = replace(mapping_for(path, mapping), free=free), None
    if tables is not False and not rules.channels:
        file = opened(path, rules)
        if tables or is_table_of_lines(file, rules):
            return _of_lines(file, path.name, rules, _digests(path, rules, mapping))
    with _told(str(path)) as said:
        measurement = replace(read(path, rules, file), source=str(path))
    label, notes = visible(rules.level or path.name), tuple(said)
    files = _digests(path, rules, mapping)
    return MeasuredRecord(str(path), label, tuple(measurement), measurement, rules, notes, files)


def recognised_as_table(path: Path, mapping: MappingLike) -> bool:
    """Whether `read_records` takes a file for a table of steady responses to a stepped sine."""
    rules = mapping_for(path, mapping)
    return is_table_of_lines(opened(path, rules), rules)


def _digests(path: Path, rules: RecordMapping, mapping: MappingLike) -> dict[str, Any]:
    """Digests of a file, of the file that names its channels, and of others that hold some."""
    file = mapping_file(path, mapping)
    others = [part for part in parts_of(path, rules) if part != path]
    more = [{"file": str(part), "sha256": sha256(part)} for part in others]
    return ({"others": more} if more else {}) | {
        "sha256": sha256(path),
        "mapping": None if file is None else {"file": str(file), "sha256": sha256(file)},
    }


@contextmanager
def _told(name: str) -> Iterator[list[Remark]]:
    """What readers find odd about a record, once each, without its name; filled when the block ends."""
    said: list[Remark] = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RecordWarning)
        yield said
    for one in (w.message.args[0] for w in caught if isinstance(w.message, RecordWarning)):
        odd = one if isinstance(one, Remark) else Remark(one)
        parts = (odd.template, *odd.of)
        nameless = [p.removeprefix(f"{name}: ") if isinstance(p, str) else p for p in parts]
        remark = Remark(*nameless, doubts=odd.doubts, spares=odd.spares)
        if remark not in said:
            said.append(remark)
