"""A configuration, checked before anything is computed: one error, naming file, key and remedy."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NoReturn

import jsonschema
import yaml
from jsonschema import ValidationError

Key = tuple[str | int, ...]
Problem = tuple[Key, str]
"""A key, and what is wrong with it and what would be right."""

_NAMES = 'Use letters, digits, "-" and "_".'


class ConfigurationError(ValueError):
    """A configuration that cannot be used; the message names the file, the key and the remedy."""


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


def against_schema(
    document: Any, schema: Mapping[str, Any], approaches: Iterable[str] = ()
) -> list[Problem]:
    """What is wrong with a document by its JSON schema, or because a number is not finite; in a fixed order.

    approaches : names that the schema's `registered: approach` allows.

    The texts say what is wrong and, from the `description` of the key in the schema, what would be right.
    """
    validator = _validator(schema, list(approaches))
    errors = sorted(validator.iter_errors(document), key=lambda error: list(map(str, error.path)))
    problems = [problem for error in errors for problem in _explain(error)]
    return problems + [
        (key, f"{value!r} is not a finite number") for key, value in _not_finite(document)
    ]


def _validator(schema: Mapping[str, Any], approaches: list[str]) -> Any:
    """A validator that knows our keyword `registered: approach`: the value is the name of an approach."""

    def check(_: Any, kind: str, value: Any, __: Any) -> Iterable[ValidationError]:
        if value not in approaches:
            near, known = _nearest(value, approaches), ", ".join(approaches)
            yield ValidationError(f"{value!r} is not an {kind}{near}; known: {known}")

    extend: Any = jsonschema.validators.extend
    return extend(jsonschema.Draft202012Validator, {"registered": check})(schema)


def in_lines(problems: Iterable[Problem], documents: Mapping[str, Any]) -> str:
    """A line for each problem, "file: key: what is wrong, what would be right".

    documents : file → what it says, merged in this order, the last one winning: they show where a key is set.
    """
    return "\n".join(f"{_origin(key, documents)}: {_dotted(key)}: {text}" for key, text in problems)


def _explain(error: ValidationError) -> Iterable[Problem]:
    key: Key = tuple(error.absolute_path)
    schema: Any = error.schema  # a mapping: the schema has no true or false in it
    wanted: Any = error.validator_value
    meaning = schema.get("description", "").strip()
    value: Any = error.instance
    if error.validator == "additionalProperties":
        keys = list(schema["properties"])
        for name in value:
            if name not in keys:
                yield (
                    (*key, name),
                    f"unknown key{_nearest(name, keys)}; known here: {', '.join(keys)}",
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
    elif error.validator == "registered":
        yield key, error.message
    elif error.validator == "pattern":
        yield key, f"{value!r} cannot be a name. {meaning or _NAMES}"
    else:
        yield key, f"{value!r} is not allowed. {meaning}"


def _nearest(name: object, keys: list[str]) -> str:
    matches = difflib.get_close_matches(str(name), keys, n=1)
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
        length = 0
        for part in key:
            try:
                document = document[part]
            except (KeyError, IndexError, TypeError):
                break
            length += 1
        if length >= depth:
            best, depth = file, length
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
