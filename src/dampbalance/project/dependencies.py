"""Finds the files of the package that a script depends on, from their import statements.

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
    """Return files of the packages below `source` that `script` imports, directly or through others, sorted.

    script : a Python file.   source : folder that holds the packages, e.g. `src`.   relative_to : folder the paths
    start from.
    """
    modules: set[str] = set()
    waiting, source = [str(script)], str(source)
    while waiting:
        file = waiting.pop()
        new = _imported_files(file, os.stat(file).st_mtime_ns, source) - modules
        modules |= new
        waiting += new
    start = os.path.relpath(source, relative_to or source)
    return sorted(os.path.normpath(start + module.removeprefix(source)) for module in modules)


# from .. import a, (b as c) or import a; a text that reads like one names a file more at most.
_IMPORT = re.compile(
    r"^ *(?:from +(\.*)([\w.]*) +import +(\([^)]*\)|.*)|import +([\w.]+))", re.MULTILINE
)


@cache  # a workflow asks about many scripts that share their modules
def _imported_files(file: str, changed: int, source: str) -> frozenset[str]:
    names: set[str] = set()
    package = os.path.dirname(os.path.relpath(file, source)).replace(os.sep, ".")
    for dots, module, taken, plain in _IMPORT.findall(Path(file).read_text(encoding="utf-8")):
        base = plain or resolve_name(dots + module, package)
        names.add(base)
        if os.path.isdir(
            _path(base, source)
        ):  # names in a module, or in another package, are no files here
            names |= {f"{base}.{name}" for name in re.findall(r"\w+", taken)}
    files = set()
    for name in names:
        path = _path(name, source)
        if os.path.isfile(f"{path}.py"):
            files.add(f"{path}.py")
        elif "." in name and os.path.isfile(
            init := os.path.join(path, "__init__.py")
        ):  # a subpackage
            files.add(init)
    return frozenset(files)


def _path(name: str, source: str) -> str:
    return os.path.join(source, *name.split("."))
