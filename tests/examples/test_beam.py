"""The beam: the damping of a decay with a closed form, and the numbers of the records where they are."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from examples.running import DATA, script_of

beam = script_of("beam")
RECORDS = DATA / "brb"

OMEGA = 2.0 * math.pi * 80.0
T = np.arange(0.0, 5.0, 1.0 / 12_800.0)


def decay(zeta_0: float, slope: float, X_0: float = 1e-4) -> tuple[np.ndarray, np.ndarray]:
    """Acceleration and amplitude of Ẋ = −(ζ_0 + slope·X) ω X from X_0 on:
    X = ζ_0 X_0 e^{−ζ_0 ωt}/(ζ_0 + slope·X_0 (1 − e^{−ζ_0 ωt}))."""
    gone = np.exp(-zeta_0 * OMEGA * T)
    X = zeta_0 * X_0 * gone / (zeta_0 + slope * X_0 * (1.0 - gone))
    return OMEGA**2 * X * np.sin(OMEGA * T), X


@pytest.mark.parametrize("slope", [0.0, 12.0])
@pytest.mark.parametrize("other", [0.0, 400.0])  # m/s² of another mode
def test_the_damping_of_a_decay_is_read_at_its_amplitude(slope, other):
    acceleration, X = decay(1.5e-3, slope)
    acceleration += other * np.exp(-3.0 * T) * np.sin(2.0 * math.pi * 297.7 * T)
    windows = beam.modal_decay(T, acceleration)
    # a window in which X falls by 20 % shows the mean over it
    zeta = 1.5e-3 + slope * windows["X_m"]
    assert windows["zeta"].to_numpy() == pytest.approx(zeta.to_numpy(), rel=1e-2 if slope else 3e-3)
    # the end of the record, where the filter runs out, moves the phase
    assert windows["frequency_hz"].to_numpy() == pytest.approx(80.0, rel=1e-4)
    at = np.interp(windows["t_s"], T, X)
    assert windows["X_m"].to_numpy() == pytest.approx(at, rel=2e-3)


@pytest.mark.skipif(not RECORDS.is_dir(), reason="no records of the beam: examples/beam/README.md")
def test_the_numbers_of_the_records(tmp_path):
    beam.main(RECORDS, tmp_path)
    numbers = json.loads((tmp_path / "beam.json").read_text(encoding="utf-8"))
    assert numbers["supported"] == "gradual"
    # three digits are noted
    assert sum(numbers["weights"].values()) == pytest.approx(1.0)
    values = {symbol: of["value"] for symbol, of in numbers["numbers"].items()}
    assert values == pytest.approx({"F_k": 5.327, "c": 0.5233, "K_z": 36330.0}, rel=1e-2)
    loss = {name: of["loss_rms"] for name, of in numbers["fits"].items()}
    assert loss == pytest.approx(
        {"nothing": 0.0457, "residual receptance": 0.151, "hardening": 0.552}, rel=1e-2
    )
    predicted = (numbers["off_mean"], numbers["off_worst"], numbers["best_factor"])
    assert predicted == pytest.approx((-0.0975, -0.1241, 1.33), rel=2e-2)
    assert (tmp_path / "beam.svg").is_file()
