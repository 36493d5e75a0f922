"""The engine of the page: in Node and in Chromium it gives what the same kernels give in Python.

Each is skipped where the machine has none. Both take sines and the like from the engine, Python takes them from the
system: results may differ by roundings, which the tolerances count in units of each feature's natural scale.
"""

from __future__ import annotations

import base64
import functools
import json
import math
import shutil
from dataclasses import asdict

import numpy as np
import pytest

from dampbalance import BaseMotion, Regime, steady_orbit, steady_orbits
from dampbalance.motion.integrals import Measures
from dampbalance.publishing import engine as builder
from paper_case import FREQUENCIES_HZ, LEVELS, PAPER
from processes import output_of

pytestmark = pytest.mark.slow

NAMES = ("m", "c", "k", "K_z", "F_k", "Y", "omega")
SCRIPT, ENGINE = builder.FOLDER / "engine.js", builder.FOLDER / builder.ENGINE
IN_NODE = """
const { readFileSync } = require("fs"), { loadEngine } = require(process.argv[1]);
loadEngine(readFileSync(process.argv[2])).then((engine) =>
  process.stdout.write(JSON.stringify((%s)(engine, JSON.parse(readFileSync(0))))));
"""
IN_CHROMIUM = """async ([bytes, given]) => {
  const engine = await loadEngine(Uint8Array.from(atob(bytes), (letter) => letter.charCodeAt(0)));
  return JSON.stringify((%s)(engine, given));
}"""


@pytest.fixture(params=["Node", "Chromium"])
def ask(request, tmp_path):
    """ask(function of the engine and of what is given, what is given) -> what it returns."""
    if request.param == "Node":
        if not shutil.which("node"):
            pytest.skip("no Node: apt-get install nodejs")

        def answer(function, given):
            return output_of(
                "node", "-e", IN_NODE % function, SCRIPT, ENGINE, given=json.dumps(given)
            )
    else:
        (tmp_path / "empty.html").write_text("<!doctype html><title>engine</title>", "utf-8")
        page = request.getfixturevalue("visit")((tmp_path / "empty.html").as_uri())
        page.add_script_tag(path=SCRIPT)
        loaded = base64.b64encode(ENGINE.read_bytes()).decode()

        def answer(function, given):
            return page.evaluate(IN_CHROMIUM % function, [loaded, given])

    return lambda function, given: json.loads(answer(function, given))


def columns(answers: list[dict[str, float | None]]) -> dict[str, np.ndarray]:
    """Features by name from those by case; JSON writes NaN as null."""
    return {
        name: np.array([one[name] for one in answers], dtype=float)
        for name in answers[0]
        if name != "regime"
    }


def drawn(rng, count, stiffest, slowest):
    """Oscillators and motions all over the place, `stiffest` in K_z/k and down to ω_n/ω = 1/`slowest`."""

    def within(low, high):
        return np.exp(rng.uniform(math.log(low), math.log(high), count))

    m, k, Y = within(0.1, 10.0), within(10.0, 1e4), within(1e-4, 0.1)
    c = 2.0 * within(1e-4, 3.0) * np.sqrt(k * m) * (rng.random(count) > 0.03)
    K_z, omega = k * within(0.3, stiffest), np.sqrt(k / m) * within(1.0 / slowest, 5.0)
    F_k = k * Y * within(1e-3, 2.0) * (rng.random(count) > 0.02)
    return np.array([m, c, k, K_z, F_k, Y, omega])


@functools.cache
def cases() -> np.ndarray:
    """10,000 cases of every regime, (7, n): a tenth with contacts up to nearly rigid, a tenth at the edges between
    regimes, and some that have no steady orbit."""
    rng = np.random.default_rng(27)
    anywhere, rigid = drawn(rng, 8080, 300.0, 20.0), drawn(rng, 1000, 1e6, 2.0)
    m, c, k, K_z, _, Y, omega = edge = drawn(rng, 500, 300.0, 20.0)
    linear = (
        k * Y / np.hypot(k + K_z - m * omega**2, c * omega)
    )  # amplitude of the contact that only sticks
    edge[4] = (
        K_z * linear * (1.0 - rng.choice([-1.0, 1.0], 500) * 10.0 ** rng.uniform(-9.0, -1.0, 500))
    )
    n = np.arange(1.0, 21.0)
    resonant = np.array([n**0, 0 * n, n**2, n, 0 * n, n, n])
    return np.hstack([anywhere, rigid, edge, between_one_slip_and_several(rng), resonant])


def between_one_slip_and_several(rng) -> np.ndarray:
    """400 cases at the edge, by bisection in F_k."""
    tried = drawn(rng, 5000, 300.0, 10.0)
    low, high = tried.copy(), tried.copy()
    low[4] *= 0.1
    differ = (regimes(low) == Regime.ONE_SLIP) & (regimes(high) == Regime.SEVERAL_SLIPS)
    low, high = (side[:, differ][:, :200] for side in (low, high))
    for _ in range(20):
        middle = (low + high) / 2.0
        several = regimes(middle) == Regime.SEVERAL_SLIPS
        low, high = np.where(several, low, middle), np.where(several, middle, high)
    assert low.shape == (7, 200)
    return np.hstack([low, high])


def regimes(parameters):
    return steady_orbits(**dict(zip(NAMES, parameters, strict=True))).regime


@functools.cache
def exact_orbits():
    return steady_orbits(**dict(zip(NAMES, cases(), strict=True)))


def test_ten_thousand_orbits_are_those_of_python(ask):
    parameters = cases()
    given = [dict(zip(NAMES, case, strict=True)) for case in parameters.T.tolist()]
    assert len(given) == 10_000
    answers = ask("(engine, cases) => cases.map(engine.steady)", given)
    exact = exact_orbits()
    words = [Regime(code).name.replace("_", " ").lower() for code in exact.regime]
    assert [one["regime"] for one in answers] == words
    assert set(words) == {regime.name.replace("_", " ").lower() for regime in Regime}

    _, c, k, _, _, Y, omega = parameters
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
        assert np.nanmax(np.abs(theirs - ours) / X) < 1e-12, n
    np.testing.assert_array_equal(found["phi_fundamental"], found["phi_1"])
    np.testing.assert_allclose(found["Z_m"], parameters[4] / parameters[3], rtol=1e-15)
    assert set(found) == {*Measures._fields, "phi_fundamental", "Z_m"}


PAPERS = [
    asdict(PAPER) | {"Y": Y, "omega": 2.0 * math.pi * f}
    for f in FREQUENCIES_HZ.values()
    for Y in LEVELS
]


@pytest.mark.parametrize(
    "change", [{}, {"Y": 1e-5}, {"F_k": 0.0}, {"Y": 0.0006, "c": 20.0, "omega": 4.0}]
)
def test_a_cycle_is_the_motion_from_one_reversal_to_the_next(ask, change):
    given = PAPERS[2] | change
    cycle = {name: np.array(row) for name, row in ask(LISTED, given).items()}
    motion = BaseMotion(given["Y"], given["omega"])
    orbit = steady_orbit(type(PAPER)(**{name: given[name] for name in NAMES[:5]}), motion)
    np.testing.assert_allclose(cycle["t"], np.linspace(0.0, motion.period, 65), rtol=1e-14)
    t = orbit.t_1 + cycle["t"]
    state = orbit.state(t)
    exact = {
        "y": motion.y(t),
        "x": state.x,
        "v": state.v,
        "acceleration": state.acceleration,
        "z": state.z,
    }
    for name, values in exact.items():
        # the moment of slip onset shifts by a rounding of t, which K_z turns into a force
        np.testing.assert_allclose(
            cycle[name], values, atol=1e-11 * np.abs(values).max(), err_msg=name
        )


LISTED = """(engine, given) => Object.fromEntries(
  Object.entries(engine.cycle(given, 65)).map(([name, row]) => [name, Array.from(row)]))"""


def test_a_parameter_that_is_no_number_is_refused(ask):
    said = "(engine, given) => { try { engine.steady(given); } catch (error) { return error.message; } }"
    assert ask(said, PAPERS[0] | {"K_z": None}) == "K_z must be a number"
