"""A record whose channels stand in several files, from these to the estimates."""

from __future__ import annotations

import hashlib
import json
import math

import pandas as pd

from dampbalance import BaseMotion, identify, steady_orbit
from dampbalance.records.synthetic import measured_orbit
from paper_case import PAPER


def _written(folder, level, Y):
    """A level in one file, and the same in one for each channel."""
    orbit = steady_orbit(PAPER, BaseMotion(Y=Y, omega=2.0 * math.pi * 3.5))
    made = measured_orbit(orbit, rate_hz=1000.0, cycles=20.0, noise=1e-3, seed=level)
    base, response = (
        pd.DataFrame({"time_s": made[q].t, f"{q}_m": made[q].values})
        for q in ("base_displacement", "displacement")
    )
    whole = folder / f"level{level}.csv"
    base.assign(displacement_m=response["displacement_m"]).to_csv(whole, index=False)
    base.to_csv(folder / f"base{level}.csv", index=False)
    response.to_csv(folder / f"mass{level}.csv", index=False)
    (folder / f"base{level}.yaml").write_text(
        f"channels:\n  base_displacement: {{channel: 2, unit: m}}\n"
        f"  displacement: {{file: mass{level}.csv, channel: 2, unit: m}}\nlevel: level{level}.csv\n",
        encoding="utf-8",
    )
    return whole, folder / f"base{level}.csv"


def test_a_file_for_each_channel_gives_the_same_and_all_are_told(tmp_path):
    whole, several = zip(
        *(_written(tmp_path, i, Y) for i, Y in enumerate((0.003, 0.005))), strict=True
    )
    options = {"approaches": ["fourier"], "replicates": 10}
    one, other = (
        json.loads(json.dumps(identify(files, PAPER.k, **options).document()))
        for files in (whole, several)
    )
    assert other["approaches"] == one["approaches"]
    for i, record in enumerate(other["records"]):
        part = tmp_path / f"mass{i}.csv"
        digest = hashlib.sha256(part.read_bytes()).hexdigest()
        assert record["others"] == [{"file": str(part), "sha256": digest}]
        assert "others" not in one["records"][i]
