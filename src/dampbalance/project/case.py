"""The configured case: oscillator, drive frequencies, levels and pairs, in SI units and the package's own types."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from ..model import BaseMotion, Oscillator
from .documents import ConfigurationError, Problem, against_schema, in_lines, read_yaml


@dataclass(frozen=True)
class Case:
    """What a configuration describes, in SI units and the package's own types.

    oscillator : the system.   frequencies_hz : drive frequencies by name.   levels_m : amplitudes Y.
    pairs : of positions in levels_m, counted from 0.   phase : the lag that the harmonic approaches use.
    """

    name: str
    oscillator: Oscillator
    frequencies_hz: dict[str, float]
    levels_m: tuple[float, ...]
    pairs: tuple[tuple[int, int], ...]
    phase: str

    @classmethod
    def from_config(cls, config: Mapping[str, Any]) -> Self:
        """The case of a configuration that `check` has passed."""
        return cls(
            name=config["case"],
            oscillator=oscillator_from(config["oscillator"]),
            frequencies_hz={f["name"]: f["hz"] for f in config["excitation"]["frequencies"]},
            levels_m=tuple(config["excitation"]["levels_m"]),
            pairs=pairs_from(config["estimation"]["pairs"]),
            phase=config["estimation"]["phase"],
        )

    def motions(self, frequency: str) -> list[BaseMotion]:
        """The base motions of one frequency, in the order of the levels."""
        return motions_from(self.frequencies_hz[frequency], self.levels_m)


def oscillator_from(section: Mapping[str, float]) -> Oscillator:
    """The oscillator of the configuration's section of that name."""
    return Oscillator(
        m=section["m_kg"],
        c=section["c_N_s_per_m"],
        k=section["k_N_per_m"],
        K_z=section["K_z_N_per_m"],
        F_k=section["F_k_N"],
    )


def motions_from(frequency_hz: float, levels_m: Iterable[float]) -> list[BaseMotion]:
    """Base motions at the frequency f, Hz, and the amplitudes Y, m."""
    return [BaseMotion(Y=Y, omega=2.0 * math.pi * frequency_hz) for Y in levels_m]


def pairs_from(pairs: Iterable[Iterable[int]]) -> tuple[tuple[int, int], ...]:
    """Pairs of positions counted from 0, from those of the configuration, counted from 1."""
    return tuple((i - 1, j - 1) for i, j in pairs)


def check(config: Mapping[str, Any], schema_file: str | Path, files: Iterable[str | Path]) -> None:
    """Check a configuration against its schema and for sense.

    files : the YAML files it was merged from, the last one winning; they serve to say where a key stands.

    Raises ConfigurationError listing every problem, a line each.
    """
    documents = {str(file): read_yaml(file) for file in files}
    problems = against_schema(config, read_yaml(schema_file)) or list(_contradictions(config))
    if problems:
        raise ConfigurationError(in_lines(problems, documents))


def _contradictions(config: Mapping[str, Any]) -> Iterable[Problem]:
    """What no schema can say: keys that do not fit each other."""
    levels = config["excitation"]["levels_m"]
    for i, pair in enumerate(config["estimation"]["pairs"]):
        for position in pair:
            if position > len(levels):
                yield (
                    ("estimation", "pairs", i),
                    f"there is no level {position}: excitation.levels_m has {len(levels)}",
                )

    names = [frequency["name"] for frequency in config["excitation"]["frequencies"]]
    for i, name in enumerate(names):
        if name in names[:i]:
            yield (
                ("excitation", "frequencies", i, "name"),
                f"{name} stands twice; give each its own",
            )
    for name in ("tabulated", "two_point"):
        rules = config["as_published"][name]
        if rules.get("X_s_mark_m") is not None and rules.get("X_s_decimals") is not None:
            yield ("as_published", name, "X_s_mark_m"), "not together with X_s_decimals; keep one"
