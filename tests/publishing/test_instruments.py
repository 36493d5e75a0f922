"""The instruments of the page: they show what Python gives, for the paper's case and any other."""

from __future__ import annotations

import contextlib
import io
import json
import math
import shutil
from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest

from dampbalance import BaseMotion, Oscillator, steady_orbit
from dampbalance.balance import APPROACHES, TERMS, takes_phase
from dampbalance.features import Features, of_orbit, stack
from dampbalance.project import wording
from dampbalance.project.case import check_case, require_own_case
from dampbalance.project.documents import read_yaml
from dampbalance.publishing.page.instruments import slider_controls
from dampbalance.replication.comparison import PHASES, RECIPES, WAYS_TO_COMPARE, approaches_table
from dampbalance.replication.numbers import by_key, numbers_table, of_routes
from dampbalance.solver import solve
from processes import output_of
from publishing.page_case import page_of
from replication.routes import CASE, CONFIG, PAPER, exact

STATIC = files("dampbalance.publishing.page") / "static"
NODE = shutil.which("node")
IN_BROWSER = ("omega", "Y", "X", "X_s", "t_s", "V_s", "a", "b", "W", "X_1", "X_3", "X_5")


def in_node(program, given):
    """Return what a program prints that finds kit.js as `kit` and its data, JSON, as `given`; NaN is null there."""
    script = (
        f"globalThis.kit = require({json.dumps(str(STATIC / 'kit.js'))});"
        "const given = JSON.parse(require('fs').readFileSync(0), (_, v) => v === null ? NaN : v);"
    )
    said = output_of(
        *(NODE, "-e", f"{script} console.log(JSON.stringify({program}));"),
        given=json.dumps(given).replace("NaN", "null"),
    )
    return json.loads(said)


def responses(features):
    """What the engine gives of every level, and its parameters, from features."""
    phases = {"phi": "phi_reversal"} | {f"phi_{name}": f"phi_{name}" for name in PHASES[1:]}
    names = dict(zip(IN_BROWSER, IN_BROWSER, strict=True)) | phases
    return [
        {"k": PAPER.k} | {key: float(getattr(features, name)[i]) for key, name in names.items()}
        for i in range(len(features))
    ]


@pytest.mark.skipif(NODE is None, reason="no Node")
@pytest.mark.parametrize("frequency", CASE.frequencies_hz)
def test_rows_and_solution_in_the_browser_are_those_of_the_package(frequency):
    features = Features.from_frame(exact(PAPER).features[frequency])
    lacking = features.replaced(X_s=np.where(np.arange(5) == 1, np.nan, features.X_s))
    ways = [
        (name, phase, shared)
        for name in APPROACHES
        for phase in (PHASES if takes_phase(name) else PHASES[:1])
        for shared in (False, True)
    ]
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


OWN = replace(  # stiffer and lighter; the lowest level does not slip
    CASE,
    name="own",
    oscillator=Oscillator(m=0.31, c=3.7, k=9123.4, K_z=45600.0, F_k=2.5),
    frequencies_hz={"low": 14.25, "high": 40.125},
    levels_m=(2e-4, 5e-4, 8e-4, 1.1e-3),
    pairs=((1, 2), (2, 3)),
)


@pytest.mark.parametrize(
    "case",
    [CASE, OWN, replace(OWN, oscillator=Oscillator(m=1e-3, c=0.0, k=5.0, K_z=2.0, F_k=0.0))],
    ids=["paper", "own", "bare"],
)
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
    assert made["Y"]["min"] > 0.0
    assert made["f"]["min"] > 0.0


FRAMES = "requestAnimationFrame(() => requestAnimationFrame(done))"
GO = f"""hash => new Promise(done => {{
  addEventListener('hashchange', () => {FRAMES}, {{ once: true }});
  if (location.hash === `#${{hash}}`) dispatchEvent(new Event('hashchange'));
  location.hash = hash;
}})"""
PHASE = """phase => {
  const slider = document.getElementById('oscillator-phase');
  slider.value = phase;
  slider.dispatchEvent(new Event('input'));
}"""


@pytest.fixture
def opened(visit, report):
    """Opens the page at an address and waits until both instruments have drawn."""

    def page(hash="", file=report / "report.html", open=visit, **options):
        view = open(file.as_uri() + hash, **{"reduced_motion": "reduce"} | options)
        for name in ("oscillator", "off_resonance"):
            view.wait_for_selector(f"#{name}.ready")
            view.wait_for_function(f"() => document.querySelector('#{name} .words').textContent")
        return view

    yield page
    assert visit.said == []


@pytest.fixture
def led(opened, visit):
    """Leads to a state of an instrument, on a page that tests share: an address states all of it."""

    def page(state):
        view = opened(open=visit.again)
        view.evaluate(GO, state)
        return view

    return page


def number(value, digits=5):
    return wording.number_text(value, digits)


def plain(text):
    return text.replace("\N{NO-BREAK SPACE}", " ")


def readings(page):
    return {
        name: plain(text)
        for name, text in page.eval_on_selector_all(
            "#oscillator dd", "all => all.map(one => [one.dataset.name, one.textContent])"
        )
    }


def orbit_of(case, Y, f, **changed):
    return steady_orbit(replace(case.oscillator, **changed), BaseMotion(Y=Y, omega=2 * math.pi * f))


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
    regimes = {}
    for state, (Y, f, changed) in STATES.items():
        page = led(f"oscillator?{state}")
        orbit = orbit_of(CASE, Y, f, **changed)
        shown = readings(page)
        for name, scale in (("X", 1e3), ("X_s", 1e3), ("V_s", 1e3), ("t_s", 1e3), ("b", 1e6)):
            assert shown[name].split()[0] == number(scale * getattr(orbit, name)), (state, name)
        assert shown["phi"] == f"{number(orbit.phi)} rad"
        words = plain(page.inner_text("#oscillator .words"))
        lost = orbit.a * orbit.oscillator.F_k
        for energy in (orbit.W, lost, orbit.b * orbit.oscillator.c):
            assert f"{number(1e3 * energy)} mJ" in words, state
        regimes[orbit.regime] = words.partition(".")[0]
    assert len(set(regimes.values())) == 4, regimes


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
            assert len(shown) == len(RECIPES)
            for step, cells in zip(RECIPES, shown, strict=True):
                approach, *way = WAYS_TO_COMPARE[step]
                line = table.loc[(frequency, chosen if way[0] else approach, *way)]
                assert [plain(cell) for cell in cells] == [
                    wording.signed_percent(0.01 * line["F_k_error_percent"]),
                    wording.percent(0.01 * line["F_k_largest_pair_error_percent"]),
                    wording.signed_percent(0.01 * line["c_error_percent"]),
                ], (frequency, chosen, step)


def printed(program):
    """The numbers that a program prints after the colon of each line."""
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(program, "shown", "exec"), {})
    return [
        [float(word) for word in line.split(":")[1].split()]
        for line in out.getvalue().splitlines()
        if ":" in line and "slip" not in line.split(":")[0]
    ]


def texts(page, name):
    page.evaluate(f"document.querySelector('#{name} .code').open = true")
    page.wait_for_function(f"() => document.querySelector('#{name} pre').textContent")
    return page.locator(f"#{name} pre").all_text_contents()


def checked(file, text):
    """The configuration, checked as the workflow does, merged from the paper's and this text."""
    file.write_text(text, encoding="utf-8")
    require_own_case([file])
    config = dict(CONFIG)
    for key, value in read_yaml(file).items():
        config[key] = {**config[key], **value} if isinstance(value, dict) else value
    check_case(config, [file])
    return config


@pytest.mark.parametrize(
    ("state", "first", "hz"),
    [
        ("oscillator?f=3.5&Y=10&F_k=0.9&c=41.5&K_z=7500", 0.01, 3.5),
        ("oscillator?", 0.004, 4.92),
        ("off_resonance?step=mean", 0.004, 4.92),
        ("off_resonance?f=3.5&approach=t_s&step=shared", 0.004, 3.5),
        ("off_resonance?step=fourier", 0.004, 4.92),
    ],
)
@pytest.mark.slow
def test_its_program_and_its_configuration_compute_the_same(led, tmp_path, state, first, hz):
    page, name = led(state), state.partition("?")[0]
    program, configuration = texts(page, name)
    words = plain(page.inner_text(f"#{name} .words"))
    if name == "oscillator":
        (X, *_, phi), energies = printed(program)
        assert readings(page)["X"] == f"{number(1e3 * X)} mm"
        assert readings(page)["phi"] == f"{number(phi)} rad"
        assert all(f"{number(1e3 * energy)} mJ" in words for energy in energies)
    else:
        ((F_k, c),) = printed(program)
        assert f" = {number(F_k, 4)} N " in words
        assert f" = {number(c, 4)} N s/m " in words
    config = checked(tmp_path / "shown.yaml", configuration)
    assert config["excitation"]["levels_m"][0] == first
    assert config["excitation"]["frequencies"][0]["hz"] == hz
    assert config["oscillator"]["K_z_N_per_m"] == (7500 if "K_z" in state else PAPER.K_z)


TOP = "document.querySelector('#numbers').getBoundingClientRect().top"


@pytest.mark.slow
def test_the_address_holds_the_state_and_other_anchors_work(opened):
    page = opened("#numbers")
    assert 0 <= page.evaluate(TOP) < 200  # though the instruments above have grown meanwhile
    slider = page.locator("#oscillator-f")
    slider.focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_function("() => location.hash === '#oscillator?f=4.93'")
    shown = readings(page)
    assert shown["X"] == f"{number(1e3 * orbit_of(CASE, 0.004, 4.93).X)} mm"
    assert slider.get_attribute("aria-valuetext") == "4.93 Hz"
    page.reload()
    page.wait_for_selector("#oscillator.ready")
    page.wait_for_function("() => document.querySelector('#oscillator dd').textContent")
    assert readings(page) == shown
    page.evaluate(GO, "numbers")
    assert 0 <= page.evaluate(TOP) < 200
    assert readings(page) == shown
    page.evaluate(GO, "oscillator?f=1e9&Y=none&step=&unknown=1")  # held to what the sliders reach
    assert page.input_value("#oscillator-Y") == "4"
    assert float(page.input_value("#oscillator-f")) == slider_controls(CASE)["f"]["max"]
    page.click("#off_resonance .steps button[value=fourier]")
    page.wait_for_function("() => location.hash === '#off_resonance?step=fourier'")
    page.click("#off_resonance .stops button:last-child")
    page.wait_for_function("() => location.hash === '#off_resonance?f=11.1&step=fourier'")


@pytest.mark.slow
@pytest.mark.parametrize("width", [390, 1280])
@pytest.mark.parametrize("name", ["oscillator", "off_resonance"])
def test_an_address_leads_to_its_instrument(visit, report, name, width):
    """Though the instruments above it grow once they are there."""
    address = f"{(report / 'report.html').as_uri()}#{name}"
    page = visit(address, reduced_motion="reduce", viewport={"width": width, "height": 844})
    page.wait_for_selector("#off_resonance.ready", state="attached")  # the last one
    page.wait_for_function(
        "name => { const y = document.getElementById(name).getBoundingClientRect().y; return y > 0 && y < 150; }",
        arg=name,
    )


@pytest.mark.slow
def test_the_oscillator_moves_and_can_be_stopped(opened, led):
    place = "() => document.querySelector('#oscillator .mass').getAttribute('transform')"
    still = led("oscillator?")
    still.evaluate(PHASE, 0)
    assert still.inner_text("#oscillator .toggle") == "Play"
    before = still.evaluate(place)
    still.locator("#oscillator-phase").focus()
    for _ in range(30):
        still.keyboard.press("ArrowRight")
    assert still.evaluate(place) != before
    moving = opened(reduced_motion="no-preference")
    moving.locator("#oscillator .scene").scroll_into_view_if_needed()
    assert moving.inner_text("#oscillator .toggle") == "Pause"
    before = moving.evaluate(place)
    moving.wait_for_function(f"was => ({place})() !== was", arg=before)
    moving.click("#oscillator .toggle")
    before = moving.evaluate(place)
    moving.evaluate(f"new Promise(done => {FRAMES})")
    assert moving.evaluate(place) == before
    moving.evaluate(PHASE, 2)
    assert moving.inner_text("#oscillator .state") == "The contact sticks."


WORK = """() => Object.fromEntries(['friction', 'damper'].map(css => {
  const area = part => {
    const svg = document.querySelector(`#oscillator svg.${css === 'friction' ? 'contact' : 'viscous'}`);
    const d = svg.querySelector(`path.area.${css}${part}`).getAttribute('d');
    const points = [...d.matchAll(/(-?[\\d.]+)[ ,](-?[\\d.]+)/g)].map(([, x, y]) => [Number(x), Number(y)]);
    return points.reduce((sum, [x, y], i) => {
      const [u, v] = points[(i + 1) % points.length];
      return sum + 0.5 * (x * v - u * y);
    }, 0);
  };
  const bar = part => Number(document.querySelector(`#oscillator rect.${css}${part}`).getAttribute('width'));
  return [css, [area(':not(.whole)') / area('.whole'), bar(':not(.whole)') / bar('.whole')]];
}))"""


@pytest.mark.slow
def test_the_loops_fill_as_the_energy_is_lost(led):
    """The area that is dark in a loop is the work so far, and the bar below says the same."""
    page = led("oscillator?")
    for phase in (60, 90, 185, 270, 360):
        page.evaluate(PHASE, phase)
        for area, bar in page.evaluate(WORK).values():
            assert area == pytest.approx(bar, abs=0.01), phase  # drawn to a tenth of a pixel
    assert bar == pytest.approx(1.0, abs=0.01)


@pytest.mark.slow
def test_a_case_of_ones_own_has_its_own_values(opened, made, tmp_path):
    file = tmp_path / "own.html"
    features = {
        name: stack(
            [of_orbit(steady_orbit(OWN.oscillator, motion)) for motion in OWN.motions(name)]
        )
        for name in OWN.frequencies_hz
    }
    routes = of_routes(OWN, {"exact": {name: of.to_frame() for name, of in features.items()}}, {})
    numbers = by_key(numbers_table(routes, {}))
    own = {
        **{"case": OWN, "claims": None, "numbers": numbers, "derived": {}, "studies": []},
        "figures": {name: made.figures[name] for name in ("figure3", "estimation_error")},
    }
    file.write_text(page_of(replace(made, **own)), encoding="utf-8")
    page = opened("#off_resonance?f=40.125", file=file)
    orbit = orbit_of(OWN, OWN.levels_m[0], 14.25)
    assert readings(page)["X"] == f"{number(1e3 * orbit.X)} mm"
    assert "only sticks" in page.inner_text("#oscillator .words")
    table = approaches_table(numbers, OWN.frequencies_hz)
    error = table.set_index(["frequency", "approach", "phase", "sharing"])["F_k_error_percent"][
        "high", "X_s", "reversal", "common"
    ]
    words = plain(page.inner_text("#off_resonance .words"))
    assert f"({wording.signed_percent(0.01 * error)})" in words
    assert f"{np.isfinite(features['high'].X_s).sum()} levels" in words
    estimation = checked(tmp_path / "shown.yaml", texts(page, "off_resonance")[1])["estimation"]
    assert estimation["pairs"] == [[i + 1, j + 1] for i, j in OWN.pairs]
