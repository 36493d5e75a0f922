"""The YAML beside a record: where it is looked for, what it may say, and how mistakes in it are named."""

from __future__ import annotations

import re

import numpy as np
import pytest
import yaml

from dampbalance.records.errors import RecordError
from dampbalance.records.mapping import (
    ChannelRule,
    RecordMapping,
    find_mapping,
    mapping_file,
    mapping_for,
    mapping_from,
    parts_of,
    read_mapping,
)
from dampbalance.records.readers import read
from dampbalance.records.recognise import recognise
from dampbalance.records.table import RawChannel, Table
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
    rules = {
        "base_displacement": ChannelRule("Laser 1", "mm"),
        "acceleration": ChannelRule(3, "g", 0.01, -1, "t2"),
    }
    layout = {"time": "t", "time_unit": "ms", "delimiter": ";", "decimal": ",", "header_lines": 3}
    more = {"frequency_hz": 4.92, "level": "4", "notes": "first run"}
    assert read_mapping(file) == RecordMapping(str(file), rules, **layout, **more)
    file.write_text("", encoding="utf-8")
    assert read_mapping(file) == RecordMapping(source=str(file))


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
    record = tmp_path / "theirs/run1.mat"
    assert mapping_for(record, tmp_path) == RecordMapping()
    (tmp_path / "run1.mat.yaml").write_text("sample_rate_hz: 400\n", encoding="utf-8")
    assert mapping_file(record, str(tmp_path)) == tmp_path / "run1.mat.yaml"
    assert mapping_for(record, tmp_path).sample_rate_hz == 400
    assert mapping_for(tmp_path / "theirs/run2.mat", tmp_path) == RecordMapping()


TWO = {"force": {"channel": 1}, "displacement": {"channel": 2}}
STEPPED = TWO | {"frequency": {"channel": 3}, "phase": {"channel": 4}}


def force(more=None, **rule):
    """A mapping of two channels and some more, in which the rule of the force says more."""
    return {"channels": TWO | {"force": {"channel": 1} | rule} | (more or {})}


MISTAKES = {
    r"chanels: unknown key \(did you mean channels\?\)": {"chanels": TWO},
    r"channels\.position: unknown key.*displacement": force({"position": {"channel": 3}}),
    r"force\.channel: missing; Name": {"channels": {**TWO, "force": {"unit": "N"}}},
    r"sign: 2 is not allowed.*-1": force(sign=2),
    r"force\.unit: 'mm' is a unit of length, but force needs one of force: N": force(unit="mm"),
    r"velocity\.channel: 2 is displacement already": force({"velocity": {"channel": 2}}),
    r"channels: .* at least one of displacement": {"channels": {"force": {"channel": 1}}},
    r"time: .* with sample_rate_hz": {"time": {"channel": 1}, "sample_rate_hz": 5},
    r"force\.time: 3 .* with sample_": force(time=3) | {"sample_rate_hz": 5},
    r"time\.unit: 'mm' is a unit of length, but time needs": {"time": {"unit": "mm"}},
    r"decimal: ',' .* It is the delimiter, too": {"delimiter": ",", "decimal": ","},
    r"delimiter: '::' .*one character": {"delimiter": "::"},
    r"table\.phase: missing": {"table": TWO | {"frequency": {"channel": 3}}},
    r"table\.force\.unit": {"table": STEPPED | {"force": {"channel": 1, "unit": "m"}}},
    "Not together with table": {"table": STEPPED, "channels": TWO},
}


@pytest.mark.parametrize("message", MISTAKES)
def test_mistakes_are_named(message):
    with pytest.raises(RecordError, match=message) as error:
        mapping_from(MISTAKES[message], "run.yaml")
    assert str(error.value).startswith("run.yaml: ")
    assert "\n" not in str(error.value)  # one mistake, one line


def test_each_missing_key_is_named_once():
    with pytest.raises(RecordError) as error:
        mapping_from({"table": TWO}, "run.yaml")
    keys = [line.split(": ")[1] for line in str(error.value).splitlines()]
    assert keys == ["table.frequency", "table.phase"]


UNFIT = {
    r"acceleration\.channel: .* no channel 'b'; it has 1 'y .mm.', 2 'acc .g.'": {"channel": "b"},
    "there is no channel 9; .* has 4": {"channel": 9},
    "has 2 channels 'CH', numbers 3 and 4; give one": {"channel": "CH"},
    r"acceleration\.time: .* no channel 't9'": {"channel": "acc", "time": "t9"},
    "'acc' cannot be its own time": {"channel": "acc", "time": "acc"},
    "'y': 'mm' is a unit of length": {"channel": "y"},
    "'acc' needs it: say sample_rate_hz": {"channel": "acc"},
}


@pytest.mark.parametrize("message", UNFIT)
def test_a_mapping_that_does_not_fit_is_refused_before_samples_are_loaded(message):
    def load(wanted):
        raise AssertionError(f"channels {wanted} were loaded")

    units = {"y": "mm", "acc": "g"}
    channels = [RawChannel(name, units.get(name), 9) for name in ("y", "acc", "CH", "CH")]
    rules = mapping_from({"channels": {"acceleration": UNFIT[message]}})
    with pytest.raises(RecordError, match=message):
        recognise(Table("run", channels, load), rules)


# The documentation


def examples():
    """The files that the page shows, by name."""
    text = (ROOT / "config/records/README.md").read_text(encoding="utf-8")
    return dict(re.findall(r"^`([\w.]+)`\n```\w+\n(.*?)^```$", text, re.DOTALL | re.MULTILINE))


def test_the_examples_read_as_they_say(tmp_path):
    shown = examples()
    table = mapping_from(yaml.safe_load(shown["levels.mat.yaml"])).table
    assert list(table) == ["frequency", "force", "acceleration", "phase"]
    assert table["acceleration"].scale == pytest.approx(2.0**0.5, rel=1e-4)
    several = mapping_from(yaml.safe_load(shown["level1_base.csv.yaml"]))
    parts = parts_of(tmp_path / "level1_base.csv", several)
    assert [part.name for part in parts] == ["level1_base.csv", "level1_acc.csv"]
    for name in ("run1.csv", "run2.csv", "run2.yaml"):
        (tmp_path / name).write_text(shown[name], encoding="utf-8")
    one, two = read(tmp_path / "run1.csv"), read(tmp_path / "run2.csv")
    np.testing.assert_array_equal(one["base_displacement"].values, [0.0, 1e-3, 2e-3, 1.5e-3])
    for quantity in ("base_displacement", "acceleration"):
        # scale and unit are multiplied first: a factor may differ in its last bit
        np.testing.assert_allclose(one[quantity].values, two[quantity].values, rtol=1e-15)
        np.testing.assert_allclose(one[quantity].t, two[quantity].t, rtol=1e-15)
    assert mapping_for(tmp_path / "run2.csv").frequency_hz == 4.92
