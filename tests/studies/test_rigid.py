"""A model of a rigid contact is the limit X_s → −X of every approach: what it costs follows in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from dampbalance.balance import APPROACHES
from dampbalance.project.wording import percent
from dampbalance.studies.shown import statistics, summary
from paper_case import FREQUENCIES_HZ, LEVELS, PAPER, features_at, orbits_at
from studies.documents import document

HERTZ = list(FREQUENCIES_HZ.values())
STUDY = document("rigid")


@pytest.fixture(scope="module")
def table(computed):
    return computed("rigid")[1]


def exact_rows(hertz):
    """a, b of the levels, from the orbits one by one."""
    orbits = orbits_at(hertz, LEVELS)
    return tuple(np.array([getattr(orbit, q) for orbit in orbits]) for q in ("a", "b"))


def test_every_approach_has_the_same_limit():
    features = features_at(levels=LEVELS)
    rigid = features.rigid()
    for name in ("direct", "X_s", "t_s", "V_s", "fourier"):
        compliant, limit = (APPROACHES[name](seen, PAPER.k) for seen in (features, rigid))
        np.testing.assert_allclose(limit.terms["F_k"], 4.0 * features.X, rtol=1e-15)
        # what does not depend on the onset of slip stays as it is
        assert np.array_equal(limit.terms["c"], compliant.terms["c"])
        assert np.array_equal(limit.W, compliant.W)
    # the spring swings from −Z_m to Z_m at either end of the stroke
    np.testing.assert_allclose(rigid.a - features.a, 4.0 * PAPER.Z_m, rtol=1e-9)


def test_the_model_does_not_know_that_nothing_slips():
    """Below the slip limit the true a is 0, and yet the rigid model takes a = 4X as for any other response."""
    stuck = features_at(levels=(1e-5,))
    assert stuck.a.tolist() == [0.0]
    assert np.isnan(stuck.X_s).all()
    rigid = stuck.rigid()
    assert rigid.a == pytest.approx(4.0 * stuck.X)
    assert not rigid.a.flags.writeable
    assert rigid.regime.tolist() == stuck.regime.tolist()


@pytest.mark.parametrize("number", range(3))
@pytest.mark.parametrize("pair", [(1, 2), (2, 5)])
def test_two_levels_in_closed_form(table, number, pair):
    a, b = exact_rows(HERTZ[number])
    (a_1, a_2), (b_1, b_2) = a[[pair[0] - 1, pair[1] - 1]], b[[pair[0] - 1, pair[1] - 1]]
    delta = a_1 * b_2 - a_2 * b_1
    primed = delta + 4.0 * PAPER.Z_m * (b_2 - b_1)
    c_shift = 4.0 * PAPER.Z_m * PAPER.F_k * (a_2 - a_1) / primed
    label = f"direct__rigid__pair_{pair[0]}_{pair[1]}"
    # rounding, 1e-15 of the rows, grows by the condition of the pair, some 1e3
    found_F, found_c = (table[f"{q}_relative_error__{label}"][number] for q in ("F_k", "c"))
    assert found_F == pytest.approx(delta / primed - 1.0, abs=1e-10)
    assert found_c == pytest.approx(c_shift / PAPER.c, abs=1e-10)
    assert found_F < 0.0 < found_c


@pytest.mark.parametrize("number", range(3))
def test_least_squares_in_closed_form(table, number):
    """W = A′p − 4Z_m F_k with A′ of the rigid model: p′ = p − 4Z_m F_k (A′ᵀA′)⁻¹A′ᵀ1."""
    a, b = exact_rows(HERTZ[number])
    # columns of one size: the solution by normal equations then keeps nine digits
    rows = np.column_stack([(a + 4.0 * PAPER.Z_m) / a[0], b / b[0]])
    shift = np.linalg.solve(rows.T @ rows, rows.T @ np.full(5, -4.0 * PAPER.Z_m * PAPER.F_k))
    shift /= np.array([a[0] * PAPER.F_k, b[0] * PAPER.c])
    for q, expected in zip(("F_k", "c"), shift, strict=True):
        found = table[f"{q}_relative_error__direct__rigid__least_squares"][number]
        assert found == pytest.approx(expected, abs=1e-9)


def test_the_harmonic_approaches_become_one(table):
    """With a rigid contact t_s, V_s and X_s see the same onset, and their estimates are the same."""
    for q in ("F_k", "c"):
        labels = [f"{q}_relative_error__{name}__rigid__reversal__individual__least_squares"
                  for name in ("X_s", "t_s", "V_s")]  # fmt: skip
        first, *others = (table[label].to_numpy() for label in labels)
        for other in others:
            np.testing.assert_allclose(other, first, rtol=1e-9)
        compliant = table[f"{q}_relative_error__X_s__reversal__individual__least_squares"]
        assert (np.abs(compliant - first) > 1e-6).all()


def test_records_without_noise_give_the_same(computed, table):
    """The route of noisy records, at no noise: the rigid model of what is read is that of the exact features."""
    changed = STUDY | {
        "route": {"kind": "measured", "sampling_hz": 2000, "cycles": 12, "seed": 1, "noise": 0.0},
        "columns": ["errors", "intervals"],
        "estimation": STUDY["estimation"] | {"approaches": ["direct"], "weights": ["equal"]},
    }
    _, read, _ = computed(changed)
    for q in ("F_k", "c"):
        column = f"{q}_relative_error__direct__rigid__least_squares"
        equal = column.replace("rigid", "rigid__equal")
        # what is left is the fit of the waveform beyond the harmonics read: test_mean_harmonics.py
        np.testing.assert_allclose(read[equal], table[column], atol=1e-4)
        assert np.isfinite(read[f"{q}_covered__direct__rigid__equal__least_squares"]).all()


def test_paragraph_and_table_say_which_contact(computed, says):
    K_z = {"from": 1.0, "to": 1.0e4, "count": 41, "spacing": "log"}
    estimation = {"approaches": ["direct"], "contact": ["compliant", "rigid"]}
    study, frame, path = computed(STUDY | {"axes": [{"K_z_over_k": K_z}], "estimation": estimation})
    template = """{% set rigid = errors("F_k", contact="rigid") %}
        {{- errors("F_k").largest | percent }}; {{ rigid.largest | percent }};
        {{ rigid.between(K_z_over_k=[30.0, 1.0e4]).largest | percent }}"""
    without, with_it, stiff = says(study, path, template).split("; ")
    error = frame["F_k_relative_error__direct__rigid__least_squares"].abs()
    assert with_it == percent(error.max())
    assert stiff == percent(error[frame["K_z_over_k"] >= 30.0].max())
    assert "10⁻" in without  # rounding: direct integration with the compliant contact
    lines = summary.summary_of(path, study)
    assert lines["contact"].tolist() == ["compliant", "compliant", "rigid", "rigid"]
    assert "| F_k | direct, rigid |" in summary.summary_markdown(study, lines, "", "")


def test_interval_of_a_share():
    # z² = 3.8415: (p + z²/2n ± z √(p(1 − p)/n + z²/4n²)) / (1 + z²/n), by hand
    by_hand = {(95, 100): (0.88825, 0.97846), (10, 10): (0.72247, 1.0), (0, 50): (0.0, 0.07135)}
    by_hand[0, 0] = np.nan, np.nan
    for (count, runs), bounds in by_hand.items():
        found = statistics.share_interval(count, runs)
        assert found == pytest.approx(bounds, abs=1e-5, nan_ok=True)
