"""Files as instruments export them, end to end: read at once, or with the mapping that is suggested, as it stands."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
import yaml

from dampbalance import Oscillator, identify, measured_orbit, measured_ring_down
from dampbalance.records.channel import QUANTITIES, RESPONSES
from dampbalance.records.errors import RecordError
from dampbalance.records.readers import mapping_to_start_from, read
from paper_case import PAPER, orbits_at
from records.drafts import filled

G = 9.80665
LOOSE = Oscillator(m=2.42, c=1.0, k=2310.0, K_z=208000.0, F_k=0.5)


@cache
def signals(level):
    """Signals of a level by quantity, SI, with time, number, a temperature and a status that does not change."""
    orbit = orbits_at(3.5, (0.004, 0.008, 0.012))[level]
    held = {}
    for base in ("base_displacement", "base_acceleration"):
        record = measured_orbit(
            orbit,
            **{"rate_hz": 1000.0, "cycles": 20.0, "noise": 0.01, "seed": level + 4},
            channels=(base, *RESPONSES),
        )
        held |= {q: record[q].values for q in record}
    return held | others(record[base].t)


def others(t):
    """Columns that are no motion."""
    number = np.arange(1.0, t.size + 1.0)
    return {
        "time": t,
        "number": number,
        "temperature": 21.0 + 0.1 * np.sin(0.01 * number),
        "status": 0.0 * t,
    }


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
    end: str = "\n"
    suffix: str = "csv"
    aside: tuple[str, ...] | None = None
    holds: Mapping[str, str] | None = None

    def write(self, file, held):
        """Write it with the signals that are held."""
        cells = [[f"{factor * v:.9g}" for v in held[name]] for name, factor in self.columns]
        lines = [self.delimiter.join(row) for row in zip(*cells, strict=True)]
        if self.decimal != ".":
            lines = [line.replace(".", self.decimal) for line in lines]
        text = self.end.join([*self.header.split("\n"), *lines, ""])
        file.write_bytes(text.encode("cp1252"))
        return str(file)


TIME, BASE, MASS = ("time", 1.0), ("base_displacement", 1e3), ("displacement", 1e3)
SCOPE = "Model,MSO24\nFirmware Version,1.28\n\nHorizontal Units,s\nRecord Length,5714\n\n"
LVM = (
    "LabVIEW Measurement\t\nSeparator\tTab\nMulti_Headings\tNo\nX_Columns\tOne\n***End_of_Header***\t\n\t\n"
    "Channels\t2\t\t\nSamples\t5714\t5714\t\nY_Unit_Label\tmm\tm/s^2\t\nX0\t0.0\t0.0\t\nDelta_X\t0.001\t0.001\t\n"
    "***End_of_Header***\t\t\t\nX_Value\tBase\tAcceleration\tComment"
)
FORCED = {
    "German": Export(
        "Zeit/s;Weg Tisch/mm;Beschleunigung/g",
        (TIME, BASE, ("acceleration", 1 / G)),
        *(";", ",", "\r\n"),
    ),
    "LabVIEW": Export(LVM, (TIME, BASE, ("acceleration", 1.0)), "\t", suffix="lvm"),
    "LabVIEW's text": Export(
        "X_Value\tWeg Fundament (mm)\tGeschwindigkeit (mm/s)\tKommentar",
        (TIME, BASE, ("velocity", 1e3)),
        *("\t", ".", "\n", "txt"),
    ),
    "in g": Export(
        "time/s\tbase acceleration/g\tacceleration/g",
        (TIME, ("base_acceleration", 1 / G), ("acceleration", 1 / G)),
        *("\t", ".", "\n", "txt"),
    ),
    "data acquisition": Export(
        "Scan,Elapsed Time (s),Temperature (degC),Status,Table displacement (mm),Mass acceleration (m/s^2)",
        (("number", 1.0), TIME, ("temperature", 1.0), ("status", 1.0), BASE, ("acceleration", 1.0)),
    ),
    "LVDT": Export(
        "t [s];base [mm];relative displacement [mm]",
        (TIME, BASE, ("relative_displacement", 1e3)),
        ";",
    ),
    "accelerometer and LVDT": Export(
        "t (ms),Base (g),Relativweg (mm)",
        (("time", 1e3), ("base_acceleration", 1 / G), ("relative_displacement", 1e3)),
    ),
    "units in a row": Export(
        "Time\tBase\tResponse\n[s]\t[mm]\t[mm]", (TIME, BASE, MASS), "\t", suffix="txt"
    ),
    "oscilloscope": Export(
        SCOPE + "TIME,CH1 [mm],CH2 [mm]",
        (TIME, BASE, MASS),
        aside=(),
        holds={"base_displacement": "CH1", "displacement": "CH2"},
    ),
    "oscilloscope in ms": Export(
        "Time,Channel A,Channel B\n(ms),(mm),(m/s²)\n",
        (("time", 1e3), BASE, ("acceleration", 1.0)),
        aside=(),
        holds={"base_displacement": "Channel A", "acceleration": "Channel B"},
    ),
    "sensors": Export(
        "Time,Temp,Status,Sensor A,Sensor B,Sensor C",
        (TIME, ("temperature", 1.0), ("status", 1.0), BASE, MASS, ("velocity", 1.0)),
        aside=("'Temp': a temperature", "'Status': constant, 0"),
        holds={"base_displacement": "Sensor A", "displacement": "Sensor B"},
    ),
    "no names": Export(
        "exported by hand",
        (("number", 1.0), TIME, BASE, MASS),
        *("\t", ".", "\n", "dat"),
        aside=("'column 1': rises by 1 from sample to sample: a counter",),
        holds={"base_displacement": "column 3", "displacement": "column 4"},
    ),
}


@pytest.mark.filterwarnings("ignore:.*channels not used")
@pytest.mark.parametrize("name", FORCED)
def test_forced_records_are_read_as_they_were_recorded(name, tmp_path):
    export = FORCED[name]
    file = export.write(tmp_path / f"level.{export.suffix}", signals(0))
    mapping = None
    if export.aside is not None:
        with pytest.raises(RecordError, match="what do the columns") as error:
            read(file)
        mapping = mapping_to_start_from(file)
        indented = mapping.rstrip("\n").replace("\n", "\n  ")
        assert str(error.value).endswith(f"for example\n  {indented}")
        for reason in export.aside:
            assert f"# left aside: {reason}" in mapping
        assert mapping.count("left aside") == len(export.aside)
        mapping = filled(yaml.safe_load(mapping), export.holds or {})
    measurement = read(file, mapping)
    recorded = [quantity for quantity, _ in export.columns if quantity in QUANTITIES]
    assert list(measurement) == recorded[:2]
    for quantity in measurement:
        values = signals(0)[quantity]
        np.testing.assert_allclose(
            measurement[quantity].values, values, rtol=1e-8, atol=1e-8 * np.ptp(values)
        )
        np.testing.assert_allclose(measurement[quantity].t, signals(0)["time"], atol=1e-12)


@pytest.mark.filterwarnings("ignore:.*channels not used")
@pytest.mark.parametrize("name", ["data acquisition", "accelerometer and LVDT", "sensors"])
def test_the_truth_is_found_in_files(name, tmp_path):
    export = FORCED[name]
    files = [export.write(tmp_path / f"level{i + 1}.{export.suffix}", signals(i)) for i in range(3)]
    if export.aside is not None:
        mapping = filled(yaml.safe_load(mapping_to_start_from(files[0])), export.holds or {})
        (tmp_path / "channels.yaml").write_text(yaml.safe_dump(mapping), encoding="utf-8")
    found = identify(files, PAPER.k)
    assert found.verdicts["F_k"].verdict == found.verdicts["c"].verdict == "usable"
    for symbol in ("F_k", "c"):
        # chance leaves one of six numbers outside four standard errors in one seed of 2,600
        value = found.values[symbol]
        apart = abs(value - getattr(PAPER, symbol))
        assert apart < 4.0 * found.standard_errors[symbol] < 0.25 * value, symbol


@pytest.mark.parametrize(
    ("header", "columns"),
    [
        ("Elapsed Time (s),Temperatur/°C,Laser/mm", (TIME, ("temperature", 1.0), MASS)),
        ("Sample,time/s,status,x_rel/mm", (("number", 1.0), TIME, ("status", 1.0), MASS)),
        ("time [s],Laser", (TIME, MASS)),
    ],
)
def test_a_decay_of_one_channel(header, columns, tmp_path):
    decay = measured_ring_down(LOOSE, x=0.01, rate_hz=1000.0, duration=4.0, noise=0.002, seed=3)
    channel = decay["displacement"]
    held = others(channel.t) | {"displacement": channel.values}
    file = Export(header, columns).write(tmp_path / "decay.csv", held)
    mapping = filled(yaml.safe_load(mapping_to_start_from(file)), {"displacement": "Laser"})
    for given in (None, mapping) if "/" in header else (mapping,):
        found = identify(file, LOOSE.k, mapping=given)
        for symbol, (low, high) in found.intervals.items():
            assert low < getattr(LOOSE, symbol) < high, symbol


def test_a_voltage_needs_its_scale_alone(tmp_path):
    export = Export("second,base (V),x (V)", (TIME, ("base_displacement", 10.0), MASS))
    file = export.write(tmp_path / "volts.csv", signals(0))
    with pytest.raises(
        RecordError,
        match=r"scale of 'base \[V\]', which is in V\? Say it in .*volts",
    ):
        read(file)
    mapping = mapping_to_start_from(file)
    assert mapping.count('scale: "?"}') == mapping.count("recorded in V: m per V") == 2
    found = read(file, filled(yaml.safe_load(mapping), scale=0.1))["base_displacement"].values
    np.testing.assert_allclose(found, signals(0)["base_displacement"], rtol=1e-7, atol=1e-10)


def test_a_column_that_is_no_number_is_left_aside(tmp_path):
    export = Export("Time [foo],A [mm],B [g],State", (TIME, BASE, ("acceleration", 1 / G), MASS))
    file = tmp_path / "run.csv"
    export.write(file, signals(0))
    lines = file.read_text().split("\n")
    lines[3000] = ",".join([*lines[3000].split(",")[:3], "overflow"])
    file.write_text("\n".join(lines))
    mapping = mapping_to_start_from(file)
    assert "# left aside: 'State': it does not hold numbers" in mapping
    assert 'time: {channel: Time, unit: "?"}' in mapping
    mapping = filled(yaml.safe_load(mapping), {"base_displacement": "A", "acceleration": "B"})
    assert list(read(file, mapping)) == ["base_displacement", "acceleration"]


def test_what_is_known_already_is_kept(tmp_path):
    export = Export("a;b", (BASE, MASS), ";", ",")
    file = export.write(tmp_path / "run.csv", signals(0))
    known = {"delimiter": ";", "decimal": ",", "sample_rate_hz": 1000.0, "level": "4 mm"}
    mapping = yaml.safe_load(mapping_to_start_from(file, known))
    assert {key: mapping[key] for key in known} == known
    mapping = filled(mapping, {"base_displacement": "a", "displacement": "b"})
    assert list(read(file, mapping)) == ["base_displacement", "displacement"]
    with pytest.raises(RecordError, match=r"names the channels of .* already"):
        mapping_to_start_from(file, mapping)
