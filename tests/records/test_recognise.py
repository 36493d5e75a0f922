"""An open table becomes SI channels in one pass, whatever it comes from, or is refused with what to write."""

from __future__ import annotations

import numpy as np
import pytest

from dampbalance import RecordError
from dampbalance.records.mapping import RecordMapping, mapping_from, parts_of
from dampbalance.records.readers import table
from dampbalance.records.recognise import recognise
from dampbalance.records.table import RawChannel, Table, signals_file
from records.drafts import filled, shown

T = np.arange(200) / 1000.0
Y, A = 4e-3 * np.sin(20.0 * T), 2.0 * np.cos(20.0 * T)  # m, m/s²
COLUMNS = {"time_s": T, "base_displacement_mm": 1e3 * Y, "acceleration_m_per_s2": A}


def assert_signals(measurement):
    """The channels are those above, in the order of quantities, to the rounding of 1e3/1e3."""
    assert list(measurement) == ["base_displacement", "acceleration"]
    for quantity, values in zip(measurement, (Y, A), strict=True):
        np.testing.assert_allclose(measurement[quantity].values, values, rtol=1e-15, atol=0.0)
        np.testing.assert_allclose(measurement[quantity].t, T, rtol=0.0, atol=1e-15)


def test_a_file_and_arrays_take_the_same_way(tmp_path):
    path = tmp_path / "run.csv"
    rows = zip(*COLUMNS.values(), strict=True)
    lines = [",".join(COLUMNS), *(",".join(repr(float(x)) for x in row) for row in rows)]
    path.write_text("\n".join([*lines, ""]), encoding="utf-8")
    for source, opened in {str(path): table(path), "run": signals_file("run", COLUMNS)}.items():
        measurement = recognise(opened, RecordMapping())
        assert_signals(measurement)
        assert measurement.name == source


def test_tables_of_one_record_are_put_together():
    drive = {"channel": "y", "unit": "mm", "file": "drive.csv"}
    mapping = {"channels": {"acceleration": {"channel": 2}, "base_displacement": drive}}
    of_response, of_drive = parts_of("response.csv", mapping_from(mapping)).values()
    response = signals_file("response", {"t [s]": T, "a [m/s²]": A})
    drive = signals_file("drive", {"time_s": T, "y": 1e3 * Y})
    assert_signals(recognise(response, of_response, (drive, of_drive)))


def test_roles_units_and_times_are_refused_before_samples_are_loaded():
    def load(wanted):
        raise AssertionError(f"channels {wanted} were loaded")

    channels = [RawChannel("y", "mm", 9), RawChannel("acc", "g", 9)]
    refused = Table("run", channels, load)
    for document, message in [
        ({"acceleration": {"channel": "b"}}, "no channel 'b'; it has 1 'y .mm.', 2 'acc .g.'"),
        ({"acceleration": {"channel": "y"}}, "'y': 'mm' is a unit of length"),
        ({"acceleration": {"channel": "acc"}}, "'acc' needs it: say sample_rate_hz"),
    ]:
        with pytest.raises(RecordError, match=message):
            recognise(refused, mapping_from({"channels": document}))


def test_a_refusal_proposes_a_mapping_that_reads_the_table():
    unnamed = {"time_s": T, "s1 [mm]": 1e3 * Y, "s2 [m/s²]": A}
    opened = signals_file("run", unnamed)
    with pytest.raises(RecordError, match="what do the columns") as refusal:
        recognise(opened, RecordMapping())
    mapping = filled(shown(refusal.value), {"base_displacement": "s1", "acceleration": "s2"})
    assert_signals(recognise(opened, mapping_from(mapping)))
