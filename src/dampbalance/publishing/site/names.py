"""Which names the reference of the package holds, and the directives by which Sphinx documents them."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable, Sequence
from enum import Enum
from importlib import import_module
from typing import Any

_NAMED = re.compile(r"`((?:[a-z_]+\.)+\w+)`")


def directives(names: Iterable[str], module: str) -> str:
    """Blocks of Markdown that document names of a module, each at its place."""
    blocks = [directive(f"{module}.{name}") for name in names]
    return "\n".join(["```{eval-rst}", *blocks, "```", ""])


def by_room(names: Iterable[str], package: str) -> list[tuple[str, str, list[str]]]:
    """The names that a package hands on by the room that they come from: (room, what it is for, its names).

    Rooms in the order of the alphabet; of a room, first the functions.

    A room is a module or a folder at the root of the package.
    """
    found: dict[str, list[str]] = {}
    for name in names:
        room = getattr(import_module(package), name).__module__.split(".")[1]
        found.setdefault(room, []).append(name)
    return [
        (room, _first_sentence(import_module(f"{package}.{room}")), sorted(found[room], key=_order))
        for room in sorted(found)
    ]


def _order(name: str) -> tuple[bool, str]:
    return name[0].isupper(), name


def _first_sentence(module: Any) -> str:
    return " ".join((inspect.getdoc(module) or "").split("\n\n")[0].split())


def directive(name: str) -> str:
    """The directive that documents a name, by its full path."""
    found = resolved(name)[1]
    if inspect.isclass(found):
        return _of_class(name, found)
    if callable(found):
        return f".. autofunction:: {name}\n"
    return f".. autodata:: {name}\n    :no-value:\n"


def _of_class(name: str, found: type) -> str:
    lines = [f".. autoclass:: {name}", "    :members:"]
    if issubclass(found, Enum):
        lines.append("    :undoc-members:")
    if issubclass(found, BaseException):
        lines = [f".. autoexception:: {name}"]
    return "\n".join([*lines, ""])


def others(naming: Iterable[str], package: str) -> dict[str, list[str]]:
    """Module → its functions, classes and registries that texts name in backticks, without those that the package hands
    on; in the order of the modules. A method stands for its class.
    """
    public = import_module(package)
    own = {id(getattr(public, name)) for name in public.__all__}
    found: dict[str, set[str]] = {}
    for name in (name for text in naming for name in _NAMED.findall(text)):
        try:
            module, _, place = resolved(name if name.startswith(package) else f"{package}.{name}")
        except LookupError:
            continue
        top = place.split(".")[0]
        if top and id(getattr(import_module(module), top)) not in own:
            found.setdefault(module, set()).add(top)
    return {module: sorted(names) for module, names in sorted(found.items())}


def resolved(name: str) -> tuple[str, Any, str]:
    """(module, object, its path in the module) of a dotted name. Raises LookupError where there is none."""
    parts: Sequence[str] = name.split(".")
    for length in range(len(parts), 0, -1):
        module = ".".join(parts[:length])
        try:
            found: Any = import_module(module)
        except ModuleNotFoundError:
            continue
        try:
            for part in parts[length:]:
                found = getattr(found, part)
        except AttributeError:
            break
        return module, found, ".".join(parts[length:])
    raise LookupError(f"there is nothing of the name {name}")
