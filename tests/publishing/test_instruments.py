"""The instruments of the page: they show what Python gives, for the paper's case and any other."""

from __future__ import annotations

import itertools
import json
import math
import shutil
import sys
from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest

from dampbalance import BaseMotion, Oscillator, steady_orbit
from dampbalance.balance import APPROACHES, TERMS, takes_phase
from dampbalance.features import Features
from dampbalance.project.case import Case, check_case, require_own_case
from dampbalance.project.documents import read_yaml
from dampbalance.project.wording import number_text, percent, signed_percent
from dampbalance.publishing.page.instruments import slider_controls
from dampbalance.replication.comparison import PHASES, RECIPES, WAYS_TO_COMPARE, approaches_table
from dampbalance.solver import solve
from processes import output_of
from replication.routes import CASE, CONFIG, PAPER, exact

STATIC = files("dampbalance.publishing.page") / "static"
NODE = shutil.which("node")
IN_BROWSER = ("omega", "Y", "X", "X_s", "t_s", "V_s", "a", "b", "W", "X_1", "X_3", "X_5")


def in_node(program, given):
    """Return what a program prints that finds kit.js as `kit` and its data, JSON, as `given`; NaN is null there."""
    script = (
        f"globalThis.kit = require({json.dumps(str(STATIC / 'kit.js'))});"
        "const given = JSON.parse(require('fs').readFileSync(0), (_, v) => v === null ? NaN : v);"
        f"console.log(JSON.stringify({program}));"
    )
    text = json.dumps(given).replace("NaN", "null")
    return json.loads(output_of(NODE, "-e", script, given=text))


def responses(features):
    """What the engine gives of every level, and its parameters, from features."""
    names = {name: name for name in IN_BROWSER} | {f"phi_{name}": f"phi_{name}" for name in PHASES}
    names |= {"phi": names.pop("phi_reversal")}
    return [
        {"k": PAPER.k} | {key: float(getattr(features, name)[i]) for key, name in names.items()}
        for i in range(len(features))
    ]


@pytest.mark.skipif(NODE is None, reason="no Node")
@pytest.mark.parametrize("frequency", CASE.frequencies_hz)
def test_rows_and_solution_in_the_browser_are_those_of_the_package(frequency):
    features = Features.from_frame(exact(PAPER).features[frequency])
    lacking = features.replaced(X_s=np.where(np.arange(5) == 1, np.nan, features.X_s))
    ways = [*itertools.product(APPROACHES, PHASES, (False, True))]
    ways = [way for way in ways if takes_phase(way[0]) or way[1] == PHASES[0]]
    call = f"{json.dumps(ways)}.map(([name, ...way]) => kit.rows(name, given, ...way))"
    for chosen in (features, lacking):
        got = in_node(f"{call}.map(rows => [rows, kit.solve(rows)])", responses(chosen))
        for (name, phase, shared), (rows, solution) in zip(ways, got, strict=True):
            ours = chosen.with_phase(phase)
            ours = ours.with_common("phi", "t_s") if shared and takes_phase(name) else ours
            expected = APPROACHES[name](ours, PAPER.k)
            columns = {"a": expected.terms["F_k"], "b": expected.terms["c"], "W": expected.W}
            for key, column in columns.items():
                values = [np.nan if row[key] is None else row[key] for row in rows]
                np.testing.assert_allclose(values, column, rtol=1e-13)
            estimate = solve(expected)
            assert solution["n"] == estimate.n
            for symbol in TERMS:
                assert solution[symbol] == pytest.approx(float(estimate[symbol]), rel=1e-11)


BARE = replace(CASE, oscillator=Oscillator(m=1e-3, c=0.0, k=5.0, K_z=2.0, F_k=0.0))


@pytest.mark.parametrize("case", [CASE, BARE], ids=["paper", "bare"])
def test_sliders_hold_the_case(case):
    made = slider_controls(case)
    held = {"Y": [1e3 * Y for Y in case.levels_m], "f": case.frequencies_hz.values()}
    held |= {name: [getattr(case.oscillator, name)] for name in ("c", "F_k", "K_z")}
    for name, values in held.items():
        slider = made[name]
        assert 0.0 <= slider["min"] < slider["max"]
        assert all(slider["min"] <= value <= slider["max"] for value in values)
        assert slider["value"] == pytest.approx(next(iter(values)), rel=1e-14)
        if not slider.get("log"):
            assert (slider["max"] - slider["min"]) / slider["step"] >= 100
    assert min(made["Y"]["min"], made["f"]["min"]) > 0.0


# --- in a browser ---------------------------------------------------------------------------------

GO = """hash => new Promise(done => {
  const drawn = () => requestAnimationFrame(() => requestAnimationFrame(done));
  addEventListener('hashchange', drawn, { once: true });
  if (location.hash === `#${hash}`) dispatchEvent(new Event('hashchange'));
  location.hash = hash;
})"""
WORDS = "() => document.querySelector('#%s .words').textContent"
"""What an instrument says in words, once it has drawn."""


@pytest.fixture(scope="module")
def led(window, report):
    """Leads to a state of an instrument, which the address states."""

    def page(state):
        if not window.url.startswith("file:"):
            window.goto((report / "report.html").as_uri())
            for name in ("oscillator", "off_resonance"):
                window.wait_for_selector(f"#{name}.ready")
                window.wait_for_function(WORDS % name)
        window.evaluate(GO, state)
        return window

    return page


def plain(text):
    return text.replace("\N{NO-BREAK SPACE}", " ")


def words(page, name):
    return plain(page.inner_text(f"#{name} .words"))


def readings(page):
    shown = "all => all.map(one => [one.dataset.name, one.textContent])"
    return {name: plain(text) for name, text in page.eval_on_selector_all("#oscillator dd", shown)}


STATES = {  # of the address → Y, f and what else is changed
    "": (0.004, 4.92, {}),
    "Y=8&f=11.1": (0.008, 11.1, {}),
    "f=2.2&F_k=4&c=5": (0.004, 2.2, {"F_k": 4.0, "c": 5.0}),
    "F_k=8&K_z=2310": (0.004, 4.92, {"F_k": 8.0, "K_z": 2310.0}),
    "F_k=0": (0.004, 4.92, {"F_k": 0.0}),
}
"""One slip at and off resonance, several slips, no slip, no friction."""


@pytest.mark.slow
def test_the_oscillator_has_the_readings_that_python_gives_in_every_regime(led):
    regimes = set()
    for state, (Y, f, changed) in STATES.items():
        page = led(f"oscillator?{state}")
        orbit = steady_orbit(replace(PAPER, **changed), BaseMotion(Y=Y, omega=2 * math.pi * f))
        shown = readings(page)
        for name, scale in (("X", 1e3), ("X_s", 1e3), ("V_s", 1e3), ("t_s", 1e3), ("b", 1e6)):
            value = number_text(scale * getattr(orbit, name), 5)
            assert shown[name].split()[0] == value, (state, name)
        assert shown["phi"] == f"{number_text(orbit.phi, 5)} rad"
        for energy in (orbit.W, orbit.a * orbit.oscillator.F_k, orbit.b * orbit.oscillator.c):
            assert f"{number_text(1e3 * energy, 5)} mJ" in words(page, "oscillator"), state
        regimes.add((orbit.regime, words(page, "oscillator").partition(".")[0]))
    assert len(regimes) == 4, regimes
    led("oscillator?f=1e9&Y=none&step=&unknown=1")  # held to what the sliders reach
    assert page.input_value("#oscillator-Y") == "4"
    page.focus("#oscillator-f")
    page.keyboard.press("ArrowLeft")
    most = slider_controls(CASE)["f"]["max"] - slider_controls(CASE)["f"]["step"]
    page.wait_for_function(f"() => location.hash === '#oscillator?f={most:g}'")


@pytest.mark.slow
def test_errors_off_resonance_are_those_of_the_table(led, made):
    table = approaches_table(made.numbers, CASE.frequencies_hz).set_index(
        ["frequency", "approach", "phase", "sharing"]
    )
    rows = "all => all.map(row => [...row.querySelectorAll('td')].map(one => one.textContent))"
    for frequency, hz in CASE.frequencies_hz.items():
        for chosen in ("X_s", "t_s", "V_s"):
            page = led(f"off_resonance?f={hz}&approach={chosen}&step=reversal")
            shown = page.eval_on_selector_all("#off_resonance .steps tbody tr", rows)
            for step, cells in zip(RECIPES, shown, strict=True):
                approach, *way = WAYS_TO_COMPARE[step]
                line = table.loc[(frequency, chosen if way[0] else approach, *way)]
                assert [plain(cell) for cell in cells] == [
                    signed_percent(0.01 * line["F_k_error_percent"]),
                    percent(0.01 * line["F_k_largest_pair_error_percent"]),
                    signed_percent(0.01 * line["c_error_percent"]),
                ], (frequency, chosen, step)


@pytest.mark.parametrize(
    ("state", "first", "hz"),
    [
        ("oscillator?f=3.5&Y=10&F_k=0.9&c=41.5&K_z=7500", 0.01, 3.5),
        ("off_resonance?step=mean", 0.004, 4.92),
        ("off_resonance?f=3.5&approach=t_s&step=shared", 0.004, 3.5),
        ("off_resonance?step=fourier", 0.004, 4.92),
    ],
)
@pytest.mark.slow
def test_its_program_and_its_configuration_compute_the_same(led, tmp_path, state, first, hz):
    page, name = led(state), state.partition("?")[0]
    page.evaluate(f"document.querySelector('#{name} .code').open = true")
    page.wait_for_function(f"() => document.querySelector('#{name} pre').textContent")
    program, configuration = page.locator(f"#{name} pre").all_text_contents()
    said = words(page, name)
    lines = [line.split(":") for line in output_of(sys.executable, "-c", program).splitlines()]
    numbers = [[*map(float, of[1].split())] for of in lines if of[1:] and "slip" not in of[0]]
    if name == "oscillator":
        (X, *_, phi), energies = numbers
        shown = readings(page)
        assert shown["X"] == f"{number_text(1e3 * X, 5)} mm"
        assert shown["phi"] == f"{number_text(phi, 5)} rad"
        assert all(f"{number_text(1e3 * energy, 5)} mJ" in said for energy in energies)
    else:
        ((F_k, c),) = numbers
        assert f" = {number_text(F_k, 4)} N " in said
        assert f" = {number_text(c, 4)} N s/m " in said
    file = tmp_path / "shown.yaml"
    file.write_text(configuration, encoding="utf-8")
    require_own_case([file])
    config = dict(CONFIG)
    for key, value in read_yaml(file).items():
        config[key] = {**config[key], **value} if isinstance(value, dict) else value
    check_case(config, [file])
    case = Case.from_config(config)
    assert (case.levels_m[0], next(iter(case.frequencies_hz.values()))) == (first, hz)
    assert case.oscillator.K_z == (7500 if "K_z" in state else PAPER.K_z)
