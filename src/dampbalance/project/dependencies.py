"""Which files of the package a script depends on, read from their import statements.

A workflow that reruns a step when its script changes must rerun it, too, when a module that the script uses
changes, and only then. A package's `__init__` hands names on; it counts where a script takes names from it, not where
one of its modules is imported. That of the top package is left out altogether: scripts import from the modules.
"""

from __future__ import annotations

import ast
import os
from collections.abc import Iterator
from functools import cache
from importlib.util import resolve_name
from pathlib import Path


def package_modules(
    script: str | Path, source: str | Path, relative_to: str | Path | None = None
) -> list[str]:
    """Files of the packages below `source` that `script` imports, directly or through others, sorted.

    script : a Python file.   source : folder that holds the packages, e.g. `src`.   relative_to : folder the paths
    start from.
    """
    source = Path(source)
    modules: set[Path] = set()
    waiting = [Path(script)]
    while waiting:
        file = waiting.pop()
        for module in _imported_files(file, file.stat().st_mtime_ns, source):
            if module not in modules:
                modules.add(module)
                waiting.append(module)
    return sorted(os.path.relpath(path, relative_to or source) for path in modules)


@cache  # a workflow asks about many scripts that share their modules
def _imported_files(file: Path, changed: int, source: Path) -> frozenset[Path]:
    tree = ast.parse(file.read_text(encoding="utf-8"), filename=str(file))
    names: set[str] = set()
    for node in _statements(tree):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            package = ".".join(file.relative_to(source).parent.parts) if node.level else None
            base = resolve_name("." * node.level + (node.module or ""), package)
            names.add(base)
            names.update(f"{base}.{alias.name}" for alias in node.names)
    files = set()
    for name in names:
        path = source.joinpath(*name.split("."))
        if path.with_suffix(".py").is_file():
            files.add(path.with_suffix(".py"))
        elif "." in name and (path / "__init__.py").is_file():  # a subpackage is its __init__
            files.add(path / "__init__.py")
    return frozenset(files)


def _statements(node: ast.AST) -> Iterator[ast.AST]:
    """The statements below a node, at any depth; expressions, which hold no imports, are most of a tree."""
    for field in ("body", "orelse", "finalbody", "handlers", "cases"):
        for child in getattr(node, field, ()):
            yield child
            yield from _statements(child)
