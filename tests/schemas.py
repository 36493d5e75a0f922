"""The schemas of the project's YAML files, and every value that they allow."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import yaml

from folders import ROOT

SCHEMAS = {
    "config": "src/dampbalance/project/schemas/config.schema.yaml",
    "study": "src/dampbalance/project/schemas/study.schema.yaml",
    "mapping": "src/dampbalance/project/schemas/mapping.schema.yaml",
}
_INSIDE = {"items": "[]", "additionalProperties": ".*"}


def values(kinds: set[str]) -> Iterator[tuple[str, dict[str, Any]]]:
    """("config: measured[].records[]", its schema) of every value that may be of one of these types."""
    for name, file in SCHEMAS.items():
        schema = yaml.safe_load((ROOT / file).read_text(encoding="utf-8"))
        for key, node in _below(schema, ""):
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
