"""The records of the real rig: the numbers recorded with the digests of the files, wherever the files are."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest
import yaml

from dampbalance.identification.measured import configured, identify
from dampbalance.project.files import sha256
from dampbalance.publishing.rigs import frame_page
from dampbalance.replication.frame.findings import Findings, findings
from folders import ROOT

CONFIG = yaml.safe_load((ROOT / "config/frame.yaml").read_text(encoding="utf-8"))
(MEASURED,) = CONFIG["measured"]
RECORDED = yaml.safe_load((ROOT / "config/records/frame/results.yaml").read_text(encoding="utf-8"))
(PATTERN,) = MEASURED["records"]
FOLDER = (ROOT / PATTERN).parent
FILES = sorted(FOLDER.glob(Path(PATTERN).name))

RESIDUAL = {"intercept_N", "intercept_interval_N", "scatter", "off_line", "loop", "speed_laws"}
RESIDUAL |= {"drift", "clock", "clocks"}
"""Keys of differences of large numbers."""

there = pytest.mark.skipif(
    not FILES, reason=f"no records {PATTERN}: see config/records/frame/README.md"
)


def measured() -> dict:
    return MEASURED | {"mapping": str(ROOT / MEASURED["mapping"])}


@cache
def found() -> Findings:
    identified = identify(FILES, **configured(measured())).document()
    return findings(FILES, measured(), CONFIG["frame"], identified)


def numbers(document: object, at: tuple = ()) -> dict[tuple, object]:
    """Every entry of a document by its place."""
    if isinstance(document, dict):
        items = document.items()
    elif isinstance(document, list):
        items = enumerate(document)
    else:
        return {at: document}
    return {place: one for key, of in items for place, one in numbers(of, (*at, key)).items()}


@there
def test_the_files_are_those_that_were_recorded():
    assert {file.name: sha256(file) for file in sorted(FOLDER.glob("*.mat"))} == RECORDED["files"]


@there
@pytest.mark.slow
def test_the_numbers_are_those_that_were_recorded():
    computed, recorded = numbers(found().document), numbers(RECORDED)
    assert computed.keys() == recorded.keys()
    for place, value in recorded.items():
        if isinstance(value, float):
            # four digits are recorded, and shares are differences. No oscillator explains these records within their
            # noise, and several come nearly as near: K_z of the best three is 353, 406 and 523 kN/m. Should rounding
            # lead a processor to another of them, F_k moves by up to a standard error, 3e-3, and what is left of a
            # line or a loop by 5e-2.
            least = 1e-9 if str(place[-1]).endswith("_m") or "given_way_m" in place else 1e-5
            rel = 8e-2 if RESIDUAL & {*place} else 5e-3
            assert computed[place] == pytest.approx(value, rel=rel, abs=least), place
        else:
            assert computed[place] == value, place


@there
@pytest.mark.slow
def test_the_cycles_foretold_follow_those_identified_from():
    for one in found().predictions:
        assert one.t.size == pytest.approx(5 * 250, abs=3)
        for x in (one.measured, one.repeated, *one.predicted.values()):
            assert x.shape == one.t.shape
        for x in one.predicted.values():
            assert x[0] == one.measured[0]


def test_the_recorded_numbers_agree_with_each_other():
    line, loads = RECORDED["line"], RECORDED["loads"]
    assert max(abs(row["off_line"]) for row in loads) < 0.01
    assert line["slope_N_per_kg"] / line["coefficient"] == pytest.approx(9.80665, rel=1e-3)
    for row in loads:
        low, high = row["interval_N"]
        assert low < row["F_k_N"] < high
        assert row["lost_to_damper"] < 0.01
        wide = row["robust_interval_N"]
        assert wide[0] < row["F_k_by_series_N"] <= row["F_k_N"] < wide[1]
        assert wide[0] < row["clocks"]["F_k_as_recorded_N"] < wide[1]
        assert row["drift"]["significant"] == (row["drift"]["p"] < 0.05 / len(loads))
        # no law predicts cycles better than cycles repeat
        for law in row["speed_laws"].values():
            assert law["rms"] > row["foretold"]["rms_of_mean_cycle"] > 0.0
        assert row["speed_laws"]["constant"]["rms"] == row["foretold"]["rms"]
    for name, rms in RECORDED["speed_laws"].items():
        squares = [row["speed_laws"][name]["rms"] ** 2 for row in loads]
        assert rms == pytest.approx((sum(squares) / len(squares)) ** 0.5, rel=1e-3)


def test_the_page_takes_its_numbers_from_the_findings():
    page = frame_page(RECORDED, MEASURED, ["the records say so"])
    for row in RECORDED["loads"]:
        assert f"| {row['record']} | {row['F_k_N']:.4g}" in page or f"{row['F_k_N']:.3f}" in page
        assert f"{100.0 * row['foretold']['rms']:.2f} %" in page
    changed = RECORDED | {"line": RECORDED["line"] | {"coefficient": 0.777}}
    assert "coefficient of friction of 0.777" in frame_page(changed, MEASURED, [])
    assert "- the records say so\n" in page
    for name, digest in RECORDED["files"].items():
        assert f"| {name} | `{digest}` |" in page
    assert "All four friction forces are doubtful by the identification's own verdict" in page
    assert (
        "The linear law predicts best over all loads, and at 250 g, 450 g and 550 g better" in page
    )
    usable = [row | {"verdict": "usable"} for row in RECORDED["loads"]]
    assert "doubtful" not in frame_page(RECORDED | {"loads": usable}, MEASURED, [])
    still = [row | {"drift": row["drift"] | {"significant": False}} for row in RECORDED["loads"]]
    assert "none of the four records has a" in frame_page(RECORDED | {"loads": still}, MEASURED, [])
    through = RECORDED["line"] | {"intercept_interval_N": [-0.1, 0.1]}
    assert "not proportional" in page
    assert "not proportional" not in frame_page(RECORDED | {"line": through}, MEASURED, [])
    alike = {name: RECORDED[name] | {"scatter": None} for name in ("line", "line_by_series")}
    said = frame_page(RECORDED | alike, MEASURED, [])
    assert "cycles\nof the records do not differ" in said
    assert "times as much as" not in said
