"""The engine of the page: in Node it gives what the same kernels give in Python, and it is what its sources make.

It takes sines and the like from Node, Python takes them from the system: results may differ by roundings, which the
tolerances count in units of each feature's natural scale.
"""

from __future__ import annotations

import hashlib
import json
import math
import shutil
from dataclasses import asdict

import numpy as np
import pytest

from dampbalance import BaseMotion, Regime, steady_orbit, steady_orbits
from dampbalance.motion.integrals import Measures
from dampbalance.publishing import engine as builder
from paper_case import PAPER
from processes import output_of

NAMES = ("m", "c", "k", "K_z", "F_k", "Y", "omega")
SCRIPT, ENGINE = builder.FOLDER / "engine.js", builder.FOLDER / builder.ENGINE
IN_NODE = """
const { readFileSync } = require("fs"), { loadEngine } = require(process.argv[1]);
loadEngine(readFileSync(process.argv[2])).then((engine) =>
  process.stdout.write(JSON.stringify((%s)(engine, JSON.parse(readFileSync(0))))));
"""
NODE = shutil.which("node")
needs_node = pytest.mark.skipif(NODE is None, reason="no Node: apt-get install nodejs")


def ask(function, given):
    """What a function of the engine and of what is given returns."""
    answer = output_of(NODE, "-e", IN_NODE % function, SCRIPT, ENGINE, given=json.dumps(given))
    return json.loads(answer)


def columns(answers: list[dict[str, float | None]]) -> dict[str, np.ndarray]:
    """Features by name from those by case; JSON writes NaN as null."""
    names = answers[0].keys() - {"regime"}
    return {name: np.array([one[name] for one in answers], dtype=float) for name in names}


def cases() -> np.ndarray:
    """Cases of every regime, (7, n): oscillators and motions all over the place, contacts up to nearly rigid, some at
    the edge of sticking, and some that have no steady orbit."""
    rng = np.random.default_rng(27)

    def within(low, high):
        return np.exp(rng.uniform(math.log(low), math.log(high), 2000))

    m, k, Y = within(0.1, 10.0), within(10.0, 1e4), within(1e-4, 0.1)
    c = 2.0 * within(1e-4, 3.0) * np.sqrt(k * m) * (rng.random(2000) > 0.03)
    K_z, omega = k * within(0.3, 300.0), np.sqrt(k / m) * within(0.05, 5.0)
    K_z[:200] *= 3e3
    omega[:200] = np.maximum(omega[:200], 0.5 * np.sqrt(k / m)[:200])
    F_k = k * Y * within(1e-3, 2.0) * (rng.random(2000) > 0.02)
    edge = slice(200, 300)  # where the contact only sticks, it moves with this amplitude
    linear = (k * Y / np.hypot(k + K_z - m * omega**2, c * omega))[edge]
    near = rng.choice([-1.0, 1.0], 100) * 10.0 ** rng.uniform(-9.0, -1.0, 100)
    F_k[edge] = K_z[edge] * linear * (1.0 - near)
    n = np.arange(1.0, 21.0)
    resonant = np.array([n**0, 0 * n, n**2, n, 0 * n, n, n])
    return np.hstack([[m, c, k, K_z, F_k, Y, omega], resonant])


@needs_node
def test_orbits_of_every_regime_are_those_of_python():
    parameters = cases()
    given = [dict(zip(NAMES, case, strict=True)) for case in parameters.T.tolist()]
    answers = ask("(engine, cases) => cases.map(engine.steady)", given)
    exact = steady_orbits(**dict(zip(NAMES, parameters, strict=True)))
    words = [Regime(code).name.replace("_", " ").lower() for code in exact.regime]
    assert [one["regime"] for one in answers] == words
    assert set(words) == {regime.name.replace("_", " ").lower() for regime in Regime}

    m, c, k, _, _, Y, omega = parameters
    X, work = exact.X, k * Y * exact.X
    # b follows from what c dissipates, to a rounding of the energies that the motion exchanges
    dissipating = np.divide(work, c, out=np.zeros_like(c), where=c > 0.0)
    scales = dict.fromkeys(("phi", "phi_zero_crossing"), 1.0)
    scales |= dict.fromkeys(("X", "X_s"), X)
    # where the mass creeps into slip, a rounding of x moves the onset by δx/V_s
    late = 1.0 + omega * X / np.maximum(exact.V_s, 1e-9 * omega * X)
    scales |= {"t_s": late / omega, "V_s": late * omega * X}
    scales |= {"a": 4.0 * X, "W": math.pi * work, "b": exact.b + dissipating}
    found = columns(answers)
    for name, scale in scales.items():
        np.testing.assert_array_equal(np.isnan(found[name]), np.isnan(getattr(exact, name)), name)
        error = np.abs(found[name] - getattr(exact, name)) / scale
        assert np.nanmax(error) < 1e-12, name
    for n in (1, 3, 5):  # a harmonic that vanishes has a phase of rounding alone
        ours, theirs = (of[f"X_{n}"] * np.exp(1j * of[f"phi_{n}"]) for of in (vars(exact), found))
        # at a resonance of its own it magnifies roundings of the force
        stiffness = np.abs(k - m * (n * omega) ** 2 + 1j * n * c * omega)
        error = np.abs(theirs - ours) / X * np.minimum(1.0, stiffness / k)
        assert np.nanmax(error) < 1e-13, n
    np.testing.assert_array_equal(found["phi_fundamental"], found["phi_1"])
    np.testing.assert_allclose(found["Z_m"], parameters[4] / parameters[3], rtol=1e-15)
    assert set(found) == {*Measures._fields, "phi_fundamental", "Z_m"}


LISTED = """(engine, given) => Object.fromEntries(
  Object.entries(engine.cycle(given, 65)).map(([name, row]) => [name, Array.from(row)]))"""
REFUSED = "(engine, given) => { try { engine.steady(given); } catch (no) { return no.message; } }"
SHAKEN = asdict(PAPER) | {"Y": 0.008, "omega": 2.0 * math.pi * 4.92}


@needs_node
@pytest.mark.parametrize(
    "change", [{}, {"Y": 1e-5}, {"F_k": 0.0}, {"Y": 0.0006, "c": 20.0, "omega": 4.0}]
)
def test_a_cycle_is_the_motion_from_one_reversal_to_the_next(change):
    given = SHAKEN | change
    cycle = {name: np.array(row) for name, row in ask(LISTED, given).items()}
    motion = BaseMotion(given["Y"], given["omega"])
    orbit = steady_orbit(type(PAPER)(**{name: given[name] for name in NAMES[:5]}), motion)
    np.testing.assert_allclose(cycle["t"], np.linspace(0.0, motion.period, 65), rtol=1e-14)
    t = orbit.t_1 + cycle["t"]
    state = orbit.state(t)
    exact = {name: getattr(state, name) for name in ("x", "v", "acceleration", "z")}
    for name, values in ({"y": motion.y(t)} | exact).items():
        # the moment of slip onset shifts by a rounding of t, which K_z turns into a force
        scale = np.abs(values).max()
        np.testing.assert_allclose(cycle[name], values, atol=1e-11 * scale, err_msg=name)
    assert ask(REFUSED, given | {"K_z": None}) == "K_z must be a number"


# --- what it is made of ---------------------------------------------------------------------------


def test_the_engine_is_made_of_the_sources_here(tmp_path, monkeypatch):
    record = json.loads((builder.FOLDER / builder.RECORD).read_text("utf-8"))
    stale = "a kernel was edited: run `make engine`, and commit what it writes"
    sources = list(record["sources"])
    assert record["sources"] == builder.source_digests(sources), stale
    assert record["engine"] == hashlib.sha256(ENGINE.read_bytes()).hexdigest()
    assert {"motion/one_slip.py", "motion/flow.py"} <= {*sources}
    for room in ("motion", "publishing"):
        shutil.copytree(builder._PACKAGE / room, tmp_path / room)
    monkeypatch.setattr(builder, "_PACKAGE", tmp_path)
    with (tmp_path / "motion/flow.py").open("a", encoding="utf-8") as file:
        file.write("# edited\n")
    assert record["sources"] != builder.source_digests(sources)
