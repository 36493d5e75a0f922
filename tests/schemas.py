"""The schemas of the project's YAML files, and every value that they allow."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from dampbalance.project.case import read_case_schema
from dampbalance.project.documents import read_schema
from folders import ROOT

SCHEMAS = {
    "config": "src/dampbalance/project/schemas/config.schema.yaml",
    "study": "src/dampbalance/project/schemas/study.schema.yaml",
    "mapping": "src/dampbalance/project/schemas/mapping.schema.yaml",
}
_INSIDE = {"items": "[]", "additionalProperties": ".*"}


def schema_of(name: str) -> Any:
    """A schema, with the keys that a configuration has of a table."""
    return read_case_schema() if name == "config" else read_schema(ROOT / SCHEMAS[name])


def values(kinds: set[str]) -> Iterator[tuple[str, dict[str, Any]]]:
    """("config: measured[].records[]", its schema) of every value that may be of one of these types."""
    for name in SCHEMAS:
        for key, node in _below(schema_of(name), ""):
            stated = node.get("type", [])
            if kinds & ({stated} if isinstance(stated, str) else {*stated}):
                yield f"{name}: {key.removeprefix('.')}", node


def _below(node: Any, key: str) -> Iterator[tuple[str, dict[str, Any]]]:
    if not isinstance(node, dict):
        return
    yield key, node
    for name, child in {**node.get("properties", {}), **node.get("$defs", {})}.items():
        yield from _below(child, f"{key}.{name}")
    for word, mark in _INSIDE.items():
        yield from _below(node.get(word), key + mark)
    for child in (*node.get("anyOf", ()), *node.get("prefixItems", ())):
        yield from _below(child, key)
