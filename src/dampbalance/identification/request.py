"""The arguments that every kind of records shares: the records, the stiffness and the mass."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from ..arguments import NUMBERS
from ..findings.finding import Finding
from ..findings.words import sentence
from ..records.coordinate import TRANSLATION
from ..records.mapping import MappingLike
from ..records.measured import as_records, require_different
from ..records.quantities import mass_with_error, read_quantity, with_error
from ..records.record import Record
from .loading import levels_of

if TYPE_CHECKING:
    from ..records.measured import ReaderOfTables, RecordLike
    from .identified import Identified

Stated: TypeAlias = float | tuple[float, float] | str
"""A number in SI, alone or with its standard uncertainty, 2310.0 or (2310.0, 10.0), or a text: "2.31 ± 0.01 N/mm"."""

IN_WORDS = {
    "forced": "forced records",
    "ring-down": "free decays",
    "stepped-sine": "tables of a stepped sine",
    "loops": "measured loops",
}
"""Kinds of records, as messages call them."""


_ANY = 1e3  # k₀/m, rad²/s², of 5 Hz


def with_stiffness_by_mass(
    identified: Callable[[Mapping[str, Any]], Identified],
    options: Mapping[str, Any],
    *further: Callable[[Mapping[str, Any]], Identified],
) -> tuple[dict[str, Any], float]:
    """Return options with the standard uncertainty of the stiffness k that the mass among them and the frequency of
    records give, and k, N/m.

    m, c, k, K_z and F_k times a number are an oscillator of the same motion: the mass m̂ that any stiffness k₀ leads to
    gives k = k₀ m/m̂.

    identified : the identification with other options.   further : identifications that begin with that k, as of
    coefficients that are given: these are known at the true k alone.

    Raises ValueError where the records determine no mass.
    """
    mass, k = options["mass_kg"], options["mass_kg"] * _ANY
    for one in (identified, *further):
        found = one({**options, "stiffness_N_per_m": k, "mass_kg": None, "laws": False})
        if math.isnan(found.mass):
            raise ValueError(sentence(Finding("no natural frequency"), found.coordinate))
        k *= mass / found.mass
    error = math.hypot(options["mass_standard_error_kg"] / mass, found.mass_error / found.mass)
    return {**options, "stiffness_standard_error_N_per_m": k * error}, k


def rig_options(
    stiffness: Stated | None, mass: Stated | None, needed_by: str = ""
) -> dict[str, Any]:
    """Return the stiffness and the mass with their standard uncertainties, by the keys of a configuration.

    needed_by : kind of records that needs the stiffness; none may do without it where this is empty.

    Raises ValueError for a stiffness that is missing with the mass, and for a number that is none.
    """
    if stiffness is None and mass is None and needed_by:
        kind = Finding("no stiffness", {"kind": IN_WORDS[needed_by]})
        raise ValueError(sentence(kind, TRANSLATION))
    k, k_error = (None, 0.0) if stiffness is None else with_error("stiffness", stiffness)
    m, m_error = (None, None) if mass is None else mass_with_error(mass)
    return {
        "stiffness_N_per_m": k,
        "stiffness_standard_error_N_per_m": k_error,
        "mass_kg": m,
        "mass_standard_error_kg": m_error,
    }


def records_of(
    kind: str,
    records: RecordLike | Sequence[RecordLike],
    mapping: MappingLike,
    reader: ReaderOfTables | None = None,
    **stated: Stated | None,
) -> tuple[Record, ...]:
    """Read the records of one kind, several levels of excitation in one as a record for each.

    reader : of tables of a stepped sine, as for `as_records`.   stated : stiffness
    and mass, whose units must be of the records' coordinate.

    Raises ValueError as `require_different`, for a table of a stepped sine among others or the other way round, and for
    a stiffness in N/m of records that rotate and the like.
    """
    read = as_records(records, mapping=mapping, free=kind == "ring-down", reader=reader)
    require_different(read)
    tables = kind == "stepped-sine"
    for record in read:
        if bool(record.channels) == tables:
            is_it = "no" if tables else "a"
            others = "forced records or free decays" if tables else IN_WORDS["stepped-sine"]
            raise ValueError(
                f"{record.name} is {is_it} table of a stepped sine: identify it separately, as {others}"
            )
    for name, value in stated.items():
        of_unit = read_quantity(name, value).coordinate if isinstance(value, str) else None
        if of_unit not in (None, read[0].coordinate):
            unit = read[0].coordinate.unit(NUMBERS[name].unit)
            raise ValueError(
                f"{name} = {value} does not fit {read[0].name}, a {read[0].coordinate.name}: give it in a unit such as "
                f"{unit}"
            )
    return read if kind != "forced" else tuple(itertools.chain(*map(levels_of, read)))


def mapping_option(mapping: MappingLike) -> str | None:
    """Return the path of a mapping for the document; None where it is none."""
    return str(mapping) if isinstance(mapping, str | Path) else None
