"""The interface for measured records, of steady responses or free decays, and tables of responses: `identify`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args

from .arguments import flag, mass_with_error, number, one_of, whole, with_error
from .balance import TERMS, checks
from .identification.decays import identify_ring_downs
from .identification.forced import identify_readings
from .identification.identified import QUICK, Identified
from .identification.law_comparison import compare_laws
from .identification.loading import Loaded, NotDriven, load
from .identification.stated import with_stated_uncertainties
from .joints.answer import Asked, identify_joint
from .joints.records import SteppedRecord, read_lines
from .joints.records import recognised_as_table as recognised_as_table
from .law.law import Law, law_of
from .motion.jit import interpreted
from .project.wording import listed
from .records.mapping import MappingLike
from .records.measured import MeasuredRecord, as_records, require_different

if TYPE_CHECKING:
    from .records.measured import RecordLike

Kind = Literal["recognised", "forced", "ring-down", "stepped-sine"]
"""Kind of records: as the first of them is recognised, forced, free decays, or tables of steady responses."""

# of the free oscillator in a cycle of the drive, or cycles in a swing; beyond that a unit is wrong
_MOST_SWINGS = 1000.0


def read_records(
    records: RecordLike | Sequence[RecordLike],
    *,
    mapping: MappingLike = None,
    tables: bool | None = None,
    free: bool = False,
) -> tuple[MeasuredRecord, ...]:
    """Measured records, ready for `identify`: from files, tables of pandas, or arrays.

    records : one, or several. Each is the path of a file in any format (`config/records/README.md`); a pandas
    DataFrame; a mapping of names to arrays, (n,), or an array with named fields; a `Measurement`; or a record already
    read. Columns and arrays are named like those of a file, displacement_mm or force_N, with time_s among them, or
    sample_rate_hz as a number. A masked sample is missing, as an empty cell of a file is.
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
    reader = None if tables is False else partial(read_lines, stated=bool(tables))
    return as_records(records, mapping=mapping, free=free, reader=reader)


def identify(
    records: RecordLike | Sequence[RecordLike],
    stiffness: float | tuple[float, float] | str | None = None,
    *,
    mapping: MappingLike = None,
    kind: Kind = "recognised",
    frequency: float | None = None,
    mass: float | tuple[float, float] | str | None = None,
    terms: Sequence[str] | str | None = None,
    given: Mapping[str, float] | None = None,
    groups: Mapping[str, Sequence[str] | str] | None = None,
    laws: bool = False,
    contact: Asked = "both",
    hardening: bool = True,
    residual: bool = False,
    approaches: Sequence[str] | str | None = None,
    skip_cycles: int = 0,
) -> Identified:
    """The coefficients of a damping law and the contact stiffness K_z from measured records, each with an interval.

    Each steady response, and each half cycle of a free decay, gives a row a F_k + b c = W of the energy balance (Eq. 6
    of the paper), weighted by inverse variance. The answer is the maximum-likelihood fit of one oscillator to all
    records, with the balance as its check, and the balance itself where the records are not those of such an
    oscillator.

    records : as `read_records` returns or takes them: files, tables of pandas, arrays. Forced records: one for each
    level of excitation, at least as many as there are coefficients; more levels, far apart, sharpen all of them. Free
    decays: one is enough. Tables of a stepped sine: two levels at least, in one or several.
    stiffness : k of the spring, N/m; it scales F_k and c. Tables of responses to a force do without. With its standard
    uncertainty, (2310.0, 10.0) or "2310±10", which the intervals then hold, as they do those of gains and delays that a
    mapping states. Without, they are conditional on k.
    mapping : what the records do not say of their channels, where they are read here.
    kind : "forced", "ring-down" or "stepped-sine" (tables of frequency, amplitudes and phase, a line for each steady
    response), where it is not to be recognised.
    frequency : of the drive as known, Hz; compared with that found in each record.
    mass : kg, if it is known: it tests the stiffness and the gains, and sharpens K_z where it is known better than the
    records know it. State its standard uncertainty like that of the stiffness, (2.42, 0.01) or "2.42±0.01"; of a mass
    alone it is half a unit of the last digit ("2.420" keeps its zero) or 0.5 %, whichever is more.
    terms : of the damping law, symbols of `KNOWN_TERMS` and objects of `Term`; default, F_k, c and those that are
    given.
    given : symbol → known coefficient, SI units.
    groups : symbol → a label for each record, where each group of records has its own coefficient.
    laws : whether to compare all laws of one or two terms, with and without friction, too.
    contact : of a stepped sine: "one slider", that of the paper, "gradual", many that slip one after the other as the
    interface of a bolted joint does, or "both", of which the one that the lines support is the answer.
    hardening : of a stepped sine: whether the spring may stiffen with the amplitude.
    residual : of a stepped sine: whether other modes may move the driven point, too. Use it for a structure.
    approaches : names of `balance.checks()`, which are the default, and objects of `Approach` that take no phase.
    "direct" assumes no shape of x(t), "fourier" takes three harmonics of it.
    skip_cycles : left out at the start of each record, where the motion has not settled.

    Free decays determine F_k, c and K_z only, and take stiffness, mass, laws and mapping; tables of a stepped
    sine take stiffness, mass, terms, given, contact, hardening, residual and mapping. Names
    and labels in order (terms, approaches, those of groups) may be a text with commas between them, as on the command
    line: terms="F_k,c".

    Raises ValueError (for a record, `RecordError`) naming argument or record, what is wrong and the remedy: an argument
    that is outside its range or of another kind, a record that cannot be used, records of both kinds, fewer of them
    than unknowns.

    >>> import math
    >>> from dampbalance import BaseMotion, Oscillator, identify, measured_orbit, steady_orbit
    >>> osc = Oscillator(m=2.42, c=90.0, k=2310.0, K_z=208000.0, F_k=1.28)
    >>> motions = [BaseMotion(Y=Y, omega=2 * math.pi * 3.5) for Y in (0.004, 0.008, 0.012)]
    >>> records = [
    ...     measured_orbit(steady_orbit(osc, motion), rate_hz=1000.0, cycles=20.0, noise=0.01, seed=i)
    ...     for i, motion in enumerate(motions)
    ... ]
    >>> found = identify(records, stiffness=2310.0)
    >>> {symbol: round(value, 1) for symbol, value in found.values.items() if symbol != "K_z"}
    {'F_k': 1.3, 'c': 90.0}
    >>> low, high = found.intervals["c"]
    >>> bool(low < osc.c < high)
    True
    >>> found.verdicts["F_k"].verdict
    'usable'
    """
    one_of("kind", kind, get_args(Kind))
    one_of("contact", contact, get_args(Asked))
    hardening, residual = flag("hardening", hardening), flag("residual", residual)
    laws = flag("laws", laws)
    frequency = None if frequency is None else number("frequency", frequency)
    m, m_error = (None, None) if mass is None else mass_with_error(mass)
    skip_cycles = whole("skip_cycles", skip_cycles)
    ways = checks(approaches)
    law = law_of(terms, given, groups)
    of_kind = {"recognised": None, "stepped-sine": True}.get(kind, False)
    free = kind == "ring-down"
    read = read_records(records, mapping=mapping, tables=of_kind, free=free)
    require_different(read)
    lines = [one.name for one in read if isinstance(one, SteppedRecord)]
    if lines and kind not in ("recognised", "stepped-sine"):
        raise ValueError(f"{lines[0]} is a table of a stepped sine: leave out kind = {kind!r}")
    of_joint = bool(lines) or kind == "stepped-sine"
    k, error = (None, 0.0) if of_joint and stiffness is None else with_error("stiffness", stiffness)
    options: dict[str, Any] = {
        "stiffness_N_per_m": k,
        "stiffness_standard_error_N_per_m": error,
        "frequency_hz": frequency,
        "mass_kg": m,
        "mass_standard_error_kg": m_error,
        "terms": list(law.terms),
        "given": dict(law.given),
        "groups": {symbol: list(labels) for symbol, labels in law.groups.items()},
        "laws": laws,
        "contact": contact,
        "hardening": hardening,
        "residual": residual,
        "approaches": list(ways),
        "mapping": str(mapping) if isinstance(mapping, str | Path) else None,
        "skip_cycles": skip_cycles,
    }
    if of_joint:
        _taken("stepped-sine", options)
        return identify_joint(
            read,
            stiffness,
            mapping=mapping,
            mass=mass,
            terms=terms,
            given=given,
            contact=contact,
            hardening=hardening,
            residual=residual,
        )
    try:
        if kind != "ring-down":
            return _of_steady(read, law, _taken("forced", options))
    except NotDriven:
        if kind == "forced":
            raise
    return _of_decays(read, _taken("ring-down", options))


_OF_K_AND_M = (
    *("stiffness_N_per_m", "stiffness_standard_error_N_per_m"),
    *("mass_kg", "mass_standard_error_kg"),
)
_OF_LAW = ("terms", "given")
_OF_CONTACT = ("contact", "hardening", "residual")
_OPTIONS = {
    "forced": (
        *(*_OF_K_AND_M, "frequency_hz"),
        *(*_OF_LAW, "groups", "laws", "approaches", "mapping", "skip_cycles"),
    ),
    "ring-down": (*_OF_K_AND_M, "laws", "mapping"),
    "stepped-sine": (*_OF_K_AND_M, *_OF_LAW, *_OF_CONTACT, "mapping"),
}
"""Options that each kind of records takes, in the order of its document."""

_DEFAULTS: dict[str, object] = {
    "frequency_hz": None,
    "skip_cycles": 0,
    "approaches": list(checks()),
    "terms": list(TERMS),
    "given": {},
    "groups": {},
    "laws": False,
    "contact": "both",
    "hardening": True,
    "residual": False,
}
"""Defaults of the options that not every kind takes."""

_IN_WORDS = {
    "forced": "forced records",
    "ring-down": "free decays",
    "stepped-sine": "tables of a stepped sine",
}
_CONFIGURED = {"stiffness_N_per_m": "stiffness", "mass_kg": "mass", "frequency_hz": "frequency"}
_OF_THE_WORKFLOW = ("name", "records")


def _taken(kind: str, options: Mapping[str, Any]) -> dict[str, Any]:
    """The options of a kind of records. Raises ValueError for one that it does not take and that is not the default."""
    for name, default in _DEFAULTS.items():
        if name not in _OPTIONS[kind] and options[name] != default:
            what = f"{_CONFIGURED.get(name, name)} = {options[name]!r}"
            raise ValueError(f"{what} {_misplaced(kind, name)}")
    stated = {} if kind == "forced" else {"kind": kind}
    return stated | {name: options[name] for name in _OPTIONS[kind]}


def _misplaced(kind: str, name: str) -> str:
    """What is said of an option that a kind of records does not take."""
    takers = [words for other, words in _IN_WORDS.items() if name in _OPTIONS[other]]
    return f"is for {listed(takers, 'or')}, and these are {_IN_WORDS[kind]}: leave it out"


def not_taken(settings: Mapping[str, Any]) -> dict[str, str]:
    """What is wrong with a set of records in a configuration, by its keys: those that mean nothing for its kind."""
    kind = settings.get("kind", "forced")
    taken = (*_OF_THE_WORKFLOW, "kind", *_OPTIONS[kind])
    odd = {
        key: _misplaced(kind, key)
        for key, of in settings.items()
        if of is not None and key not in taken
    }
    needed = "stiffness_N_per_m"
    lacks = kind != "stepped-sine" and settings.get(needed) is None
    return odd | ({needed: f"is missing: {_IN_WORDS[kind]} need it; add it"} if lacks else {})


def configured(settings: Mapping[str, Any]) -> dict[str, Any]:
    """The arguments of `identify` that a set of records in a configuration states, except the records; they are forced
    unless it states another kind."""
    arguments = {
        _CONFIGURED.get(key, key): value
        for key, value in settings.items()
        if value is not None and key not in _OF_THE_WORKFLOW
    }
    error = arguments.pop("stiffness_standard_error_N_per_m", 0.0)
    if "stiffness" in arguments:
        arguments["stiffness"] = arguments["stiffness"], error
    if "mass_standard_error_kg" in arguments:
        arguments["mass"] = arguments["mass"], arguments.pop("mass_standard_error_kg")
    return {"kind": "forced"} | arguments


@interpreted(calls=QUICK)  # whatever was compiled before: the last bits may differ
def _of_steady(
    records: tuple[MeasuredRecord, ...], law: Law, options: Mapping[str, Any]
) -> Identified:
    k, error, mass, mass_error = (options[name] for name in _OF_K_AND_M)
    of_drive = {name: options[name] for name in ("frequency_hz", "skip_cycles")}
    loaded = tuple(load(record, k, **of_drive) for record in records)
    _require_possible(loaded, mass, k)
    readings = [one.reading for one in loaded]
    found = identify_readings(
        readings,
        k,
        approaches=options["approaches"],
        mass=mass,
        mass_error=mass_error or 0.0,
        uncertainty=error / k,
        law=law,
    )
    held = mass if found.joint.mass_taken else None
    laws = compare_laws(readings, k, mass=held, law=law) if options["laws"] else None
    return with_stated_uncertainties(
        replace(found, laws=laws, loaded=loaded, records=records, options=options)
    )


@interpreted(False)  # a motion of thousands of samples, hundreds of times
def _of_decays(records: tuple[MeasuredRecord, ...], options: Mapping[str, Any]) -> Identified:
    measurements = [record.whole() for record in records]
    k, error, mass, mass_error = (options[name] for name in _OF_K_AND_M)
    of_mass = {"mass": mass, "mass_error": mass_error or 0.0}
    found = identify_ring_downs(
        measurements, k, uncertainty=error / k, laws=options["laws"], **of_mass
    )
    odd = [words.about(record.name) for record in records for words in record.warnings]
    warnings = (*odd, *found.warnings)
    return with_stated_uncertainties(
        replace(found, warnings=warnings, records=records, options=options)
    )


def _require_possible(loaded: Sequence[Loaded], mass: float | None, k: float) -> None:
    """Raise ValueError for a mass with which the oscillator is a thousand times faster or slower than the drive."""
    if mass is None:
        return
    for one in loaded:
        swings = math.sqrt(k / mass) / one.reading.steady.omega
        if not 1.0 / _MOST_SWINGS < swings < _MOST_SWINGS:
            raise ValueError(
                f"with k = {k:g} N/m and m = {mass:g} kg the oscillator swings {swings:.2g} times in a cycle of "
                f"{one.record.name}: give the mass in kg and the stiffness in N/m, or leave out the mass"
            )
