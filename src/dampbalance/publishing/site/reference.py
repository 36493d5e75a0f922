"""The reference: keys of files, documented names, and docstrings in reStructuredText, the markup that Sphinx reads.

A schema becomes Markdown tables of its keys, each with its type, bounds, unit and meaning. In a docstring of this
project a paragraph that begins like `m : mass, kg.   c : viscous damping, N s/m.` describes arguments; several on one
line are separated by three blanks. Indented lines are equations or tables and are shown unchanged; backticks mark code.
Everything else is text, whatever characters it contains: |x|, x*, F_k.
"""

from __future__ import annotations

import inspect
import pkgutil
import re
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from enum import Enum
from functools import reduce
from importlib import import_module
from itertools import groupby
from operator import getitem, itemgetter
from textwrap import dedent, indent
from typing import Any

from ...model import named_with_unit
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
_BLANKS = {"\t": "a tab", " ": "a blank", "": "a blank"}
_LIMITS = {"minimum": "≥", "exclusiveMinimum": ">", "maximum": "≤", "exclusiveMaximum": "<"}


def tables(schema: Mapping[str, Any], registered: Mapping[str, Sequence[str]]) -> str:
    """Markdown tables of all keys of a schema: first the keys at the top level, then those inside other keys.

    Each further table has a heading with the path of its keys, in which [] stands for each entry of a
    list and * for a name chosen by the user. Consecutive keys with the same description share a row.

    registered : the names in each registry to which the schema refers (`registered: NAME`).
    """
    lines: dict[str, dict[tuple[str, ...], None]] = {}
    for parent, cells in _rows(_resolved(schema, schema), "", registered):
        lines.setdefault(parent, {})[cells] = None
    parts = []
    for parent, rows in lines.items():
        parts += [f"## `{parent}`\n"] if parent else []
        parts.append(markdown_table(["key", "type", "unit", "meaning"], rows) + "\n")
    return "\n".join(parts)


def _resolved(node: Any, schema: Mapping[str, Any]) -> Any:
    """A node of a schema with its references (`$ref`) within the schema replaced by what they refer to."""
    if isinstance(node, list):
        return [_resolved(item, schema) for item in node]
    if not isinstance(node, Mapping):
        return node
    own = {name: _resolved(value, schema) for name, value in node.items() if name != "$ref"}
    path = node["$ref"].removeprefix("#/").split("/") if "$ref" in node else []
    return {**_resolved(reduce(getitem, path, schema), schema), **own} if path else own


def _rows(
    node: Mapping[str, Any], parent: str, registered: Mapping[str, Sequence[str]]
) -> Iterator[tuple[str, tuple[str, ...]]]:
    """The path of the table and the cells of each row; a key precedes the keys inside it."""
    for inner, name in (("items", "[]"), ("additionalProperties", ".*")):
        if isinstance(node.get(inner), Mapping):
            yield from _rows(node[inner], f"{parent}{name}".lstrip("."), registered)
    for child, alike in groupby(node.get("properties", {}).items(), key=itemgetter(1)):
        names = [name for name, _ in alike]
        needed = " *needed*" * (names[0] in node.get("required", ()))
        yield (
            parent,
            (
                ", ".join(f"`{name}`" for name in names) + needed,
                _type(child, registered),
                ", ".join(dict.fromkeys(filter(None, map(_unit, names)))),
                in_markdown(" ".join(child.get("description", "").split())),
            ),
        )
        inside = names[0] if len(names) == 1 else "*"
        yield from _rows(child, f"{parent}.{inside}".lstrip("."), registered)


def _type(node: Mapping[str, Any], registered: Mapping[str, Sequence[str]]) -> str:
    """The type in words with its bounds, or the admissible values."""
    if "registered" in node:
        words = [f"`{name}`" for name in (*registered[node["registered"]], *node.get("also", []))]
    elif "enum" in node or "const" in node:
        values = map(str, node.get("enum", [node.get("const")]))
        words = [_BLANKS.get(value, f"`{value}`") for value in values]
    elif "anyOf" in node:
        words = [_type(choice, registered) for choice in node["anyOf"]]
    else:
        kinds, words = node.get("type", "any value"), []
        for kind in [kinds] if isinstance(kinds, str) else kinds:
            words.append(_TYPES.get(kind, kind) + _range(node) * (kind in ("number", "integer")))
            if kind == "array" and isinstance(node.get("items"), Mapping):
                inner = _type(node["items"], registered)
                what = "entries with keys" if inner == _TYPES["object"] else inner
                words[-1] = f"list of {_length(node)}{what}"
    return listed(list(dict.fromkeys(words)), "or")


def _unit(key: str) -> str:
    """The unit that is stated at the end of the name of a key; "" if there is none."""
    return next((unit for end, unit in _UNITS.items() if f"_{key}".endswith(end)), "")


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


_NAMED = re.compile(r"`((?:[a-z_]+\.)+\w+)`")


def directives(names: Iterable[str], module: str) -> str:
    """Markdown that documents names of a module."""
    blocks = [directive(f"{module}.{name}") for name in names]
    return "\n".join(["```{eval-rst}", *blocks, "```", ""])


def directive(name: str) -> str:
    """The directive that documents a name, by its full path."""
    documented = resolved(name)[1]
    kind, options = "data", ["no-value"]
    if inspect.isclass(documented) and issubclass(documented, BaseException):
        kind, options = "exception", []
    elif inspect.isclass(documented):
        kind, options = "class", ["members", *["undoc-members"] * issubclass(documented, Enum)]
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
    purposes = {room: inspect.getdoc(import_module(f"{package}.{room}")) or "" for room in rooms}
    return [
        (room, " ".join(purposes[room].split("\n\n")[0].split()), inside)
        for room, inside in sorted(rooms.items())
    ]


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


_NAME = r"\*{0,2}[A-Za-z_φω][\w.\[\]]*"
_NAMES = rf"{_NAME}(?:, {_NAME})*"
_ARGUMENT = re.compile(rf"(?:^|(?<=\n)|(?<= {{3}}))({_NAMES}) : ")
_LIST = re.compile(r"(?:[-*]|\d+\.) ")
_MARK = r"[\\*`|_<]"
_INLINE = re.compile(
    r"(?P<ticks>`+)(?P<code>.+?)(?P=ticks)"
    r"|(?<![\w*])\*(?P<stressed>[^\s*](?:[^*]*[^\s*])?)\*(?![\w*])"
    r"|\b(?P<name>[A-Z]\w*Error|(?<=Raises )[A-Z]\w+|None|True|False|NaN)\b"
    rf"|(?P<mark>{_MARK})",
    re.DOTALL,
)


def markup(lines: Iterable[str]) -> list[str]:
    """The lines of a docstring as lines of reStructuredText; its arguments become a definition list."""
    made: list[str] = []
    for paragraph in _paragraphs(lines):
        text = "\n".join(paragraph).rstrip()
        block = paragraph
        if text.startswith(" "):
            block = [".. code-block:: none", "", *indent(dedent(text), "    ").split("\n")]
        elif _ARGUMENT.match(text):
            _, *parts = _ARGUMENT.split(text)
            pairs = zip(parts[::2], map(_line, parts[1::2]), strict=True)
            block = [line for names, words in pairs for line in (f"``{names}``", f"    {words}")]
        elif _LIST.match(text):
            entries = (entry.split(" ", 1) for entry in re.split(rf"\n(?={_LIST.pattern})", text))
            block = [f"{mark} {_line(words)}" for mark, words in entries]
        elif not text.startswith(">>> "):
            block = _INLINE.sub(_set, text).split("\n")
        made += [*block, ""]
    return made


def _paragraphs(lines: Iterable[str]) -> Iterator[list[str]]:
    """The paragraphs of a text, as lines; an indented one may contain empty lines and ends with the indentation."""
    block: list[str] = []
    for line in [*lines, "", "end"]:
        indented = bool(block) and block[0].startswith(" ")
        goes_on = line.startswith("  ") if indented else bool(line.strip())
        starts_code = not indented and block and line.startswith("    ") and not _is_argument(block)
        if block and (starts_code or not (goes_on or (indented and not line.strip()))):
            yield block
            block = []
        if line.strip() or block:
            block.append(line)


def _is_argument(block: list[str]) -> bool:
    return bool(_ARGUMENT.match(block[0])) or bool(_LIST.match(block[0]))


def _line(text: str) -> str:
    """Text in one line, in which code and emphasis are marked up and all other characters are literal."""
    return _INLINE.sub(_set, " ".join(text.split()))


def _set(found: re.Match[str]) -> str:
    if found["mark"]:
        return f"\\{found[0]}"
    if found["stressed"]:
        stressed = re.sub(_MARK, r"\\\g<0>", found["stressed"])
        return rf"\ *{stressed}*\ "
    return rf"\ ``{found['code'] or found['name']}``\ "
