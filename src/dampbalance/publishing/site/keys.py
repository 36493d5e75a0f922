"""Shows a schema as Markdown tables of its keys, each with its type, bounds, unit and meaning."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from typing import Any

from ...law.terms import named_with_unit
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
    reader = _Reader(schema, registered)
    reader.read(schema, "")
    parts = []
    for parent, lines in reader.lines.items():
        parts += [f"{'#' * level} `{parent}`\n"] if parent else []
        parts.append(markdown_table(["key", "type", "unit", "meaning"], lines) + "\n")
    return "\n".join(parts)


@dataclass(frozen=True, slots=True)
class _Reader:
    """Reads nodes of a schema into rows of tables and follows references.

    lines : the rows of each table, by the path of its keys.
    """

    schema: Mapping[str, Any]
    registered: Mapping[str, Sequence[str]]
    lines: dict[str, dict[tuple[str, ...], None]] = field(default_factory=dict)

    def read(self, node: Mapping[str, Any], parent: str) -> None:
        """Add the keys below a node; each key precedes the keys inside it."""
        node = self.followed(node)
        for inner, name in (("items", "[]"), ("additionalProperties", ".*")):
            if isinstance(node.get(inner), Mapping):
                self.read(node[inner], f"{parent}{name}".lstrip("."))
        children = node.get("properties", {})
        for child, alike in groupby(children, key=lambda name: self.followed(children[name])):
            names = list(alike)
            units = dict.fromkeys(filter(None, map(_unit, names)))
            cells = (
                ", ".join(f"`{name}`" for name in names)
                + " *needed*" * (names[0] in node.get("required", ())),
                self.type_of(child),
                ", ".join(units),
                in_markdown(" ".join(child.get("description", "").split())),
            )
            self.lines.setdefault(parent, {})[cells] = None
            self.read(child, f"{parent}.{names[0] if len(names) == 1 else '*'}".lstrip("."))

    def followed(self, node: Mapping[str, Any]) -> Mapping[str, Any]:
        """The node with its reference (`$ref`) within the schema resolved."""
        if "$ref" not in node:
            return node
        target: Any = self.schema
        for name in node["$ref"].removeprefix("#/").split("/"):
            target = target[name]
        return {**target, **{name: value for name, value in node.items() if name != "$ref"}}

    def type_of(self, node: Mapping[str, Any]) -> str:
        """The type in words with its bounds, or the admissible values."""
        node = self.followed(node)
        if "registered" in node:
            names = [*self.registered[node["registered"]], *node.get("also", [])]
            words = [f"`{name}`" for name in names]
        elif "enum" in node or "const" in node:
            words = [_value(value) for value in node.get("enum", [node.get("const")])]
        elif "anyOf" in node:
            words = [self.type_of(choice) for choice in node["anyOf"]]
        else:
            names = node.get("type", "any value")
            words = [
                self._word(one, node) for one in ([names] if isinstance(names, str) else names)
            ]
        return listed(list(dict.fromkeys(words)), "or")

    def _word(self, name: str, node: Mapping[str, Any]) -> str:
        """One type in words; for a list, with the type of its entries."""
        items = node.get("items")
        if name == "array" and isinstance(items, Mapping):
            inner = self.type_of(items)
            what = "entries with keys" if inner == _TYPES["object"] else inner
            return f"list of {_length(node)}{what}"
        return _TYPES.get(name, name) + (_range(node) if name in ("number", "integer") else "")


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
