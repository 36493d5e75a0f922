"""Files as instruments export them, end to end: read at once, or with the mapping that is suggested, as it stands."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
import pandas as pd
import pytest
import yaml

from dampbalance import Oscillator, identify, measured_ring_down
from dampbalance.records.channel import QUANTITIES, RESPONSES
from dampbalance.records.errors import RecordError
from dampbalance.records.readers import mapping_to_start_from, read
from identification.levels import close, measured
from paper_case import PAPER
from records.drafts import filled

G = 9.80665
LOOSE = Oscillator(m=2.42, c=1.0, k=2310.0, K_z=208000.0, F_k=0.5)


@cache
def signals(level):
    """Signals of a level by quantity, SI, with time, number, a temperature and a status that does not change."""
    held = {}
    for base in ("base_displacement", "base_acceleration"):
        record = measured(channels=(base, *RESPONSES), seed=level + 4)[level]
        held |= {q: record[q].values for q in record}
    return held | others(record[base].t)


def others(t):
    """Columns that are no motion."""
    number = np.arange(1.0, t.size + 1.0)
    temperature = 21.0 + 0.1 * np.sin(0.01 * number)
    return {"time": t, "number": number, "temperature": temperature, "status": 0.0 * t}


@dataclass(frozen=True)
class Export:
    """A file: preamble and headings, and what its columns hold, each with its factor.

    aside : columns that the suggested mapping leaves aside, with the reason; None where none is needed.   holds : what
    is filled in there, quantity → column.
    """

    header: str
    columns: tuple[tuple[str, float], ...]
    delimiter: str = ","
    decimal: str = "."
    aside: tuple[str, ...] | None = None
    holds: Mapping[str, str] | None = None

    def write(self, folder, held, name="level"):
        """Write it with the signals that are held."""
        file = folder / f"{name}.csv"
        columns = pd.DataFrame(factor * held[name] for name, factor in self.columns).T
        options = {"sep": self.delimiter, "decimal": self.decimal, "float_format": "%.9g"}
        rows = columns.to_csv(index=False, header=False, **options)
        file.write_bytes(f"{self.header}\n{rows}".encode("cp1252"))
        return str(file)

    def mapping(self, file):
        """The mapping that is suggested, filled in; None where none is needed."""
        if self.aside is not None:
            return filled(yaml.safe_load(mapping_to_start_from(file)), self.holds or {})
        return None


TIME, BASE, MASS = ("time", 1.0), ("base_displacement", 1e3), ("displacement", 1e3)
FORCED = {
    "German": Export(
        "Zeit/s;Weg Tisch/mm;Beschleunigung/g", (TIME, BASE, ("acceleration", 1 / G)), ";", ","
    ),
    "accelerometer and LVDT": Export(
        "t (ms),Base (g),Relativweg (mm)",
        (("time", 1e3), ("base_acceleration", 1 / G), ("relative_displacement", 1e3)),
    ),
    "sensors": Export(
        "Model,MSO24\n\nRecord Length,5714\n\nTime,Temp,Status,Sensor A,Sensor B,Sensor C",
        (TIME, ("temperature", 1.0), ("status", 1.0), BASE, MASS, ("velocity", 1.0)),
        aside=("'Temp': a temperature", "'Status': constant, 0"),
        holds={"base_displacement": "Sensor A", "displacement": "Sensor B"},
    ),
    "no names": Export(
        "exported by hand",
        (("number", 1.0), TIME, BASE, MASS),
        "\t",
        aside=("'column 1': rises by 1 from sample to sample: a counter",),
        holds={"base_displacement": "column 3", "displacement": "column 4"},
    ),
}


@pytest.mark.filterwarnings("ignore:.*channels not used")
@pytest.mark.parametrize("name", FORCED)
def test_forced_records_are_read_as_they_were_recorded(name, tmp_path):
    export = FORCED[name]
    file = export.write(tmp_path, signals(0))
    if export.aside is not None:
        with pytest.raises(RecordError, match="what do the columns"):
            read(file)
        mapping = mapping_to_start_from(file)
        assert mapping.count("left aside") == len(export.aside)
        assert all(f"# left aside: {reason}" in mapping for reason in export.aside)
    measurement = read(file, export.mapping(file))
    recorded = [quantity for quantity, _ in export.columns if quantity in QUANTITIES]
    assert list(measurement) == recorded[:2]
    for quantity in measurement:
        values, channel = signals(0)[quantity], measurement[quantity]
        # nine digits
        np.testing.assert_allclose(channel.values, values, rtol=1e-8, atol=1e-8 * np.ptp(values))
        np.testing.assert_allclose(channel.t, signals(0)["time"], atol=1e-12)


@pytest.mark.filterwarnings("ignore:.*channels not used")
@pytest.mark.parametrize("name", ["accelerometer and LVDT", "sensors"])
def test_the_truth_is_found_in_files(name, tmp_path):
    export = FORCED[name]
    files = [export.write(tmp_path, signals(i), f"level{i}") for i in range(3)]
    found = identify(files, PAPER.k, mapping=export.mapping(files[0]))
    assert found.verdicts["F_k"].verdict == found.verdicts["c"].verdict == "usable"
    assert close(found, PAPER, ("F_k", "c"))


@pytest.mark.parametrize("heading", ["Laser/mm", "Laser"])
def test_a_decay_of_one_channel(heading, tmp_path):
    decay = measured_ring_down(LOOSE, x=0.01, rate_hz=1000.0, duration=4.0, noise=0.002, seed=3)
    channel = decay["displacement"]
    export = Export(
        f"Elapsed Time (s),Temperatur/°C,{heading}",
        (TIME, ("temperature", 1.0), MASS),
        aside=() if heading == "Laser" else None,
        holds={"displacement": "Laser"},
    )
    file = export.write(tmp_path, others(channel.t) | {"displacement": channel.values})
    found = identify(file, LOOSE.k, mapping=export.mapping(file))
    assert close(found, LOOSE)


def test_what_is_known_already_is_kept(tmp_path):
    file = Export("a;b", (BASE, MASS), ";", ",").write(tmp_path, signals(0))
    known = {"delimiter": ";", "decimal": ",", "sample_rate_hz": 1000.0, "level": "4 mm"}
    mapping = yaml.safe_load(mapping_to_start_from(file, known))
    assert {key: mapping[key] for key in known} == known
    mapping = filled(mapping, {"base_displacement": "a", "displacement": "b"})
    assert list(read(file, mapping)) == ["base_displacement", "displacement"]
    with pytest.raises(RecordError, match=r"names the channels of .* already"):
        mapping_to_start_from(file, mapping)
