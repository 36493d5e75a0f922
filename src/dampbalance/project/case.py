"""The configured case: one object made from the configuration, in SI units and the package's own types."""

from __future__ import annotations

import copy
import functools
import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from ..model import BaseMotion, Oscillator
from .documents import (
    ConfigurationError,
    Problem,
    against_schema,
    documents_of,
    in_lines,
    read_schema,
    read_yaml,
)
from .options import contradictions, schema_of_options

NOT_GIVEN: Any = None
SCHEMA = Path(__file__).with_name("schemas") / "config.schema.yaml"

# folders of results that no other case can have
_FOLDERS_IN_USE = ("paper", "studies", "archive", "benchmarks", "site")


@dataclass(frozen=True)
class Numerics:
    """The authors' numerics: the section `as_published`. Decimals that are None stand for all of them.

    scheme : a key of `fixed_step.SCHEMES`.   step_s : s.   cycles : simulated from rest.
    c_over_m_decimals, k_over_m_decimals : kept of c/m (1/s) and k/m (1/s²).
    slip_samples : how many samples after slip is seen a begins, for each level.
    tabulated, two_point : rules of reading as configured, for `ReadOut.from_config`.
    """

    scheme: str
    step_s: float
    cycles: int
    c_over_m_decimals: int | None
    k_over_m_decimals: int | None
    slip_samples: Sequence[int]
    tabulated: Mapping[str, Any]
    two_point: Mapping[str, Any]

    def after_slip(self, level: int) -> int:
        """Return how many samples after slip onset a begins; 1 without an entry.   level : counted from 0."""
        return self.slip_samples[level] if level < len(self.slip_samples) else 1


@dataclass(frozen=True)
class Case:
    """The case that a configuration describes. A field is NOT_GIVEN when the case was made from an excerpt without it.

    name : of the folder of the results.   oscillator : the system.
    frequencies_hz : drive frequencies by name.   levels_m : amplitudes Y.
    pairs : of positions in levels_m, counted from 0.   phase : the lag that the harmonic approaches use.
    numerics : those of the as-published route.
    """

    name: str = NOT_GIVEN
    oscillator: Oscillator = NOT_GIVEN
    frequencies_hz: Mapping[str, float] = NOT_GIVEN
    levels_m: tuple[float, ...] = NOT_GIVEN
    pairs: tuple[tuple[int, int], ...] = NOT_GIVEN
    phase: str = NOT_GIVEN
    numerics: Numerics = NOT_GIVEN

    @classmethod
    def from_config(cls, config: Mapping[str, Any]) -> Self:
        """Return the case of a configuration that `check_case` has passed, or of an `excerpt` of one."""
        fields = {}
        for field, (section, name, make) in _CASE_FIELDS.items():
            part = config.get(section, {}) if section else config
            if name in part:
                fields[field] = make(part[name])
        return cls(**fields)

    def omega(self, frequency: str) -> float:
        """Return the circular drive frequency ω = 2πf, rad/s."""
        return 2.0 * math.pi * self.frequencies_hz[frequency]

    def motions(self, frequency: str) -> list[BaseMotion]:
        """Return the base motions of one frequency, in the order of the levels."""
        return [BaseMotion(Y=Y, omega=self.omega(frequency)) for Y in self.levels_m]

    def suffix(self, frequency: str) -> str:
        """Return the end of the file names of its tables: nothing at the first frequency, which is the paper's."""
        return "" if frequency == next(iter(self.frequencies_hz)) else f"_{frequency}"


def excerpt(config: Mapping[str, Any], *fields: str) -> dict[str, Any]:
    """Return the part of a configuration from which `Case.from_config` makes these fields, and no other.

    Rules of the workflow hand it to their scripts: a change elsewhere in the configuration then reruns nothing.

    fields : names of fields of `Case`.
    """
    kept: dict[str, Any] = {}
    for section, name, _ in (_CASE_FIELDS[field] for field in fields):
        part, whole = (kept.setdefault(section, {}), config[section]) if section else (kept, config)
        part[name] = whole[name]
    return kept


def _oscillator(section: Mapping[str, float]) -> Oscillator:
    keys = ("m_kg", "c_N_s_per_m", "k_N_per_m", "K_z_N_per_m", "F_k_N")
    return Oscillator(*(section[key] for key in keys))


# Field of a case → section and key of the configuration, and the function that makes the field.
_CASE_FIELDS: dict[str, tuple[str, str, Callable[[Any], Any]]] = {
    "name": ("", "case", str),
    "oscillator": ("", "oscillator", _oscillator),
    "frequencies_hz": ("excitation", "frequencies", lambda all: {f["name"]: f["hz"] for f in all}),
    "levels_m": ("excitation", "levels_m", tuple),
    "pairs": ("estimation", "pairs", lambda pairs: tuple((i - 1, j - 1) for i, j in pairs)),
    "phase": ("estimation", "phase", str),
    "numerics": ("", "as_published", lambda section: Numerics(**section)),
}


@functools.cache
def read_case_schema() -> Any:
    """Return the schema of a configuration, the keys of `project.options` among those of a set of records."""
    schema = copy.deepcopy(read_schema(SCHEMA))
    values = schema["$defs"].pop("values")
    schema["properties"]["measured"]["items"]["properties"] |= schema_of_options(values)
    return schema


def check_case(config: Mapping[str, Any], files: Iterable[str | Path]) -> None:
    """Check a configuration against its schema, and its keys against each other.

    files : the YAML files from which it was merged, the last one winning, for the lines in messages.

    Raises ConfigurationError listing every problem, a line each.
    """
    documents = documents_of(files)
    problems = against_schema(config, read_case_schema())
    problems = problems or list(_contradictions(config))
    if problems:
        raise ConfigurationError(in_lines(problems, documents))


def require_own_case(overriding: Iterable[str | Path]) -> None:
    """Refuse configurations that override the paper's case and leave it its name: its results would be replaced.

    overriding : the YAML files, at least one of which has to name a case.
    """
    files = [str(file) for file in overriding]
    if files and not any("case" in read_yaml(file) for file in files):
        name = re.sub("[^A-Za-z0-9_-]+", "_", Path(files[-1]).stem).strip("_-")[:50]
        name = name if name and name not in _FOLDERS_IN_USE else f"my_{name or 'case'}"
        raise ConfigurationError(
            f"{files[-1]}: case: is missing, and the results would replace those of the paper; name the case "
            f"(case: {name}), and add published: null if there are no printed numbers to compare with"
        )


def _contradictions(config: Mapping[str, Any]) -> Iterable[Problem]:
    """Yield what no schema can say: keys that do not fit each other."""
    levels = config["excitation"]["levels_m"]
    for i, pair in enumerate(config["estimation"]["pairs"]):
        for position in pair:
            if position > len(levels):
                text = f"there is no level {position}: excitation.levels_m has {len(levels)}"
                yield ("estimation", "pairs", i), text
    shown: dict[str, int] = {}
    for i, Y in enumerate(levels):
        first = shown.setdefault(f"{1e3 * Y:g}", i)
        if first != i:
            text = f"{Y!r} is the same as level {first + 1} to six digits, which tables show; take levels further apart"
            yield ("excitation", "levels_m", i), text
    names = [frequency["name"] for frequency in config["excitation"]["frequencies"]]
    for i, name in enumerate(names):
        # some file systems do not distinguish capital and small letters
        if name.casefold() in map(str.casefold, names[:i]):
            text = f"{name} stands twice, capital or small; give each its own"
            yield ("excitation", "frequencies", i, "name"), text
    for name in ("tabulated", "two_point"):
        rules = config["as_published"][name]
        if rules.get("X_s_mark_m") is not None and rules.get("X_s_decimals") is not None:
            yield ("as_published", name, "X_s_mark_m"), "not together with X_s_decimals; keep one"
    for i, settings in enumerate(config.get("measured") or []):
        for key, text in contradictions(settings):
            yield ("measured", i, key), text
