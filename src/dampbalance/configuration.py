"""A configuration, checked before anything is computed: one error, naming file, key and remedy."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn, Self

import jsonschema
import yaml

from .model import BaseMotion, Oscillator

Key = tuple[str | int, ...]
Problem = tuple[Key, str]
"""A key, and what is wrong with it and what would be right."""

_NAMES = 'Use letters, digits, "-" and "_".'


class ConfigurationError(ValueError):
    """A configuration that cannot be used; the message names the file, the key and the remedy."""


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


def refuse(key: Key, text: str, files: Iterable[str | Path]) -> NoReturn:
    """Raise the ConfigurationError for one key; the text says what is wrong and what would be right."""
    raise ConfigurationError(
        in_lines([(key, text)], {str(file): read_yaml(file) for file in files})
    )


def read_yaml(file: str | Path) -> Any:
    """The document of a YAML file in which every key stands once; {} for an empty one.

    Raises ConfigurationError naming the file and what is wrong.
    """
    with open(file, encoding="utf-8") as stream:
        try:
            return yaml.load(stream, _StrictLoader) or {}
        except yaml.YAMLError as error:
            raise ConfigurationError(f"{file}: not readable as YAML: {error}") from None


def against_schema(document: Any, schema: Mapping[str, Any]) -> list[Problem]:
    """What a JSON schema, and the rule that every number is finite, find wrong with a document; in a fixed order.

    The texts tell what is wrong and what would be right, from the `description` of the key in the schema.
    """
    validator = jsonschema.Draft202012Validator(schema)
    errors = sorted(validator.iter_errors(document), key=lambda error: list(map(str, error.path)))
    problems = [problem for error in errors for problem in _explain(error)]
    return problems + [
        (key, f"{value!r} is not a finite number") for key, value in _not_finite(document)
    ]


def in_lines(problems: Iterable[Problem], documents: Mapping[str, Any]) -> str:
    """A line for each problem, "file: key: what is wrong, what would be right".

    documents : file → what it says, merged in this order, the last one winning: they tell where a key stands.
    """
    return "\n".join(f"{_origin(key, documents)}: {_dotted(key)}: {text}" for key, text in problems)


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


def _explain(error: jsonschema.ValidationError) -> Iterable[Problem]:
    key: Key = tuple(error.absolute_path)
    schema: Any = error.schema  # a mapping: the schema has no true or false in it
    wanted: Any = error.validator_value
    meaning = schema.get("description", "").strip()
    value: Any = error.instance
    if error.validator == "additionalProperties":
        known = list(schema["properties"])
        for name in value:
            if name not in known:
                yield (
                    (*key, name),
                    f"unknown key{_nearest(name, known)}; known here: {', '.join(known)}",
                )
    elif error.validator == "required":
        for name in wanted:
            if name not in value:
                described = schema["properties"][name].get("description", "").strip()
                yield (*key, name), f"missing; {described}"
    elif error.validator == "type" and isinstance(value, str) and _reads_as_number(value):
        remedy = (
            f"write {_yaml_number(value)}" if "e" in value.lower() else "write it without quotes"
        )
        yield key, f"{value!r} is text to YAML; {remedy}. {meaning}"
    elif error.validator == "pattern":
        yield key, f"{value!r} cannot be a name. {meaning or _NAMES}"
    else:
        yield key, f"{value!r} is not allowed. {meaning}"


def _nearest(name: object, known: list[str]) -> str:
    matches = difflib.get_close_matches(str(name), known, n=1)
    return f" (did you mean {matches[0]}?)" if matches else ""


def _reads_as_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _yaml_number(text: str) -> str:
    """The number as YAML reads it: a mantissa with a point, an exponent with a sign."""
    mantissa, exponent = text.lower().split("e")
    point = mantissa if "." in mantissa else f"{mantissa}.0"
    return f"{point}e{int(exponent):+d}"


def _not_finite(value: Any, key: Key = ()) -> Iterable[tuple[Key, float]]:
    if isinstance(value, Mapping):
        for name, item in value.items():
            yield from _not_finite(item, (*key, name))
    elif isinstance(value, list):
        for i, item in enumerate(value):
            yield from _not_finite(item, (*key, i))
    elif isinstance(value, float) and not math.isfinite(value):
        yield key, value


def _dotted(key: Key) -> str:
    """The key as a person writes it, list positions counted from 1."""
    text = ""
    for part in key:
        text += f"[{part + 1}]" if isinstance(part, int) else f".{part}"
    return text.removeprefix(".") or "(top level)"


def _origin(key: Key, documents: Mapping[str, Any]) -> str:
    """The last file that sets the key, or the longest part of it that any file sets."""
    best, depth = "configuration", 0
    for file, document in documents.items():
        found = 0
        for part in key:
            try:
                document = document[part]
            except (KeyError, IndexError, TypeError):
                break
            found += 1
        if found >= depth:
            best, depth = file, found
    return best


class _StrictLoader(yaml.SafeLoader):
    """YAML in which a key stands once."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen = set()
        for key_node, _ in node.value:
            key = self.construct_object(key_node, deep=True)
            if key in seen:
                line = key_node.start_mark.line + 1
                raise ConfigurationError(
                    f"{key_node.start_mark.name}: {key}: stands twice (again in line {line}); keep one of them"
                )
            seen.add(key)
        return super().construct_mapping(node, deep)
