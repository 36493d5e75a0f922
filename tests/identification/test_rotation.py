"""Records that rotate: the same oscillator with an angle for x, a torque for the force and an inertia for the mass.

The truth of a pendulum's release is an independent integrator (tests/analytic/integrator.py), at small angles, where
gravity is a spring of m g l. The other records are exact responses; what is told apart are units and names.
"""

from __future__ import annotations

import math
import re
from types import SimpleNamespace

import numpy as np
import pytest

from analytic.integrator import integrate
from dampbalance import BaseMotion, Oscillator, identify, measured_orbit, steady_orbit
from dampbalance.commands.main import main
from dampbalance.measured import read_records
from dampbalance.model import UNITS as OF_TRANSLATION
from dampbalance.project.wording import in_html
from dampbalance.records.channel import Channel
from dampbalance.records.coordinate import ROTATION, TRANSLATION
from dampbalance.records.errors import RecordError
from dampbalance.records.record import Record
from dampbalance.records.writers import write

MASS, LENGTH, GRAVITY = 0.8, 0.15, 9.81  # of the bob, kg, from the pivot to it, m; m/s²
PENDULUM = Oscillator(
    m=MASS * LENGTH**2 + 1e-3, c=2e-3, k=MASS * GRAVITY * LENGTH, K_z=60.0, F_k=0.01
)
"""kg m², N m s/rad, N m/rad, N m/rad and N m: a pendulum on a bearing with friction."""
RATE, ANGLE, NOISE = 250.0, 0.15, 2e-4  # Hz, rad, rad
FORCED = {"rate_hz": 200.0, "cycles": 20.0, "noise": 0.003}
LEVELS = (0.02, 0.05, 0.12)  # rad


@pytest.fixture(scope="module")
def release():
    """Times, s, and angles, rad, of a release of the pendulum by the independent integrator."""
    t, at_rest = np.arange(0.0, 8.0, 1.0 / RATE), SimpleNamespace(Y=0.0, omega=1.0)
    x, v, z, angles = ANGLE, 0.0, PENDULUM.Z_m, [ANGLE]
    for _ in t[1:]:
        end = integrate(PENDULUM, at_rest, 1.0 / RATE, x, v, z)
        x, v, z = end.x, end.v, end.z
        angles.append(x)
    lead = np.full(50, ANGLE)
    angles = np.append(lead, angles)
    return np.arange(angles.size) / RATE, angles + NOISE * np.random.default_rng(3).standard_normal(
        angles.size
    )


@pytest.fixture(scope="module")
def pendulum(release):
    """The identification of the release, its stiffness and inertia being given."""
    t, angles = release
    return identify({"time_s": t, "angle_rad": angles}, PENDULUM.k, mass=PENDULUM.m)


@pytest.fixture(scope="module")
def orbits():
    return [steady_orbit(PENDULUM, BaseMotion(Y=Y, omega=2.0 * math.pi * 1.4)) for Y in LEVELS]


@pytest.fixture(scope="module")
def forced(orbits, tmp_path_factory):
    """Files of forced records, one called like a symbol, and what is identified from them."""
    folder = tmp_path_factory.mktemp("forced")
    files = [
        write(
            folder / f"F_k of 3 N {i}.csv",
            measured_orbit(orbit, seed=i, channels=("base_angle", "angle"), **FORCED),
        )
        for i, orbit in enumerate(orbits)
    ]
    return files, identify(files, (PENDULUM.k, 0.01), mass=PENDULUM.m)


def test_a_release_of_a_pendulum_gives_its_friction_torque(pendulum):
    for symbol in ("F_k", "c", "K_z"):
        error = pendulum.standard_errors[symbol]
        # four standard errors: once in 16,000 of normal errors; the record is fixed
        assert abs(pendulum.values[symbol] - getattr(PENDULUM, symbol)) < 4.0 * error, symbol
    assert pendulum.values["F_k"] == pytest.approx(PENDULUM.F_k, rel=0.02)
    assert pendulum.coordinate is ROTATION
    assert pendulum.text().count("T_k (N m)") == 1
    document = pendulum.document()
    assert document["coordinate"] == "rotation"
    assert document["maximum_likelihood"]["T_k_N_m"] == pendulum.values["F_k"]
    assert document["maximum_likelihood"]["J_kg_m2"] == pytest.approx(PENDULUM.m, rel=1e-2)
    assert document["options"]["inertia_kg_m2"] == PENDULUM.m
    assert [*pendulum.to_frame()["unit"][:3]] == ["N m", "N m s/rad", "N m/rad"]


def test_degrees_give_the_decay_that_radians_give(release, pendulum):
    t, angles = release
    in_degrees = {"time_s": t, "angle_deg": np.degrees(angles)}
    found = identify(in_degrees, PENDULUM.k, mass=PENDULUM.m)
    # the last bits of the samples differ, and the search ends where its steps are small: 1e-6 of an error
    for symbol, value in pendulum.values.items():
        reach = 1e-6 * pendulum.standard_errors[symbol]
        assert found.values[symbol] == pytest.approx(value, abs=reach)


@pytest.mark.parametrize(
    ("name", "quantity", "per_si"),
    [
        ("speed [rpm]", "angular_velocity", 30.0 / math.pi),
        ("angle [°]", "angle", 180.0 / math.pi),
        ("angular acceleration (deg/s²)", "angular_acceleration", 180.0 / math.pi),
    ],
)
def test_degrees_and_turns_a_minute_give_what_radians_give(orbits, name, quantity, per_si):
    options = FORCED | {"channels": ("base_angle", quantity)}
    records = [measured_orbit(orbit, seed=i, **options) for i, orbit in enumerate(orbits)]
    others = [
        {
            "time_s": record["base_displacement"].t,
            "base angle [mrad]": 1e3 * record["base_displacement"].values,
            name: per_si * record.responses[0].values,
        }
        for record in records
    ]
    expected, found = (identify(of, PENDULUM.k) for of in (records, others))
    assert found.coordinate is expected.coordinate is ROTATION
    for symbol, value in expected.values.items():
        assert found.values[symbol] == pytest.approx(
            value, abs=1e-6 * expected.standard_errors[symbol]
        )


def test_a_rotation_has_the_numbers_of_a_translation(orbits, forced):
    options = FORCED | {"channels": ("base_displacement", "displacement")}
    records = [measured_orbit(orbit, seed=i, **options) for i, orbit in enumerate(orbits)]
    found = identify(records, (PENDULUM.k, 0.01), mass=PENDULUM.m)
    assert found.coordinate is TRANSLATION
    assert found.values == forced[1].values
    assert "F_k (N)" in found.text()


def test_a_torque_drives():
    drive = BaseMotion(Y=0.05, omega=2.0 * math.pi * 1.4)
    options = FORCED | {"channels": ("torque", "angle")}
    records = [
        measured_orbit(steady_orbit(PENDULUM, BaseMotion(Y, drive.omega)), seed=3, **options)
        for Y in LEVELS
    ]
    assert {record["force"].unit for record in records} == {"N m"}
    tables = [
        {
            "time_s": record["force"].t,
            "Torque (ozf·in)": record["force"].values / 0.00706155181422604,
            "Encoder [deg]": np.degrees(record["displacement"].values),
        }
        for record in records
    ]
    found = identify(tables, PENDULUM.k)
    assert found.values["F_k"] == pytest.approx(PENDULUM.F_k, rel=0.02)
    assert found.records[0].to_frame().columns.to_list() == ["torque_N_m", "angle_rad"]


# Units of a translation, and its words, wherever they stand: none may be left.
LEFT = re.compile(
    r"(?<![\w])N(?! ?m)(?![\w])|N/m|\bkg\b(?! m²)|(?<=\d )m\b|\((?:m|mm|m/s|m/s²)\)|F_k|<i>F</i>|\bmass\b|"
    r"\bforces?\b|displacement|(?<!ngular )velocity|(?<!ngular )(?<!ngular_)acceleration|_kg(?!_m2)|_N_(?!m)|_m\b|_mm?_"
)


def test_no_unit_of_a_translation_is_left_in_any_output(forced, pendulum, tmp_path):
    for name, found in {"decay": pendulum, "forced": forced[1]}.items():
        names = {*found.sources, *(source.rpartition("/")[2] for source in found.sources)}
        names |= {in_html(name) for name in names}  # set like symbols, but not exchanged
        files = [file for file in found.save(tmp_path / name) if file.suffix != ".png"]
        texts = {file.name: file.read_text(encoding="utf-8") for file in files}
        texts |= {"html": found._repr_html_(), "rows": " ".join(found.rows)}
        for file, text in texts.items():
            if file.endswith(".svg"):  # what is written, as matplotlib notes it
                text = " | ".join(re.findall(r"<!--(.*?)-->", text, re.DOTALL))
                assert "rad" in text or "N m" in text or file == "balance.svg", file
            text = re.sub(r"<style>.*?</style>|data:[^\"]*", "", text, flags=re.DOTALL)
            for source in sorted(names, key=len, reverse=True):
                text = text.replace(source, "")
            text = re.sub(r"kg_m2|(?<=[_ ])N_m|kg m²", "", text)
            match = LEFT.search(text)
            assert match is None, (file, text[max(0, match.start() - 80) : match.end() + 40])
        assert all("F_k" not in symbol for symbol in found.document()["maximum_likelihood"])


def test_names_of_records_stay_as_they_are(forced):
    files, found = forced
    document = found.document()
    assert [of["record"] for of in document["records"]] == [str(file) for file in files]
    assert [level["level"] for level in document["damping"]["levels"]] == [*map(str, files)]
    assert files[0].name in found.report()


def test_an_angle_and_a_displacement_are_no_record(release, orbits):
    t, angles = release
    both = {"time_s": t, "angle_deg": angles, "force_N": np.sin(t)}
    with pytest.raises(RecordError, match=r"'angle.*' rotates and 'force.*' moves along a line"):
        identify(both, 1.0)
    with pytest.raises(ValueError, match="'angle' rotates and 'force' moves along a line"):
        Record.of("run", [Channel("angle", t, angles), Channel("force", t, np.sin(t))])
    with pytest.raises(ValueError, match="'angle' rotates and 'displacement' moves along a line"):
        Record.of("run", [Channel(q, t, angles) for q in ("angle", "displacement")])
    rules = {"channels": {"angle": {"channel": "angle"}, "force": {"channel": "force"}}}
    with pytest.raises(RecordError, match="holds angle and force: a record rotates or moves along"):
        read_records(both, mapping=rules)
    records = [
        measured_orbit(orbits[0], channels=(f"base_{of}", of), **FORCED)
        for of in ("angle", "displacement")
    ]
    with pytest.raises(RecordError, match=r"rotates and record 2.* identify them separately"):
        identify(
            [
                records[0],
                {"time_s": records[1]["displacement"].t}
                | {f"{q}_m": records[1][q].values for q in records[1]},
            ],
            1.0,
        )


@pytest.mark.parametrize(
    ("command", "columns"),
    [
        ("release --channel angle --displacement 0.1", ["angle_rad"]),
        (
            "simulate --channel base_angle --channel angular_velocity --frequency 1 --amplitude 0.1",
            ["base_angle_rad", "angular_velocity_rad_per_s"],
        ),
    ],
)
def test_commands_write_records_that_rotate(tmp_path, command, columns):
    path = tmp_path / "run.csv"
    rig = "--mass 0.02 --stiffness 1.2 --contact-stiffness 60 --friction 0.01 --damping 0.002"
    assert main([*command.split(), str(path), *rig.split(), "--rate", "200"]) == 0
    (record,) = read_records(path)
    assert record.coordinate == ROTATION
    assert [*record.to_frame()] == columns
    assert "rad" in record.corrected().responses[0].unit


def test_a_mapping_names_the_quantities_of_a_rotation(release):
    t, angles = release
    table = {"time_s": t, "CH1": 2.0 * np.degrees(angles)}
    rules = {"channels": {"angle": {"channel": "CH1", "unit": "deg", "scale": 0.5}}}
    (record,) = read_records(table, mapping=rules)
    assert record.coordinate is ROTATION
    # a degree and its inverse, each rounded
    assert record.corrected()["displacement"].values == pytest.approx(angles, rel=1e-15)
    rules["channels"]["angle"]["unit"] = "mm"
    with pytest.raises(RecordError, match="'mm' is a unit of length, but angle needs one of angle"):
        read_records(table, mapping=rules)


def test_errors_have_units_of_a_rotation(orbits):
    records = [measured_orbit(o, channels=("base_angle", "angle"), **FORCED) for o in orbits]
    with pytest.raises(ValueError, match=r"k = 1·10¹² N m/rad and J = 0.0001 kg m²") as error:
        identify(records, 1e12, mass=1e-4)
    assert "give the inertia in kg m² and the stiffness in N m/rad" in str(error.value)


OF_ROTATION = {
    **{"kg": "kg m²", "N": "N m", "N/m": "N m/rad", "N s/m": "N m s/rad", "N/m³": "N m/rad³"},
    **{"m": "rad", "m/s": "rad/s", "m/s²": "rad/s²", "m²/s": "rad²/s", "J": "J", "s": "s"},
    **{"rad": "rad", "rad/s": "rad/s", "mm": "mrad", "N/mm": "N m/mrad", "µm": "µrad"},
}


def test_every_unit_of_an_oscillator_has_its_own_of_a_rotation():
    assert {*OF_TRANSLATION.values()} <= OF_ROTATION.keys()
    for unit, rotating in OF_ROTATION.items():
        assert ROTATION.unit(unit) == ROTATION.unit(rotating) == rotating
        assert TRANSLATION.unit(unit) == unit


def test_nouns_symbols_and_keys_are_exchanged_once():
    nouns = {"mass": "inertia", "force": "torque", "velocity": "angular velocity"}
    nouns |= {"base_velocity": "base_angular_velocity", "normal_force": "normal_torque"}
    for noun, other in nouns.items():
        assert ROTATION.noun(noun) == ROTATION.noun(other) == other
        assert TRANSLATION.noun(noun) == noun
    for symbol, other in {"F_k": "T_k", "F_k[A]": "T_k[A]", "m": "J", "c": "c"}.items():
        assert ROTATION.symbol(symbol) == ROTATION.symbol(other) == other
    document = {"F_k_N": 1.0, "terms": ["F_k", "c"], "F_k of 3 N.csv": "F_k of 3 N.csv"}
    exchanged = {"T_k_N_m": 1.0, "terms": ["T_k", "c"], "F_k of 3 N.csv": "F_k of 3 N.csv"}
    assert ROTATION.document(document, ["F_k of 3 N.csv"]) == exchanged
