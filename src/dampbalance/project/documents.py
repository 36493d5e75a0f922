"""YAML files of a user, read within bounds and checked before anything is computed.

Every error is one line: file, line, key, what is wrong, and what would be right.
"""

from __future__ import annotations

import functools
import math
import re
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NoReturn

import jsonschema
from jsonschema import ValidationError
from ruamel.yaml import YAML
from ruamel.yaml.constructor import ConstructorError, SafeConstructor
from ruamel.yaml.error import MarkedYAMLError
from ruamel.yaml.nodes import Node
from ruamel.yaml.reader import ReaderError

from ..law.terms import KNOWN_TERMS
from .wording import cut, did_you_mean, shortened

KeyPath = tuple[str | int, ...]
Problem = tuple[KeyPath, str]  # a key, its fault and the remedy
MOST_BYTES = 100_000  # the longest file of the project has 20 kB
MOST_VALUES = 20_000  # keys and values in a file, those that aliases repeat counted each time
DEEPEST = 20  # lists and mappings inside each other; the schemas go down to seven
_LINE_LENGTHS, _KEY = 300, 40  # characters of a message, and of a key in it
_MESSAGES = 20  # shown of a file that is wrong all over
_NAMES = 'Use letters, digits, "-" and "_".'
_UNSEEN = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")
"""Control characters, halves of characters, and what is no character, as escapes such as "\\0" write them."""


class ConfigurationError(ValueError):
    """A configuration that cannot be used; the message names the file, the key and the remedy."""


def documents_of(files: Iterable[str | Path]) -> dict[str, Any]:
    """Return what each file says."""
    return {str(file): read_yaml(file) for file in files}


def refuse(key: KeyPath, text: str, files: Iterable[str | Path]) -> NoReturn:
    """Raise the ConfigurationError for one key; the text says what is wrong and what would be right."""
    raise ConfigurationError(in_lines([(key, text)], documents_of(files)))


class _Constructor(SafeConstructor):
    """Makes plain values, within bounds; every error names its line."""

    def construct_object(self, node: Node, deep: bool = False) -> Any:
        try:
            return super().construct_object(node, deep)
        except (ValueError, LookupError) as error:
            what = f"the value cannot be read ({error}); correct it"
            raise ConstructorError(None, None, what, node.start_mark) from None

    def flatten_mapping(self, node: Any) -> Any:
        super().flatten_mapping(node)
        if len(node.value) > MOST_VALUES:
            raise ConstructorError(None, None, "too many values", node.start_mark)


def _parser() -> YAML:
    parser = YAML(typ="safe", pure=True)
    parser.Constructor = _Constructor
    return parser


def read_yaml(file: str | Path) -> Any:
    """Return the document of a YAML file, {} for an empty one: keys that stand once, plain values.

    A file is read within bounds (MOST_BYTES, MOST_VALUES, DEEPEST): none takes long, or much memory.

    Raises ConfigurationError naming file, line, what is wrong and what would be right.
    """
    try:
        if Path(file).exists() and not Path(file).is_file():
            raise OSError(0, "is no file")
        with open(file, "rb") as stream:
            data = stream.read(MOST_BYTES + 1)
        if len(data) > MOST_BYTES:
            what = f"has more than {MOST_BYTES:,} bytes; give ranges instead of lists"
        else:
            document = _parser().load(data.decode("utf-8"))
            what = _beyond_bounds(document)
            if not what:
                return {} if document is None else document
    except OSError as error:
        what = f"cannot be read ({error.strerror}); name a YAML file"
    except UnicodeDecodeError as error:
        line, byte = data.count(b"\n", 0, error.start) + 1, data[error.start]
        what = f"line {line}: the byte 0x{byte:02X} is not UTF-8; save it as UTF-8"
    except RecursionError:
        what = _TOO_DEEP
    except TypeError as error:  # a list with mappings as a key
        what = f"not readable as YAML: {error}"
    except ReaderError as error:
        what = f"the character U+{error.character:04X} cannot stand in YAML; remove it"
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        begun = error.context_mark or mark
        since = f" (begun in line {begun.line + 1})" if begun.line != mark.line else ""
        context = f", {error.context}{since}" if error.context else ""
        what = f"line {mark.line + 1}: not readable as YAML{context}: {error.problem}"
        if "'\\t'" in str(error.problem):
            what += "; indent with spaces, not with tabs"
    raise ConfigurationError(_one_line(f"{file}: {what}"))


_TOO_DEEP = f"has more than {DEEPEST} lists and mappings inside each other"


def _beyond_bounds(document: Any) -> str:
    """Return why a document is not used: how much it holds, or how deep; "" if it may be."""
    count, waiting = 0, [(document, 0)]
    while waiting:
        value, depth = waiting.pop()
        count += 1
        if depth > DEEPEST:
            return _TOO_DEEP
        if count > MOST_VALUES:
            return f"has more than {MOST_VALUES:,} values; give ranges instead of lists"
        if isinstance(value, Mapping | list):
            items = value.values() if isinstance(value, Mapping) else value
            waiting += [(item, depth + 1) for item in items]
    return ""


@functools.cache
def read_schema(file: str | Path) -> Any:
    """Return a schema of this project, which needs no bounds and is read once."""
    return _parser().load(Path(file))


def _one_line(text: str) -> str:
    """Return the text in a line that fits a screen."""
    return cut(_UNSEEN.sub("\N{REPLACEMENT CHARACTER}", " ".join(text.split())), _LINE_LENGTHS)


def against_schema(
    document: Any, schema: Mapping[str, Any], approaches: Iterable[str] = ()
) -> list[Problem]:
    """Return what is wrong with a document by its JSON schema, or because no value can be so; in a fixed order.

    approaches : names that the schema's `registered: approach` allows; `registered: term` allows those of KNOWN_TERMS.

    The texts say what is wrong and, from the `description` of the key in the schema, what would be right.
    """
    validator = _validator(schema, list(approaches))
    errors = sorted(validator.iter_errors(document), key=lambda error: list(map(str, error.path)))
    impossible = list(_impossible(document))
    # each of several keys that are missing is an error for all of them
    problems = dict.fromkeys(problem for error in errors for problem in _explain(error))
    keys = {key for key, _ in impossible}
    return [problem for problem in problems if problem[0] not in keys] + impossible


def _validator(schema: Mapping[str, Any], approaches: list[str]) -> Any:
    """Return a validator that knows our keyword `registered`.

    Its value is the name of an approach, of a term of a law, or one of those of `also` next to it. An
    integer is one to Python (2.0 is none), and a pattern holds for the whole text, its last line end too.
    """

    def check(_: Any, kind: str, value: Any, node: Any) -> Iterable[ValidationError]:
        names = (list(KNOWN_TERMS) if kind == "term" else approaches) + node.get("also", [])
        if value not in names:
            words = f"{'an' if kind == 'approach' else 'a'} {kind}{did_you_mean(value, names)}"
            yield ValidationError(f"{shortened(value)} is not {words}; known: {', '.join(names)}")

    def pattern(_: Any, wanted: str, value: Any, __: Any) -> Iterable[ValidationError]:
        if isinstance(value, str) and not re.fullmatch(wanted.removesuffix("$"), value):
            yield ValidationError("")

    base: Any = jsonschema.Draft202012Validator
    types = base.TYPE_CHECKER.redefine("integer", lambda _, value: type(value) is int)
    extend: Any = jsonschema.validators.extend
    ours = {"registered": check, "pattern": pattern}
    return extend(base, ours, type_checker=types)(schema)


def in_lines(problems: Iterable[Problem], documents: Mapping[str, Any]) -> str:
    """Return a line for each problem, "file: line N: key: wrong, right", and no more than fit a screen.

    documents : file → what it says, merged in this order, the last one winning: they show where a key is set.
    """
    listed, lines = list(problems), []
    with_lines = functools.cache(lambda file: YAML(pure=True).load(Path(file)))
    for key, text in listed[:_MESSAGES]:
        depths = {file: _depth(key, document) for file, document in documents.items()}
        # the last file that sets the key, or the longest part of it that any file sets
        file = max(reversed(depths), key=lambda file: depths[file], default="configuration")
        line = _line_of(key[: depths[file]], with_lines(file)) if Path(file).is_file() else ""
        lines.append(_one_line(f"{file}: {line}{_dotted(key)}: {text}"))
    if len(listed) > _MESSAGES:
        lines.append(f"… and {len(listed) - _MESSAGES} more")
    return "\n".join(lines)


def _explain(error: ValidationError) -> Iterable[Problem]:
    key: KeyPath = tuple(error.absolute_path)
    schema: Any = error.schema  # a mapping: the schema has no true or false in it
    wanted: Any = error.validator_value
    meaning = schema.get("description", "").strip()
    value: Any = error.instance
    if error.validator == "additionalProperties":
        keys = list(schema["properties"])
        for name in value:
            if name not in keys:
                text = f"unknown key{did_you_mean(name, keys)}; known here: {', '.join(keys)}"
                yield (*key, str(name)), text
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


def _of_numbers(wanted: str | list[str]) -> bool:
    return not {"number", "integer"}.isdisjoint([wanted] if isinstance(wanted, str) else wanted)


def _as_number(text: object) -> str:
    """Return how to write a number that YAML takes for text; nothing for what is no number.

    YAML wants a mantissa with a point, and an exponent with a sign.
    """
    try:
        float(text if isinstance(text, str) else "")
    except ValueError:
        return ""
    mantissa, e, exponent = str(text).lower().partition("e")
    point = mantissa if "." in mantissa else f"{mantissa}.0"
    return f"{point}e{int(exponent):+d}" if e else "it without quotes"


def _impossible(value: Any, key: KeyPath = ()) -> Iterable[Problem]:
    """Yield the numbers that no array can hold, and the text that no page can show."""
    if isinstance(value, Mapping | list):
        for name, item in value.items() if isinstance(value, Mapping) else enumerate(value):
            yield from _impossible(item, (*key, name))
    elif isinstance(value, float) and not math.isfinite(value):
        yield key, f"{value!r} is not a finite number"
    elif isinstance(value, int) and abs(value) > 2**63 - 1:  # the largest integer of an array
        yield key, "the number is too large; correct it"
    elif isinstance(value, str) and (unseen := _UNSEEN.search(value)):
        yield key, f"the character U+{ord(unseen[0]):04X} cannot be shown as text; remove it"


def _dotted(key: KeyPath) -> str:
    """Return the key as a person writes it, list positions counted from 1."""
    text = ""
    for part in key:
        text += f"[{part + 1}]" if isinstance(part, int) else f".{cut(str(part), _KEY)}"
    return text.removeprefix(".") or "(top level)"


def _depth(key: KeyPath, document: Any) -> int:
    """Return how many parts of a key a document sets."""
    for depth, part in enumerate(key):
        try:
            document = document[part]
        except (KeyError, IndexError, TypeError):
            return depth
    return len(key)


def _line_of(key: KeyPath, document: Any) -> str:
    """Return where a key stands in a document that knows its lines, "line 3: "; nothing for the top level."""
    line = ""
    for part in key:
        if part not in (document.lc.data or ()):  # it is merged into this mapping
            break
        line, document = f"line {document.lc.data[part][0] + 1}: ", document[part]
    return line


# `make` runs python -m … FILE …, because Snakemake shows a traceback for an unreadable file
if __name__ == "__main__":
    try:
        documents_of(sys.argv[1:])
    except ConfigurationError as unreadable:
        sys.exit(f"error: {unreadable}")
