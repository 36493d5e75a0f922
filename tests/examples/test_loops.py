"""Measured loops: readings by hand with a closed form, and the numbers of the records where they are."""

from __future__ import annotations

import json

import numpy as np
import pytest

from examples.running import DATA, script_of

loops = script_of("loops")
RECORDS = DATA / "loops"


def test_readings_by_hand_are_those_of_a_slider():
    """A slider moved by ± X: plateaus ± F_k, slope K_z, loss 4 F_k (X − Z_m)."""
    F_k, K_z, X = 12.0, 2e5, 1e-3
    x = X * np.sin(np.linspace(0.0, 20.0 * np.pi, 40_001))
    z, f = 0.0, []
    for step in np.diff(x, prepend=0.0):
        z = min(max(z + step, -F_k / K_z), F_k / K_z)
        f.append(K_z * z)
    read = loops.by_hand(x, np.array(f))
    loss = 4.0 * F_k * (X - F_k / K_z)
    # 4,000 samples a cycle
    assert read == pytest.approx({"F_k": F_k, "K_z": K_z, "loss": loss}, rel=2e-3)


@pytest.mark.skipif(not RECORDS.is_dir(), reason="no measured loops: examples/loops/README.md")
def test_the_numbers_of_the_records(tmp_path):
    loops.main(RECORDS, tmp_path)
    numbers = json.loads((tmp_path / "loops.json").read_text(encoding="utf-8"))
    wear, damper = numbers["tribometer"], numbers["damper"]
    values = {symbol: wear["numbers"][symbol]["value"] for symbol in ("F_k", "K_z")}
    # three digits are noted
    assert values == pytest.approx({"F_k": 2.386, "K_z": 40210.0}, rel=1e-3)
    assert wear["friction_coefficient"] == pytest.approx(0.477, abs=5e-4)
    assert wear["by_hand"] == pytest.approx({"F_k": 2.38, "K_z": 42.0e3, "loss": 5.33e-4}, rel=1e-2)
    # the interval of K_z is wider than what another shape of the loop may do to it
    assert {damper["numbers"][symbol]["verdict"] for symbol in ("F_k", "c")} == {"doubtful"}
    page = (tmp_path / "loops.md").read_text(encoding="utf-8")
    assert "μ = F_k/N = 0.477" in page
    assert (tmp_path / "response.svg").is_file()
    assert (tmp_path / "damper/loops.svg").is_file()
