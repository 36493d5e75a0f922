"""Studies whose contact yields gradually: the records are those of several sliders, the fit that of one."""

from __future__ import annotations

import numpy as np
import pytest

from dampbalance.motion.sliders import spread_contact
from dampbalance.studies.shown import summary
from dampbalance.studies.shown.statistics import bounds_of
from dampbalance.studies.shown.study_figure import alternative_text
from paper_case import PAPER
from studies.documents import document

FIT = "fit__F_k+c+K_z__maximum_likelihood"
SMALL = {
    "axes": [{"slip_range": {"values": [1, 10]}}],
    "base": {"K_z_over_k": 10.0},
    "levels_m": [0.004, 0.008],
    "route": {**document("noisy")["route"], "noise": 0.001},
    "estimation": {"approaches": ["direct"], "yardsticks": ["K_z"]},
    "figure": {"kind": "curves", "x": "slip_range"},
}


@pytest.fixture(scope="module")
def gradual(computed):
    return computed(SMALL)


def test_the_elements_share_stiffness_and_friction():
    r, kappa = spread_contact(PAPER, 30.0)
    assert np.sum(kappa) == pytest.approx(PAPER.K_z, rel=1e-14)
    assert kappa @ r == pytest.approx(PAPER.F_k, rel=1e-14)
    assert r[-1] / r[0] == pytest.approx(30.0, rel=1e-14)
    np.testing.assert_allclose(np.diff(np.log(r)), np.log(30.0) / 31.0, rtol=1e-10)
    np.testing.assert_allclose(spread_contact(PAPER, 1.0)[0], PAPER.Z_m, rtol=1e-14)


def test_without_a_range_it_is_the_contact_of_one_slider(gradual, make):
    """The records of r_max = r_min are those of the study without the axis."""
    from dampbalance.studies.evaluate import evaluate

    _, table, _ = gradual
    plain = make(SMALL | {"axes": [{"K_z_over_k": {"values": [10.0]}}], "base": {}, "figure": None})
    expected = evaluate(plain, 0, 1).iloc[0]
    for symbol in ("F_k", "c", "K_z"):
        column = f"{symbol}_relative_error__{FIT}"
        # the records differ by rounding: 1e-9 is what a fit makes of that
        assert table[column][0] == pytest.approx(expected[column], abs=1e-7)


def test_one_slider_is_as_stiff_as_takes_the_same_energy(gradual):
    """Its loss 4F_k(X − F_k/K_z) is Σ 4κ_j r_j (X − r_j) for F_k = Σ κ_j r_j and K_z = F_k²/Σ κ_j r_j²."""
    _, table, _ = gradual
    r = np.geomspace(1.0, 10.0, 32)
    # of the loss alone; the waveforms have their say, which makes 0.07 at most of K_z/k = 2 to 90 (the study)
    expected = r.mean() ** 2 / np.mean(r**2) - 1.0
    assert table[f"K_z_relative_error__{FIT}"][1] == pytest.approx(expected, abs=0.07)
    assert abs(table[f"F_k_relative_error__{FIT}"][1]) < 0.01
    assert abs(table[f"K_z_relative_error__{FIT}"][0]) < 0.03


def test_the_contact_stiffness_is_tabled_and_named(gradual):
    study, _, path = gradual
    rows = summary.summary_of(path, study)
    assert set(rows["quantity"]) == {"F_k", "c", "K_z"}
    assert list(rows[rows["quantity"] == "K_z"]["approach"]) == ["fit"]
    page = summary.summary_markdown(study, rows, "", "")
    assert "| K_z | fit |" in page
    assert "F_k, c and K_z" in alternative_text(study)


def test_a_contact_that_yields_gradually_has_no_bound_of_one_slider(make):
    run = {"run": {"values": [1, 2]}}
    study = make(SMALL | {"axes": [*SMALL["axes"], run], "figure": None})
    one, gradual = (bounds_of(study, np.array(cases)) for cases in ([0, 1], [2, 3]))
    assert 0.0 < one["F_k"] < 1.0
    assert np.isnan([*gradual.values()]).all()
    # nor where the range is that of all cases
    route = {**SMALL["route"], "slip_range": 10.0}
    study = make(SMALL | {"axes": [run], "route": route, "figure": None})
    assert np.isnan([*bounds_of(study, np.array([0, 1])).values()]).all()


def test_other_routes_refuse_a_range(make):
    with pytest.raises(ValueError, match="slip_range: is not used by the route exact"):
        make({"axes": [{"slip_range": {"values": [1, 10]}}]})
    with pytest.raises(ValueError, match="From 1 to"):
        make(SMALL | {"axes": [{"slip_range": {"values": [0.5, 10]}}]})
