"""The report of an identification: whole, true to the document, in one file; its pictures hold what they say."""

from __future__ import annotations

import base64
import math
import re
from dataclasses import replace
from functools import cache
from html import unescape

import numpy as np
import pytest

from dampbalance import Oscillator, identify, measured_ring_down, read_records
from dampbalance.findings.words import unit_of
from dampbalance.identification.document import table as rows_of_table
from dampbalance.identification.forced import friction_loops
from dampbalance.identification.level import Level, damping_ratio
from dampbalance.identification.pictures import draw
from dampbalance.identification.screen import interval_of, value_of
from folders import ROOT
from identification.levels import clipped
from paper_case import PAPER

FILES = sorted((ROOT / "config/records/example").glob("level*.csv"))
DECAYING = Oscillator(m=2.0, c=1.5, k=2310.0, K_z=208000.0, F_k=0.5)
OMEGA, X = 2.0 * math.pi * 4.0, 0.003


@pytest.fixture(scope="module")
def steady():
    return identify(FILES[::2], PAPER.k)


@pytest.fixture(scope="module")
def decay():
    """Less than two seconds of motion, and five of rest."""
    free = measured_ring_down(DECAYING, x=0.006, rate_hz=1000.0, duration=7.0, noise=0.005)
    return identify(free, DECAYING.k)


@pytest.fixture(scope="module")
def doubtful():
    whole = read_records(FILES[::2])
    return identify([*whole[:2], clipped(whole[2], "acceleration", 0.9)], PAPER.k)


KINDS = pytest.mark.parametrize("kind", ["steady", "decay", "doubtful"])


@pytest.fixture
def found(request, kind):
    return request.getfixturevalue(kind)


@pytest.fixture(scope="module")
def report(request):
    """Makes the report of a kind, once: report(kind) -> its HTML."""
    return cache(lambda kind: request.getfixturevalue(kind).report())


def words(html):
    """Text of a page, a blank between cells."""
    return " ".join(unescape(re.sub(r"<[^>]*>", "", re.sub("</t[hd]>", " ", html))).split())


@KINDS
def test_a_report_is_one_file_with_every_number(found, kind, report):
    html = report(kind)
    assert set(re.findall(r'(?:src|href)="([^:"]+:[^;"]*)', html)) == {"data:image/svg+xml"}
    assert not re.search(r"<script|<link|@import|url\(", html)
    pictures = re.findall(r'<img alt="(.+?)" src="data:image/svg\+xml;base64,(.+?)"', html)
    assert len(pictures) == len(found.figures) + 1
    assert pictures[-1][0].startswith("the rig: ")
    for _, data in pictures:
        assert b"prefers-color-scheme: dark" in base64.b64decode(data)
    said = words(html)
    for symbol, p in found.answer.parameters.items():
        value = value_of(p) if math.isnan(p.value) else f"{value_of(p)} {unit_of(symbol)}"
        name, verdict = symbol.replace("_", ""), found.verdicts[symbol].verdict
        row = rf"{name} {re.escape(f'{value} {interval_of(p)}')} (± \S+ %|–) . {verdict} "
        assert re.search(row, said)
    for level in found.document()["damping"]["levels"]:
        assert f"{1e3 * level['X_m']:#.{3 if found.basis.columns else 4}g}" in said
    for record in found.document()["records"]:
        assert (record.get("sha256") or "not from a file") in said


def test_the_first_sentence_says_what_can_be_used(report):
    (kind, sentence), (other, why) = (
        re.search(r'<p class="lead (\w+)">(.+?)</p>', report(one)).groups()
        for one in ("steady", "doubtful")
    )
    assert (kind, other) == ("usable", "doubtful")
    assert re.search(r"F.*k.* = 1\.28.* N.*c = 90\..* usable within ", words(sentence))
    assert words(why).startswith("No answer: acceleration is clipped")


def test_where_there_is_no_answer_the_cause_comes_first_and_the_numbers_last(
    steady, doubtful, report
):
    cause = "acceleration is clipped"
    said, page = doubtful.text(), words(report("doubtful"))
    assert said.startswith(f"No answer: {cause}")
    assert said.index("Causes and remedies:") < said.index("raise the measuring range")
    assert said.index("raise the measuring range") < said.index("F_k (N)")
    assert "No answer: " in page
    assert page.index("Causes and remedies") < page.index("95 % interval")
    assert cause in doubtful.document()["no_answer"]
    assert [cause in row["no_answer"] for row in rows_of_table(doubtful)[:1]] == [True]
    # numbers that can be used come before what limits them
    page = words(report("steady"))
    assert steady.text().startswith(steady.head)
    assert page.index("95 % interval") < page.index("What to check and do next")
    assert (steady.no_answer, steady.document()["no_answer"]) == ("", None)


def test_a_name_is_no_markup_in_a_report():
    frames = [record.to_frame() for record in read_records(FILES[::4])]
    frames[0].attrs["name"] = "<script>& at 2 m/s"
    html = identify(frames, PAPER.k).report()
    assert "<script>" not in html
    assert "<h1>Friction and damping from &lt;script&gt;&amp; at 2 m/s" in html


# --- pictures -------------------------------------------------------------------------------------


def by_label(axes):
    return {line.get_label(): line for line in axes.get_lines()}


@pytest.mark.parametrize("fitted", [True, False])
def test_the_friction_loop_takes_what_friction_takes(steady, fitted):
    """∮ f dx = a F_k; without a fit the mass is that of a contact that does not yield."""
    result = steady
    if not fitted:
        result = replace(
            result,
            basis=replace(result.basis, common=replace(result.basis.common, selection=None)),
            reference=None,
        )
    for loop in friction_loops(result, PAPER.m).values():
        v = loop["v_m_per_s"]
        off = loop["f_N"] / PAPER.F_k - np.sign(v)
        # away from the stops, about which harmonics ring; noise and fit leave less than a hundredth
        assert off[v.abs() > 0.3 * v.abs().max()].abs().max() < 0.02
    for axes, a in zip(
        draw(result.pictures["friction"], result.coordinate).axes,
        result.basis.features.a,
        strict=True,
    ):
        lines = by_label(axes)
        x, f = lines["from the record"].get_data()
        area = abs(np.trapezoid(f, 1e-3 * x))
        assert area == pytest.approx(a * PAPER.F_k, rel=0.01)
        assert ("fitted oscillator" in lines) == fitted
        if fitted:
            assert max(lines["fitted oscillator"].get_ydata()) == pytest.approx(PAPER.F_k, rel=0.01)
            (x_s, other), (up, down) = lines["onset of slip"].get_data()
            assert x_s == -other == pytest.approx(min(x), rel=0.01)
            assert up == -down == pytest.approx(PAPER.F_k, rel=0.01)


@pytest.mark.parametrize(("kind", "largest"), [("steady", 1.1), ("doubtful", 20.0)])
def test_the_residual_of_a_cycle_is_noise_unless_the_fit_fails(found, kind, largest):
    below = found.plot("cycles")[1::2]
    spread = [np.sqrt(np.mean(axes.get_lines()[0].get_ydata() ** 2)) for axes in below]
    assert spread[:2] == pytest.approx([1.0, 1.0], abs=0.15)
    assert spread[2] < largest
    assert (spread[2] > 2.0) == (kind == "doubtful")


def test_a_decay_fills_the_picture_as_long_as_it_moves(decay):
    panel = decay.plot("decays")[0]
    assert panel.get_position().width > 0.85
    (start, end), fit = panel.get_xlim(), decay.basis.fit
    moves = fit.sticks_from(0)
    assert moves < end - start <= moves + 1.6 * fit.decays[0].period


# --- equivalent damping ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("W", "c"),
    [
        (math.pi * 90.0 * OMEGA * X**2, 90.0),  # viscous
        (4.0 * 1.28 * X, 4.0 * 1.28 / (math.pi * OMEGA * X)),  # dry friction: Jacobsen (1930)
        (math.pi * 0.02 * PAPER.k * X**2, 0.02 * PAPER.k / OMEGA),  # structural, η = 0.02
    ],
)
def test_equivalent_damping_has_closed_forms(W, c):
    level = Level("one", X, OMEGA, W, 0.0)
    assert level.equivalent_damping == pytest.approx(c, rel=1e-12)
    assert level.loss_factor(PAPER.k) == pytest.approx(c * OMEGA / PAPER.k, rel=1e-12)


def test_at_the_natural_frequency_the_loss_factor_is_twice_the_damping_ratio():
    omega = math.sqrt(PAPER.k / PAPER.m)
    W = math.pi * PAPER.c * omega * X**2
    level = Level("one", X, omega, W, 0.0).document(PAPER.k, PAPER.m)
    zeta = damping_ratio(PAPER.c, PAPER.k, PAPER.m)
    assert level["equivalent_damping_ratio"] == pytest.approx(zeta, rel=1e-12)
    assert level["loss_factor"] == pytest.approx(2.0 * zeta, rel=1e-12)
    assert level["Q"] == pytest.approx(1.0 / (2.0 * zeta), rel=1e-12)


def test_the_levels_of_records_lose_what_friction_and_damper_take(steady, decay):
    for found, osc in ((steady, PAPER), (decay, DECAYING)):
        zeta = damping_ratio(osc.c, osc.k, osc.m)
        assert found.document()["damping"]["damping_ratio"] == pytest.approx(zeta, rel=0.05)
        assert found.levels
    for level in steady.levels[:-1]:
        viscous = math.pi * PAPER.c * level.omega * level.X**2  # of the fundamental
        assert pytest.approx(level.friction + viscous, rel=0.05) == level.W
    for level in decay.levels:  # from the swings alone
        friction = 2.0 * DECAYING.F_k / (math.pi * DECAYING.k * level.X)
        assert abs(level.ratio - zeta - friction) < 4.0 * level.ratio_error + 0.1 * friction
