"""The YAML beside a record: where it is looked for, what it may say, and how mistakes in it are named."""

from __future__ import annotations

import re

import numpy as np
import pytest
import yaml

from dampbalance.records.channel import QUANTITIES, ROTATING
from dampbalance.records.errors import RecordError
from dampbalance.records.headings import TEMPERATURE, WORDS
from dampbalance.records.mapping import (
    SCHEMA,
    ChannelRule,
    RecordMapping,
    find_mapping,
    mapping_file,
    mapping_for,
    mapping_from,
    parts_of,
    read_mapping,
)
from dampbalance.records.readers import FORMATS, read
from dampbalance.records.units import UNITS
from folders import ROOT

FULL = """\
channels:
  base_displacement: {channel: Laser 1, unit: mm}
  acceleration: {channel: 3, unit: g, scale: 0.01, sign: -1, time: t2}
time: {channel: t, unit: ms}
delimiter: ";"
decimal: ","
header_lines: 3
frequency_hz: 4.92
level: 4
notes: first run
"""


def test_every_key_is_read(tmp_path):
    file = tmp_path / "channels.yaml"
    file.write_text(FULL, encoding="utf-8")
    mapping = read_mapping(file)
    assert mapping == RecordMapping(
        source=str(file),
        channels={
            "base_displacement": ChannelRule("Laser 1", "mm"),
            "acceleration": ChannelRule(3, "g", 0.01, -1, "t2"),
        },
        time="t",
        time_unit="ms",
        delimiter=";",
        decimal=",",
        header_lines=3,
        frequency_hz=4.92,
        level="4",
        notes="first run",
    )


def test_the_nearest_file_counts(tmp_path):
    record = tmp_path / "run1.csv"
    assert find_mapping(record) is None
    assert mapping_for(record) == RecordMapping()
    # each is nearer than the one before
    for name in ("channels.yaml", "run1.yaml", "run1.csv.yaml"):
        (tmp_path / name).write_text("sample_rate_hz: 100\n", encoding="utf-8")
        assert find_mapping(record) == tmp_path / name
    other = tmp_path / "elsewhere.yaml"
    other.write_text("sample_rate_hz: 200\n", encoding="utf-8")
    assert mapping_for(record, other).sample_rate_hz == 200
    assert mapping_for(record, {"sample_rate_hz": 300}).sample_rate_hz == 300


def test_a_folder_holds_the_mappings_of_records_that_stand_elsewhere(tmp_path):
    record, folder = tmp_path / "theirs" / "run1.mat", tmp_path / "mine"
    folder.mkdir()
    assert mapping_file(record, folder) is None
    assert mapping_for(record, folder) == RecordMapping()
    (folder / "run1.mat.yaml").write_text("sample_rate_hz: 400\n", encoding="utf-8")
    assert mapping_file(record, str(folder)) == folder / "run1.mat.yaml"
    assert mapping_for(record, folder).sample_rate_hz == 400
    assert mapping_for(tmp_path / "theirs" / "run2.mat", folder) == RecordMapping()


def test_an_empty_mapping_says_nothing(tmp_path):
    file = tmp_path / "run.yaml"
    file.write_text("", encoding="utf-8")
    assert read_mapping(file) == RecordMapping(source=str(file))


TWO = {"force": {"channel": 1}, "displacement": {"channel": 2}}


def force(more=None, **rule):
    """A mapping of two channels and some more, in which the rule of the force says more."""
    return {"channels": TWO | {"force": {"channel": 1} | rule} | (more or {})}


@pytest.mark.parametrize(
    ("document", "message"),
    [
        ({"chanels": TWO}, r"chanels: unknown key \(did you mean channels\?\)"),
        (force({"position": {"channel": 3}}), r"channels\.position: unknown key.*displacement"),
        ({"channels": {**TWO, "force": {"unit": "N"}}}, r"channels\.force\.channel: missing; Name"),
        (force(channel=0), r"force\.channel: 0 is not allowed"),
        (force(sign=2), r"sign: 2 is not allowed.*-1"),
        (force(scale=0), r"scale: 0 is not allowed"),
        (force(scale="1e3"), r"'1e3' is text to YAML; write 1\.0e\+3"),
        (
            force(unit="mm"),
            r"force\.unit: 'mm' is a unit of length, but force needs one of force: N",
        ),
        (
            force({"velocity": {"channel": 3, "unit": "mmm"}}),
            r"velocity\.unit: unknown unit 'mmm' \(did you mean mm\?\)",
        ),
        (force({"velocity": {"channel": 2}}), r"2 is displacement already"),
        ({"channels": {"force": {"channel": 1}}}, r"channels: .* at least one of displacement"),
        (
            {"time": {"channel": 1}, "sample_rate_hz": 5},
            r"time: .* Not together with sample_rate_hz",
        ),
        (
            force(time=3) | {"sample_rate_hz": 5},
            r"channels\.force\.time: 3 is not allowed\. Not together with sample_",
        ),
        ({"time": {"unit": "mm"}}, r"time\.unit: 'mm' is a unit of length, but time needs"),
        ({"sample_rate_hz": 0}, r"sample_rate_hz: 0 is not allowed. Samples per second"),
        ({"sample_rate_hz": float("inf")}, r"sample_rate_hz: inf is not a finite number"),
        ({"delimiter": ",", "decimal": ","}, r"decimal: ',' .* It is the delimiter, too"),
        ({"delimiter": "::"}, r"delimiter: '::' .*one character"),
        ({"decimal": "'"}, r"decimal: \"'\" is not allowed"),
        ({"header_lines": -1}, r"header_lines: -1 is not allowed"),
        ({"frequency_hz": -4.92}, r"frequency_hz: -4.92 is not allowed"),
        ([1], r"\(top level\): \[1\] is not allowed"),
    ],
)
def test_mistakes_are_named(document, message):
    with pytest.raises(RecordError, match=message) as error:
        mapping_from(document, "run.yaml")
    assert str(error.value).startswith("run.yaml: ")
    assert "\n" not in str(error.value)  # one mistake, one line


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("channels: [\n", "not readable as YAML"),
        ("notes: a\nnotes: b\n", "duplicate key .notes."),
        ("\xff\xfe", "is not UTF-8"),
        (None, r"run\.yaml"),
    ],
)
def test_a_file_that_is_no_mapping(tmp_path, text, message):
    file = tmp_path / "run.yaml"
    if text is not None:
        file.write_bytes(text.encode("latin-1"))
    with pytest.raises(RecordError, match=message) as error:
        read_mapping(file)
    assert str(file) in str(error.value)


# The documentation

README = ROOT / "config/records/README.md"


def examples():
    """The files that the page shows, by name."""
    text = README.read_text(encoding="utf-8")
    return dict(re.findall(r"^`([\w.]+)`\n```\w+\n(.*?)^```$", text, re.DOTALL | re.MULTILINE))


def test_the_examples_read_as_they_say(tmp_path):
    shown = examples()
    named = ["run1.csv", "run2.csv", "run2.yaml", "level1_base.csv.yaml", "levels.mat.yaml"]
    assert list(shown) == [*named, "rig.yaml"]
    shown.pop("rig.yaml")  # no mapping: the tests of the workflow run it
    table = mapping_from(yaml.safe_load(shown.pop("levels.mat.yaml"))).table
    assert list(table) == ["frequency", "force", "acceleration", "phase"]
    assert table["acceleration"].scale == pytest.approx(2.0**0.5, rel=1e-4)
    several = mapping_from(yaml.safe_load(shown.pop("level1_base.csv.yaml")))
    parts = parts_of(tmp_path / "level1_base.csv", several)
    assert [part.name for part in parts] == ["level1_base.csv", "level1_acc.csv"]
    for name, text in shown.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    one, two = read(tmp_path / "run1.csv"), read(tmp_path / "run2.csv")
    np.testing.assert_array_equal(one["base_displacement"].values, [0.0, 1e-3, 2e-3, 1.5e-3])
    for quantity in ("base_displacement", "acceleration"):
        # scale and unit are multiplied first: a factor may differ in its last bit
        np.testing.assert_allclose(one[quantity].values, two[quantity].values, rtol=1e-15)
        np.testing.assert_allclose(one[quantity].t, two[quantity].t, rtol=1e-15)
    assert mapping_for(tmp_path / "run2.csv").frequency_hz == 4.92


def test_the_page_names_every_quantity_suffix_name_and_unit():
    text = README.read_text(encoding="utf-8")
    schema = yaml.safe_load(SCHEMA.read_text(encoding="utf-8"))
    assert list(schema["properties"]["channels"]["properties"]) == [
        *QUANTITIES,
        *ROTATING,
    ]
    words = [*" ".join(WORDS.values()).split(), *TEMPERATURE]
    for name in [*QUANTITIES, *ROTATING, *words]:
        assert f"`{name}`" in text
    for suffix in (suffix for known in FORMATS.values() for suffix in known.suffixes):
        assert re.search(rf"(?<!\w){re.escape(suffix)} ", text), suffix
    listed = re.search(r"^Units: (.*?)\. `um`", text, re.MULTILINE)
    units = re.split(r"[,;] ", listed[1])
    assert units == [u.name for u in UNITS if u.dimension != "frequency"]
