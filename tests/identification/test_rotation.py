"""Records that rotate: the same oscillator with an angle for x, a torque for the force and an inertia for the mass.

Releases of a pendulum are those of an independent integrator. The forced records are exact responses; what is told
apart are units and names.
"""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from dampbalance import BaseMotion, Oscillator, identify, measured_orbit, steady_orbit
from dampbalance.fit.select import REFITTED
from dampbalance.identification.answer import USABLE
from dampbalance.identification.decays import identify_decay_records
from dampbalance.measured import read_records
from dampbalance.project.wording import in_html
from dampbalance.records.channel import Channel
from dampbalance.records.coordinate import ROTATION, TRANSLATION
from dampbalance.records.errors import RecordError
from dampbalance.records.record import Record
from dampbalance.records.writers import write
from identification.levels import close
from identification.pendulums import Release

# kg m², N m s/rad, N m/rad, N m/rad and N m: a pendulum on a bearing with friction, at small angles
PENDULUM = Oscillator(m=0.02, c=2e-3, k=1.2, K_z=60.0, F_k=0.01)
FORCED = {"rate_hz": 200.0, "cycles": 20.0, "noise": 0.003}
LEVELS = (0.02, 0.05, 0.12)  # rad


def identified(release, seed=1, **options):
    return identify(release.record(seed), release.k, kind="ring-down", **options)


@pytest.fixture(scope="module")
def pendulum():
    """The identification of a release from 0.3 rad, stiffness and inertia being given."""
    return identified(Release(0.3), mass=Release.m)


def made(*channels, Y=LEVELS):
    """Forced records of these channels."""
    motions = [BaseMotion(Y=one, omega=2.0 * math.pi * 1.4) for one in Y]
    return [
        measured_orbit(steady_orbit(PENDULUM, one), seed=i, channels=channels, **FORCED)
        for i, one in enumerate(motions)
    ]


@pytest.fixture(scope="module")
def forced(tmp_path_factory):
    """Files of forced records, called like a symbol, and what is identified from them."""
    folder = tmp_path_factory.mktemp("forced")
    files = [
        write(folder / f"F_k of 3 N {i}.csv", one)
        for i, one in enumerate(made("base_angle", "angle"))
    ]
    return files, identify(files, (PENDULUM.k, 0.01), mass=PENDULUM.m)


@pytest.mark.parametrize(("A", "option"), [(0.3, False), (2.0, True)])
def test_a_release_of_a_pendulum_gives_its_friction_torque(pendulum, A, option):
    release = Release(A)
    found = identified(release, pendulum=True) if option else pendulum
    assert found.basis.fit.problem.pendulum
    assert close(found, release, ("F_k", "c"))
    assert found.verdicts["F_k"].verdict == found.verdicts["c"].verdict == USABLE
    assert found.basis.fit.error("F_k") < 0.01 * release.F_k
    # the balance agrees, from swings that are not those of a spring
    balance = [found.approaches["balance"].values[s] for s in ("F_k", "c")]
    assert balance == pytest.approx([release.F_k, release.c], rel=0.1)
    said = {one.code for one in found.findings}
    assert ("pendulum" in said) != option
    assert "contradicts" not in said
    assert max(one.weight for one in found.weighed if one.name == "k_3") < REFITTED


def test_numbers_of_a_rotation_have_its_names_and_units(pendulum):
    assert pendulum.coordinate is ROTATION
    document = pendulum.document()
    assert document["coordinate"] == "rotation"
    assert document["maximum_likelihood"]["T_k_N_m"] == pendulum.values["F_k"]
    assert document["options"]["inertia_kg_m2"] == Release.m
    assert [*pendulum.to_frame()["unit"][:3]] == ["N m", "N m s/rad", "N m/rad"]


def test_turns_a_minute_give_what_radians_give():
    records = made("base_angle", "angular_velocity")
    tables = [
        {
            "time_s": one["base_displacement"].t,
            "base angle [mrad]": 1e3 * one["base_displacement"].values,
            "speed [rpm]": 30.0 / math.pi * one.responses[0].values,
        }
        for one in records
    ]
    expected, found = (identify(of, PENDULUM.k) for of in (records, tables))
    assert found.coordinate is expected.coordinate is ROTATION
    # the last bits of the samples differ, and the search ends where its steps are small
    for symbol, value in expected.values.items():
        reach = 1e-6 * expected.standard_errors[symbol]
        assert found.values[symbol] == pytest.approx(value, abs=reach)


def test_a_rotation_has_the_numbers_of_a_translation(forced):
    records = made("base_displacement", "displacement")
    found = identify(records, (PENDULUM.k, 0.01), mass=PENDULUM.m)
    assert found.coordinate is TRANSLATION
    assert found.values == forced[1].values


# Units of a translation, and its words, wherever they stand: none may be left.
LEFT = re.compile(
    r"(?<![\w])N(?! ?m)(?![\w])|N/m|\bkg\b(?! m²)|(?<=\d )m\b|\((?:m|mm|m/s|m/s²)\)|F_k|<i>F</i>|\bmass\b|"
    r"\bforces?\b|displacement|(?<!ngular )velocity|(?<!ngular )(?<!ngular_)acceleration|_kg(?!_m2)|_N_(?!m)|_m\b|_mm?_"
)


@pytest.mark.parametrize("kind", ["decay", "forced"])
def test_no_unit_of_a_translation_is_left_in_any_output(forced, pendulum, tmp_path, kind):
    found = {"decay": pendulum, "forced": forced[1]}[kind]
    names = {*found.sources, *(source.rpartition("/")[2] for source in found.sources)}
    names |= {in_html(name) for name in names}  # set like symbols, but not exchanged
    files = [file for file in found.save(tmp_path / kind) if file.suffix != ".png"]
    texts = {file.name: file.read_text(encoding="utf-8") for file in files}
    texts |= {"html": found._repr_html_(), "rows": " ".join(found.rows)}
    for file, text in texts.items():
        if file.endswith(".svg"):  # what is written, as matplotlib notes it
            text = " | ".join(re.findall(r"<!--(.*?)-->", text, re.DOTALL))
            assert "rad" in text or "N m" in text or file == "balance.svg", file
        text = text.replace("\N{NO-BREAK SPACE}", " ")
        text = re.sub(r"<style>.*?</style>|data:[^\"]*", "", text, flags=re.DOTALL)
        for source in sorted(names, key=len, reverse=True):
            text = text.replace(source, "")
        text = re.sub(r"kg_m2|(?<=[_ ])N_m|kg m²", "", text)
        match = LEFT.search(text)
        assert match is None, (file, text[max(0, match.start() - 80) : match.end() + 40])
    assert all("F_k" not in symbol for symbol in found.document()["maximum_likelihood"])


def test_an_angle_and_a_displacement_are_no_record():
    (one,), (other,) = (made(f"base_{of}", of, Y=[0.02]) for of in ("angle", "displacement"))
    table = {f"{q}_m": other[q].values for q in other} | {"time_s": other["displacement"].t}
    with pytest.raises(RecordError, match=r"rotates and record 2.* separately"):
        identify([one, table], 1.0)
    with pytest.raises(ValueError, match="'angle' rotates and 'displacement' moves along a line"):
        Record.of(
            "run", [Channel(q, np.arange(9.0), np.ones(9)) for q in ("angle", "displacement")]
        )


def test_errors_have_units_of_a_rotation():
    with pytest.raises(ValueError, match=r"k = 1·10¹² N m/rad and J = 0.0001 kg m²"):
        identify(made("base_angle", "angle"), 1e12, mass=1e-4)


def test_pendulums_without_friction_show_none():
    random, missed = np.random.default_rng(50), 0
    for i in range(18):
        release = Release(random.uniform(0.5, 0.8), 0.0, random.uniform(1e-3, 3e-3))
        found = identified(release, 50 + i)
        verdict = found.verdicts["F_k"]
        assert verdict.verdict != USABLE or math.isinf(verdict.within)
        low, high = found.intervals["c"]
        missed += not low <= release.c <= high
    assert missed <= 3  # of 18 with 5 % each, 1.1 % of the time by chance


def test_a_spring_that_does_not_soften_is_no_pendulum():
    release = Release(0.6, spring=True)
    found = identified(release)
    assert not found.basis.fit.problem.pendulum
    assert close(found, release, ("F_k", "c"))
    record = release.record(1)
    record["displacement_m"] = record.pop("angle_rad")
    with pytest.raises(ValueError, match="pendulum"):
        identify(record, 1.5, kind="ring-down", pendulum=True)


def test_no_law_is_supported_whose_residual_the_fit_itself_rejects():
    """A spring with friction and damping for a pendulum: its residual is a motion, whatever the terms."""
    release = Release(1.0)
    (record,) = read_records(release.record(1), free=True)
    found = identify_decay_records([record], release.k, laws=True)
    assert "weighs" in {one.code for one in found.findings}
    assert found.laws.chosen is None
