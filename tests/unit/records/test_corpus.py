"""A corpus of files as laboratories write them, each read and compared with the signals it was made of.

The small text files under `corpus/` were written by hand after the originals of recorders; the rest is made here.
"""

from __future__ import annotations

import datetime
import math
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from dampbalance.records.errors import RecordError, RecordWarning
from dampbalance.records.readers import open_channels, read

RATE = 20000.0
T = np.arange(40000) / RATE
Y = np.round(4.0 * np.cos(2.0 * math.pi * 3.5 * T), 6)  # mm
A = np.round(1.5 * np.sin(2.0 * math.pi * 3.5 * T) + 0.2 * np.sin(2.0 * math.pi * 10.5 * T), 6)  # g
G = 9.80665
START = pd.Timestamp("2026-03-01T23:59:59.5")


def _frame(stamps, name="time") -> pd.DataFrame:
    return pd.DataFrame({name: stamps, "base [mm]": Y, "acc [g]": A})


def _csv(stamps, name="time", **options) -> Callable[[Path], Path]:
    def make(folder):
        frame = _frame(stamps, name)
        frame.to_csv(folder / "run.csv", index=False, **options)
        return folder / "run.csv"

    return make


def _parquet(index) -> Callable[[Path], Path]:
    def make(folder):
        frame = pd.DataFrame({"base_mm": Y, "acc_g": A}, index=index)
        frame.to_parquet(folder / "run.parquet")
        return folder / "run.parquet"

    return make


def _points(unit="ns") -> pd.DatetimeIndex:
    return pd.DatetimeIndex(START + pd.to_timedelta(np.round(T * 1e9), unit="ns")).as_unit(unit)


def _iso(zone="") -> list[str]:
    return [f"{p.isoformat(timespec='microseconds')}{zone}" for p in _points("us")]


def _of_day() -> list[str]:
    return [p.strftime("%H:%M:%S.%f") for p in _points("us")]


def _two_columns(folder: Path) -> Path:
    frame = _frame(_of_day())
    frame.insert(0, "date", [p.date().isoformat() for p in _points("us")])
    frame.to_csv(folder / "run.txt", index=False, sep="\t")
    return folder / "run.txt"


def _german(folder: Path) -> Path:
    frame = _frame([p.replace("T", " ").replace(".", ",") for p in _iso()], "Zeit")
    frame.to_csv(folder / "run.csv", index=False, sep=";", decimal=",", encoding="cp1252")
    return folder / "run.csv"


SPANS = pd.to_timedelta(np.round(T * 1e9), unit="ns")

EXACT = {
    "ISO 8601": _csv(_iso()),
    "ISO 8601 with a zone": _csv(_iso("+01:00")),
    "ISO 8601 in UTC": _csv(_iso("Z"), "timestamp"),
    "points in time of pandas": _csv(_points("us"), ""),
    "time of day over midnight": _csv(_of_day()),
    "date and time of day": _two_columns,
    "Windows, decimal comma": _german,
    "spans of pandas": _csv([str(span) for span in SPANS]),
    "Parquet, points in time": _parquet(_points()),
    "Parquet, points in time with a zone": _parquet(_points("us").tz_localize("Europe/Berlin")),
    "Parquet, spans": _parquet(SPANS),
}

CORPUS = {**EXACT}


@pytest.mark.filterwarnings("ignore:.*channels not used. 'date'")
@pytest.mark.parametrize("kind", CORPUS)
def test_a_file_of_a_laboratory_gives_its_signals(tmp_path, kind):
    path = CORPUS[kind](tmp_path)
    measurement = read(path)
    assert set(measurement) == {"base_displacement", "acceleration"}
    for quantity, values in (("base_displacement", 1e-3 * Y), ("acceleration", G * A)):
        channel = measurement[quantity]
        np.testing.assert_allclose(channel.values, values, rtol=1e-15, atol=0)
        # a point in time has nine digits of a second at the most
        np.testing.assert_allclose(channel.t - channel.t[0], T, rtol=0, atol=1e-9)


@pytest.mark.parametrize("kind", EXACT)
@pytest.mark.filterwarnings("ignore:.*channels not used. 'date'")
def test_blocks_give_the_same(tmp_path, kind):
    path = CORPUS[kind](tmp_path)
    whole = read(path)
    for quantity, blocks in open_channels(path, block=7001).items():
        t, values = np.hstack([np.array(block) for block in blocks()])
        np.testing.assert_array_equal(t, whole[quantity].t)
        np.testing.assert_array_equal(values, whole[quantity].values)
