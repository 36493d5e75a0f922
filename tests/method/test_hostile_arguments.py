"""Every public function, each of its arguments, and values that no caller should give: a result or a ValueError.

A call that is accepted must be right: its numbers are finite, and a steady orbit balances its energy.
"""

from __future__ import annotations

import datetime
import math
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from dampbalance import (
    BaseMotion,
    Channel,
    NoSteadyOrbit,
    Oscillator,
    Record,
    RecordError,
    Regime,
    identify,
    measured_orbit,
    measured_ring_down,
    read_records,
    sliders_orbit,
    steady_orbit,
    steady_orbits,
    study,
    transient,
)
from dampbalance.features import of_orbit
from dampbalance.law.law import Law, law_of
from dampbalance.motion.law_response import law_response
from dampbalance.project.documents import ConfigurationError
from dampbalance.records.readers import read, table
from dampbalance.records.writers import write
from dampbalance.replication.fixed_step import simulate
from dampbalance.replication.record import SimulatedRecord
from dampbalance.solver import contact_stiffness
from paper_case import PAPER

NESTED: list[object] = []
NESTED.append(NESTED)
MASKED = np.ma.array([1.0, 2.0, 3.0], mask=[False, True, False])
FIELDS = np.zeros(3, dtype=[("time_s", float), ("displacement_m", float)])

# Made anew for every call: a generator is used up.
VALUES: dict[str, Callable[[], object]] = {
    repr(value): lambda value=value: value
    for value in (
        None, "", "abc", "1.0", "F_k,c", "direct", ".", "\0", b"abc", True, np.True_, 1j, math.nan,
        math.inf, -math.inf, -1, 0, -0.0, 0.5, 1e308, -1e308, 1e-300, 5e-324, 1e-30, 1e30, 5, 2**63, 10**400,
        Fraction(1, 3), Decimal("1"), Path("."), Path("/nowhere/at/all"), [], [[]], [None], ["a"], [1, [2, 3]], (), {},
        {"a": 1}, {5: "x"}, {"F_k": 5}, {"channels": 5}, set(), {"c"}, ..., int, pd.DataFrame, abs, pd.NA, pd.NaT,
        np.ma.masked, np.longdouble("1e4000"), datetime.datetime(2026, 1, 1), datetime.timedelta(1), range(0),
    )
}  # fmt: skip
VALUES |= {
    "an integer of 5000 digits": lambda: 10**5000,
    "nested in itself": lambda: NESTED,
    "generator": lambda: (x for x in (1.0, "a", None)),
    "object": object,
    "Boolean array": lambda: np.array([True, False, True]),
    "array of texts": lambda: np.array(["a", "b", "c"]),
    "array of objects": lambda: np.array([1.0, None, {}], dtype=object),
    "array of NA": lambda: np.array([1.0, pd.NA, 2.0], dtype=object),
    "complex array": lambda: np.ones(3, complex),
    "dates": lambda: np.array(["2026-01-01"] * 3, dtype="datetime64[s]"),
    "masked array": lambda: MASKED,
    "list of masked": lambda: [np.ma.masked, 1.0, 2.0],
    "array with fields": lambda: FIELDS,
    "array of no dimension": lambda: np.array(1.0),
    "empty array": lambda: np.zeros((0, 3)),
    "array of three dimensions": lambda: np.ones((2, 3, 4)),
    "array with NaN": lambda: np.array([1.0, np.nan, 3.0]),
    "series with NA": lambda: pd.Series([1, None, 3], dtype="Int64"),
    "table": lambda: pd.DataFrame({"a": [1.0, 2.0], "b": ["x", None]}),
}

MOTION = BaseMotion(Y=0.004, omega=2.0 * math.pi * 3.5)
ORBIT = steady_orbit(PAPER, MOTION)
DECAY = transient(PAPER, None, 0.05, x=0.001)
NUMBERS = {"m": 2.42, "c": 90.0, "k": 2310.0, "K_z": 208000.0, "F_k": 1.28}
FEATURES = of_orbit(ORBIT)
T = np.arange(4) / 8.0
STATE = {"x": 0.001, "v": 0.0, "z": 0.0, "start": 0.0}
RATE = {"rate_hz": 1000.0, "seed": 0, "noise": 0.0}


def balanced(orbit, k=None, Y=None, F_k=None, c=None):
    """Whether every number of an orbit is finite, unless its regime says why not, and a F_k + b c = W."""
    if o := getattr(orbit, "oscillator", None):
        k, Y, F_k, c = o.k, orbit.motion.Y, o.F_k, o.c
    k, Y, F_k, c = (np.asarray(number, float) for number in (k, Y, F_k, c))
    there = np.asarray(orbit.regime) != Regime.NOT_FOUND
    assert np.isfinite(np.asarray(orbit.X)[there]).all()
    W = np.asarray(orbit.W)
    # W = πkYX sin φ, and φ is rounded
    size = np.abs(orbit.a * F_k) + np.abs(orbit.b * c) + 1e-4 * k * Y * np.asarray(orbit.X)
    assert (np.abs(orbit.a * F_k + orbit.b * c - W) <= 1e-9 * size)[there].all()


def finite(state):
    assert np.isfinite(state).all()


def signals(**arguments):
    (record,) = read_records({"time_s": T, "displacement_m": np.sin(T)} | arguments)
    return record


STEADY = [
    measured_orbit(steady_orbit(PAPER, BaseMotion(Y, MOTION.omega)), rate_hz=200.0, cycles=8.0)
    for Y in (0.004, 0.012)
]

# name → (function, arguments that are right, what must hold of a result)
CALLS: dict[str, tuple[Callable[..., object], dict[str, object], Callable[..., object]]] = {
    "Oscillator": (Oscillator, NUMBERS, lambda o: finite((o.omega_n, o.zeta, o.Z_m))),
    "BaseMotion": (BaseMotion, {"Y": 0.004, "omega": 22.0}, lambda m: finite(m.period)),
    "BaseMotion.y": (MOTION.y, {"t": 0.0}, finite),
    "steady_orbit": (steady_orbit, {"oscillator": PAPER, "motion": MOTION}, balanced),
    "steady_orbit of": (
        lambda Y, omega, **of: steady_orbit(Oscillator(**of), BaseMotion(Y, omega)),
        {**NUMBERS, "Y": 0.004, "omega": 22.0},
        balanced,
    ),
    "steady_orbits": (
        lambda **of: (steady_orbits(**of), *(of[name] for name in ("k", "Y", "F_k", "c"))),
        {**NUMBERS, "Y": 0.004, "omega": 22.0, "threads": 1},
        lambda found: balanced(*found),
    ),
    "Orbit.state": (ORBIT.state, {"t": 0.0}, finite),
    "Orbit.harmonic": (ORBIT.harmonic, {"n": 1}, finite),
    "Orbit.harmonics": (ORBIT.harmonics, {"count": 3}, finite),
    "transient": (
        transient,
        {"oscillator": PAPER, "motion": MOTION, "end": 0.02, **STATE},
        lambda path: finite(path.state(path.end)),
    ),
    "sliders_orbit": (
        sliders_orbit,
        {"oscillator": PAPER, "motion": MOTION, "r": [1e-4, 5e-4], "kappa": [4000.0, 1000.0]},
        lambda orbit: finite((orbit.X, orbit.friction_loss)),
    ),
    "SlidersOrbit.state": (sliders_orbit(PAPER, MOTION, 1e-4, 4000.0).state, {"t": 0.0}, finite),
    "Trajectory.state": (DECAY.state, {"t": 0.01}, finite),
    "law_response": (
        law_response,
        {"oscillator": PAPER, "motion": MOTION, "law": {}},
        lambda orbit: finite(orbit.X),
    ),
    "a law of": (
        lambda c_2: law_response(PAPER, MOTION, {"c_2": c_2}),
        {"c_2": 1.0},
        lambda orbit: finite(orbit.X),
    ),
    "Law": (Law, {"terms": ("F_k", "c"), "given": {}, "groups": {}}, repr),
    "law_of": (law_of, {"terms": ["F_k", "c"], "given": {}, "groups": {}}, repr),
    "the c of a law": (lambda c: law_of(None, {"c": c}, None), {"c": 1.0}, repr),
    "the groups of": (lambda F_k: law_of(None, None, {"F_k": F_k}), {"F_k": "AB"}, repr),
    "simulate": (
        simulate,
        {"osc": PAPER, "motion": MOTION, "scheme": "rk4", "step": 1e-4, "cycles": 1.0, "keep_cycles": 0.5}
        | {"c_over_m": 37.0, "k_over_m": 950.0, "stick_samples": 0},
        lambda record: finite(record.x),
    ),
    "SimulatedRecord": (SimulatedRecord, {"t": T, "y": T, "x": T, "v": T, "acceleration": T}, lambda r: finite(r.x)),
    "Features.with_phase": (FEATURES.with_phase, {"phase": "reversal"}, repr),
    "Features.with_common": (lambda name: FEATURES.with_common(name), {"name": "phi"}, repr),
    "Features.replaced": (FEATURES.replaced, {"X": 0.004, "phi": 1.0, "Y": [0.004]}, repr),
    "contact_stiffness": (contact_stiffness, {"F_k": 1.0, "X": 0.004, "X_s": -0.003}, repr),
    "Channel": (
        Channel,
        {"quantity": "displacement", "t": T, "values": np.sin(T), "name": "A1"},
        lambda channel: finite(channel.values),
    ),
    "Record": (Record, {"name": "a", "channels": {}}, repr),
    "Record.of": (Record.of, {"name": "a", "channels": []}, repr),
    "measured_orbit": (
        measured_orbit,
        {"orbit": ORBIT, "cycles": 2.0, "channels": ["displacement"], "start": 0.0, **RATE},
        lambda made: finite(made["displacement"].values),
    ),
    "measured_ring_down": (
        measured_ring_down,
        {"oscillator": PAPER, "x": 0.01, "v": 0.0, "duration": 0.05, "held": 0.0, **RATE}
        | {"channels": ["displacement"]},
        lambda made: finite(made["displacement"].values),
    ),
    "read_records": (
        read_records,
        {"records": {"time_s": T, "displacement_m": np.sin(T)}, "mapping": None},
        repr,
    ),
    "a signal": (signals, {"displacement_m": np.sin(T), "time_s": T}, repr),
    "the rate": (lambda dt: signals(dt=dt, time_s=np.sin(T)), {"dt": 0.1}, repr),
    "write": (write, {"path": "", "record": STEADY[0]}, repr),
    "read": (read, {"path": "level1.csv", "mapping": None}, repr),
    "table": (table, {"path": "level1.csv", "mapping": None}, lambda file: repr(file.channels)),
    "study": (
        study,
        {"axes": {"zeta": [0.1]}, "base": {}, "levels_m": [0.004, 0.008], "estimation": {}, "read_out": {}}
        | {"route": "exact", "columns": "errors", "threads": 1},
        repr,
    ),
    "identify": (
        identify,
        {"records": STEADY, "stiffness": 2310.0, "mapping": None, "kind": "forced", "frequency": 3.5, "mass": 2.42}
        | {"terms": ["F_k", "c"], "given": {}, "groups": {}, "laws": False, "skip_cycles": 0},
        repr,
    ),
}  # fmt: skip


@pytest.fixture(scope="module")
def found():
    return identify(STEADY, PAPER.k)


CASES = [(name, argument) for name, (_, right, _) in CALLS.items() for argument in right]


@pytest.mark.parametrize(("name", "argument"), CASES, ids=lambda part: part)
def test_a_hostile_value_gives_a_right_result_or_one_clear_error(
    name, argument, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    if name == "identify":  # once its arguments are read
        monkeypatch.setattr("dampbalance.identification.forced._of_records", lambda *_: None)
        monkeypatch.setattr("dampbalance.identification.decays._of_records", lambda *_: None)
    function, right, holds = CALLS[name]
    wrong = []
    for shown, value in VALUES.items():
        try:
            holds(function(**right | {argument: value()}))
        except (ValueError, NoSteadyOrbit, MemoryError) as error:
            lines = str(error).split("\n")  # one; of a mapping, one for each key that is wrong
            several = isinstance(error, RecordError | ConfigurationError)
            if not lines[0] or (len(lines) > 1 and not several):
                wrong.append(f"{shown}: {error!r:.200}")
        except BaseException as error:  # whatever it is, and a warning is one, too
            wrong.append(f"{shown}: {error!r:.200}")
    assert wrong == []
