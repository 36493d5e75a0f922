"""Selects the names that the reference of the package documents, and writes the Sphinx directives for them."""

from __future__ import annotations

import inspect
import pkgutil
import re
import sys
from collections.abc import Iterable
from enum import Enum
from importlib import import_module
from typing import Any

_NAMED = re.compile(r"`((?:[a-z_]+\.)+\w+)`")


def directives(names: Iterable[str], module: str) -> str:
    """Markdown that documents names of a module."""
    blocks = [directive(f"{module}.{name}") for name in names]
    return "\n".join(["```{eval-rst}", *blocks, "```", ""])


def directive(name: str) -> str:
    """The directive that documents a name, by its full path."""
    documented = resolved(name)[1]
    kind, options = "data", ["no-value"]
    if inspect.isclass(documented):
        kind, options = "class", ["members"]
        if issubclass(documented, Enum):
            options.append("undoc-members")
        if issubclass(documented, BaseException):
            kind, options = "exception", []
    elif callable(documented):
        kind, options = "function", []
    return "\n".join([f".. auto{kind}:: {name}", *(f"    :{one}:" for one in options), ""])


def by_room(names: Iterable[str], package: str) -> list[tuple[str, str, list[str]]]:
    """The public names of a package grouped by the room that defines them: (room, its purpose, its names).

    A room is a module or a folder at the root of the package. Rooms are in alphabetical order; the functions of a room
    precede its classes.
    """
    rooms: dict[str, list[str]] = {}
    for name in sorted(names, key=lambda name: (name[0].isupper(), name)):
        room = getattr(import_module(package), name).__module__.split(".")[1]
        rooms.setdefault(room, []).append(name)
    return [
        (room, _first_paragraph(import_module(f"{package}.{room}")), inside)
        for room, inside in sorted(rooms.items())
    ]


def _first_paragraph(module: Any) -> str:
    return " ".join((inspect.getdoc(module) or "").split("\n\n")[0].split())


def others(naming: Iterable[str], package: str) -> dict[str, list[str]]:
    """The functions, classes and registries that texts name in backticks, by module, except public names.

    A method stands for its class.
    """
    public = import_module(package)
    own = {id(getattr(public, name)) for name in public.__all__}
    inner: dict[str, set[str]] = {}
    for name in _NAMED.findall("\n".join(naming)):
        try:
            module, _, place = resolved(name if name.startswith(package) else f"{package}.{name}")
        except LookupError:
            continue
        top = place.split(".")[0]
        if top and id(getattr(sys.modules[module], top)) not in own:
            inner.setdefault(module, set()).add(top)
    return {module: sorted(names) for module, names in sorted(inner.items())}


def resolved(name: str) -> tuple[str, Any, str]:
    """(module, object, path in the module) of a dotted name. Raises LookupError if there is no such object."""
    try:
        target = pkgutil.resolve_name(name)
    except (ImportError, AttributeError):
        raise LookupError(f"there is nothing of the name {name}") from None
    module = name
    while module not in sys.modules:
        module = module.rpartition(".")[0]
    return module, target, name.removeprefix(module).lstrip(".")
