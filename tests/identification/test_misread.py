"""Channels in a wrong unit or with a wrong sign are asked for by name, and the remedy that is named gives the truth;
what is refused names the key or the option that helps."""

import math
from dataclasses import replace

import pytest

from dampbalance import Oscillator, identify, measured_ring_down
from identification.levels import measured

OSC = Oscillator(m=1.9, c=31.0, k=2900.0, K_z=160000.0, F_k=1.7)
HERTZ = 5.5
TURN = 6.28319  # 2π as it is shown


def tables(drive, response, factors=(1.0, 1.0), units=None):
    """Return a table of each level, whose channels are so many times as large as in SI, in units as labelled."""
    options = {"rate_hz": 1500.0, "cycles": 22.0, "noise": 0.004, "channels": (drive, response)}
    heads = [f"{q} [{u}]" for q, u in zip((drive, response), units or ("m", "m"), strict=True)]
    return [
        {"time_s": of[drive].t}
        | {h: f * of[q].values for h, f, q in zip(heads, factors, (drive, response), strict=True)}
        for of in measured((0.0021, 0.0038, 0.0066), HERTZ, OSC, **options)
    ]


@pytest.mark.parametrize(
    ("drive", "response", "factors", "units", "quantity", "remedy"),
    [
        # inches called mm, mm called in
        ("base_displacement", "displacement", (1 / 0.0254, 1e3), ("mm", "mm"), 0, {"unit": "in"}),
        ("base_velocity", "velocity", (1e3, 1e3), ("mm/s", "in/s"), 1, {"unit": "mm/s"}),
        # an amplitude times a frequency in Hz
        ("base_displacement", "velocity", (1e3, 500 / math.pi), ("mm", "mm/s"), 1, {"scale": TURN}),
        # upside down
        ("base_acceleration", "acceleration", (1.0, -1.0), ("m/s²", "m/s²"), 1, {"sign": -1}),
        ("base_displacement", "relative_displacement", (-1e3, 1e3), ("mm", "mm"), 0, {"sign": -1}),
    ],
)
def test_named_channel_with_the_remedy_gives_the_truth(
    drive, response, factors, units, quantity, remedy
):
    given = tables(drive, response, factors, units)
    wrong = identify(given, stiffness=OSC.k)
    assert wrong.no_answer
    (asked,) = (one for one in wrong.findings if one.code == "misread")
    assert wrong.unanswered[0] == [asked]  # the first cause
    of = (drive, response)[quantity]
    said = [one.numbers for one in asked.numbers["what"]]
    assert any(of in (one.get("quantity"), *one.get("quantities", ())) for one in said)
    # what it says can be typed, and is right
    (key, value), text = next(iter(remedy.items())), wrong.no_answer
    assert f"{key}: {value}" in text
    rules = {q: {"channel": q, "unit": u} for q, u in zip((drive, response), units, strict=True)}
    rules[of] |= remedy
    found = identify(given, stiffness=OSC.k, mapping={"channels": rules})
    assert not found.no_answer
    for symbol in ("F_k", "c"):
        # three standard errors, and what 6.28319 is rounded to
        error = 3.0 * found.standard_errors[symbol] + 1e-5 * getattr(OSC, symbol)
        assert found.values[symbol] == pytest.approx(getattr(OSC, symbol), abs=error)


def test_exchanged_channels_are_not_called_turned():
    """With the other sign an oscillator comes nearer to them, and none is near."""
    rig = Oscillator(m=1.9, c=8.0, k=3000.0, K_z=150000.0, F_k=2.0)
    records = []
    for of in measured((0.0014, 0.003, 0.006), 5.2, rig, rate_hz=1600.0, cycles=30.0, noise=0.003):
        y, x = of["base_displacement"], of["displacement"]
        names = ("time_s", "base_displacement_m", "displacement_m")
        records.append(dict(zip(names, (y.t, x.values, y.values), strict=True)))
    codes = {one.code for one in identify(records, stiffness=rig.k).unanswered[0]}
    assert "exchanged" in codes
    assert "misread" not in codes


def test_nothing_is_asked_where_the_records_hold():
    # both channels alike: no record shows it, and F_k is in proportion
    of, factor = ("base_acceleration", "acceleration"), 9.80665
    found = identify(tables(*of, (factor, factor), ("m/s²", "m/s²")), stiffness=OSC.k)
    assert not any(one.code == "misread" for one in found.findings)
    assert any(one.code == "gains" for one in found.rig)
    error = 3.0 * found.standard_errors["F_k"]
    assert found.values["F_k"] == pytest.approx(factor * OSC.F_k, abs=error)


# --- refusals --------------------------------------------------------------------------------------

FORCED = tables("base_displacement", "displacement")[0]
STILL = FORCED | {"base_displacement [m]": 0.0 * FORCED["time_s"]}
A = -((2.0 * math.pi * HERTZ) ** 2) * FORCED["displacement [m]"]


def decay(factor):
    """A free decay whose accelerometer shows so many times its acceleration."""
    of = {"x": 0.008, "rate_hz": 1200.0, "duration": 2.5, "noise": 0.001}
    sensors = "displacement", "acceleration"
    x, a = measured_ring_down(
        replace(OSC, c=3.0, F_k=0.8), channels=sensors, **of
    ).channels.values()
    return {"time_s": x.t, "displacement_m": x.values, "acceleration_m_per_s2": factor * a.values}


AS_NAMED = {"channels": {q: {"channel": q} for q in ("displacement", "acceleration")}}


@pytest.mark.parametrize(
    ("table", "options", "named"),
    [
        (FORCED, {"frequency": 6.0}, "frequency="),
        (FORCED, {"skip_cycles": 20}, "skip_cycles="),
        (FORCED, {"kind": "ring-down"}, "kind="),
        # a drive that stands still beside a motion that does not die out
        (STILL, {}, "in a mapping"),
        (STILL, {"kind": "forced"}, "kind="),
        # another sensor, upside down or in g
        ({**FORCED, "acceleration_m_per_s2": -A}, {}, "sign: -1"),
        ({**FORCED, "acceleration_g": A}, {}, "unit: "),
        (decay(-1.0), {}, "sign: -1"),
        (decay(1.0 / 9.80665), {"mapping": AS_NAMED}, "record 1: acceleration contradicts.*unit: "),
    ],
)
def test_a_refusal_names_what_helps(table, options, named):
    with pytest.raises(ValueError, match=named):
        identify(table, stiffness=OSC.k, **options)
