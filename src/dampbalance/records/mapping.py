"""The mapping of a record: a small YAML file next to it that says which channel holds what, and in which unit.

    channels:
      base_displacement: {channel: Laser 1, unit: mm}
      acceleration: {channel: 3, unit: g, sign: -1}
    sample_rate_hz: 5000

`mapping.schema.yaml` defines the keys; config/records/README.md has examples.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

from ..arguments import Bounds, path
from ..arrays import ReadOnly
from ..project.wording import listed
from .channel import EXCITATIONS, RESPONSES, ROTATING, Correction
from .coordinate import ROTATION, TRANSLATION, Coordinate
from .errors import RecordError
from .quantities import quantity
from .units import table_factor, unit_for

SCHEMA = Path(__file__).parents[1] / "project/schemas/mapping.schema.yaml"
FOLDER_FILE = "channels.yaml"

_FILTERS = ("low_pass", "high_pass")
_CORRECTED = {"gain", "delay", *_FILTERS, "gain_uncertainty", "delay_uncertainty"}

BLANK = "?"
"""Mark in a draft, alone or at the end of a key, where something is to be filled in."""

Which = str | int  # a channel by its name, or by its number counted from 1


@dataclass(frozen=True, slots=True)
class ChannelRule:
    """The channel of a quantity: value in SI = sign · scale · reading · (the unit in SI).

    channel : its name, or its number counted from 1.   unit : of scale · reading; None if the file states it.
    scale : None if the file states it, 1 if it states none and has no volts.   time : its time channel; None for the
    common one.   correction : known effect of the channel; None for none.   file : in which it is, relative to the
    folder of the record; None for the record itself.   standard_error : in a table, the column with the standard error
    of this one, in the same unit.
    """

    channel: Which
    unit: str | None = None
    scale: float | None = None
    sign: int = 1
    time: Which | None = None
    correction: Correction | None = None
    file: str | None = None
    standard_error: Which | None = None
    coordinate: Coordinate = TRANSLATION


@dataclass(frozen=True)
class RecordMapping:
    """Instructions for reading a record; what is None or empty is taken from the file.

    source : file of the mapping.   channels : by quantity.   time, time_unit : the common time channel.
    sample_rate_hz : instead of a time channel.   delimiter ("\\t", "whitespace", …), decimal, header_lines : of a text
    file.   frequency_hz : nominal frequency of the drive.   level : name of the level of excitation.
    table : columns of a table of steady responses, by quantity.   force_N : amplitude of the force at which a response
    given per force was measured.   kind : of the record, as `identify` takes it; "" if unknown.
    """

    source: str = ""
    channels: Mapping[str, ChannelRule] = field(default_factory=lambda: ReadOnly({}))
    time: Which | None = None
    time_unit: str | None = None
    sample_rate_hz: float | None = None
    delimiter: str | None = None
    decimal: str | None = None
    header_lines: int | None = None
    frequency_hz: float | None = None
    level: str | None = None
    notes: str = ""
    table: Mapping[str, ChannelRule] = field(default_factory=lambda: ReadOnly({}))
    force_N: float | None = None
    kind: str = ""

    @property
    def free(self) -> bool:
        """Whether the record is known to be one of free decays."""
        return self.kind == "ring-down"

    @property
    def steady(self) -> bool:
        """Whether its rows are known to be of steady speeds, without times."""
        return self.kind == "friction-speed"


MappingLike = RecordMapping | Mapping[str, Any] | str | Path | None
"""A mapping as an object, a document or a file, or a folder of such files, named as they would be next to the record;
None for the mapping next to the record, if any."""


def find_mapping(record: str | Path) -> Path | None:
    """Return the mapping next to a record: run1.csv.yaml, run1.yaml or channels.yaml, the first that exists."""
    record = Path(record)
    names = (f"{record.name}.yaml", f"{record.stem}.yaml", FOLDER_FILE)
    return next((file for name in names if (file := record.with_name(name)).is_file()), None)


def mapping_for(record: str | Path, mapping: MappingLike = None) -> RecordMapping:
    """Return the given mapping, else the one next to the record, else an empty one. Raises RecordError naming file,
    key and remedy."""
    if isinstance(mapping, RecordMapping | Mapping):
        return mapping if isinstance(mapping, RecordMapping) else mapping_from(mapping)
    if mapping is not None:
        path("mapping", mapping, "what the channels hold, or the path of a file that says it")
    file = mapping_file(record, mapping)
    return RecordMapping() if file is None else read_mapping(file)


def mapping_file(record: str | Path, mapping: MappingLike = None) -> Path | None:
    """Return the file of the mapping of a record, the given one or the one next to the record; None for none.

    mapping : may be a folder of mappings, if that of the records cannot be written.
    """
    if isinstance(mapping, str | Path):
        given = Path(mapping)
        return find_mapping(given / Path(record).name) if given.is_dir() else given
    return find_mapping(record) if mapping is None else None


def parts_of(record: str | Path, mapping: RecordMapping) -> dict[Path, RecordMapping]:
    """Return the files of a record, each with its part of the mapping."""
    record = Path(record)
    files: dict[Path, dict[str, ChannelRule]] = {}
    for of, rule in mapping.channels.items():
        file = record if rule.file is None else record.parent / rule.file
        files.setdefault(file, {})[of] = rule
    if len(files) < 2:
        return dict.fromkeys(files or [record], mapping)
    return {file: replace(mapping, channels=ReadOnly(of)) for file, of in files.items()}


def read_mapping(file: str | Path) -> RecordMapping:
    """Return the mapping of a YAML file. Raises RecordError naming file, key and remedy."""
    from ..project.documents import ConfigurationError, read_yaml

    try:
        document = read_yaml(file)
    except ConfigurationError as error:
        raise RecordError(str(error)) from None
    return mapping_from(document, str(file))


def mapping_from(document: Any, source: str = "mapping") -> RecordMapping:
    """Return the mapping that a document describes. Raises RecordError with a line for each problem: source, key,
    remedy."""
    from ..project.documents import against_schema, in_lines, read_schema

    if blanks := [*_blanks(document)]:
        remedy = "fill them in, or delete the lines of columns that are not needed"
        raise RecordError(f'{source}: blanks, "{BLANK}", are left at {listed(blanks)}: {remedy}')
    problems = against_schema(document, read_schema(SCHEMA))
    problems = problems or list(_contradictions(document))
    if problems:
        raise RecordError(in_lines(problems, {source: document}))
    keys = dict(document)
    channels, time = keys.pop("channels", {}), keys.pop("time", {})
    if "delimiter" in keys:
        keys["delimiter"] = keys["delimiter"].replace("\\t", "\t")
    if "level" in keys:
        keys["level"] = str(keys["level"])
    table = ReadOnly({q: _rule(q, rule) for q, rule in keys.pop("table", {}).items()})
    rules = ReadOnly({ROTATING.get(q, q): _rule(q, rule) for q, rule in channels.items()})
    return RecordMapping(source, rules, time.get("channel"), time.get("unit"), table=table, **keys)


def _blanks(document: Any, above: str = "") -> Iterator[str]:
    """Yield the keys of a draft that are still to be filled in."""
    for key, value in document.items() if isinstance(document, Mapping) else ():
        blank = str(key).endswith(BLANK) or value == BLANK
        yield from [f"{above}{key}"] if blank else _blanks(value, f"{above}{key}.")


def _rule(of: str, stated: Mapping[str, Any]) -> ChannelRule:
    plain = {key: value for key, value in stated.items() if key not in _CORRECTED}
    low, high = (tuple(_poles(stated.get(key, {}))) for key in _FILTERS)
    gain, delay = float(stated.get("gain", 1.0)), _seconds(stated.get("delay", 0.0))
    errors = (_seconds(stated.get(f"{key}_uncertainty", 0.0)) for key in ("gain", "delay"))
    correction = None if plain == stated else Correction(gain, delay, low, high, *errors)
    coordinate = ROTATION if of in ROTATING else TRANSLATION
    return ChannelRule(**plain, correction=correction, coordinate=coordinate)


def _contradictions(document: Mapping[str, Any]) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Yield problems that a schema cannot state: units that do not fit, and channels that cannot go together."""
    channels = document.get("channels", {})
    rules = {(of, q): r for of in ("channels", "table") for q, r in document.get(of, {}).items()}
    for key, rule in (*rules.items(), (("time",), document.get("time", {}))):
        unit = partial(table_factor if key[0] == "table" else unit_for, quantity=key[-1])
        for part, read in (("unit", unit), ("delay", _seconds), ("delay_uncertainty", _seconds)):
            try:
                if part in rule:
                    read(rule[part])
            except ValueError as error:
                yield (*key, part), str(error)
    rotating = [q for q in channels if q in ROTATING]
    if rotating and (others := [q for q in channels if q not in ROTATING]):
        problem = f"holds {rotating[0]} and {others[0]}: a record rotates or moves along a line; keep one kind"
        yield ("channels",), problem
    stated = {ROTATING.get(q, q) for q in channels}
    if channels and (stated.isdisjoint(RESPONSES) or len(stated & {*EXCITATIONS}) > 1):
        needed = f"one of {', '.join(EXCITATIONS)}, or none for a free decay"
        yield ("channels",), f"needs {needed}, and at least one of {', '.join(RESPONSES)}"
    holder: dict[tuple[str | int, str | None], str] = {}
    for of, rule in channels.items():
        other = holder.setdefault((rule["channel"], rule.get("file")), of)
        if other != of:
            problem = f"{rule['channel']!r} is {other} already; a channel holds one quantity"
            yield ("channels", of, "channel"), problem


def _seconds(delay: float | str) -> float:
    return quantity("the delay", delay, Bounds("s", -1e6, 1e6))


def _poles(stated: Mapping[str, Any]) -> Iterator[complex]:
    """Yield the poles of a filter, rad/s."""
    if "corner_hz" in stated:
        order = stated.get("order", 1)
        for j in range(order):
            angle = math.pi * (2 * j + order + 1) / (2 * order)
            yield 2.0 * math.pi * stated["corner_hz"] * cmath.exp(1j * angle)
    for pole in stated.get("poles_rad_per_s", ()):
        p = complex(*pole) if isinstance(pole, list) else complex(pole)
        yield p
        if p.imag:
            yield p.conjugate()
