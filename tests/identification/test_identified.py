"""The interface for records: the same result from files, tables and arrays, of both kinds, whole and consistent."""

from __future__ import annotations

import hashlib
import importlib
import json
import math
import re
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from matplotlib import pyplot

from dampbalance import (
    Oscillator,
    RecordError,
    identify,
    measured_ring_down,
    read_records,
)
from dampbalance.findings.words import sentence
from dampbalance.identification import report
from dampbalance.identification.outputs import ALL_PICTURES, PICTURES, REPORT, TABLES, pictures_of
from folders import ROOT
from identification.levels import changed, clipped, measured
from paper_case import PAPER
from toys import toy

LEVELS = (0.004, 0.007, 0.010, 0.012)
FILES = sorted((ROOT / "config/records/example").glob("level*.csv"))
TWO = FILES[:2]


def made(**options):
    """A record of each level, below resonance."""
    return measured(LEVELS, **options)


DECAYING = Oscillator(m=2.0, c=1.5, k=2310.0, K_z=208000.0, F_k=0.5)


@pytest.fixture(scope="module")
def steady():
    return identify(made(), stiffness=PAPER.k, laws=True)


@pytest.fixture(scope="module")
def decay():
    free = measured_ring_down(DECAYING, x=0.012, rate_hz=1000.0, duration=3.0, noise=0.005)
    return identify(free, stiffness=DECAYING.k)


BOTH = pytest.mark.parametrize("kind", ["steady", "decay"])


@pytest.fixture
def found(kind, request):
    return request.getfixturevalue(kind)


@pytest.fixture
def truth(kind):
    return PAPER if kind == "steady" else DECAYING


@BOTH
def test_the_truth_is_found(found, truth):
    for symbol in ("F_k", "c", "K_z"):
        true, (low, high) = getattr(truth, symbol), found.intervals[symbol]
        error = found.standard_errors[symbol]
        # four standard errors: chance leaves one of the six numbers outside in one seed of 2,600
        assert abs(found.values[symbol] - true) < 4.0 * error
        assert low < found.values[symbol] < high
        # Student's t; a model far away is in the error more than in the interval, and K_z has a long tail
        assert symbol == "K_z" or high - low < 1.1 * 3.92 * error


@BOTH
def test_the_fit_is_the_answer_and_the_balance_its_check(found):
    fit = found.approaches["maximum likelihood"]
    assert list(found.approaches)[:2] in (
        ["maximum likelihood", "direct"],
        ["maximum likelihood", "balance"],
    )
    assert found.document()["answer"] == "maximum likelihood"
    assert found.values == fit.values
    assert [one[0] for one in found.verdicts.values()] == [v[0] for v in fit.verdicts.values()]
    assert "\nmaximum likelihood  " in found.text()


def test_where_the_records_are_of_another_oscillator_their_numbers_are_doubtful():
    """The response clipped at 80 % of its peak is that of no oscillator."""
    records = [clipped(one, "displacement", 0.8) for one in made(noise=0.001)]
    found = identify(records, stiffness=PAPER.k)
    assert next(iter(found.approaches)) == found.document()["answer"]
    assert {v.verdict for v in found.verdicts.values()} <= {"doubtful", "none"}


@BOTH
def test_the_frame_holds_every_number_of_the_document(found):
    frame, document = found.to_frame(), found.document()
    assert set(frame["approach"]) == set(found.approaches)
    for line in frame.itertuples():
        told = document["approaches"].get(line.approach) or document["maximum_likelihood"]
        key = next(k for k in told if k.startswith(line.symbol) and k.count("_error") == 0)
        assert told[key] == pytest.approx(line.value, rel=1e-15)
        assert told["verdicts"].get(line.symbol, {"verdict": ""})["verdict"] == line.verdict
    json.dumps(document, allow_nan=False)


@BOTH
def test_the_covariance_has_the_errors_on_its_diagonal_and_is_one(found):
    for name, answer in found.approaches.items():
        diagonal = np.sqrt(np.diag(answer.covariance))
        assert np.isfinite(answer.covariance).all(), name
        np.testing.assert_allclose(diagonal, list(answer.standard_errors.values()), rtol=1e-9)
        known = answer.covariance[:2, :2]  # of F_k and c
        assert np.array_equal(known, known.T), name
        assert np.linalg.eigvalsh(known / np.outer(diagonal[:2], diagonal[:2])).min() > 0.0, name
    assert list(found.covariance.columns) == ["F_k", "c", "K_z"]
    assert found.covariance.loc["F_k", "c"] < 0.0  # what one takes of the work, the other lacks


@BOTH
def test_the_rows_are_those_that_were_solved(found):
    check = next(name for name, answer in found.approaches.items() if answer.rows)
    rows, values = found.rows, found.approaches[check].values
    left = rows["a_m"] * values["F_k"] + rows["b_m2_per_s"] * values["c"] - rows["W_J"]
    np.testing.assert_allclose(left, rows["misfit_J"], atol=1e-14 * rows["W_J"].abs().max())
    scaled = rows["misfit_J"] / rows["standard_error_J"]
    assert (scaled.abs() < 5.0).all()  # within their noise
    assert len(rows) == len(rows.index) >= 2


def test_each_group_has_a_column_of_its_own(steady):
    groups = {"F_k": ["A", "A", "B", "B"]}
    grouped = identify(made(), PAPER.k, groups=groups)
    assert list(grouped.values) == ["F_k[A]", "F_k[B]", "c", "K_z"]
    a = grouped.rows[["a_A_m", "a_B_m"]].sum(axis=1)
    # of a friction force that is known otherwise, a part in 1e3 of the travel is
    np.testing.assert_allclose(a, steady.rows["a_m"], rtol=1e-3)


def plain(text):
    """Text in one line, as its lines are broken where the screen ends."""
    return " ".join(text.split())


@BOTH
def test_the_screen_begins_with_the_answer_and_holds_what_is_asked_for_first(found, truth):
    said = plain(found.screen())
    for symbol, unit in (("F_k", "N"), ("c", "N s/m")):
        form = rf"{symbol} = ([\d.]+) (?:± ([\d.]+)|\[([\d.]+), ([\d.]+)\]) {unit}"
        value, half, *ends = re.search(form, said).groups()
        half = half or 0.5 * (float(ends[1]) - float(ends[0]))
        low, high = found.intervals[symbol]
        # two digits of the half width are shown
        assert float(value) == pytest.approx(found.values[symbol], abs=0.05 * (high - low))
        assert float(half) == pytest.approx(0.5 * (high - low), rel=0.05)
    zeta = truth.c / (2.0 * math.sqrt(truth.k * truth.m))
    shown = float(re.search(r"ζ = ([\d.]+) % from c alone", said)[1])
    assert shown == pytest.approx(100.0 * zeta, rel=0.02)  # what noise does to c
    levels = sorted(found.levels, key=lambda level: level.X)
    losses = re.findall(r"η = ([\d.]+), ζ_eq", said)
    for level, shown in zip((levels[0], levels[-1]), losses, strict=False):
        assert float(shown) == pytest.approx(level.loss_factor(found.k), rel=0.005)  # three digits
    damping = (
        ("Measured from", "m = ", "Check: ")
        if found.basis.kind == "ring-down"
        else ("m = ", "With friction", "Check: ")
    )
    assert bool(losses) == ("With friction" in damping)
    parts = ("F_k = ", " at 95 %: usable", *damping, "--mass", "See the")
    assert sorted(parts, key=said.index) == list(parts)


@BOTH
def test_the_screen_is_as_wide_as_it_is_told_and_keeps_units_with_their_numbers(found):
    for width in (40, 80, 132):
        lines = found.screen(width).splitlines()
        assert all(len(line) <= width for line in lines if "  " not in line.strip())
        assert not [line for line in lines if re.match(r"\s*(?:N|kg|%|mm|Hz|=)(?:\s|$)", line)]
        assert plain(found.screen(width)) == plain(found.screen())


def test_without_an_answer_the_cause_comes_first_and_the_numbers_last(steady):
    found = identify(made()[:1], PAPER.k)
    said = found.screen()
    assert plain(said).startswith("No answer: there are fewer levels than coefficients")
    order = ("add records at other amplitudes", "verdict", "doubtful", "m = ", "Check: none")
    assert sorted(order, key=plain(said).index) == list(order)
    assert plain(said).count("add records at other amplitudes") == 1
    assert "verdict" not in steady.screen()


def test_the_screen_has_three_causes_the_one_that_changes_most_first():
    few = toy("a cable hides a part", {"F_k": 0.01})
    much = toy("the gain is wrong; check it", {"": 0.2})
    others = [toy(f"a {word} is seen") for word in ("line", "step", "drift")]
    found = replace(identify(made(), PAPER.k), odd=(*others, few, much))
    said = [line for line in found.screen().splitlines() if line.startswith("- ")]
    assert said == [
        "- The gain is wrong; check it.",
        "- A cable hides a part.",
        "- A line is seen.",
    ]
    assert "See the method text for 2 more and all numbers" in found.screen()
    assert "doubtful" in plain(found.screen()).partition("the gain is wrong")[0]


@BOTH
def test_the_summary_is_a_table_of_the_answer(found, truth):
    table = found.summary()
    assert [*table.index] == [*found.values, "m", "f_n", "zeta"]
    for symbol in found.values:
        assert tuple(table.loc[symbol, ["low", "high"]]) == found.intervals[symbol]
    hertz = math.sqrt(truth.k / truth.m) / (2.0 * math.pi)
    assert table.loc["f_n", "value"] == pytest.approx(hertz, rel=1e-3)  # four standard errors of m
    assert table.loc["K_z", "unit"] == "N/m"


@BOTH
def test_it_shows_itself_as_the_command_does(found):
    text, html = found.text(), found._repr_html_()
    assert repr(found) == str(found) == found.screen().rstrip("\n")
    for name, answer in found.approaches.items():
        assert name in text
        assert f'<th scope="row">{name}' in html
        assert all(sentence(note, found.coordinate) in text for note in answer.notes)
    own = html.rpartition("<table>")[2]
    assert own.count("<td>") == len(found.approaches) * (len(found.values) + 1)
    cells = pd.read_html(html)[-1] if importlib.util.find_spec("lxml") else None
    assert cells is None or len(cells) == len(found.approaches)


def test_a_name_is_no_markup():
    frames = [record.to_frame() for record in read_records(made()[::3])]
    frames[0]["spare_V"] = frames[0]["displacement_m"]
    frames[0].attrs["name"] = "<script>&"
    html = identify(frames, PAPER.k)._repr_html_()
    assert "<script>" not in html
    assert "&lt;script&gt;" in html


@BOTH
def test_every_picture_can_be_drawn(found):
    for name in found.figures:
        panels = found.plot(name)
        assert len(panels) > 1
        assert pyplot.figure(panels[0].figure).get_axes() == [*panels]  # which pyplot shows
        figure, wide = pyplot.subplots(1, 2)
        assert found.plot(name, ax=wide[0], color="r") is wide[0]
        assert [line.get_color() for line in wide[0].get_lines()] == ["r"] * len(panels[0].lines)
        assert wide[0].get_xlabel() in {panel.get_xlabel() for panel in panels} - {""}
        assert [*found.plot(name, ax=[None, wide[1]])] == [wide[1]]
        assert wide[1].get_ylabel() == panels[1].get_ylabel()
        assert figure.get_axes() == [*wide]
    assert found.plot()[0].get_lines()
    pyplot.close("all")
    with pytest.raises(ValueError, match=f"one of {', '.join(found.figures)}, got 'loop'"):
        found.plot("loop")


def test_the_line_of_the_balance_takes_the_coefficient_that_is_given():
    given = identify(made(), PAPER.k, given={"c": 90.0})
    *_, line = given.plot("balance")[0].get_lines()
    (_, end), heights = line.get_data()
    np.testing.assert_allclose(heights, [90.0, 90.0 + given.values["F_k"] * end], rtol=1e-12)


@BOTH
def test_all_of_it_is_saved_and_nothing_is_replaced_unasked(found, tmp_path):
    folder = tmp_path / "new" / "found"
    files = found.save(folder)
    assert sorted(files) == sorted(folder.iterdir())
    assert {file.name for file in files} == {*TABLES, *pictures_of(found.figures), REPORT}
    assert (folder / REPORT).read_text(encoding="utf-8") == found.report()
    document = (folder / "identification.json").read_text(encoding="utf-8")
    assert json.loads(document) == json.loads(json.dumps(found.document()))
    assert (folder / "summary.txt").read_text(encoding="utf-8") == found.text()
    with pytest.raises(ValueError, match=r"already contains .* add overwrite=True$"):
        found.save(folder)
    assert len(found.save(folder, figures=False, overwrite=True)) == len(TABLES)
    assert not any((folder / name).exists() for name in ALL_PICTURES)


@BOTH
def test_the_pictures_of_a_kind_are_those_declared(found):
    assert found.figures == tuple(PICTURES[found.basis.kind])


def test_an_error_in_the_report_leaves_what_was_there(tmp_path, monkeypatch):
    """All is computed before a file changes; no temporary file is left."""
    free = measured_ring_down(DECAYING, x=0.012, rate_hz=1000.0, duration=3.0, noise=0.005)
    found = identify(free, PAPER.k)
    for name in ("decays.svg", REPORT):
        (tmp_path / name).write_text("before")

    def fails(*_):
        raise OSError("no room")

    monkeypatch.setattr(report, "report", fails)
    with pytest.raises(OSError, match="no room"):
        found.save(tmp_path, overwrite=True)
    assert {file.name: file.read_text() for file in tmp_path.iterdir()} == {
        "decays.svg": "before",
        REPORT: "before",
    }


def test_files_tables_and_arrays_give_the_same():
    records = read_records(FILES[:3])
    frames = [record.to_frame() for record in records]
    arrays = [
        {"time_s": frame.index.to_numpy()} | {name: frame[name].to_numpy() for name in frame}
        for frame in frames
    ]
    of_files, *others = (identify(some, PAPER.k) for some in (FILES[:3], records, frames, arrays))
    for other in others:
        assert other.values == of_files.values
        assert other.document()["approaches"] == of_files.document()["approaches"]


def test_the_mapping_and_the_options_reach_the_records(tmp_path):
    named = [
        {"t": one["displacement"].t, "in": one["base_displacement"].values, "out": 1e3 * one["displacement"].values}
        for one in made()
    ]  # fmt: skip
    mapping = {
        "channels": {
            "base_displacement": {"channel": "in", "unit": "m"},
            "displacement": {"channel": "out", "unit": "mm"},
        },
        "time": {"channel": "t", "unit": "s"},
    }
    options = {"mapping": mapping, "frequency": 3.5}
    whole, part = (identify(named, PAPER.k, skip_cycles=n, **options) for n in (0, 5))
    cycles, fewer = ([r["cycles"] for r in one.document()["records"]] for one in (whole, part))
    assert [n - 5 for n in cycles] == fewer
    with pytest.raises(ValueError, match=r"record 1: the excitation oscillates"):
        identify(named, PAPER.k, mapping=mapping, frequency=7.0)
    with pytest.raises(RecordError, match="in which units are 'in' and 'out'"):
        identify(named, PAPER.k)


@pytest.mark.parametrize(
    ("records", "options", "message"),
    [
        ([], {}, "no records are given"),
        ([FILES[0], FILES[0]], {}, "is named twice"),
        (TWO, {"stiffness": -1.0}, "stiffness"),
        (
            TWO,
            {"stiffness": "2310 N"},
            "stiffness must be a positive number of N/m, .*, got '2310 N'",
        ),
        (TWO, {"mass": 0.0}, "mass must be a positive number of kg"),
        (TWO, {"mass": 2.42e9}, "swings .* times in a cycle"),
        (TWO, {"kind": "ring-down"}, "moves: this is no free decay"),
        (TWO, {"kind": "free"}, "kind must be one of recognised, forced, ring-down"),
        (TWO, {"mapping": 5}, "mapping must be what the channels hold, .*, got 5"),
        (TWO, {"skip_cycles": -1}, "skip_cycles must be a whole number, 0 to .*, got -1"),
        (TWO, {"terms": ["F_k", "d"]}, "'?d'?"),
    ],
)
def test_what_cannot_be_identified_is_refused_in_a_sentence(records, options, message):
    with pytest.raises(ValueError, match=message):
        identify(records, **{"stiffness": PAPER.k, **options})


def test_names_in_a_text_are_read_as_on_the_command_line():
    options = {"given": {"c": 90.0}}
    words = {"terms": "F_k, c", "groups": {"F_k": "A,A,A,B"}}
    listed = {"terms": ["F_k", "c"], "groups": {"F_k": list("AAAB")}}
    one, other = (identify(made(), PAPER.k, **options, **names) for names in (words, listed))
    assert one.document() == other.document()
    assert list(one.values) == ["F_k[A]", "F_k[B]", "K_z"]


def test_the_averaged_cycle_lies_on_the_samples_whatever_the_zero_of_the_transducer():
    records = made(noise=1e-4)[:2]
    x = records[1]["displacement"].values + 0.02
    records[1] = replace(changed(records[1], "displacement", values=x), name="another zero")
    found = identify(records, PAPER.k)
    for reading, axes in zip(found.basis.readings, found.plot("cycles")[::2], strict=True):
        dots, line = axes.get_lines()[:2]
        on_line = np.interp(dots.get_xdata(), line.get_xdata(), line.get_ydata(), period=360.0)
        # half a degree between the points of the line, and the noise
        X = 1e3 * reading.features.X[0]
        np.testing.assert_allclose(dots.get_ydata(), on_line, atol=1e-3 * X)


def _written(folder, level, record):
    """A record in one file, and in one for each channel."""
    base, response = (
        pd.DataFrame({"time_s": record[q].t, f"{q}_m": record[q].values})
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


def test_a_file_for_each_channel_gives_the_same_and_all_are_listed(tmp_path):
    records = enumerate(made(noise=1e-3)[:2])
    whole, several = zip(*(_written(tmp_path, i, record) for i, record in records), strict=True)
    one, other = (
        json.loads(json.dumps(identify(files, PAPER.k).document())) for files in (whole, several)
    )
    assert other["approaches"] == one["approaches"]
    for i, record in enumerate(other["records"]):
        part = tmp_path / f"mass{i}.csv"
        digest = hashlib.sha256(part.read_bytes()).hexdigest()
        assert record["others"] == [{"file": str(part), "sha256": digest}]
        assert "others" not in one["records"][i]
