"""Studies of laws: what oscillators are drawn, which law is chosen for their records, and what is counted and shown."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from analytic.integrals import input_work, of_motion
from analytic.law_response import law_orbit
from dampbalance.studies import evaluate, responses
from dampbalance.studies.settings import law_named, terms_named
from dampbalance.studies.shown import facts, summary
from dampbalance.studies.shown.study_figure import alternative_text, study_figure
from unit.studies.documents import document

LEVELS = (0.25, 0.5, 1.0)
SIX = ("F_k + c", "F_k + c_r", "F_k + c_2", "F_k + c_3", "F_k + eta", "F_k + c + c_2")
SMALL = document("laws")


def test_a_law_is_named_by_its_terms():
    assert law_named(("c_2", "F_k", "c")) == law_named(("c", "c_2")) == "F_k + c + c_2"
    assert terms_named("F_k + c + c_2") == ("F_k", "c", "c_2")
    with pytest.raises(ValueError, match="should be written 'F_k \\+ c \\+ c_2'"):
        terms_named("F_k + c_2 + c")
    with pytest.raises(ValueError, match="unknown term 'c_9'"):
        terms_named("F_k + c_9")


@pytest.mark.parametrize("law", SIX)
def test_what_is_drawn_has_every_term_of_its_law_matter(law):
    # the shares once more, from the motion that the integrator finds; what the harmonics cut off is below 1e-4
    truth = responses.drawn_oscillator(law, LEVELS, np.random.default_rng(3))
    assert law_named(truth.coefficients) == law
    taken = {symbol: [] for symbol in truth.coefficients}
    for motion in truth.motions:
        orbit = law_orbit(truth.oscillator, motion, truth.law)
        assert np.count_nonzero(orbit.phases[:, 1]) == 1  # one onset of slip
        for symbol, p in truth.coefficients.items():
            taken[symbol].append(p * of_motion(symbol, orbit) / input_work(orbit))
    shares = truth.shares()
    taken["F_k"] = 1.0 - np.sum(list(taken.values()), axis=0)
    for symbol, part in taken.items():
        np.testing.assert_allclose(shares[symbol], part, atol=1e-4)
        assert any(0.2 <= share <= 0.6 for share in part)
    ratios = sorted({motion.omega / truth.oscillator.omega_n for motion in truth.motions})
    assert len(ratios) == 2
    assert 0.6 <= ratios[0] <= 0.9
    assert 1.1 <= ratios[1] <= 1.6
    amplitudes = sorted(motion.Y for motion in truth.motions)
    assert amplitudes[-1] / amplitudes[0] == pytest.approx(4.0)
    assert len(amplitudes) == 6


def test_a_law_whose_oscillators_never_slip_as_wanted_is_named(monkeypatch):
    monkeypatch.setattr(responses.Truth, "shares", lambda _: {})
    with pytest.raises(ArithmeticError, match="no oscillator with the law F_k \\+ c slips once"):
        responses.drawn_oscillator("F_k + c", LEVELS, np.random.default_rng(1))


def test_the_law_of_clear_records_is_found_whatever_the_chunk(computed):
    study, table, _ = computed(SMALL | {"axes": [SMALL["axes"][0], {"run": {"values": [2]}}]})
    assert list(table.columns) == ["case", "law", "run", "regime", "chosen"]
    assert list(table["chosen"]) == list(table["law"])
    assert set(table["regime"]) == {"one_slip"}
    alone = evaluate.evaluate(study, 1, 2)
    assert alone.iloc[0].to_dict() == table.iloc[1].to_dict()


def test_records_that_cannot_be_read_have_no_law(monkeypatch):
    def too_short(*_):
        raise ValueError("too few cycles")

    monkeypatch.setattr(responses, "read_features", too_short)
    assert responses.chosen_law("F_k + c", (1.0,), 12, 0.01, np.random.default_rng(1)) == "none"


def test_noise_and_oscillator_follow_from_seed_law_and_run(make, monkeypatch):
    seen = []
    monkeypatch.setattr(
        responses, "chosen_law", lambda *given: seen.append(given[-1].random()) or "none"
    )
    study, other = (make(SMALL | {"route": SMALL["route"] | {"seed": seed}}) for seed in (1, 2))
    evaluate.evaluate(study, 0, 4)
    evaluate.evaluate(study, 1, 4)
    assert seen[1:4] == seen[4:]
    evaluate.evaluate(other, 0, 4)
    assert len({*seen}) == 8


@pytest.fixture
def counted(computed):
    """A study whose choices are set by hand: of F_k + c 17 right, 2 with a term too many, 1 none; of F_k + c_r 18
    right, 2 others, which have no term too many."""
    laws, runs = ["F_k + c", "F_k + c_r"], [*range(1, 21)]
    axes = [{"law": {"values": laws}}, {"run": {"values": runs}}]
    table = pd.DataFrame({"case": np.arange(40), "law": np.repeat(laws, 20), "run": runs * 2})
    chosen = ["F_k + c"] * 17 + ["F_k + c + c_2"] * 2 + ["none"]
    chosen += ["F_k + c_r"] * 18 + ["F_k + c", "F_k + c_2 + eta"]
    study, _, path = computed(
        SMALL | {"axes": axes}, table.assign(regime="one_slip", chosen=chosen)
    )
    return study, path


def test_the_summary_counts_what_was_chosen(counted):
    study, path = counted
    table = summary.summary_of(path, study).set_index("law")
    counts = table.drop(columns=["cases", *(name for name in table if "percent" in name)])
    assert counts.loc["F_k + c"].to_dict() == {
        "F_k + c": 17, "F_k + c_r": 0, "F_k + c + c_2": 2, "F_k + c_2 + eta": 0, "none": 1
    }  # fmt: skip
    assert counts.loc["F_k + c_r"].tolist() == [1, 18, 0, 1, 0]
    assert table.loc["F_k + c", "right_percent"] == pytest.approx(85.0)
    assert table.loc["F_k + c", "extra_percent"] == pytest.approx(10.0)
    assert table.loc["F_k + c_r", "extra_percent"] == 0.0
    # Wilson's interval of 17 in 20
    assert table.loc["F_k + c", "right_low_percent"] == pytest.approx(63.96, abs=0.005)
    assert table.loc["F_k + c", "right_high_percent"] == pytest.approx(94.76, abs=0.005)
    text = facts.paragraph(study, path)
    page = summary.summary_markdown(study, table.reset_index(), text, "figure.png")
    assert "40: 87.5 %" in page
    shares = "85.0 % (64.0 % to 94.8 %) | 10.0 % (2.79 % to 30.1 %)"
    assert f"| F_k + c | 17 |  | 2 |  | 1 | {shares} |" in page


def test_facts_are_shares_of_all_laws_or_of_one(counted):
    study, path = counted

    expected = {"right": "87.5 %", "extra": "5.00 %", "extra_low": "1.38 %", "extra_high": "16.5 %"}
    of_law = {("right", "F_k + c_r"): "90.0 %", ("none", "F_k + c"): "5.00 %"}
    for take, words in expected.items():
        assert facts.fact(study, path, {"of": "law", "take": take}) == words
    for (take, law), words in of_law.items():
        assert facts.fact(study, path, {"of": "law", "take": take, "at": {"law": law}}) == words


def test_the_figure_shows_each_number_and_names_each_law(counted):
    study, path = counted
    figure = study_figure(study, path)
    (axes,) = figure.axes
    texts = [text.get_text() for text in axes.texts]
    assert texts[:10] == ["17", "0", "2", "0", "1", "1", "18", "0", "1", "0"]
    named = [label.get_text() for label in axes.get_xticklabels()]
    assert named == ["$F_k+c$", "$F_k+c_r$", "$F_k+c+c_2$", r"$F_k+c_2+\eta$", "none"]
    assert len(axes.patches) == 2  # the right ones
    assert "true law" in alternative_text(study)
    assert set(summary.laws_in(summary.confusion(path))) >= {"none", "F_k + c"}
