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
from .project.wording import did_you_mean
from .records.channel import ACCOMPANYING
from .records.mapping import MappingLike
from .records.measured import as_records
from .records.record import Record
from .records.stepped_sine import read_lines

if TYPE_CHECKING:
    from .records.measured import RecordLike

Kind = Literal["recognised", "forced", "ring-down", "stepped-sine", "loops", "friction-speed"]
"""Kind of records: recognised from the records, forced, free decays ("ring-down"), tables of steady responses to a
stepped sine, loops of force against the displacement of a contact, or friction at steady speeds."""

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
    """Read measured records from files, pandas tables or arrays, check them, and return them in SI units.

    `identify` reads records by itself. Use this function to look at the channels first, or to identify the same records
    several times without reading them again.

    records : one, or several. Each is the path of a file in any format (`config/records/README.md`), or of a folder of
    them; a pandas DataFrame; a mapping of names to arrays; an array with named fields, or a plain one of columns; a
    `Table`, as `records.readers.table` makes it; or a `Record`, of channels or already read. Columns and arrays are
    named like those of a file, displacement_mm or force_N, with time_s among them, or sample_rate_hz as a number. A
    masked sample counts as missing, like an empty cell of a file.
    mapping : the meaning of channels whose names do not give it, for all records: a document as in the YAML file of a
    record, or the path of one; by default, for a file, the one next to it.
    tables : whether these are tables of steady responses to a stepped sine (frequency, amplitudes, phase); by default,
    those with columns of frequency and phase and none of times.
    free : whether these are free decays; then unnamed channels and the unit of an excitation channel are not errors.

    A record in memory is called "record 1" by its place, or by `name` in the `attrs` of its table.

    Raises RecordError (a ValueError) naming record, key and remedy: for a missing or ambiguous channel, a wrong unit,
    times that do not increase or have a long gap, more than a few missing values, an infinite value or a constant
    channel. Warns of samples that are left out.

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

    Use it for records of any kind. It recognises the kind and calls the function for it: `identify_forced` for forced
    records, `identify_decays` for free decays, `identify_joint` for tables of a stepped sine, `identify_loops` for
    measured loops, `identify_friction_speed` for tables of friction at steady speeds. Their signatures show which
    options apply to a kind; an option at its default is accepted for every kind.

    records : as `read_records` takes or returns them: files, pandas tables or arrays, all of one kind.
    stiffness : k, N/m (N m/rad of a rotation), alone, with its standard uncertainty, (2310.0, 10.0), or as a text with
    its unit, "2.31 ± 0.01 N/mm". Measure it statically and state its uncertainty, as all results scale with it. Forced
    records and free decays need it or the mass; tables of responses to a force, measured loops and steady speeds do
    not.
    mapping : the meaning of channels whose names do not give it, see `read_records`.
    kind : "forced", "ring-down" (free decays), "stepped-sine", "loops" or "friction-speed". State it if the records are
    taken for another kind. By default, tables are recognised by their columns, of frequency and phase, or of velocity
    and force in both directions without times; measured loops by a force and a displacement or velocity without
    stiffness or mass; and forced records by an excitation channel that keeps moving.
    The options of the signature, which `help` describes.

    Raises ValueError (for a record, `RecordError`) naming argument or record, what is wrong and the remedy: for an
    option that does not apply to the kind, for records of several kinds, and where the function for the kind does.

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
    one_of("kind", kind, get_args(Kind), did_you_mean(kind, get_args(Kind)))
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
        found = replace(found, check=[*found.check, Finding("taken for loops")])
    return found


def _is_loop(record: Record) -> bool:
    """Return whether a record has a force and a displacement or velocity that keep moving, and no other channel except
    a normal force."""
    moving = {*record.quantities} - {*ACCOMPANYING, "force"}
    known = "force" in record.quantities and moving <= {"displacement", "velocity"}
    return bool(known and moving) and keeps_moving(record)
