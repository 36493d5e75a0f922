"""A schema as tables of its keys: type with bounds, unit and meaning of each, for Markdown."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ...project.wording import MINUS, in_markdown, listed, markdown_table

_UNITS = (  # by the end of a key's name, the longer one first
    ("N_s2_per_m2", "N s²/m²"),
    ("N_s3_per_m3", "N s³/m³"),
    ("N_s_per_m", "N s/m"),
    ("N_per_m", "N/m"),
    ("rad_per_s", "rad/s"),
    ("hz", "Hz"),
    ("kg", "kg"),
    ("N", "N"),
    ("m", "m"),
    ("s", "s"),
)
_TYPES = {
    "array": "list",
    "boolean": "true or false",
    "integer": "whole number",
    "null": "`null`",
    "object": "keys",
    "string": "text",
}
_NUMBERS = ("number", "integer")
_LIMITS = (
    ("minimum", "≥"),
    ("exclusiveMinimum", ">"),
    ("maximum", "≤"),
    ("exclusiveMaximum", "<"),
)


@dataclass(frozen=True, slots=True)
class Key:
    """A key of a file, as its schema describes it; several names where neighbours are described alike.

    parent : the names that lead to it; [] stands for each entry of a list, * for a name of the user's choice.
    names : of the keys.   type, with its bounds, and meaning : as Markdown.   required : whether it must be given.
    """

    parent: tuple[str, ...]
    names: tuple[str, ...]
    type: str
    meaning: str
    required: bool

    @property
    def unit(self) -> str:
        """The unit that the ends of the names tell; "" for none."""
        units = [_unit(name) for name in self.names]
        return ", ".join(dict.fromkeys(unit for unit in units if unit))


def keys(schema: Mapping[str, Any], registered: Mapping[str, Sequence[str]]) -> list[Key]:
    """Every key that a schema knows, each before those inside it.

    registered : name of a registry → its keys, for what the schema leaves to one (`registered: NAME`).
    """
    reader = _Reader(schema, registered)
    return list(dict.fromkeys(reader.inside(schema, ())))


def tables(found: Sequence[Key], level: int = 2) -> str:
    """Keys as Markdown: a table of those at the top, then of those inside others, below headings of that level."""
    groups: dict[tuple[str, ...], list[Key]] = {}
    for key in found:
        groups.setdefault(key.parent, []).append(key)
    parts = []
    for parent, inside in groups.items():
        if parent:
            dotted = ".".join(parent).replace(".[]", "[]")
            parts.append(f"{'#' * level} `{dotted}`\n")
        parts.append(_table(inside))
    return "\n".join(parts)


def _table(found: Sequence[Key]) -> str:
    rows = []
    for key in found:
        names = ", ".join(f"`{name}`" for name in key.names) + " *needed*" * key.required
        rows.append([names, key.type, key.unit, key.meaning])
    return markdown_table(["key", "type", "unit", "meaning"], rows) + "\n"


@dataclass(frozen=True, slots=True)
class _Reader:
    """Reads nodes of a schema, with what they refer to."""

    schema: Mapping[str, Any]
    registered: Mapping[str, Sequence[str]]

    def inside(self, node: Mapping[str, Any], parent: tuple[str, ...]) -> Iterator[Key]:
        """The keys below a node."""
        node = self.followed(node)
        items = node.get("items")
        if isinstance(items, Mapping):
            yield from self.inside(items, (*parent, "[]"))
        free = node.get("additionalProperties")
        if isinstance(free, Mapping):
            yield from self.inside(free, (*parent, "*"))
        required = node.get("required", ())
        alike: list[tuple[str, Mapping[str, Any]]] = []
        for name, child in [*node.get("properties", {}).items(), ("", {})]:
            child = self.followed(child)
            if alike and (child != alike[0][1] or not name):
                yield from self._entry(alike, parent, required)
                alike = []
            alike.append((name, child))

    def _entry(
        self,
        alike: Sequence[tuple[str, Mapping[str, Any]]],
        parent: tuple[str, ...],
        required: Sequence[str],
    ) -> Iterator[Key]:
        names, child = tuple(name for name, _ in alike), alike[0][1]
        yield Key(
            parent=parent,
            names=names,
            type=self.type_of(child),
            meaning=in_markdown(" ".join(child.get("description", "").split())),
            required=names[0] in required,
        )
        yield from self.inside(child, (*parent, names[0] if len(names) == 1 else "*"))

    def followed(self, node: Mapping[str, Any]) -> Mapping[str, Any]:
        """The node, with what it refers to within the schema."""
        if "$ref" not in node:
            return node
        target: Any = self.schema
        for name in node["$ref"].removeprefix("#/").split("/"):
            target = target[name]
        return {**target, **{name: value for name, value in node.items() if name != "$ref"}}

    def type_of(self, node: Mapping[str, Any]) -> str:
        """The type in words, or the values to choose from."""
        node = self.followed(node)
        if "registered" in node:
            names = [*self.registered[node["registered"]], *node.get("also", [])]
            return _choice([f"`{name}`" for name in names])
        if "enum" in node:
            return _choice([_value(value) for value in node["enum"]])
        if "const" in node:
            return _value(node["const"])
        if "anyOf" in node:
            return _choice([self.type_of(choice) for choice in node["anyOf"]])
        names = node.get("type", "any value")
        return _choice(
            [self._word(one, node) for one in ([names] if names == str(names) else names)]
        )

    def _word(self, name: str, node: Mapping[str, Any]) -> str:
        """One type in words, with that of its entries."""
        items = node.get("items")
        if name == "array" and isinstance(items, Mapping):
            inner = self.type_of(items)
            what = "entries with keys" if inner == _TYPES["object"] else inner
            return f"list of {_length(node)}{what}"
        return _TYPES.get(name, name) + (_range(node) if name in _NUMBERS else "")


def _unit(name: str) -> str:
    return next((unit for end, unit in _UNITS if name.endswith(f"_{end}") or name == end), "")


def _choice(words: Sequence[str]) -> str:
    return listed(list(dict.fromkeys(words)), "or")


def _value(value: object) -> str:
    if value == "\t":
        return "a tab"
    return f"`{value}`" if str(value).strip() else "a blank"


def _range(node: Mapping[str, Any]) -> str:
    """The bounds of a number, to stand behind its type."""
    low, high = node.get("minimum"), node.get("maximum")
    if low is not None and high is not None:
        return f" from {_number(low)} to {_number(high)}"
    signs = [f" {sign} {_number(node[name])}" for name, sign in _LIMITS if name in node]
    return ",".join(signs)


def _length(node: Mapping[str, Any]) -> str:
    """How many entries a list must have, to stand before what they are."""
    least, most = node.get("minItems"), node.get("maxItems")
    if least and most:
        return f"{least} " if least == most else f"{least} to {most} "
    if most:
        return f"up to {most} "
    return f"{least} or more " if least and least > 1 else ""


def _number(value: float) -> str:
    if isinstance(value, int) and abs(value) < 1e6:
        return str(value).replace("-", MINUS)
    return (
        f"{value:g}".replace("e+0", "e").replace("e+", "e").replace("e-0", "e-").replace("-", MINUS)
    )
