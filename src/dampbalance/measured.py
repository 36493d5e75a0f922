"""Identify damping and contact from measured records of any kind, or a configured set of them: `identify`."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, Literal, get_args

from .arguments import one_of, shown
from .findings.finding import Finding
from .identification.decays import identify_decays
from .identification.forced import identify_forced
from .identification.identified import Identified
from .identification.loading import keeps_moving
from .identification.request import IN_WORDS, Stated
from .joints.answer import identify_joint as identify_joint
from .joints.records import read_lines
from .joints.records import recognised_as_table as recognised_as_table
from .loops.answer import identify_loops as identify_loops
from .project.wording import listed
from .records.channel import ACCOMPANYING
from .records.mapping import MappingLike
from .records.measured import as_records
from .records.record import Record

if TYPE_CHECKING:
    from .records.measured import RecordLike

Kind = Literal["recognised", "forced", "ring-down", "stepped-sine", "loops"]
"""Kind of records: as they are recognised, forced, free decays, tables of steady responses to a stepped sine, or loops
of force against the displacement of a contact."""

WAYS: Mapping[str, Callable[..., Identified]] = {
    "forced": identify_forced,
    "ring-down": identify_decays,
    "stepped-sine": identify_joint,
    "loops": identify_loops,
}
"""The function that identifies each kind of records; its signature says which options apply."""

OPTIONS = {kind: inspect.signature(way).parameters for kind, way in WAYS.items()}
"""Kind of records → name of an argument → its parameter."""


def read_records(
    records: RecordLike | Sequence[RecordLike],
    *,
    mapping: MappingLike = None,
    tables: bool | None = None,
    free: bool = False,
) -> tuple[Record, ...]:
    """Return measured records, ready for `identify`: from files, tables of pandas, or arrays.

    records : one, or several. Each is the path of a file in any format (`config/records/README.md`); a pandas
    DataFrame; a mapping of names to arrays; an array with named fields, or a plain one of columns; a `Table`, as
    `records.readers.table` makes it; or a `Record`, of channels or already read. Columns and arrays are named like
    those of a file, displacement_mm or force_N, with time_s among them, or sample_rate_hz as a number. A masked sample
    is missing, as an empty cell of a file is.
    mapping : what the names do not say, for all records: a document as in the YAML file of a record, or the path of
    one; default, for a file, the one next to it.
    tables : whether they are tables of steady responses to a stepped sine (frequency, amplitudes, phase); default,
    those that have columns of frequency and phase and none of times.   free : whether they are known to be free decays,
    so that no channel that nothing names, and no unit of a drive, is in the way.

    A record in memory is called "record 1" by its place, or as `name` in the `attrs` of its table says.

    Raises RecordError (a ValueError) naming record, key and remedy: a channel that is missing or unclear, a wrong unit,
    times that do not increase or have a long gap, more than a few values that are missing, one that is infinite, a
    constant channel. Warns of samples that are left out.

    >>> import numpy as np
    >>> from dampbalance import read_records
    >>> t = np.arange(0.0, 2.0, 1e-3)
    >>> base, mass = 4.0 * np.cos(22.0 * t), 2.0 * np.sin(22.0 * t)
    >>> (record,) = read_records({"time_s": t, "base_displacement_mm": base, "displacement_mm": mass})
    >>> record
    <record record 1: base_displacement and displacement; 2,000 samples from 0 s to 1.999 s at 1000 Hz>
    >>> float(record["base_displacement"].values[0])  # m
    0.004
    """
    reader = None if tables is False else partial(read_lines, stated=bool(tables))
    return as_records(records, mapping=mapping, free=free, reader=reader)


def identify(
    records: RecordLike | Sequence[RecordLike],
    stiffness: Stated | None = None,
    *,
    mapping: MappingLike = None,
    kind: Kind = "recognised",
    **options: Any,
) -> Identified:
    """Identify the coefficients of a damping law and the contact stiffness K_z from measured records, with intervals.

    The records are recognised and handed over: forced records to `identify_forced`, free decays to `identify_decays`,
    tables of a stepped sine to `identify_joint`, measured loops to `identify_loops`. Their signatures are the options
    that apply.

    records : as `read_records` returns or takes them: files, tables of pandas, arrays; all of one kind.
    stiffness : k, N/m (N m/rad of a rotation), alone or with its standard uncertainty, (2310.0, 10.0); it scales F_k
    and c. Only tables of responses to a force and measured loops do without.
    mapping : what the records do not say of their channels, where they are read here.
    kind : "forced", "ring-down", "stepped-sine" or "loops", where it is not to be recognised: tables by their columns
    of frequency and phase, measured loops by force and displacement or velocity where neither stiffness nor mass is
    given, forced records by an excitation channel that keeps moving.
    options : of the function for the kind. One at its default may be given for any kind.

    Raises ValueError (for a record, `RecordError`) naming argument or record, what is wrong and the remedy: an option
    that does not apply to the kind, records of several kinds, and what the function for the kind refuses.

    >>> from dampbalance import Oscillator, identify, measured_ring_down
    >>> osc = Oscillator(m=2.42, c=1.0, k=2310.0, K_z=20800.0, F_k=0.5)
    >>> decay = measured_ring_down(osc, x=0.01, rate_hz=500.0, duration=2.0, noise=0.001)
    >>> found = identify(decay, stiffness=2310.0)  # as `identify_decays` does
    >>> round(found.values["F_k"], 2), round(found.mass, 2), round(found.natural_frequency, 2)
    (0.5, 2.42, 4.92)
    >>> identify(decay, stiffness=2310.0, frequency=3.5)
    Traceback (most recent call last):
    ValueError: frequency = 3.5 is for forced records, and these are free decays: leave it out
    """
    one_of("kind", kind, get_args(Kind))
    recognised = kind == "recognised"
    defaults = {name: of.default for each in OPTIONS.values() for name, of in each.items()}
    if unknown := sorted(options.keys() - defaults.keys()):
        raise TypeError(f"identify() got an unexpected keyword argument {unknown[0]!r}")
    if recognised:
        records = read_records(records, mapping=mapping)
        if not all(record.channels for record in records):
            kind = "stepped-sine"
        elif stiffness is None and options.get("mass") is None and all(map(_is_loop, records)):
            kind = "loops"
        else:
            kind = "forced" if all(map(keeps_moving, records)) else "ring-down"
    asked = {name: value for name, value in options.items() if value is not defaults[name]}
    for name, value in asked.items():
        if words := _misplaced(kind, name):
            raise ValueError(f"{name} = {shown(value)} {words}")
    found = WAYS[kind](records, stiffness, mapping=mapping, **asked)
    if recognised and kind == "loops":
        found = replace(found, rig=[found.rig[0], Finding("taken for loops"), *found.rig[1:]])
    return found


def _is_loop(record: Record) -> bool:
    """Return whether a record holds a force and a displacement or velocity that keep moving, and nothing else but a
    normal force."""
    moving = {*record.quantities} - {*ACCOMPANYING, "force"}
    return moving in ({"displacement"}, {"velocity"}) and keeps_moving(record)


def _misplaced(kind: str, name: str) -> str:
    """Return the reason why an argument does not apply to a kind of records; empty where it does."""
    if name in OPTIONS[kind]:
        return ""
    kinds = [IN_WORDS[other] for other, parameters in OPTIONS.items() if name in parameters]
    return f"is for {listed(kinds, 'or')}, and these are {IN_WORDS[kind]}: leave it out"


# --- a set of records in a configuration ----------------------------------------------------------

_ARGUMENTS = {
    **dict.fromkeys(("stiffness_N_per_m", "stiffness_standard_error_N_per_m"), "stiffness"),
    **dict.fromkeys(("mass_kg", "mass_standard_error_kg"), "mass"),
    "frequency_hz": "frequency",
    "fixture_mass_kg": "fixture_mass",
    "normal_force_N": "normal_force",
    "fixture_stiffness_N_per_m": "fixture_stiffness",
}
"""Key of a configuration → argument, where their names differ."""

_UNCERTAINTIES = {
    "stiffness_standard_error_N_per_m": "stiffness_N_per_m",
    "mass_standard_error_kg": "mass_kg",
}
"""Key of a standard uncertainty → key of the number that has it."""


def not_taken(settings: Mapping[str, Any]) -> dict[str, str]:
    """Return what is wrong with a set of records in a configuration, by its keys: those that do not apply to its kind,
    and a stiffness that is missing."""
    kind, k = settings.get("kind", "forced"), "stiffness_N_per_m"
    keys = [key for key, value in settings.items() if value is not None and key not in _OF_SET]
    wrong = {key: words for key in keys if (words := _misplaced(kind, _ARGUMENTS.get(key, key)))}
    for error, of in _UNCERTAINTIES.items():
        if error in keys and of not in keys:
            wrong[error] = (
                f"has no effect without {of}, whose uncertainty it is: add that, or leave it out"
            )
        elif error in keys and not settings[error] < settings[of]:
            wrong[error] = f"must be below {of} = {settings[of]:g}: correct one of them"
    if k not in keys and "mass_kg" not in keys and kind not in ("stepped-sine", "loops"):
        wrong[k] = f"is missing: {IN_WORDS[kind]} need it, or the mass; add it"
    return wrong


_OF_SET = ("name", "records", "kind")


def configured(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return the arguments of `identify` that a set of records in a configuration states, except the records; they are
    forced unless it states another kind."""
    stated = {key: of for key, of in settings.items() if of is not None and key not in _OF_SET}
    errors = {_UNCERTAINTIES[key]: stated.pop(key) for key in _UNCERTAINTIES.keys() & stated.keys()}
    stated |= {key: (stated[key], error) for key, error in errors.items()}
    arguments = {_ARGUMENTS.get(key, key): of for key, of in stated.items()}
    return {"kind": settings.get("kind", "forced")} | arguments
