"""What each number is worth, and what limits it: findings and departures, decided once, said once."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from dampbalance import identify, measured_ring_down
from dampbalance.balance import Rows
from dampbalance.findings.finding import UNBOUNDED, Finding
from dampbalance.findings.sentences import SENTENCES, Sentence
from dampbalance.findings.words import sentence
from dampbalance.fit.select import Model, Selection
from dampbalance.identification.answer import (
    REFERENCE,
    UNKNOWN,
    Answer,
    Balance,
    Interval,
    Verdict,
    doubted,
)
from dampbalance.identification.answer import ParameterEstimate as Estimate
from dampbalance.identification.balance_check import compared, forbidden, notes_on
from dampbalance.identification.oscillator import CommonFit
from dampbalance.identification.result import Result
from dampbalance.identification.screen import Number, in_one, limiting
from dampbalance.identification.weighing import DEPARTURES, departure, said_of, weighed_of
from dampbalance.records.coordinate import ROTATION, TRANSLATION
from identification.levels import changed, measured
from paper_case import PAPER
from slips import slips
from toys import TOY, toy


def parameter(value, half):
    return Estimate(value, half / 2.0, Interval(value - half, value + half))


SOUND = Answer(
    "direct",
    {"F_k": parameter(1.28, 0.01), "c": parameter(90.0, 0.1), "K_z": parameter(208e3, 2e3)},
    covariance=np.full((3, 3), math.nan),
    balance=Balance(Rows({"F_k": np.ones(2)}, np.ones(2)), np.ones(2), ("a", "b")),
    merit={"misfit": 1.0},
)


def with_parameters(**changed):
    return replace(SOUND, parameters={**SOUND.parameters, **changed})


NOTED = toy("another oscillator")
FAR = Finding("far", effect=UNBOUNDED)
WIDE = parameter(1.28, 0.65)
BOTH = "usable within 0.78 %: F_k, c"
LIMIT = Estimate(math.inf, math.nan, Interval(41234.5, math.inf))
UNSOLVED = replace(SOUND, parameters=dict.fromkeys(SOUND.parameters, UNKNOWN), notes=(NOTED,))


@pytest.mark.parametrize(
    ("symbol", "interval", "known"),
    [
        ("K_z", (-16.5, math.inf), False),
        ("K_z", (16.5, math.inf), True),
        ("F_k", (-1.0, 24.0), False),  # of work that 1 N takes
        ("F_k", (-1.0, 3.0), True),
        ("F_k", (5.0, 24.0), True),
        ("c", (-1.0, 24.0), True),
    ],
)
def test_a_limit_that_physics_forbids_is_none(symbol, interval, known):
    limited = Estimate(max(interval[0], 1.0), 1.0, Interval(*interval))
    (found,) = doubted({"direct": with_parameters(**{symbol: limited})}, []).values()
    assert (found.parameters[symbol] is not UNKNOWN) == known


@pytest.mark.parametrize(
    ("answer", "verdicts", "codes"),
    [
        (SOUND, "usable within 0.96 %", []),
        (replace(SOUND, notes=(NOTED,)), "usable within 0.96 %", []),
        (UNSOLVED, "none", [TOY]),
        (with_parameters(K_z=UNKNOWN), f"{BOTH}; none: K_z", ["undetermined"]),
        (with_parameters(F_k=UNKNOWN), "usable within 0.96 %: c, K_z; none: F_k", []),
        (with_parameters(K_z=LIMIT), f"{BOTH}; doubtful: K_z", ["lower limit"]),
        (with_parameters(K_z=parameter(1.28, 0.63)), f"{BOTH}; usable within 49 %: K_z", []),
        (with_parameters(K_z=WIDE), f"{BOTH}; doubtful: K_z", ["wide"]),
    ],
)
def test_a_number_that_is_not_usable_has_a_reason(answer, verdicts, codes):
    assert in_one(answer.verdicts, TRANSLATION) == verdicts
    for one in answer.verdicts.values():
        assert (one.worded(TRANSLATION).reason == "") == (one.verdict == "usable")
    assert [one.code for one in answer.verdicts["K_z"].findings] == codes


def test_friction_that_does_not_show_is_a_limit_where_the_damping_is_known():
    none, sure, loose = parameter(2e-5, 8e-5), parameter(9.0, 0.2), parameter(9.0, 1.0)
    errors = np.array([4e-5, 0.1, 1e3])
    correlated = np.outer(errors, errors) * [[1.0, -0.9, 0.0], [-0.9, 1.0, 0.0], [0.0, 0.0, 1.0]]

    def answer(F_k, c, covariance=correlated):
        return replace(with_parameters(F_k=F_k, c=c), covariance=covariance)

    verdicts = answer(none, sure).verdicts
    assert verdicts["F_k"][::2] == ("usable", math.inf)
    assert verdicts["F_k"].worded(TRANSLATION).reason == "an upper limit only: F_k < 0.00010 N"
    assert verdicts["c"].within == pytest.approx(0.2 / 9.0)
    # a contact that only sticks takes nothing, whatever its friction is, and the damping knows nothing of it
    apart = answer(none, sure, np.diag(errors**2))
    for other in (answer(none, loose), answer(none, UNKNOWN), apart):
        assert other.verdicts["F_k"].verdict == "doubtful"


def test_an_answer_has_a_coefficient_whose_error_is_bounded():
    assert SOUND.answered
    assert not UNSOLVED.answered
    assert not replace(UNSOLVED, parameters={**UNSOLVED.parameters, "K_z": SOUND.K_z}).answered
    warned = partial(doubted, {"direct": SOUND})
    assert not warned([toy("exchanged", UNBOUNDED)])["direct"].answered
    assert warned([toy("Stribeck", {"F_k": math.inf})])["direct"].answered
    assert warned([toy("a wrong mass", {"": 0.9})])["direct"].answered
    # what may change a number by all of it bounds nothing
    assert not warned([toy("a wrong mass", {"": 1.1})])["direct"].answered


NEAR = replace(SOUND, name=REFERENCE, balance=None)


@pytest.mark.parametrize(
    ("doubts", "doubtful"),
    [
        ({}, ""),
        ({"": math.inf}, "F_k c K_z"),
        ({"": math.nan}, "F_k c K_z"),
        ({"K_z": math.inf}, "K_z"),
        # the intervals reach 0.78, 0.11 and 0.96 % to either side: far beyond them is still no harm up to 5 %
        ({"": 0.001}, ""),
        ({"": 0.049}, ""),
        ({"": 0.06}, "F_k c K_z"),
        ({"c": 0.0002, "K_z": 0.06}, "K_z"),
    ],
)
def test_what_is_warned_of_is_doubtful_beyond_the_interval_and_five_percent(doubts, doubtful):
    warning = Finding("asymmetric", {"order": 2, "share": 0.1}, doubts, of="a")
    answers = doubted({"direct": SOUND, REFERENCE: NEAR}, [warning])
    assert in_one(answers["direct"].verdicts, TRANSLATION) == "usable within 0.96 %"
    judged = answers[REFERENCE].verdicts
    assert [s for s, v in judged.items() if v.verdict == "doubtful"] == doubtful.split()
    assert all(judged[symbol].findings == (warning,) for symbol in doubtful.split())


@pytest.mark.parametrize("shift", [0.06, 0.3, 0.41])
def test_a_shift_inside_a_wide_interval_is_no_doubt(shift):
    rough = with_parameters(F_k=parameter(1.0, 0.4))
    answer = doubted({"direct": rough}, [toy("drift", {"F_k": shift})])["direct"]
    assert answer.verdicts["F_k"].verdict == ("doubtful" if shift > 0.4 else "usable")


def test_an_interval_holds_what_departures_can_do_to_the_number():
    of_two_records = [Finding("exchanged", {"sine": i}, {"": 0.01 * i}) for i in (1.0, 3.0)]
    note = toy("another shape", {"F_k": 0.04})
    answer = doubted({"direct": replace(SOUND, notes=(note,))}, of_two_records)["direct"]
    # half the width before, 0.01 of 1.28; the worse of two records, 3 %, and 4 % of the note, in quadrature
    half = math.hypot(0.01, 0.05 * 1.28)
    assert answer.intervals["F_k"] == pytest.approx((1.28 - half, 1.28 + half))
    assert answer.verdicts["F_k"] == ("usable", "", pytest.approx(half / 1.28), ())
    assert answer.verdicts["c"].within == pytest.approx(math.hypot(0.1 / 90.0, 0.03))
    # a shift is taken for 95 % of what may be
    error = answer.standard_errors["F_k"]
    assert error == pytest.approx(math.hypot(0.005, 0.05 * 1.28 / 1.959964))
    plain = replace(SOUND, covariance=np.diag([0.005**2, 0.05**2, 1e6]))
    wider = doubted({"direct": plain}, [toy("late", {"F_k": 0.05})])["direct"].covariance
    assert np.sqrt(np.diag(wider)) == pytest.approx([error, 0.05, 1000.0])


@pytest.mark.parametrize(
    ("balance", "fit", "warnings", "first"),
    [
        (SOUND, NEAR, (), REFERENCE),
        (SOUND, None, (), "direct"),
        (SOUND, replace(NEAR, notes=(NOTED,)), (), REFERENCE),
        (SOUND, replace(NEAR, notes=(FAR,)), (), "direct"),
        (replace(SOUND, notes=(FAR,)), replace(NEAR, notes=(FAR,)), (), "direct"),
        (replace(SOUND, notes=(FAR,)), NEAR, (), REFERENCE),
        (UNSOLVED, replace(NEAR, notes=(FAR,)), (), REFERENCE),
        # the warning concerns the fit only, or both
        (SOUND, NEAR, (Finding("asymmetric", {"order": 2, "share": 0.9}, {"": 0.9}),), "direct"),
        (SOUND, NEAR, (toy("unsteady", {"": 0.9}),), REFERENCE),
    ],
)
def test_the_first_answer_is_the_one_to_use(balance, fit, warnings, first):
    kinds = {"basis": None, "head": "", "rig": (), "k": 1.0, "sources": ()}
    outcome = Result(estimates={"direct": balance}, reference=fit, odd=warnings, **kinds)
    assert next(iter(outcome.approaches)) == first
    assert set(outcome.approaches) == {"direct"} | ({REFERENCE} if fit else set())


def read(source, stick=0.0, **clipped):
    """A reading of a stick distance, of channels that are clipped in these parts of their cycles."""
    channels = {quantity: SimpleNamespace(clipped=part) for quantity, part in clipped.items()}
    steady = SimpleNamespace(source=source, channels=channels)
    return SimpleNamespace(steady=steady, stick_travel=stick)


def test_an_onset_that_is_not_known_moves_F_k_by_half_of_the_stick():
    rows = Rows({"F_k": np.array([2.0, 4.0])}, 1.28 * np.array([2.0, 4.0]))
    balance = Balance(rows, np.array([0.1, 0.2]), ("a", "b"))
    answer = replace(SOUND, parameters={"F_k": SOUND.parameters["F_k"]}, balance=balance)
    common = {"frictionless": False, "stuck": None, "waveforms_hold": False, "in_rows": False}
    common = SimpleNamespace(**common, fit=TOY, answer=SOUND)
    readings = [read("a", 0.2), read("b", 0.4)]
    (note,) = notes_on(answer, readings, common)
    assert note.effect["F_k"] == pytest.approx(1.0 - 1.0 / 1.05, rel=1e-12)  # both rows alike
    _, scatter = notes_on(replace(answer, merit={"misfit": 16.0}), readings, common)
    assert scatter.code == "rows scatter"
    assert scatter.effect["F_k"] == pytest.approx(4.0 * answer.parameters["F_k"].within)


def test_a_coefficient_that_physics_forbids_is_named_with_the_likely_cause():
    negative = with_parameters(F_k=parameter(-0.1, 0.2), c=parameter(-6.0, 1.0))
    both = [read("a", force=0.2, velocity=0.9), read("b", velocity=1.0)]
    for readings, clipped in (
        ([read("a", force=0.0)], ""),
        (both, "velocity of a and velocity of b"),
    ):
        first = next(notes_on(negative, readings, CommonFit(None)))
        numbers = {"value": (("c", -6.0),), "clipped": clipped}
        assert first == Finding("negative", numbers, UNBOUNDED)
    assert forbidden(SOUND.coefficients, []) == []


@pytest.mark.parametrize(
    ("value", "half", "expected"),
    [
        (1.2785, 0.0039, "1.2785 ± 0.0039"),
        (207_400.0, 1650.0, "207400 ± 1600"),
        (2.9e-24, 1e-26, "2.900·10⁻²⁴ ± 1.0·10⁻²⁶"),
        (1e300, 2e299, "1.00·10³⁰⁰ ± 2.0·10²⁹⁹"),
        (5.0, 1e15, "< 1.0·10¹⁵"),
        (2.42, 0.0, "2.4200"),
        (-1.0, 0.5, "−1.00 ± 0.50"),
    ],
)
def test_a_number_of_any_size_fits_its_cell(value, half, expected):
    assert Number("F_k", parameter(value, half), Verdict("")).text == expected


@pytest.mark.parametrize(("part", "apart"), [(0.9, False), (1.1, True)])
def test_balance_and_fit_are_apart_where_they_differ_by_more_than_both_intervals(part, apart):
    # 0.1 of the fit and 0.5 of the balance
    check = with_parameters(c=parameter(90.0 + part * 0.6, 0.5)).as_check()
    assert bool(compared(check, SOUND)[1]) == apart


# --- findings of records, and departures that were weighed -----------------------------------------


@pytest.fixture(scope="module")
def sound():
    return identify(measured(noise=0.003), PAPER.k)


def test_a_finding_is_a_line_in_the_table_of_sentences(sound, monkeypatch):
    """Screen, details, report, document and verdicts then have it."""
    toy = Sentence("a cable hides {part:percent} of {F_k}", "pull it off", page="cable")
    monkeypatch.setitem(SENTENCES, "cable", toy)
    cable = Finding("cable", {"part": 0.25}, {"F_k": 0.25}, of=sound.sources[0])
    found = replace(sound, odd=(*sound.odd, cable))
    assert (found.verdicts["F_k"].verdict, found.verdicts["c"].verdict) == ("doubtful", "usable")
    for text in (found.screen(400), found.text()):
        assert "a cable hides 25 % of F_k; pull it off" in text
    assert "howto/symptoms.html#cable" in found.report()
    (entry,) = (one for one in found.document()["findings"] if one["code"] == "cable")
    told = [entry[key] for key in ("numbers", "effect", "of")]
    assert told == [{"part": 0.25}, {"F_k": 0.25}, sound.sources[0]]
    assert cable in found.findings


def test_a_verdict_depends_on_effects_and_not_on_the_order(sound):
    some = [toy("a", {"F_k": 0.3}), toy("b", {"": 0.06}), toy("c")]
    one, other = (replace(sound, odd=tuple(of)).answer.verdicts for of in (some, some[::-1]))
    assert {s: v[:3] for s, v in one.items()} == {s: v[:3] for s, v in other.items()}


def model(name, moved=0.0, size=(0.0, 0.0)):
    return Model(name, 0.1, 0.0, np.array([1.0, 2.0 * (1.0 + moved)]), np.eye(2), None, size)


def selection(weight, moved=0.1):
    models = (model(""), model("delay", moved, (-2e-5, 1e-6)), model("many sliders", 9.0))
    return Selection(("F_k", "c"), models, (0.9 - weight, weight, 0.1))


@pytest.mark.parametrize(
    ("weight", "moved", "said"),
    [
        (0.95, 0.0, [True]),  # clearly there
        (0.6, 0.1, [False]),  # its share moves c by 6 %
        (0.3, 0.1, []),  # by 3 %, less than what makes a number useless
        (0.0, 9.0, []),
    ],
)
def test_a_departure_is_named_where_it_is_clear_or_matters(weight, moved, said):
    found = said_of(selection(weight, moved))
    assert [one.numbers["clear"] for one in found] == said
    assert all(one.effect == {} for one in found)


def test_all_that_was_weighed_is_listed_with_size_and_error(sound):
    rows = weighed_of(selection(0.6))
    assert [one.name for one in rows] == ["delay", "", "many sliders"]
    assert rows[0][1:] == (0.6, -2e-5, 1e-6)
    assert sum(one.weight for one in rows) == pytest.approx(1.0)
    first = replace(sound, weighed=rows).document()["weights"][0]
    assert first == {"name": "delay", "weight": 0.6, "size": -2e-5, "error": 1e-6}


def test_each_departure_has_words_with_its_size():
    words = [sentence(departure(name, -0.2, 0.5), ROTATION) for name in DEPARTURES]
    assert not [one for one in words if "{" in one]


# --- words that slip out of a program, whatever the numbers in a sentence are ---------------------


def said(found):
    """Everything that an identification says, as one text, in which nothing slips out."""
    text = "\n".join([str(found), found.text(), found._repr_html_(), *limiting(found)])
    assert slips(text) == []
    return text


def altered(seconds=0.0, factor=1.0, loud=0.0, F_k=PAPER.F_k, **options):
    """Records whose displacement is later and larger, and whose first channel has a second harmonic, a part of its
    amplitude."""
    for record in measured(osc=replace(PAPER, F_k=F_k), **options):
        drive, x = (record[q] for q in record)
        wave = loud * np.abs(drive.values).max() * np.cos(14.0 * math.pi * drive.t)
        record = changed(record, drive.name, values=drive.values + wave)
        yield changed(record, x.name, t=x.t + seconds, values=factor * x.values)


@pytest.mark.parametrize(
    ("alteration", "words", "others"),
    [
        ({"seconds": -1753e-6}, "a response that leads the drive by 17", "lags the drive"),
        ({"seconds": 1753e-6}, "a response that lags the drive by 17", "leads the drive"),
        ({"loud": 0.2, "channels": ("force", "displacement")}, "the force is not", "base motion"),
        ({"F_k": 5.0, "levels": (0.004, 0.005, 0.006)}, "", "e+"),
    ],
)
def test_what_is_said_of_forced_records(alteration, words, others):
    text = said(identify([*altered(**alteration)], PAPER.k))
    assert words in text
    assert others not in text


def test_what_is_said_of_another_law_and_a_wrong_mass():
    said(identify([*altered(F_k=1e-9)], PAPER.k, terms=["F_k", "eta"], mass=1.0))


def test_what_is_said_of_free_decays():
    osc = replace(PAPER, m=2.0, c=1.5, F_k=1e-9)
    free = measured_ring_down(osc, x=0.02, rate_hz=500.0, duration=4.0, noise=0.01)
    said(identify(free, osc.k))
