"""The input of an identification: records are read, and options are checked."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

from ..arguments import flag, one_of, whole
from ..findings.finding import Finding
from ..findings.words import sentence
from ..law.law import law_of
from ..project.options import IN_TIME, IN_WORDS, OPTIONS, Option, asked
from ..records.coordinate import TRANSLATION
from ..records.mapping import MappingLike
from ..records.measured import as_records, require_different
from ..records.quantities import quantity, read_quantity, with_error
from ..records.record import Record
from .loading import levels_of

if TYPE_CHECKING:
    from ..records.measured import ReaderOfTables, RecordLike
    from .result import Result


_READERS: Mapping[str, Callable[[Option, Any], Any]] = {
    "flag": lambda of, value: flag(of.name, value),
    "whole": lambda of, value: whole(of.name, value, of.bounds),
    "number": lambda of, value: quantity(of.name, value, of.bounds),
    "stated": lambda of, value: with_error(of.name, value, of.bounds, of.uncertainty),
    "path": lambda _, value: str(value) if isinstance(value, str | Path) else None,
    "names": lambda _, value: list(value),
    "coefficients": lambda _, value: dict(value),
    "labels": lambda _, value: {symbol: list(labels) for symbol, labels in value.items()},
    "choice": lambda of, value: one_of(of.name, value, get_args(of.type)),
}
"""Form of the value of an option → its reader, for one that is not None."""


def with_stiffness_by_mass(
    identified: Callable[[Mapping[str, Any]], Result[Any]],
    options: Mapping[str, Any],
    *further: Callable[[Mapping[str, Any]], Result[Any]],
) -> tuple[dict[str, Any], float]:
    """Return the stiffness k, N/m, that follows from the stated mass and the records, and the options with its standard
    uncertainty.

    Scaling m, c, k, K_z and F_k by one factor leaves the motion unchanged. If an identification with any stiffness k₀
    gives the mass m̂, then k = k₀ m/m̂.

    identified : the identification with other options.
    further : identifications that start from that k, such as those with given coefficients, which are true for the true
    k only.

    Raises ValueError if the records determine no mass, or a channel has a wrong unit.
    """
    # k₀/m = 1000 rad²/s², a natural frequency of 5 Hz
    mass, k = options["mass_kg"], options["mass_kg"] * 1e3
    for one in (identified, *further):
        found = one({**options, "stiffness_N_per_m": k, "mass_kg": None, "laws": False})
        unknown = [Finding("no natural frequency")] * math.isnan(found.mass)
        # a channel in a wrong unit gives a wrong frequency
        if why := [one for one in found.odd if one.code == "misread"] or unknown:
            raise ValueError(sentence(why[0], found.coordinate))
        k *= mass / found.mass
    error = math.hypot(options["mass_standard_error_kg"] / mass, found.mass_error / found.mass)
    return {**options, "stiffness_standard_error_N_per_m": k * error}, k


def read_options(kind: str, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return all options of a kind of records, checked, by the keys of a configuration.

    options : by their names.

    Raises TypeError for an unknown name, ValueError for an option that does not apply, for a wrong value, and if both
    stiffness and mass are missing.
    """
    given = asked(kind, options)
    if kind in IN_TIME and not {"stiffness", "mass"} & given.keys():
        kind_in_words = Finding("no stiffness", {"kind": IN_WORDS[kind]})
        raise ValueError(sentence(kind_in_words, TRANSLATION))
    law = law_of(*map(given.get, ("terms", "given", "groups")))
    given |= {"terms": law.terms, "given": law.given, "groups": law.groups}
    read: dict[str, Any] = {"kind": kind}
    for option in OPTIONS.values():
        if kind in option.kinds:
            value = given.get(option.name, option.default)
            if value is not None:
                value = _READERS[option.form](option, value)
            if option.error_key:
                value, read[option.error_key] = value or (None, None)
            read[option.key] = value
    return read


def read_request(
    kind: str,
    records: RecordLike | Sequence[RecordLike],
    mapping: MappingLike,
    options: Mapping[str, Any],
    reader: ReaderOfTables | None = None,
) -> tuple[tuple[Record, ...], dict[str, Any]]:
    """Return the records of one kind, one for each level of excitation, and all options as `read_options` does.

    reader : of tables of a stepped sine, as for `as_records`.

    Raises ValueError like `read_options` and `require_different`, for tables of a stepped sine among other records, for
    records without times where these are needed, and for units of a translation with records of a rotation, or the
    reverse.
    """
    asked_for = read_options(kind, {**options, "mapping": mapping})
    read = as_records(records, mapping=mapping, kind=kind, reader=reader)
    require_different(read)
    if kind in IN_TIME and (bare := [record.name for record in read if not record.timed]):
        raise ValueError(
            f"{bare[0]} has no times, which {IN_WORDS[kind]} need: give a column of them, or their rate"
        )
    tables = kind == "stepped-sine"
    for record in read:
        if bool(record.channels) == tables:
            is_it = "no" if tables else "a"
            others = "forced records or free decays" if tables else IN_WORDS["stepped-sine"]
            raise ValueError(
                f"{record.name} is {is_it} table of a stepped sine: identify it separately, as {others}"
            )
    for name in ("stiffness", "mass"):
        value, option, of_unit = options.get(name), OPTIONS[name], None
        if isinstance(value, str):
            of_unit = read_quantity(name, value, option.bounds).coordinate
        if of_unit not in (None, read[0].coordinate):
            unit = read[0].coordinate.unit(option.unit)
            raise ValueError(
                f"{name} = {value} does not fit {read[0].name}, a {read[0].coordinate.name}: give it in a unit such as "
                f"{unit}"
            )
    levels = tuple(itertools.chain(*map(levels_of, read))) if kind == "forced" else read
    return levels, asked_for
