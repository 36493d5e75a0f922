"""The map of many oscillators agrees with other oscillators and with a study, and with what the article says of it."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

import oscillators
from dampbalance import study
from dampbalance.studies.study_file import Sampled
from legible import faults
from oscillators import RANGES, counted, errors_of, main

PRINTED = json.loads((oscillators.SUPPLEMENT / "oscillators.json").read_text(encoding="utf-8"))
BANDS = ("all", "resonance", "above")


def same_shares(one: float, n: int, other: float, m: int) -> bool:
    """Whether two shares, %, of n and m random oscillators agree within five of their standard errors, once in two
    million comparisons not."""
    p = (n * one + m * other) / (n + m) / 100.0
    return abs(one - other) / 100.0 <= 5.0 * math.sqrt(p * (1.0 - p) * (1.0 / n + 1.0 / m)) + 1e-12


def test_the_printed_numbers_are_those_of_other_oscillators():
    count = 200_000
    numbers, shares = counted(count, seed=1)
    assert PRINTED["ranges"] == numbers["ranges"]
    for key in ("F_k.fourier", "c.fourier"):
        # fifty times as many reach further into the corners: two samples of this size had about half of it or more
        assert 0.3 < numbers["largest"][key] / PRINTED["largest"][key] <= 1.0
    # what each band holds of evenly spread logarithms of ω/ω_n
    parts = {"all": 1.0, "resonance": math.log(1.05 / 0.95), "above": math.log(3.0 / 1.5)}
    for band in BANDS:
        part = parts[band] / (1.0 if band == "all" else math.log(6.0))
        # sizes of bands scatter by 1/√10,000 at most, within the tenth that is taken off
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
        # bins of equal size in the logarithms: the mean of their shares is that of all, whose standard error is 0.1 %
        assert 100.0 * np.nanmean(share) == pytest.approx(numbers["all"][key], abs=0.5)


def test_a_study_of_the_same_oscillators_finds_the_same_errors(monkeypatch):
    """`study` starts from the paper's mass, stiffness and amplitude, and takes the levels as multiples."""
    count = 500
    monkeypatch.setitem(RANGES, "level_ratio", oscillators.Range(2.0, 2.0, "log"))
    of, errors = errors_of(Sampled(RANGES, "random", count, 3), np.arange(count))
    axes = {name: {"values": of[name].tolist()} for name in RANGES if name != "level_ratio"}
    estimation = {"phases": list(oscillators.PHASES)}
    table = study([axes], levels_of_Y=[1.0, 2.0], estimation=estimation).to_frame()
    assert len(errors) == 16
    for (symbol, name, phase), here in errors.items():
        start = "__".join(filter(None, (f"{symbol}_relative_error", name, phase)))
        (column,) = (column for column in table if str(column).startswith(f"{start}__"))
        # other units round otherwise; an error, relative to the truth, keeps nine digits
        assert here == pytest.approx(table[column].abs().to_numpy(), abs=1e-9), start


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
