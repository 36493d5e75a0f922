"""YAML files of a user, read within bounds and checked before anything is computed.

Every error is one line: file, line, key, what is wrong, and what would be right.
"""

from __future__ import annotations

import difflib
import functools
import json
import math
import re
import stat
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

import jsonschema
import yaml
from jsonschema import ValidationError

from ..balance import Approach
from ..law.terms import KNOWN_TERMS, Term
from .wording import cut, shortened

Key = tuple[str | int, ...]
Problem = tuple[Key, str]  # a key, and what is wrong with it and what would be right
MOST_BYTES = 1_000_000  # of a file that is read; the longest one of the project has 20 kB
MOST_VALUES = 20_000  # keys and values in a file, those that aliases repeat counted each time
DEEPEST = 20  # lists and mappings inside each other; the schemas go down to seven
_LARGEST = 2**63 - 1  # what an integer of the arrays holds
_LINE, _KEY = 300, 40  # characters of a message, and of a key in it
_MESSAGES = 20  # of a file that is wrong all over
_NAMES = 'Use letters, digits, "-" and "_".'


class ConfigurationError(ValueError):
    """A configuration that cannot be used; the message names the file, the key and the remedy."""


@dataclass(frozen=True)
class SectionOfFile:
    """A configuration that is part of a file, as that which another workflow gives to this one as a module.

    file : in which it stands.   key : of it there; None where the file is no YAML but a Snakefile.
    """

    file: str
    key: Key | None
    document: Any

    def __str__(self) -> str:
        return self.file


Source = str | Path | SectionOfFile  # where a configuration stands


def section_of(
    given: Mapping[str, Any], files: Sequence[str | Path], else_in: str
) -> SectionOfFile:
    """The section of the last of the YAML files in which a configuration, or some of it, stands; if there is none, the
    whole of the file `else_in`, which is no YAML."""

    def place(document: Any, key: Key) -> Key | None:
        if not isinstance(document, Mapping) or not document:
            return None
        if all(name in given and given[name] == value for name, value in document.items()):
            return key
        inside = (place(value, (*key, name)) for name, value in document.items())
        return next((key for key in inside if key is not None), None)

    for file in reversed(files):
        if (key := place(read_yaml(file), ())) is not None:
            return SectionOfFile(str(file), key, given)
    return SectionOfFile(else_in, None, given)


def documents_of(files: Iterable[Source]) -> dict[str, Any]:
    """What each file says, a section as itself."""
    return {
        str(file): file if isinstance(file, SectionOfFile) else read_yaml(file) for file in files
    }


def refuse(key: Key, text: str, files: Iterable[Source]) -> NoReturn:
    """Raise the ConfigurationError for one key; the text says what is wrong and what would be right."""
    raise ConfigurationError(in_lines([(key, text)], documents_of(files)))


def read_yaml(file: str | Path) -> Any:
    """The document of a YAML file, {} for an empty one: text keys that stand once, plain values, 64-bit integers.

    A file is read within bounds (MOST_BYTES, MOST_VALUES, DEEPEST): none takes long, or much memory.

    Raises ConfigurationError naming file, line, what is wrong and what would be right.
    """
    return _parsed(file)[0]


@functools.cache
def read_schema(file: str | Path) -> Any:
    """A schema of this project, which needs no bounds: read once, by the parser in C where there is one."""
    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    return yaml.load(Path(file).read_bytes(), loader)


def _parsed(file: str | Path) -> tuple[Any, yaml.Node | None]:
    """The document of a file, and its tree of nodes, which knows the lines."""
    text = _text(file)
    try:
        loader = _BoundedLoader(text, str(file))
        root = loader.get_single_node()
        document = loader.construct_document(root) if root is not None else None
        return {} if document is None else document, root
    except yaml.reader.ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        what = f"the character U+{error.character:04X} cannot stand in YAML; remove it"
    except yaml.MarkedYAMLError as error:
        mark, begun = error.problem_mark or error.context_mark, error.context_mark
        line = mark.line + 1 if mark else 1
        since = f" that begins in line {begun.line + 1}" if begun and begun.line + 1 != line else ""
        context = f", {error.context}{since}" if error.context else ""
        what = f"not readable as YAML{context}: {error.problem}"
        if "'\\t'" in str(error.problem):
            what += "; indent with spaces, not with tabs"
    raise _unreadable(file, f"line {line}: {what}")


def _unreadable(file: str | Path, what: str) -> ConfigurationError:
    return ConfigurationError(_one_line(f"{_file_name(file)}: {what}"))


def _text(file: str | Path) -> str:
    """The text of a regular file of bounded size."""
    try:
        mode = Path(file).stat().st_mode
        if not stat.S_ISREG(mode):
            kind = "a folder" if stat.S_ISDIR(mode) else "a pipe or a device"
            raise _unreadable(file, f"is {kind}; name a YAML file")
        with open(file, "rb") as stream:
            data = stream.read(MOST_BYTES + 1)
    except OSError as error:
        reason = error.strerror or "unreadable"
        raise _unreadable(file, f"cannot be read ({reason}); name a YAML file") from None
    if len(data) > MOST_BYTES:
        much = f"more than {MOST_BYTES:,} bytes"
        raise _unreadable(file, f"has {much}; give ranges instead of lists")
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        line, byte = data.count(b"\n", 0, error.start) + 1, data[error.start]
        what = f"line {line}: the byte 0x{byte:02X} is not UTF-8; save it as UTF-8"
        raise _unreadable(file, what) from None


def _file_name(file: str | Path, most: int = 160) -> str:
    """A file as it was named, without the middle of a name that is too long to be one."""
    name, half = str(file), most // 2
    return name if len(name) <= most else f"{name[:half]}…{name[-half:]}"


def _one_line(text: str) -> str:
    """Text in a line that fits a screen."""
    return cut(" ".join(text.split()), _LINE)


def against_schema(
    document: Any, schema: Mapping[str, Any], approaches: Iterable[str] = ()
) -> list[Problem]:
    """What is wrong with a document by its JSON schema, or because a number is not finite; in a fixed order.

    approaches : names that the schema's `registered: approach` or `registered: check` allows; `registered: term` allows
    those of KNOWN_TERMS.

    The texts say what is wrong and, from the `description` of the key in the schema, what would be right.
    """
    validator = _validator(schema, list(approaches))
    errors = sorted(validator.iter_errors(document), key=lambda error: list(map(str, error.path)))
    endless = [(key, f"{value!r} is not a finite number") for key, value in _not_finite(document)]
    problems = [problem for error in errors for problem in _explain(error)]
    keys = {key for key, _ in endless}
    return [problem for problem in problems if problem[0] not in keys] + endless


def _validator(schema: Mapping[str, Any], approaches: list[str]) -> Any:
    """A validator that knows our keyword `registered`: the value is the name of an approach, or of a term of a law, or
    among those of `also` next to it.

    An integer is one to Python (2.0 is none), a pattern holds for the whole text, its last line end too, and items are
    compared in a time that grows with their number only.
    """

    def check(_: Any, kind: str, value: Any, node: Any) -> Iterable[ValidationError]:
        names = (list(KNOWN_TERMS) if kind == "term" else approaches) + node.get("also", [])
        if not isinstance(value, Approach | Term) and value not in names:
            words = f"{'an' if kind == 'approach' else 'a'} {kind}{_nearest(value, names)}"
            yield ValidationError(f"{shortened(value)} is not {words}; known: {', '.join(names)}")

    def unique(_: Any, wanted: bool, value: Any, __: Any) -> Iterable[ValidationError]:
        if wanted and isinstance(value, list):
            words = [json.dumps(_as_float(item), sort_keys=True, default=str) for item in value]
            if len(set(words)) < len(words):
                yield ValidationError("")

    def pattern(_: Any, wanted: str, value: Any, __: Any) -> Iterable[ValidationError]:
        if isinstance(value, str) and not re.fullmatch(wanted.removesuffix("$"), value):
            yield ValidationError("")

    base: Any = jsonschema.Draft202012Validator
    types = base.TYPE_CHECKER.redefine("integer", lambda _, value: type(value) is int)
    extend: Any = jsonschema.validators.extend
    ours = {"registered": check, "uniqueItems": unique, "pattern": pattern}
    return extend(base, ours, type_checker=types)(schema)


def in_lines(problems: Iterable[Problem], documents: Mapping[str, Any]) -> str:
    """A line for each problem, "file: line N: key: what is wrong, what would be right", and no more than fit a screen.

    documents : file → what it says, merged in this order, the last one winning: they show where a key is set.
    """
    listed, lines = list(problems), []
    tree = functools.cache(lambda file: _parsed(file)[1] if Path(file).is_file() else None)
    for key, text in listed[:_MESSAGES]:
        depths = {file: _depth(key, of) for file, of in documents.items()}
        # the last file that sets the key, or the longest part of it that any file sets
        file = max(reversed(depths), key=lambda file: depths[file], default="configuration")
        section = documents.get(file)
        above = section.key if isinstance(section, SectionOfFile) else ()
        set_there = (*(above or ()), *key[: depths.get(file, 0)])
        line = "" if above is None else _line_of(set_there, tree(file))
        place = f"{_file_name(file)}: {line}{_dotted((*(above or ()), *key))}"
        lines.append(_one_line(f"{place}: {text}"))
    if len(listed) > _MESSAGES:
        lines.append(f"… and {len(listed) - _MESSAGES} more")
    return "\n".join(lines)


def _explain(error: ValidationError) -> Iterable[Problem]:
    key: Key = tuple(error.absolute_path)
    schema: Any = error.schema  # a mapping: the schema has no true or false in it
    wanted: Any = error.validator_value
    meaning = schema.get("description", "").strip()
    value: Any = error.instance
    if error.validator == "additionalProperties":
        keys = list(schema["properties"])
        for name in value:
            if name not in keys:
                known = ", ".join(keys)
                yield (*key, name), f"unknown key{_nearest(name, keys)}; known here: {known}"
    elif error.validator == "required":
        for name in wanted:
            if name not in value:
                described = schema["properties"][name].get("description", "").strip()
                yield (*key, name), f"missing; {described}"
    elif error.validator == "type" and _of_numbers(wanted) and _as_number(value):
        yield key, f"{shortened(value)} is text to YAML; write {_as_number(value)}. {meaning}"
    elif error.validator == "registered":
        yield key, error.message
    elif error.validator == "pattern":
        yield key, f"{shortened(value)} cannot be a name. {meaning or _NAMES}"
    else:
        yield key, f"{shortened(value)} is not allowed. {meaning}"


def _nearest(name: object, keys: list[str]) -> str:
    matches = difflib.get_close_matches(cut(str(name), _KEY), keys, n=1)
    return f" (did you mean {matches[0]}?)" if matches else ""


def _of_numbers(wanted: str | list[str]) -> bool:
    return not {"number", "integer"}.isdisjoint([wanted] if isinstance(wanted, str) else wanted)


def _as_number(text: object) -> str:
    """How to write a number that is text to YAML, which wants a mantissa with a point, and an exponent with a sign;
    nothing for what is no number."""
    try:
        float(text if isinstance(text, str) else "")
    except ValueError:
        return ""
    mantissa, e, exponent = str(text).lower().partition("e")
    point = mantissa if "." in mantissa else f"{mantissa}.0"
    return f"{point}e{int(exponent):+d}" if e else "it without quotes"


def _as_float(value: Any) -> Any:
    """A value in which 1 and 1.0 are the same."""
    if isinstance(value, list):
        return list(map(_as_float, value))
    return float(value) if type(value) is int else value


def _not_finite(value: Any, key: Key = ()) -> Iterable[tuple[Key, float]]:
    if isinstance(value, Mapping | list):
        for name, item in value.items() if isinstance(value, Mapping) else enumerate(value):
            yield from _not_finite(item, (*key, name))
    elif isinstance(value, float) and not math.isfinite(value):
        yield key, value


def _dotted(key: Key) -> str:
    """The key as a person writes it, list positions counted from 1."""
    text = ""
    for part in key:
        text += f"[{part + 1}]" if isinstance(part, int) else f".{cut(str(part), _KEY)}"
    return text.removeprefix(".") or "(top level)"


def _depth(key: Key, document: Any) -> int:
    """How many parts of a key a document sets."""
    held = document.document if isinstance(document, SectionOfFile) else document
    for depth, part in enumerate(key):
        try:
            held = held[part]
        except (KeyError, IndexError, TypeError):
            return depth
    return len(key)


def _line_of(key: Key, node: yaml.Node | None) -> str:
    """Where a key stands in a tree of nodes, "line 3: "; nothing for the top level, or a document without a file."""
    line = 0
    for part in key:
        if isinstance(node, yaml.MappingNode):
            marks = {name.value: (name.start_mark, value) for name, value in node.value}
            if part not in marks:  # in another of the files that were merged
                break
            mark, node = marks[part]
        elif isinstance(node, yaml.SequenceNode):
            node = node.value[part]
            mark = node.start_mark
        else:
            break
        line = mark.line + 1
    return f"line {line}: " if line else ""


class _BoundedLoader(yaml.SafeLoader):
    """YAML whose size is counted while its tree is built, before any value is made."""

    def __init__(self, text: str, name: str) -> None:
        super().__init__(text)
        self.name = name
        self._depth = self._count = 0
        self._sizes: dict[str, int] = {}  # of the anchored nodes that are complete

    def refuse(self, mark: Any, what: str) -> NoReturn:
        """Raise the ConfigurationError for a place in the file."""
        raise _unreadable(self.name, f"line {mark.line + 1}: {what}")

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        event: Any = self.peek_event()  # type: ignore[no-untyped-call]
        mark, before = event.start_mark, self._count
        if isinstance(event, yaml.AliasEvent):
            if event.anchor in self.anchors and event.anchor not in self._sizes:
                self.refuse(mark, f"*{event.anchor} stands inside what it repeats; write it out")
            self._count += self._sizes.get(str(event.anchor), 0)
        else:
            if event.tag is not None:
                self.refuse(mark, f"the tag {event.tag} is not known here; leave it out")
            self._count += 1
        if self._count > MOST_VALUES:
            self.refuse(mark, f"more than {MOST_VALUES:,} values; give ranges instead of lists")
        if self._depth == DEEPEST:
            self.refuse(mark, f"more than {DEEPEST} lists and mappings inside each other")
        self._depth += 1
        node = super().compose_node(parent, index)
        self._depth -= 1
        if event.anchor is not None and not isinstance(event, yaml.AliasEvent):
            self._sizes[event.anchor] = self._count - before
        return node

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen: dict[str, int] = {}
        for key_node, _ in node.value:
            mark, key = key_node.start_mark, key_node.value
            if key_node.tag not in (_TAG.format("str"), _TAG.format("merge")):
                shown = shortened(key) if isinstance(key, str) else "a list or a mapping"
                self.refuse(mark, f"{shown} cannot be a key, which is text; put it in quotes")
            if key in seen:
                twice = f"stands twice, first in line {seen[key]}; keep one of them"
                self.refuse(mark, f"{cut(key, _KEY)}: {twice}")
            seen[key] = mark.line + 1
        return super().construct_mapping(node, deep)


_TAG = "tag:yaml.org,2002:{}"
_UNSEEN = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")
"""Control characters, halves of characters, and what is no character, as escapes such as "\\0" write them."""


def _number(loader: _BoundedLoader, node: yaml.ScalarNode) -> Any:
    """An integer, number or date of a file, or the error of one that does not exist or is too large."""
    try:
        value = yaml.SafeLoader.yaml_constructors[node.tag](loader, node)
    except ValueError:  # no such date, or digits without end
        value = None
    if value is None or (isinstance(value, int) and abs(value) > _LARGEST):
        text = shortened(node.value, 40)
        loader.refuse(node.start_mark, f"{text} is no date or number that can be used; correct it")
    return value


def _words(loader: _BoundedLoader, node: yaml.ScalarNode) -> str:
    """Text of a file without what no page or table can show."""
    if unseen := _UNSEEN.search(node.value):
        what = f"the character U+{ord(unseen[0]):04X} cannot be shown as text; remove it"
        loader.refuse(node.start_mark, what)
    return str(node.value)


for _kind, _make in {"int": _number, "float": _number, "timestamp": _number, "str": _words}.items():
    _BoundedLoader.add_constructor(_TAG.format(_kind), _make)


if (
    __name__ == "__main__"
):  # python -m … FILE …: `make`, as Snakemake answers an unreadable file with a traceback
    try:
        documents_of(sys.argv[1:])
    except ConfigurationError as unreadable:
        sys.exit(f"error: {unreadable}")
