"""Channels in a wrong unit or with a wrong sign are asked for by name, and the remedy that is named gives the truth."""

import math

import numpy as np
import pytest

from dampbalance import BaseMotion, Oscillator, identify, measured_orbit, read_records, steady_orbit

OSC = Oscillator(m=1.9, c=31.0, k=2900.0, K_z=160000.0, F_k=1.7)
OMEGA = 2.0 * math.pi * 5.5
LEVELS = 0.0021, 0.0038, 0.0066


def signals(drive, response, noise=0.004):
    """Return time, drive and response of each level, SI."""
    for seed, Y in enumerate(LEVELS):
        orbit = steady_orbit(OSC, BaseMotion(Y=Y, omega=OMEGA))
        of = measured_orbit(
            orbit, rate_hz=1500.0, cycles=22.0, noise=noise, seed=seed, channels=(drive, response)
        )
        yield of[drive].t, of[drive].values, of[response].values


def files(folder, drive, response, factors, units):
    """Write each level as a file whose channels are so many times as large as they should be, in units as labelled."""
    for i, (t, *values) in enumerate(signals(drive, response)):
        columns = [t, *(f * v for f, v in zip(factors, values, strict=True))]
        names = [f"{q} [{u}]" for q, u in zip((drive, response), units, strict=True)]
        rows = "\n".join(",".join(f"{x:.9g}" for x in row) for row in zip(*columns, strict=True))
        (folder / f"{i}.csv").write_text(f"time [s],{','.join(names)}\n{rows}\n")
    return sorted(folder.glob("*.csv"))


@pytest.mark.parametrize(
    ("drive", "response", "factors", "units", "quantity", "remedy"),
    [
        # inches called mm, lbf called N, mm called in
        ("base_displacement", "displacement", (1 / 0.0254, 1e3), ("mm", "mm"), 0, {"unit": "in"}),
        ("force", "displacement", (1 / 4.44822, 1e3), ("N", "mm"), 0, {"unit": "lbf"}),
        ("base_velocity", "velocity", (1e3, 1e3), ("mm/s", "in/s"), 1, {"unit": "mm/s"}),
        # an amplitude times a frequency in Hz
        (
            "base_displacement",
            "velocity",
            (1e3, 0.5e3 / math.pi),
            ("mm", "mm/s"),
            1,
            {"scale": 6.28319},
        ),
        # upside down
        ("base_acceleration", "acceleration", (1.0, -1.0), ("m/s²", "m/s²"), 1, {"sign": -1}),
        ("base_displacement", "relative_displacement", (-1e3, 1e3), ("mm", "mm"), 0, {"sign": -1}),
    ],
)
def test_named_channel_with_the_remedy_gives_the_truth(
    tmp_path, drive, response, factors, units, quantity, remedy
):
    paths = files(tmp_path, drive, response, factors, units)
    wrong = identify(paths, stiffness=OSC.k)
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
    found = identify(paths, stiffness=OSC.k, mapping={"channels": rules})
    assert not found.no_answer
    for symbol in ("F_k", "c"):
        # three standard errors, and what 4.44822 and 6.28319 are rounded to
        error = 3.0 * found.standard_errors[symbol] + 1e-5 * getattr(OSC, symbol)
        assert found.values[symbol] == pytest.approx(getattr(OSC, symbol), abs=error)


def test_exchanged_channels_are_not_called_turned():
    """With the other sign an oscillator comes nearer to them, and none is near."""
    rig, records = Oscillator(m=1.9, c=8.0, k=3000.0, K_z=150000.0, F_k=2.0), []
    for seed, Y in enumerate((0.0014, 0.003, 0.006)):
        orbit = steady_orbit(rig, BaseMotion(Y=Y, omega=2.0 * math.pi * 5.2))
        of = measured_orbit(orbit, rate_hz=1600.0, cycles=30.0, noise=0.003, seed=seed)
        y, x = of["base_displacement"], of["displacement"]
        names = ("time_s", "base_displacement_m", "displacement_m")
        records.append(dict(zip(names, (y.t, x.values, y.values), strict=True)))
    codes = {one.code for one in identify(records, stiffness=rig.k).unanswered[0]}
    assert "exchanged" in codes
    assert "misread" not in codes


@pytest.mark.parametrize("factor", [1.0, 9.80665])
def test_nothing_is_asked_where_the_records_hold(factor):
    # both channels alike: no record shows it, and F_k is in proportion
    pairs = signals("base_acceleration", "acceleration")
    found = identify(
        [
            {
                "time_s": t,
                "base_acceleration_m_per_s2": factor * y,
                "acceleration_m_per_s2": factor * x,
            }
            for t, y, x in pairs
        ],
        stiffness=OSC.k,
    )
    assert not any(one.code == "misread" for one in found.findings)
    assert any(one.code == "gains" for one in found.rig)
    error = 3.0 * found.standard_errors["F_k"]
    assert found.values["F_k"] == pytest.approx(factor * OSC.F_k, abs=error)


@pytest.mark.parametrize(
    ("base", "mass", "read"),
    [
        ("base velocity [mm/s]", "mass velocity [mm/s]", True),
        ("v_base (mm/s)", "v (mm/s)", True),
        ("velocity base (mm/s)", "x/mm", True),
        ("laser 1 (mm/s)", "laser 2 (mm/s)", False),
    ],
)
def test_velocity_of_the_base_drives(tmp_path, base, mass, read):
    response = "displacement" if mass.startswith("x") else "velocity"
    (t, w, x), *_ = signals("base_velocity", response)
    rows = np.column_stack([t, 1e3 * w, 1e3 * x])
    np.savetxt(
        tmp_path / "1.csv", rows, delimiter=",", header=f"time (s),{base},{mass}", comments=""
    )
    if read:
        (record,) = read_records(tmp_path / "1.csv")
        assert set(record) == {"base_velocity", response}
    else:
        with pytest.raises(ValueError, match="base_velocity or velocity"):
            read_records(tmp_path / "1.csv")


def test_velocities_of_base_and_mass_give_the_truth():
    tables = [
        {"time_s": t, "base_velocity_m_per_s": w, "velocity_m_per_s": v}
        for t, w, v in signals("base_velocity", "velocity")
    ]
    found = identify(tables, stiffness=OSC.k)
    for symbol in ("F_k", "c"):
        error = 3.0 * found.standard_errors[symbol]
        assert found.values[symbol] == pytest.approx(getattr(OSC, symbol), abs=error)
        assert found.verdicts[symbol].verdict == "usable"
