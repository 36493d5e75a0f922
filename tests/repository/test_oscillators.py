"""The map of many oscillators: another count of others, and what the article prints of it."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

import oscillators
from dampbalance import study
from legible import faults
from oscillators import RANGES, counted, main

PRINTED = json.loads((oscillators.SUPPLEMENT / "oscillators.json").read_text(encoding="utf-8"))
BANDS = ("all", "resonance", "above")


def same_shares(one: float, n: int, other: float, m: int) -> bool:
    """Whether two shares, %, of n and m random oscillators agree within five of their standard errors, once in two
    million comparisons not."""
    p = (n * one + m * other) / (n + m) / 100.0
    return abs(one - other) / 100.0 <= 5.0 * math.sqrt(p * (1.0 - p) * (1.0 / n + 1.0 / m)) + 1e-12


def test_the_printed_numbers_are_those_of_other_oscillators():
    count = 40_000
    numbers, shares = counted(count, seed=1)
    assert PRINTED["ranges"] == numbers["ranges"]
    # what each band holds of evenly spread logarithms of ω/ω_n
    parts = {"all": 1.0, "resonance": math.log(1.05 / 0.95), "above": math.log(3.0 / 1.5)}
    for band in BANDS:
        part = parts[band] / (1.0 if band == "all" else math.log(6.0))
        # sizes of bands scatter by 1/√2,000 at most, which moves the bound by 2 %
        of = {name: (share, int(0.9 * part * count)) for name, share in numbers[band].items()}
        assert of.keys() == PRINTED[band].keys()
        wrong = [
            name
            for name, (share, n) in of.items()
            if not same_shares(share, n, PRINTED[band][name], int(part * PRINTED["count"]))
        ]
        assert wrong == []
    for (symbol, name, phase), share in shares.items():
        key = ".".join(filter(None, (symbol, name, phase)))
        assert np.nanmin(share) >= 0.0
        assert np.nanmax(share) <= 1.0
        # bins of equal size in the logarithms: the mean of their shares is that of all
        assert 100.0 * np.nanmean(share) == pytest.approx(numbers["all"][key], abs=1.5)


def test_a_study_counts_alike(monkeypatch):
    """A study of its own sample at levels Y and 2Y: other oscillators, cases and columns."""
    count = 20_000
    monkeypatch.setitem(RANGES, "level_ratio", oscillators.Range(2.0, 2.0, "log"))
    here, _ = counted(count, seed=3)
    over = {
        name: {"from": of.low, "to": of.high, "spacing": "log"}
        for name, of in RANGES.items()
        if name != "level_ratio"
    }
    sample = {"method": "random", "count": count, "seed": 7, "over": over}
    estimation = {"phases": list(oscillators.PHASES)}
    table = study([{"sample": sample}], levels_of_Y=[1.0, 2.0], estimation=estimation).to_frame()
    compared = 0
    for key, share in here["all"].items():
        symbol, name, *phase = key.split(".")
        start = "__".join((f"{symbol}_relative_error", name, *phase))
        (errors,) = (of for column, of in table.items() if str(column).startswith(start))
        there = 100.0 * float((errors.abs() <= 0.01).mean())
        assert same_shares(share, count, there, count), key
        compared += 1
    assert compared == 16


def test_what_the_article_says_of_the_map():
    """Its words, which do not follow the numbers by themselves."""
    everywhere = ("F_k.direct", "c.direct", "F_k.fourier", "c.fourier")
    assert all(PRINTED["all"][key] == pytest.approx(100.0, abs=0.01) for key in everywhere)
    for name in ("X_s", "t_s", "V_s"):
        key = f"F_k.{name}.reversal"
        width = math.log(1.05 / 0.95) / math.log(6.0)  # of the band around resonance
        assert PRINTED["resonance"][key] * width > 0.5 * PRINTED["all"][key]  # most of them
        assert PRINTED["all"][key] == pytest.approx(PRINTED["all"]["F_k.X_s.reversal"], rel=0.02)
        assert (
            PRINTED["above"][f"F_k.{name}.fundamental"] > PRINTED["all"][f"F_k.{name}.fundamental"]
        )


def test_it_writes_numbers_and_figure(tmp_path):
    main(["--count", "3000", "--output", str(tmp_path)])
    assert json.loads((tmp_path / "oscillators.json").read_text())["count"] == 3000
    assert "<svg" in (tmp_path / "oscillators.svg").read_text(encoding="utf-8")


def test_the_figure_is_legible():
    assert faults(oscillators.figure(*counted(3000))) == []
