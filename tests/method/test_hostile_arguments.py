"""Public functions, each of their arguments, and values that no caller should give: a result or a ValueError.

A call that is accepted must be right: its numbers are finite, and a steady orbit balances its energy. What it gives can
be copied and pickled, and is the same afterwards.
"""

from __future__ import annotations

import copy
import math
import pickle
from collections.abc import Callable
from dataclasses import replace
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
    transient,
)
from dampbalance.features import of_orbit
from dampbalance.law.law import law_of
from dampbalance.motion.law_response import law_response
from dampbalance.project.documents import ConfigurationError
from dampbalance.solver import contact_stiffness
from paper_case import PAPER

NESTED: list[object] = []
NESTED.append(NESTED)

VALUES: list[object] = [
    None, "", "abc", "1.0", "F_k,c", ".", "\0", b"abc", True, np.True_, 1j, math.nan, math.inf, -1, 0, -0.0, 0.5,
    1e308, -1e308, 5e-324, 1e-30, 1e30, 5, 2**63, 10**400, 10**5000, Fraction(1, 3), Decimal("1"), Path("/nowhere/at"),
    [], [[]], [None], ["a"], [1, [2, 3]], (), {}, {"a": 1}, {5: "x"}, {"F_k": 5}, {"channels": 5}, {"c"}, ..., int, abs,
    object(), NESTED, range(0), pd.NA, pd.NaT, np.ma.masked, np.longdouble("1e4000"), [np.ma.masked, 1.0, 2.0],
    np.array([True, False, True]), np.array(["a", "b", "c"]), np.array([1.0, None, {}], dtype=object), np.array(1.0),
    np.array([1.0, pd.NA, 2.0], dtype=object), np.ones(3, complex), np.zeros((0, 3)), np.ones((2, 3, 4)),
    np.array(["2026-01-01"] * 3, dtype="datetime64[s]"), np.ma.array([1.0, 2.0, 3.0], mask=[False, True, False]),
    np.zeros(3, dtype=[("time_s", float), ("displacement_m", float)]), np.array([1.0, np.nan, 3.0]),
    pd.Series([1, None, 3], dtype="Int64"), pd.DataFrame({"a": [1.0, 2.0], "b": ["x", None]}),
]  # fmt: skip

MOTION = BaseMotion(Y=0.004, omega=2.0 * math.pi * 3.5)
ORBIT = steady_orbit(PAPER, MOTION)
DECAY = transient(PAPER, None, 0.05, x=0.001)
NUMBERS = {"m": 2.42, "c": 90.0, "k": 2310.0, "K_z": 208000.0, "F_k": 1.28}
CASE = {"oscillator": PAPER, "motion": MOTION}
FEATURES = of_orbit(ORBIT)
T = np.arange(4) / 8.0
RATE = {"rate_hz": 1000.0, "seed": 0, "noise": 0.0, "channels": ["displacement"]}
STEADY = [
    measured_orbit(steady_orbit(PAPER, BaseMotion(Y, MOTION.omega)), rate_hz=200.0, cycles=8.0)
    for Y in (0.004, 0.012)
]


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
    return read_records({"time_s": T, "displacement_m": np.sin(T)} | arguments)


# function, arguments that are right, what must hold of a result
CALLS: list[tuple[Callable[..., object], dict[str, object], Callable[..., object]]] = [
    (steady_orbit, CASE, balanced),
    (
        lambda **of: (steady_orbits(**of), *(of[name] for name in ("k", "Y", "F_k", "c"))),
        {**NUMBERS, "Y": 0.004, "omega": 22.0, "threads": 1},
        lambda found: balanced(*found),
    ),
    (ORBIT.state, {"t": 0.0}, finite),
    (ORBIT.harmonics, {"count": 3}, finite),
    (
        transient,
        {**CASE, "end": 0.02, "x": 0.001, "v": 0.0, "z": 0.0, "start": 0.0},
        lambda path: finite(path.state(path.end)),
    ),
    (DECAY.state, {"t": 0.01}, finite),
    (
        sliders_orbit,
        {**CASE, "r": [1e-4, 5e-4], "kappa": [4000.0, 1000.0]},
        lambda orbit: finite((orbit.X, orbit.friction_loss)),
    ),
    (law_response, {**CASE, "law": {}}, lambda orbit: finite(orbit.X)),
    (lambda c_2: law_response(PAPER, MOTION, {"c_2": c_2}).X, {"c_2": 1.0}, finite),
    (law_of, {"terms": ["F_k", "c"], "given": {}, "groups": {}}, repr),
    (FEATURES.replaced, {"X": 0.004, "phi": 1.0, "Y": [0.004]}, repr),
    (contact_stiffness, {"F_k": 1.0, "X": 0.004, "X_s": -0.003}, repr),
    (Channel, {"quantity": "displacement", "t": T, "values": np.sin(T), "name": "A1"}, repr),
    (Record.of, {"name": "a", "channels": []}, repr),
    (
        measured_orbit,
        {"orbit": ORBIT, "cycles": 2.0, "start": 0.0, **RATE},
        lambda made: finite(made["displacement"].values),
    ),
    (
        measured_ring_down,
        {"oscillator": PAPER, "x": 0.01, "v": 0.0, "duration": 0.05, "held": 0.0, **RATE},
        lambda made: finite(made["displacement"].values),
    ),
    (read_records, {"records": {"time_s": T, "displacement_m": np.sin(T)}, "mapping": None}, repr),
    (signals, {"displacement_m": np.sin(T), "time_s": T}, repr),
    (
        identify,
        {"records": STEADY, "stiffness": 2310.0, "mapping": None, "kind": "forced", "mass": 2.42}
        | {"frequency": 3.5, "terms": ["F_k", "c"], "given": {}, "groups": {}, "laws": False}
        | {"skip_cycles": 0},
        repr,
    ),
]


@pytest.mark.parametrize(("function", "right", "holds"), CALLS)
def test_a_hostile_value_gives_a_right_result_or_one_clear_error(
    function, right, holds, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    if function is identify:  # once its arguments are read
        monkeypatch.setattr("dampbalance.identification.forced._of_records", lambda *_: None)
        monkeypatch.setattr("dampbalance.identification.decays._of_records", lambda *_: None)
    wrong = []
    for argument in right:
        for i, value in enumerate([*VALUES, (x for x in (1.0, "a", None))]):
            try:
                holds(function(**right | {argument: value}))
            except (ValueError, NoSteadyOrbit, MemoryError) as error:
                lines = str(error).split("\n")  # one; of a mapping, one for each key that is wrong
                several = isinstance(error, RecordError | ConfigurationError)
                if not lines[0] or (len(lines) > 1 and not several):
                    wrong.append(f"{argument}, value {i}: {error!r:.200}")
            except BaseException as error:  # whatever it is, and a warning is one, too
                wrong.append(f"{argument}, value {i}: {error!r:.200}")
    assert wrong == []


COPIES = (copy.copy, copy.deepcopy, lambda thing: pickle.loads(pickle.dumps(thing)))


def of_law():
    orbit = law_response(PAPER, MOTION, {"c_2": 20.0})
    orbit.state(0.1)  # what it keeps from then on is copied, too
    return orbit


# what is made, and all that it says
THINGS = {
    "orbit": (lambda: ORBIT, lambda o: (o.to_dict(), o.W, o.state(0.1))),
    "orbits": (lambda: steady_orbits(PAPER, Y=[0.004, 0.008], omega=22.0), lambda o: o.X.tolist()),
    "orbit of a law": (of_law, lambda o: (o.state(0.2), o.X)),
    "features": (
        lambda: replace(FEATURES, integrals={"c_2": np.array([1.5])}),
        lambda f: (f.to_frame().to_csv(), dict(f.integrals)),
    ),
    "record": (lambda: read_records(STEADY)[0], lambda r: (repr(r), r.to_frame().to_csv())),
    "identified": (
        lambda: identify(STEADY, PAPER.k),
        lambda found: (found.document(), found.text(), found.to_frame().to_csv()),
    ),
}


@pytest.mark.parametrize(("make", "say"), THINGS.values(), ids=THINGS)
def test_a_copy_says_the_same(make, say):
    original = make()
    said = repr(say(original))
    for copied in COPIES:
        other = copied(original)
        assert type(other) is type(original)
        assert repr(say(other)) == said
    assert repr(say(original)) == said
