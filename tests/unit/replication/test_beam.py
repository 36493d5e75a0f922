"""The beam: what tables and a blow say of a joint that is known, and the numbers recorded of the real one."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import yaml

from dampbalance.identification.measured import configured, identify
from dampbalance.law.gradual import Sliders
from dampbalance.likelihood.dynamic_stiffness import SteppedLines, compare_contacts
from dampbalance.project.files import sha256
from dampbalance.publishing.rigs import beam_page
from dampbalance.replication.beam.findings import Findings, findings, findings_of
from folders import ROOT

CONFIG = yaml.safe_load((ROOT / "config/beam.yaml").read_text(encoding="utf-8"))
(MEASURED,), BEAM = CONFIG["measured"], CONFIG["beam"]
RECORDED = yaml.safe_load((ROOT / "config/records/beam/results.yaml").read_text(encoding="utf-8"))
(TABLE,) = MEASURED["records"]
FILES = [(ROOT / name).resolve() for name in (TABLE, BEAM["record"])]

there = pytest.mark.skipif(
    not all(map(Path.is_file, FILES)),
    reason="no tables of the beam: see config/records/beam/README.md",
)

K, M, C = 465_000.0, 1.9, 2.0
LEVELS = np.geomspace(15e-6, 320e-6, 8)
SLIDERS = Sliders(np.geomspace(2e-5, 4e-4, 12), np.full(12, 2500.0))


def known_lines() -> SteppedLines:
    """Eight levels of an oscillator with twelve sliders, 0.5 % of noise."""
    X = np.repeat(LEVELS, 15)
    omega = 2.0 * math.pi * np.tile(np.linspace(79.0, 81.5, 15), 8)
    Z = K - M * omega**2 + 1j * omega * C + SLIDERS.secant(X)
    noise = np.random.default_rng(20_101).standard_normal((2, X.size))
    level = np.repeat(np.arange(8), 15)
    names = tuple(f"{i + 1}" for i in range(8))
    return SteppedLines(omega, X, Z * (1.0 + 0.005 * (noise[0] + 1j * noise[1])), level, names)


def known_blow(folder: Path, X_0: float = 250e-6) -> dict:
    """The record of a blow to the same oscillator: Ẋ = −W(X)/(2πm ω X)."""
    rate, seconds, omega = 6400.0, 4.0, 2.0 * math.pi * 80.2
    t = np.arange(0.0, seconds, 1.0 / rate)
    grid = np.geomspace(1e-7, 2.0 * X_0, 400)
    W = SLIDERS.loss(grid) + math.pi * omega * C * grid**2
    # time that passes from X_0 down to X, by quadrature of dt = −2πm ω X dX / W
    slowness = 2.0 * math.pi * M * omega * grid**2 / W  # over ln X
    passed = np.concatenate(
        [[0.0], np.cumsum(0.5 * (slowness[1:] + slowness[:-1]) * np.diff(np.log(grid)))]
    )
    passed = np.interp(math.log(X_0), np.log(grid), passed) - passed
    X = np.exp(np.interp(t, passed[::-1], np.log(grid)[::-1]))
    text = "\n".join(
        f"{a:.6f},{b:.9g}" for a, b in zip(t, omega**2 * X * np.sin(omega * t), strict=True)
    )
    record = folder / "blow.csv"
    record.write_text(f"time,tip\n{text}\n", encoding="utf-8")
    return {**BEAM, "record": str(record), "channels": ["tip"]}


def test_a_blow_to_the_same_joint_is_foretold(tmp_path):
    lines = known_lines()
    comparison = compare_contacts(lines, hardening=False)
    found = findings(comparison, lines, {}, known_blow(tmp_path)).document
    assert found["supported"] == "gradual"
    blow = found["blow"]
    # 0.5 % of noise, and the windows' mean over 10 % of amplitude
    assert abs(blow["off_mean"]) < 0.02
    # where the first slider begins, between two levels
    assert abs(blow["off_worst"]) < 0.08
    assert blow["scale"] == pytest.approx(1.0, abs=0.03)
    resonances = [row["resonance_hz"] for row in found["levels"]]
    stiff = K + SLIDERS.secant(LEVELS).real
    assert resonances == pytest.approx(np.sqrt(stiff / M) / (2.0 * math.pi), abs=0.02)
    page = beam_page(found | {"files": {}}, ["A limit."])
    assert "120 lines of a stepped sine at eight levels" in page
    assert "| tip" not in page
    assert "ζ, tip (‰)" in page


def test_a_blow_to_another_joint_is_not(tmp_path):
    lines = known_lines()
    comparison = compare_contacts(lines, hardening=False)
    far = known_blow(tmp_path, X_0=250e-6)
    text = Path(far["record"]).read_text(encoding="utf-8").splitlines()
    halved = [f"{a},{0.5 * float(b)}" for a, b in (row.split(",") for row in text[1:])]
    Path(far["record"]).write_text("\n".join([text[0], *halved]) + "\n", encoding="utf-8")
    found = findings(comparison, lines, {}, far).document["blow"]
    # a channel with half the motion shows the damping of twice its amplitude
    assert found["off_mean"] < -0.05
    assert found["scale"] == pytest.approx(2.0, rel=0.1)


def test_a_decay_without_an_amplitude_of_the_lines_is_refused(tmp_path):
    lines = known_lines()
    comparison = compare_contacts(lines, hardening=False)
    with pytest.raises(ValueError, match="the decay of tip passes no amplitude of the lines"):
        findings(comparison, lines, {}, known_blow(tmp_path, X_0=1e-6))


def test_a_window_without_a_sample_is_refused_by_file_and_key(tmp_path):
    lines = known_lines()
    comparison = compare_contacts(lines, hardening=False)
    blow = known_blow(tmp_path) | {"window_s": 1e-6}
    with pytest.raises(
        ValueError, match=r"beam: .*blow\.csv: window_s must be a cycle of the band's"
    ):
        findings(comparison, lines, {}, blow)


@cache
def found() -> Findings:
    identified = identify(
        FILES[:1], **configured(MEASURED | {"mapping": str(ROOT / MEASURED["mapping"])})
    )
    return findings_of(identified, {**BEAM, "record": str(FILES[1])})


@there
def test_the_files_are_those_that_were_recorded():
    assert {file.name: sha256(file) for file in FILES} == RECORDED["files"]


@there
@pytest.mark.slow
def test_the_numbers_are_those_that_were_recorded():
    document = found().document
    assert document["supported"] == RECORDED["supported"]
    recorded = {row["law"]: row for row in RECORDED["laws"]}
    assert [row["law"] for row in document["laws"]] == list(recorded)
    for row in document["laws"]:
        for name, value in recorded[row["law"]].items():
            # three digits are recorded
            assert row[name] == (value if name == "law" else pytest.approx(value, rel=1e-2))
    for name, value in RECORDED["gradual"].items():
        assert document["gradual"][name]["value"] == pytest.approx(value, rel=1e-2)
    for name, value in RECORDED["blow"].items():
        assert document["blow"][name] == pytest.approx(value, rel=2e-2)
