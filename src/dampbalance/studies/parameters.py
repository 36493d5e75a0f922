"""The parameters that a study can vary: name, unit and meaning of each, and its quantity in SI.

Each of c, K_z, F_k and ω can be given by itself or by the dimensionless group that it is part of,

    ζ = c/(2√(km)),   K_z/k,   F_k/(kY),   ω/ω_n with ω_n = √(k/m),

never both. In F_k/(kY), Y is the reference amplitude `Y_m`, of which the excitation levels are multiples.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from ..arrays import Array
from ..balance import TERMS
from ..law.terms import KNOWN_TERMS, Term
from ..model import UNITS, Oscillator, named_with_unit
from ..project.documents import read_schema

ParameterKind = Literal["oscillator", "excitation", "numerics", "read_out"]


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter that a study can set: its unit ("1" for a pure number, "" for a word) and meaning; its bounds are in
    the schema.

    stands_for : the parameter that it replaces.   symbol : for figures, in TeX.   whole : of whole numbers only.
    default : the paper's value.
    """

    kind: ParameterKind
    unit: str
    meaning: str
    symbol: str = ""
    stands_for: str = ""
    whole: bool = False
    default: float | None = None

    @property
    def is_word(self) -> bool:
        """Whether its values are words, which have no unit and no range."""
        return self.unit == ""

    @property
    def name(self) -> str:
        """Symbol of the parameter in TeX, or its meaning where it has none."""
        return f"${self.symbol}$" if self.symbol else self.meaning


OF_LAW = {term.column: term for term in KNOWN_TERMS.values() if term not in TERMS}
"""Coefficients of further terms of the damping law, zero where they are not set: parameter → term."""

STUDY_SCHEMA = Path(__file__).parents[1] / "project/schemas/study.schema.yaml"

PARAMETERS: dict[str, Parameter] = {
    name: Parameter(**row) for name, row in read_schema(STUDY_SCHEMA)["$defs"]["parameters"].items()
} | {
    name: Parameter(
        "oscillator", term.unit or "1", f"{term.words} {term}", term.replace("eta", r"\eta")
    )
    for name, term in OF_LAW.items()
}
"""Every name that an axis can have, as the schema describes it, and the coefficients of the law."""


def parameter(name: str) -> Parameter:
    """Return the parameter of a name."""
    return PARAMETERS[name]


def of_law(names: Collection[str]) -> dict[str, Term]:
    """Return the coefficients of further terms of the damping law among names of parameters: name → term."""
    return {name: term for name, term in OF_LAW.items() if name in names}


def mechanical(names: Collection[str]) -> list[str]:
    """Return the names that make up the oscillator and its excitation, among names of parameters."""
    known = ("oscillator", "excitation")
    return [name for name, p in PARAMETERS.items() if p.kind in known and name in names]


def synonyms(name: str) -> list[str]:
    """Return the names that set the same quantity, this one first, e.g. for zeta: zeta and c_N_s_per_m."""
    target = parameter(name).stands_for or name
    same = [other for other, p in PARAMETERS.items() if (p.stands_for or other) == target]
    return [name, *(other for other in same if other != name)]


def in_si(given: Mapping[str, Array]) -> dict[str, Array]:
    """Return m, c, k, K_z, F_k, Y, omega, arrays (n,), of cases whose parameters have the names of PARAMETERS.

    Exactly one name of each quantity is given. Further terms of the law, where they are given, are added by symbol.
    ω is in rad/s, the rest as in `dampbalance.model`.
    """
    m, k, Y = given["m_kg"], given["k_N_per_m"], given["Y_m"]
    c = 2.0 * given["zeta"] * np.sqrt(k * m) if "zeta" in given else given["c_N_s_per_m"]
    K_z = given["K_z_over_k"] * k if "K_z_over_k" in given else given["K_z_N_per_m"]
    F_k = given["F_k_over_kY"] * k * Y if "F_k_over_kY" in given else given["F_k_N"]
    if "omega_over_omega_n" in given:
        omega = given["omega_over_omega_n"] * np.sqrt(k / m)
    else:
        omega = 2.0 * np.pi * given["frequency_hz"]
    law: dict[str, Array] = {term: given[name] for name, term in of_law(given).items()}
    return {"m": m, "c": c, "k": k, "K_z": K_z, "F_k": F_k, "Y": Y, "omega": omega, **law}


def oscillator_of(si: Mapping[str, Array], case: int) -> Oscillator:
    """Return the oscillator of one of the cases of `in_si`."""
    return Oscillator(*(float(si[name][case]) for name in ("m", "c", "k", "K_z", "F_k")))


SI_COLUMNS = {
    name: named_with_unit(name, UNITS[name]) for name in ("m", "c", "k", "K_z", "F_k", "Y", "omega")
}
"""Column of each SI parameter in the table of cases."""
