"""Which module of the package, and which room, imports which."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path

from folders import ROOT

SOURCE = ROOT / "src"
PACKAGE = SOURCE / "dampbalance"
MODULES = {
    ".".join(path.relative_to(SOURCE).with_suffix("").parts).removesuffix(".__init__"): path
    for path in sorted(PACKAGE.rglob("*.py"))
}
FACE = {"dampbalance"}  # from which others take the version alone


def imported(module: str, path: Path, text: str | None = None, *, types: bool = True) -> set[str]:
    """The modules of the package that a module imports, anywhere in it.   types : or for its types alone."""
    package = module.split(".") if path.name == "__init__.py" else module.split(".")[:-1]
    names = set()
    tree = ast.parse(text or path.read_text(encoding="utf-8"))
    unseen = {
        one
        for node in ast.walk(tree)
        if not types and isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        for one in ast.walk(node)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node not in unseen:
            base = package[: len(package) - node.level + 1] if node.level else []
            start = ".".join([*base, *([node.module] if node.module else [])])
            inner = {alias: f"{start}.{alias.name}" for alias in node.names}
            names |= {one if one in MODULES else start for one in inner.values()}
    return {name for name in names if name in MODULES} - {module}


@cache
def graph() -> dict[str, set[str]]:
    return {module: imported(module, path) for module, path in MODULES.items()}


def rooms() -> dict[str, set[str]]:
    """The rooms that each room imports: a room is a folder, or a module at the root."""
    of: dict[str, set[str]] = {}
    for module, others in graph().items():
        if module not in (*FACE, "dampbalance.__main__"):
            room = module.split(".")[1]
            names = {other.split(".")[1] for other in others - FACE}
            of[room] = of.get(room, set()) | names - {room}
    return of


def reached(start: Iterable[str], imports: Mapping[str, set[str]]) -> set[str]:
    """What these modules, or rooms, import, directly or through others, and themselves."""
    found, waiting = set[str](), set(start)
    while waiting:
        found |= waiting
        waiting = {other for name in waiting for other in imports[name]} - found
    return found
