"""Whatever a YAML file holds, reading it ends soon, in a document or in one line that names file, line and remedy."""

from __future__ import annotations

import os
import random

import pytest

from dampbalance.project.documents import (
    MOST_BYTES,
    ConfigurationError,
    against_schema,
    in_lines,
    read_yaml,
)
from folders import ROOT
from processes import in_time

LONGEST = 300  # characters of a message
SECONDS = 20  # a file of the largest size takes one on an idle core


def error_of(file):
    """What reading a file says where it is refused, as it must be said; "" where it is read."""
    message = ""
    with in_time(SECONDS):
        try:
            read_yaml(file)
        except ConfigurationError as error:
            message = str(error)
    assert not message or message.startswith(str(file))
    assert len(message) <= LONGEST
    assert len(message.splitlines()) <= 1
    return message


def bomb(first: str, repeated: str) -> str:
    """Nine anchors, each of which repeats the one before ten times."""
    lines = [f"a0: &a0 {first}"]
    lines += [f"a{i}: &a{i} {repeated % ', '.join([f'*a{i - 1}'] * 10)}" for i in range(1, 10)]
    return "\n".join(lines)


HOSTILE = [
    (bomb("[x]", "[%s]"), "more than 20,000 values"),
    (bomb("{x: 1}", "{<<: [%s]}"), "line 6: not readable as YAML: too many values"),
    ("a: &a [*a]", "more than 20 lists and mappings inside each other"),
    ("a: !!int ''", "line 1: not readable as YAML: the value cannot be read (string index"),
    ("a: 1\nb:\n  a: 2\n  a: 3", "line 4: not readable as YAML, while constructing a mapping (beg"),
    ("a:\n\t- 1", "indent with spaces, not with tabs"),
    ("? [a, {b: c}]\n: d", "not readable as YAML: a key is a list or a mapping"),
    ("a: *" + "x" * 50_000, "line 1: not readable as YAML"),
    ("a: \x07", "the character U+0007 cannot stand in YAML; remove it"),
    ("a: !!python/object/apply:os.system [ls]", "line 1: not readable as YAML: could not deter"),
    ("a: x" + "x" * MOST_BYTES, "has more than 100,000 bytes"),
    (b"a: 1\nb: \xe9", "line 2: the byte 0xE9 is not UTF-8; save it as UTF-8"),
]


@pytest.mark.parametrize(("text", "told"), HOSTILE)
def test_what_cannot_be_read_is_told_in_one_line(tmp_path, text, told):
    file = tmp_path / "hostile.yaml"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    assert told in error_of(file)


def test_only_regular_files_are_read(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for file in (tmp_path, tmp_path / "pipe", tmp_path / "missing", "/dev/zero"):
        assert "cannot be read" in error_of(file)


def test_anchors_merges_and_an_empty_file_are_read(tmp_path):
    for text, held in (
        ("a: &a {x: 1, y: 2}\nb: {<<: *a, y: 3}\n", {"a": {"x": 1, "y": 2}, "b": {"x": 1, "y": 3}}),
        ("# nothing\n", {}),
    ):
        (tmp_path / "fine.yaml").write_text(text, encoding="utf-8")
        assert read_yaml(tmp_path / "fine.yaml") == held


@pytest.mark.parametrize("seed", range(5))
def test_a_file_with_errors_put_into_it_is_read_or_refused(tmp_path, seed):
    draw = random.Random(seed)
    data = bytearray((ROOT / "config/config.yaml").read_bytes())
    pieces = b"\t~\0~\xff~&a ~*a~[~}~: ~'~- ~!!x ~\n~?".split(b"~")
    for _ in range(draw.choice([1, 2, 5, 20])):
        place, width = draw.randrange(len(data)), draw.choice([0, 0, 1, 30])
        data[place : place + width] = draw.choice(pieces) * draw.choice([1, 1, 3])
    (tmp_path / "spoiled.yaml").write_bytes(bytes(data))
    error_of(tmp_path / "spoiled.yaml")


UNUSABLE = [
    ('a: "\\ud800"', "line 1: a: the character U+D800 cannot be shown as text; remove it"),
    (f"a: [1, {2**63}]", "line 1: a[2]: the number is too large; correct it"),
    ("b: 1\na: .inf", "line 2: a: inf is not a finite number"),
    ("~: 2", "None: unknown key; known here: a, list"),
    ("lisst: 2", "line 1: lisst: unknown key (did you mean list?)"),
    (f"a: {{x: {'x' * 60_000}}}", f"a: {{'x': '{'x' * 52}… is not allowed"),
    (f"list: [{'1, ' * 5000}1]", "… and 4981 more"),  # of 5,001 in all
]


@pytest.mark.parametrize(("text", "said"), UNUSABLE)
def test_a_value_that_nothing_can_use_is_named_in_a_line(tmp_path, text, said):
    file = tmp_path / "odd.yaml"
    file.write_text(text, encoding="utf-8")
    document = read_yaml(file)
    types = {"a": {"type": ["string", "array", "number"]}, "list": {"items": {"type": "string"}}}
    schema = {"additionalProperties": False, "properties": types}
    lines = in_lines(against_schema(document, schema), {str(file): document}).splitlines()
    assert lines[0].startswith(f"{file}: ")
    assert said in "\n".join(lines)
    assert all(len(line) <= LONGEST for line in lines)
