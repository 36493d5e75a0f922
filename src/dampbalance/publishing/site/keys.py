"""Shows a schema as Markdown tables of its keys, each with its type, bounds, unit and meaning."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import reduce
from itertools import groupby
from operator import getitem, itemgetter
from typing import Any

from ...model import named_with_unit
from ...project.wording import MINUS, in_markdown, listed, markdown_table

# The ending of the name of a key → the unit that it states, the longest endings first
_UNITS = {
    named_with_unit("", unit): unit
    for unit in ("N s³/m³", "N s²/m²", "N s/m", "N/m", "rad/s", "kg", "N", "m", "s")
} | {"_hz": "Hz"}
_TYPES = {
    "array": "list",
    "boolean": "true or false",
    "integer": "whole number",
    "null": "`null`",
    "object": "keys",
    "string": "text",
}
_LIMITS = {"minimum": "≥", "exclusiveMinimum": ">", "maximum": "≤", "exclusiveMaximum": "<"}


def tables(
    schema: Mapping[str, Any], registered: Mapping[str, Sequence[str]], level: int = 2
) -> str:
    """Markdown tables of all keys of a schema: first the keys at the top level, then those inside other keys.

    Each further table has a heading of that level with the path of its keys, in which [] stands for each entry of a
    list and * for a name chosen by the user. Consecutive keys with the same description share a row.

    registered : the names in each registry to which the schema refers (`registered: NAME`).
    """
    lines: dict[str, dict[tuple[str, ...], None]] = {}
    for parent, cells in _rows(_resolved(schema, schema), "", registered):
        lines.setdefault(parent, {})[cells] = None
    parts = []
    for parent, rows in lines.items():
        parts += [f"{'#' * level} `{parent}`\n"] if parent else []
        parts.append(markdown_table(["key", "type", "unit", "meaning"], rows) + "\n")
    return "\n".join(parts)


def _resolved(node: Any, schema: Mapping[str, Any]) -> Any:
    """A node of a schema with its references (`$ref`) within the schema replaced by what they refer to."""
    if isinstance(node, list):
        return [_resolved(item, schema) for item in node]
    if not isinstance(node, Mapping):
        return node
    own = {name: _resolved(value, schema) for name, value in node.items() if name != "$ref"}
    path = node["$ref"].removeprefix("#/").split("/") if "$ref" in node else []
    return {**_resolved(reduce(getitem, path, schema), schema), **own} if path else own


def _rows(
    node: Mapping[str, Any], parent: str, registered: Mapping[str, Sequence[str]]
) -> Iterator[tuple[str, tuple[str, ...]]]:
    """The path of the table and the cells of each row; a key precedes the keys inside it."""
    for inner, name in (("items", "[]"), ("additionalProperties", ".*")):
        if isinstance(node.get(inner), Mapping):
            yield from _rows(node[inner], f"{parent}{name}".lstrip("."), registered)
    for child, alike in groupby(node.get("properties", {}).items(), key=itemgetter(1)):
        names = [name for name, _ in alike]
        needed = " *needed*" * (names[0] in node.get("required", ()))
        yield (
            parent,
            (
                ", ".join(f"`{name}`" for name in names) + needed,
                _type(child, registered),
                ", ".join(dict.fromkeys(filter(None, map(_unit, names)))),
                in_markdown(" ".join(child.get("description", "").split())),
            ),
        )
        inside = names[0] if len(names) == 1 else "*"
        yield from _rows(child, f"{parent}.{inside}".lstrip("."), registered)


def _type(node: Mapping[str, Any], registered: Mapping[str, Sequence[str]]) -> str:
    """The type in words with its bounds, or the admissible values."""
    if "registered" in node:
        words = [f"`{name}`" for name in (*registered[node["registered"]], *node.get("also", []))]
    elif "enum" in node or "const" in node:
        words = [_value(value) for value in node.get("enum", [node.get("const")])]
    elif "anyOf" in node:
        words = [_type(choice, registered) for choice in node["anyOf"]]
    else:
        kinds, words = node.get("type", "any value"), []
        for kind in [kinds] if isinstance(kinds, str) else kinds:
            words.append(_TYPES.get(kind, kind) + _range(node) * (kind in ("number", "integer")))
            if kind == "array" and isinstance(node.get("items"), Mapping):
                inner = _type(node["items"], registered)
                what = "entries with keys" if inner == _TYPES["object"] else inner
                words[-1] = f"list of {_length(node)}{what}"
    return listed(list(dict.fromkeys(words)), "or")


def _unit(key: str) -> str:
    """The unit that is stated at the end of the name of a key; "" if there is none."""
    return next((unit for end, unit in _UNITS.items() if f"_{key}".endswith(end)), "")


def _value(value: object) -> str:
    if value == "\t":
        return "a tab"
    return f"`{value}`" if str(value).strip() else "a blank"


def _range(node: Mapping[str, Any]) -> str:
    """The bounds of a number, to be written after its type."""
    low, high = node.get("minimum"), node.get("maximum")
    if low is not None and high is not None:
        return f" from {_number(low)} to {_number(high)}"
    return ",".join(
        f" {sign} {_number(node[name])}" for name, sign in _LIMITS.items() if name in node
    )


def _length(node: Mapping[str, Any]) -> str:
    """The admissible number of entries of a list, to be written before their type."""
    least, most = node.get("minItems"), node.get("maxItems")
    if least and most:
        return f"{least} " if least == most else f"{least} to {most} "
    if most:
        return f"up to {most} "
    return f"{least} or more " if least and least > 1 else ""


def _number(value: float) -> str:
    """A number whose exponent has no plus sign and no leading zeros."""
    return re.sub(r"e\+?(-?)0*", r"e\1", f"{value:g}").replace("-", MINUS)
