"""Which files of the package a script depends on, read from their import statements.

A workflow that reruns a step when its script changes must rerun it, too, when a module that the script uses
changes, and only then. A package's `__init__` hands names on; it counts where a script takes names from it, not where
one of its modules is imported. That of the top package is left out altogether: scripts import from the modules.
"""

from __future__ import annotations

import os
import re
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


# from .. import a, (b as c) or import a; a text that reads like one names a file more at most.
_IMPORT = re.compile(
    r"^ *(?:from +(\.*)([\w.]*) +import +(\([^)]*\)|.*)|import +([\w.]+))", re.MULTILINE
)


@cache  # a workflow asks about many scripts that share their modules
def _imported_files(file: Path, changed: int, source: Path) -> frozenset[Path]:
    paths: set[Path] = set()
    for dots, module, taken, plain in _IMPORT.findall(file.read_text(encoding="utf-8")):
        package = ".".join(file.relative_to(source).parent.parts) if dots else None
        base = source.joinpath(*(plain or resolve_name(dots + module, package)).split("."))
        paths.add(base)
        if base.is_dir():  # of a module, or of another package, names are no files here
            paths |= {base / name for name in re.findall(r"\w+", taken)}
    files = set()
    for path in paths:
        if path.with_suffix(".py").is_file():
            files.add(path.with_suffix(".py"))
        elif path.parent != source and (path / "__init__.py").is_file():  # a subpackage
            files.add(path / "__init__.py")
    return frozenset(files)
