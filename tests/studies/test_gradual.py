"""Studies whose contact yields gradually: the records are those of several sliders, the fit that of one."""

from __future__ import annotations

import numpy as np
import pytest

from dampbalance.motion.sliders import spread_contact
from dampbalance.studies.shown import summary
from dampbalance.studies.shown.statistics import bounds_of
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


def test_the_elements_share_stiffness_and_friction():
    r, kappa = spread_contact(PAPER, 30.0)
    assert np.sum(kappa) == pytest.approx(PAPER.K_z, rel=1e-14)
    assert kappa @ r == pytest.approx(PAPER.F_k, rel=1e-14)
    assert r[-1] / r[0] == pytest.approx(30.0, rel=1e-14)
    np.testing.assert_allclose(np.diff(np.log(r)), np.log(30.0) / 31.0, rtol=1e-10)
    np.testing.assert_allclose(spread_contact(PAPER, 1.0)[0], PAPER.Z_m, rtol=1e-14)


def test_one_slider_is_as_stiff_as_takes_the_same_energy(computed):
    """Its loss 4F_k(X − F_k/K_z) is Σ 4κ_j r_j (X − r_j) for F_k = Σ κ_j r_j and K_z = F_k²/Σ κ_j r_j²."""
    study, table, path = computed(SMALL)
    axes = [{"K_z_over_k": {"values": [10.0]}}]
    _, plain, _ = computed(SMALL | {"axes": axes, "base": {}, "figure": None})
    for symbol in ("F_k", "c", "K_z"):
        column = f"{symbol}_relative_error__{FIT}"
        # the records of r_max = r_min differ from those of one slider by rounding: 1e-9 is what a fit makes of that
        assert table[column][0] == pytest.approx(plain[column][0], abs=1e-7)
    r = np.geomspace(1.0, 10.0, 32)
    # of the loss alone; the waveforms have their say, which makes 0.07 at most of K_z/k = 2 to 90 (the study)
    expected = r.mean() ** 2 / np.mean(r**2) - 1.0
    assert table[f"K_z_relative_error__{FIT}"][1] == pytest.approx(expected, abs=0.07)
    assert abs(table[f"F_k_relative_error__{FIT}"][1]) < 0.01
    rows = summary.summary_of(path, study)
    assert rows.groupby("quantity")["approach"].apply(set)["K_z"] == {"fit"}


@pytest.mark.parametrize("ranges", [[1, 10], [10]])
def test_a_contact_that_yields_gradually_has_no_bound_of_one_slider(make, ranges):
    axes = [{"slip_range": {"values": ranges}}, {"run": {"values": [1, 2]}}]
    of_one = SMALL | {"axes": axes[1:], "route": {**SMALL["route"], "slip_range": 10.0}}
    study = make((SMALL | {"axes": axes} if len(ranges) > 1 else of_one) | {"figure": None})
    *one, gradual = (bounds_of(study, np.array([2 * i, 2 * i + 1])) for i in range(len(ranges)))
    assert np.isnan([*gradual.values()]).all()
    assert all(0.0 < of["F_k"] < 1.0 for of in one)
