"""A record is what it says it is, or it is refused by name."""

from __future__ import annotations

import numpy as np
import pytest

from dampbalance.replication.record import RECORD_COLUMNS, SimulatedRecord

I = np.arange(101)
T = 0.01 * I


def record(**changed):
    signals = {"t": T, "y": np.cos(T), "x": np.sin(T), "v": np.cos(T), "acceleration": -np.sin(T)}
    return SimulatedRecord(**signals | changed)


def test_signals_are_read_only_copies_and_columns_have_their_units():
    x = np.sin(T)
    made = record(x=x, v=None)
    x[0] = 5.0
    assert (made.x[0], len(made), made.dt) == (0.0, 101, pytest.approx(0.01, rel=1e-15))
    with pytest.raises(ValueError, match="read-only"):
        made.x[0] = 1.0
    frame = made.to_frame()
    assert list(frame.columns) == ["time_s", "y_m", "x_m", "acceleration_m_per_s2"]
    for name, signal in made.signals().items():
        assert np.array_equal(signal, frame[RECORD_COLUMNS[name]]), name


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"x": np.sin(T)[:-1]}, "x has 100 samples, t has 101"),
        ({"v": np.where(I == 7, np.nan, T)}, r"v is nan at sample 7 \(1 in all\)"),
        ({"y": np.where(I >= 99, np.inf, T)}, r"y is inf at sample 99 \(2 in all\)"),
        ({"t": T[::-1]}, "t is not in equal steps"),
        ({"t": np.where(I == 3, T[2], T)}, "t is not in equal steps: 0 s from sample 2 to 3"),
        ({"t": T + 0.001 * (I == 40)}, "not in equal steps: 0.011 s from sample 39 to 40"),
        ({"t": T**1.02}, "not in equal steps"),
        ({"x": np.zeros((101, 2))}, r"x must be one-dimensional, got shape \(101, 2\)"),
        ({"t": T[:2]}, "at least 3 samples, got 2"),
    ],
)
def test_what_is_not_a_record_is_refused_by_name(changed, message):
    with pytest.raises(ValueError, match=rf"^SimulatedRecord\..*{message}"):
        record(**changed)


def test_times_written_with_few_digits_are_uniform_enough():
    # 0.3 ms steps printed to 10 µs: each time off by up to 5 µs, a sixtieth of a step.
    made = SimulatedRecord(t=np.round(np.arange(101) * 3.0e-4, 5), y=T, x=T)
    assert made.dt == pytest.approx(3.0e-4, rel=1e-12)
