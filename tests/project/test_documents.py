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
    shortened,
)
from folders import ROOT
from processes import in_time

LONGEST = 300  # characters of a message
SECONDS = 20  # a file of the largest size takes one on an idle core


def error_of(file):
    with in_time(SECONDS), pytest.raises(ConfigurationError) as caught:
        read_yaml(file)
    message = str(caught.value)
    assert len(message) <= LONGEST
    assert len(message.splitlines()) == 1
    return message


def bomb(first: str, repeated: str) -> str:
    """Nine anchors, each of which repeats the one before ten times."""
    lines = [f"a0: &a0 {first}"]
    lines += [f"a{i}: &a{i} {repeated % ', '.join([f'*a{i - 1}'] * 10)}" for i in range(1, 10)]
    return "\n".join(lines)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (bomb("[x]", "[%s]"), "more than 20,000 values"),
        (bomb("{x: 1}", "{<<: [%s]}"), "line 6: not readable as YAML: too many values"),
        ("a: [" + "1," * 25_000 + "]", "more than 20,000 values"),
        ("a: &a [*a]", "more than 20 lists and mappings inside each other"),
        ("[" * 30_000, "more than 20 lists and mappings inside each other"),
        ("\n".join(" " * i + "a:" for i in range(400)), "more than 20 lists"),
        (
            "a: 1\nb: 2026-13-45",
            "line 2: not readable as YAML: the value cannot be read (month must be in 1..12); correct it",
        ),
        (
            "a: 2026-01-01 25:61:00",
            "line 1: not readable as YAML: the value cannot be read (hour must be in 0..23",
        ),
        (
            "a: " + "9" * 5000,
            "line 1: not readable as YAML: the value cannot be read (Exceeds the limit",
        ),
        (
            "a: 0x_",
            "line 1: not readable as YAML: the value cannot be read (invalid literal for int",
        ),
        ("{a: 1}: 3", "line 1: not readable as YAML, while constructing a mapping: found unhash"),
        (
            "a: 1\nb:\n  a: 2\n  a: 3",
            'line 4: not readable as YAML, while constructing a mapping (begun in line 3): found duplicate key "a"',
        ),
        ("a:\n\t- 1", "indent with spaces, not with tabs"),
        (
            "a: [1,\n2",
            "line 2: not readable as YAML, while parsing a flow sequence (begun in line 1)",
        ),
        ("a: !!bool x", "line 1: not readable as YAML: the value cannot be read ('x'); correct it"),
        ("a: !!int ''", "line 1: not readable as YAML: the value cannot be read (string index"),
        ("? [a, {b: c}]\n: d", "not readable as YAML: unhashable type: 'dict'"),
        ("a: *nowhere", "line 1: not readable as YAML"),
        ("a: *" + "x" * 50_000, "line 1: not readable as YAML"),
        ("a: 1\n---\nb: 2", "line 2: not readable as YAML"),
        ("a: \x07", "the character U+0007 cannot stand in YAML; remove it"),
        (
            "a: !!python/object/apply:os.system [ls]",
            "line 1: not readable as YAML: could not deter",
        ),
        ("a: x" + "x" * MOST_BYTES, "has more than 100,000 bytes"),
    ],
)
def test_what_cannot_be_read_is_told_in_one_line(tmp_path, text, told):
    file = tmp_path / "hostile.yaml"
    file.write_text(text, encoding="utf-8")
    message = error_of(file)
    assert message.startswith(str(file))
    assert told in message


@pytest.mark.parametrize(
    "data", [b"a: 1\nb: \xe9", "a: 1".encode("utf-16"), bytes(range(128, 256))]
)
def test_other_encodings_are_refused(tmp_path, data):
    file = tmp_path / "latin.yaml"
    file.write_bytes(data)
    assert "is not UTF-8; save it as UTF-8" in error_of(file)


def test_only_regular_files_are_read(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "dangling").symlink_to(tmp_path / "nowhere")
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    files = [tmp_path / name for name in (".", "pipe", "missing", "dangling", "loop")]
    for file in (*files, "/dev/zero"):
        assert "cannot be read" in error_of(file)


def test_anchors_merges_and_an_empty_file_are_read(tmp_path):
    file = tmp_path / "fine.yaml"
    file.write_text("a: &a {x: 1, y: 2}\nb: {<<: *a, y: 3}\n", encoding="utf-8")
    assert read_yaml(file) == {"a": {"x": 1, "y": 2}, "b": {"x": 1, "y": 3}}
    file.write_text("# nothing\n", encoding="utf-8")
    assert read_yaml(file) == {}


@pytest.mark.parametrize("seed", range(60))
def test_a_file_with_errors_put_into_it_is_read_or_refused(tmp_path, seed):
    draw = random.Random(seed)
    data = bytearray((ROOT / "config/config.yaml").read_bytes())
    pieces = b"\t~\0~\xff~&a ~*a~[~}~: ~'~- ~!!x ~\n~?".split(b"~")
    for _ in range(draw.choice([1, 2, 5, 20])):
        place = draw.randrange(len(data))
        width = draw.choice([0, 0, 1, 30])
        data[place : place + width] = draw.choice(pieces) * draw.choice([1, 1, 3])
    file = tmp_path / "mutated.yaml"
    file.write_bytes(bytes(data))
    message = ""
    with in_time(SECONDS):
        try:
            read_yaml(file)
        except ConfigurationError as error:
            message = str(error)
    assert not message or message.startswith(str(file))
    assert len(message) <= LONGEST
    assert len(message.splitlines()) <= 1
    assert file.read_bytes() == bytes(data)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('a: "\\0"', "a: the character U+0000 cannot be shown as text; remove it"),
        ('a: "\\ud800"', "a: the character U+D800 cannot be shown as text; remove it"),
        (f"a: [1, {2**63}]", "a[2]: the number is too large; correct it"),
        ("a: .inf", "a: inf is not a finite number"),
        ("1: 2", "1: unknown key; known here: a"),
        ("~: 2", "None: unknown key; known here: a"),
        ("[1, 2]: 2", "(1, 2): unknown key; known here: a"),
        ('"\\0": 2', "�: unknown key; known here: a"),
        ("a: !!set {b, c}", "is not allowed"),
    ],
)
def test_a_value_that_nothing_can_use_is_named(tmp_path, text, said):
    file = tmp_path / "odd.yaml"
    file.write_text(text, encoding="utf-8")
    document = read_yaml(file)
    schema = {
        "additionalProperties": False,
        "properties": {"a": {"type": ["string", "array", "number"]}},
    }
    (line,) = in_lines(against_schema(document, schema), {str(file): document}).splitlines()
    assert line.startswith(f"{file}: ")
    assert said in line


def test_messages_quote_no_more_than_a_line(tmp_path):
    file = tmp_path / "long.yaml"
    file.write_text(f"name: {'x' * 60_000}\nlist: [{'1, ' * 5000}1]\n", encoding="utf-8")
    document = read_yaml(file)
    schema = {"properties": {"name": {"enum": ["a"]}, "list": {"items": {"type": "string"}}}}
    lines = in_lines(against_schema(document, schema), {str(file): document}).splitlines()
    assert lines[-1] == "… and 4982 more"  # of 5,002 in all
    assert all(len(line) <= LONGEST for line in lines)
    assert len(shortened("x" * 1000)) == 60
