"""Identify damping and contact from measured records of any kind: `identify`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, Literal, Never, get_args

from .arguments import one_of
from .findings.finding import Finding
from .identification.decays import identify_decays
from .identification.forced import identify_forced
from .identification.friction_speed import identify_friction_speed
from .identification.loading import keeps_moving
from .identification.loops import identify_loops
from .identification.result import Result
from .identification.stepped_sine import identify_joint as identify_joint
from .project.options import Stated, asked, options_of, with_options
from .records.channel import ACCOMPANYING
from .records.mapping import MappingLike
from .records.measured import as_records
from .records.record import Record
from .records.stepped_sine import read_lines

if TYPE_CHECKING:
    from .records.measured import RecordLike

Kind = Literal["recognised", "forced", "ring-down", "stepped-sine", "loops", "friction-speed"]
"""Kind of records: as they are recognised, forced, free decays, tables of steady responses to a stepped sine, loops of
force against the displacement of a contact, or friction at steady speeds."""

WAYS: Mapping[str, Callable[..., Result[Any]]] = {
    "forced": identify_forced,
    "ring-down": identify_decays,
    "stepped-sine": identify_joint,
    "loops": identify_loops,
    "friction-speed": identify_friction_speed,
}
"""The function that identifies each kind of records."""


def read_records(
    records: RecordLike | Sequence[RecordLike],
    *,
    mapping: MappingLike = None,
    tables: bool | None = None,
    free: bool = False,
) -> tuple[Record, ...]:
    """Return measured records, ready for `identify`: from files, tables of pandas, or arrays.

    records : one, or several. Each is the path of a file in any format (`config/records/README.md`), or of a folder of
    them; a pandas DataFrame; a mapping of names to arrays; an array with named fields, or a plain one of columns; a
    `Table`, as `records.readers.table` makes it; or a `Record`, of channels or already read. Columns and arrays are
    named like those of a file, displacement_mm or force_N, with time_s among them, or sample_rate_hz as a number. A
    masked sample is missing, as an empty cell of a file is.
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
    kind = "ring-down" if free else ""
    return as_records(records, mapping=mapping, kind=kind, reader=reader)


@with_options
def identify(
    records: RecordLike | Sequence[RecordLike],
    stiffness: Stated | None = None,
    *,
    mapping: MappingLike = None,
    kind: Kind = "recognised",
    mass: Stated | None = None,
    frequency: float | str | None = None,
    groups: Mapping[str, Sequence[str] | str] | None = None,
    contact_to: Literal["ground", "base"] = "ground",
    fixture_mass: float | str | None = None,
    skip_cycles: int = 0,
    laws: bool = False,
    terms: Sequence[str] | str | None = None,
    given: Mapping[str, float] | None = None,
    pendulum: bool = False,
    contact: Literal["both", "one slider", "gradual"] = "both",
    hardening: bool = True,
    residual: bool = False,
    normal_force: Stated | None = None,
    fixture_stiffness: float | str | None = None,
    backlash: bool = True,
    **unknown: Never,
) -> Result[Any]:
    """Identify the coefficients of a damping law and the contact stiffness K_z from measured records, with intervals.

    The records are recognised and handed over: forced records to `identify_forced`, free decays to `identify_decays`,
    tables of a stepped sine to `identify_joint`, measured loops to `identify_loops`, tables of friction at steady
    speeds to `identify_friction_speed`. Their signatures are the options that apply; one at its default may be given
    for any kind.

    records : as `read_records` returns or takes them: files, tables of pandas, arrays; all of one kind.
    stiffness : k, N/m (N m/rad of a rotation), alone or with its standard uncertainty, (2310.0, 10.0), or a text
    with its unit, "2.31 ± 0.01 N/mm"; it scales F_k and c. Only tables of responses to a force, measured loops and
    steady speeds do without.
    mapping : what the records do not say of their channels, where they are read here.
    kind : "forced", "ring-down", "stepped-sine", "loops" or "friction-speed", where it is not to be recognised:
    tables by their columns of frequency and phase, or of velocity and force in both directions without times; measured
    loops by force and displacement or velocity where neither stiffness nor mass is given, forced records by an
    excitation channel that keeps moving.
    The options of the signature, which `help` describes.

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
    options = asked(kind, options_of(locals()))
    if recognised:
        records = read_records(records, mapping=mapping)
        if not all(record.channels for record in records):
            kind = "stepped-sine"
        elif records and not any(one.timed or "displacement" in one for one in records):
            kind = "friction-speed"
        elif not {"stiffness", "mass"} & options.keys() and all(map(_is_loop, records)):
            kind = "loops"
        else:
            kind = "forced" if all(map(keeps_moving, records)) else "ring-down"
    found = WAYS[kind](records, **options)
    if recognised and kind == "loops":
        found = replace(found, check=[*(found.check or ()), Finding("taken for loops")])
    return found


def _is_loop(record: Record) -> bool:
    """Return whether a record holds a force and a displacement or velocity, or both, that keep moving, and nothing else
    but a normal force."""
    moving = {*record.quantities} - {*ACCOMPANYING, "force"}
    known = "force" in record.quantities and moving <= {"displacement", "velocity"}
    return bool(known and moving) and keeps_moving(record)
