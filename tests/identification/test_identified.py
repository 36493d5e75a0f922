"""What `identify` takes and returns, whole and consistent: options, numbers, screen, report, pictures, files."""

from __future__ import annotations

import base64
import hashlib
import inspect
import json
import math
import re
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
import yaml
from matplotlib import pyplot

from dampbalance import (
    Oscillator,
    identify,
    identify_decays,
    identify_forced,
    measured_ring_down,
    read_records,
    steady_orbits,
)
from dampbalance.findings.words import unit_of
from dampbalance.identification import report as reports
from dampbalance.identification.forced import friction_loops
from dampbalance.identification.level import Level, damping_ratio
from dampbalance.identification.outputs import ALL_PICTURES, PICTURES, REPORT, TABLES, pictures_of
from dampbalance.identification.screen import interval_of, value_of
from dampbalance.measured import WAYS
from dampbalance.project.case import read_case_schema
from dampbalance.project.options import OPTIONS, configured, contradictions
from dampbalance.records.errors import RecordError
from dampbalance.records.readers import mapping_to_start_from
from folders import ROOT
from identification.levels import THREE, clipped, close, measured
from paper_case import PAPER
from publishing.html import in_a_line, words
from records.drafts import filled

FILES = sorted((ROOT / "config/records/example").glob("level*.csv"))
DECAYING = Oscillator(m=2.0, c=1.5, k=2310.0, K_z=208000.0, F_k=0.5)


@pytest.fixture(scope="module")
def steady():
    return identify(FILES[::2], PAPER.k, laws=True)


def release():
    return measured_ring_down(DECAYING, x=0.012, rate_hz=1000.0, duration=4.0, noise=0.005)


@pytest.fixture(scope="module")
def decay():
    return identify(release(), DECAYING.k)


BOTH = pytest.mark.parametrize("kind", ["steady", "decay"])


@pytest.fixture
def found(kind, request):
    return request.getfixturevalue(kind)


@pytest.fixture
def truth(kind):
    return PAPER if kind == "steady" else DECAYING


# --- numbers --------------------------------------------------------------------------------------


def test_a_clipped_record_is_left_out_where_enough_others_are_there():
    *sound, last = measured(levels=(0.004, 0.006, 0.009, 0.012), channels=THREE, rate_hz=500.0)
    found = identify([*sound, clipped(last, "acceleration", 0.9)], PAPER.k)
    assert found.values == identify(sound, PAPER.k).values
    assert [one.of for one in found.findings if one.code == "left out"] == [last.name]


@BOTH
def test_the_fit_is_the_answer_and_finds_the_truth(found, truth):
    assert close(found, truth)
    assert list(found.approaches)[1] in ("direct", "balance")
    document = found.document()
    assert next(iter(found.approaches)) == document["answer"] == "maximum likelihood"
    assert (found.no_answer, document["no_answer"]) == ("", None)
    for symbol in ("F_k", "c"):
        low, high = found.intervals[symbol]
        # Student's t; a model far away is in the error more than in the interval
        assert high - low < 1.1 * 3.92 * found.standard_errors[symbol]
    hertz = math.sqrt(truth.k / truth.m) / (2.0 * math.pi)
    table = found.summary()
    assert [*table.index] == [*found.values, "m", "f_n", "zeta"]
    assert tuple(table.loc["F_k", ["low", "high"]]) == found.intervals["F_k"]
    assert table.loc["f_n", "value"] == pytest.approx(hertz, rel=1e-3)  # four standard errors of m


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
        np.testing.assert_allclose(diagonal, list(answer.standard_errors.values()), rtol=1e-9)
        known = answer.covariance[:2, :2]  # of F_k and c
        assert np.array_equal(known, known.T), name
        assert np.linalg.eigvalsh(known / np.outer(diagonal[:2], diagonal[:2])).min() > 0.0, name
    assert found.covariance.loc["F_k", "c"] < 0.0  # what one takes of the work, the other lacks


@BOTH
def test_the_rows_are_those_that_were_solved(found):
    check = next(name for name, answer in found.approaches.items() if answer.rows)
    rows, values = found.rows, found.approaches[check].values
    left = rows["a_m"] * values["F_k"] + rows["b_m2_per_s"] * values["c"] - rows["W_J"]
    np.testing.assert_allclose(left, rows["misfit_J"], atol=1e-14 * rows["W_J"].abs().max())
    assert ((rows["misfit_J"] / rows["standard_error_J"]).abs() < 5.0).all()  # within their noise
    assert len(rows) >= 2


def test_equivalent_damping_has_closed_forms():
    """A damper has its own c, ζ_eq = ζ and η = 2ζ = 1/Q at the natural frequency; dry friction 4F_k/(πωX), Jacobsen."""
    omega, X = math.sqrt(PAPER.k / PAPER.m), 0.003
    zeta = damping_ratio(PAPER.c, PAPER.k, PAPER.m)
    viscous = Level("one", X, omega, math.pi * PAPER.c * omega * X**2, 0.0)
    told = viscous.document(PAPER.k, PAPER.m)
    ratios = [told[key] for key in ("equivalent_damping_ratio", "loss_factor", "Q")]
    assert ratios == pytest.approx([zeta, 2.0 * zeta, 1.0 / (2.0 * zeta)], rel=1e-12)
    assert viscous.equivalent_damping == pytest.approx(PAPER.c, rel=1e-12)
    dry = Level("one", X, omega, 4.0 * PAPER.F_k * X, 0.0).equivalent_damping
    assert dry == pytest.approx(4.0 * PAPER.F_k / (math.pi * omega * X), rel=1e-12)


def test_the_levels_of_records_lose_what_friction_and_damper_take(steady, decay):
    assert steady.levels
    assert decay.levels
    for found, osc in ((steady, PAPER), (decay, DECAYING)):
        zeta = damping_ratio(osc.c, osc.k, osc.m)
        assert found.document()["damping"]["damping_ratio"] == pytest.approx(zeta, rel=0.05)
    for level in steady.levels[:-1]:
        viscous = math.pi * PAPER.c * level.omega * level.X**2  # of the fundamental
        assert pytest.approx(level.friction + viscous, rel=0.05) == level.W
    for level in decay.levels:  # from the swings alone
        friction = 2.0 * DECAYING.F_k / (math.pi * DECAYING.k * level.X)
        assert abs(level.ratio - zeta - friction) < 4.0 * level.ratio_error + 0.1 * friction


# --- screen and report ----------------------------------------------------------------------------


@BOTH
def test_the_screen_begins_with_the_answer_and_is_as_wide_as_it_is_told(found):
    said = in_a_line(found.screen())
    for symbol, unit in (("F_k", "N"), ("c", "N s/m")):
        form = rf"{symbol} = ([\d.]+) (?:± ([\d.]+)|\[([\d.]+), ([\d.]+)\]) {unit}"
        value, half, *ends = re.search(form, said).groups()
        half = half or 0.5 * (float(ends[1]) - float(ends[0]))
        low, high = found.intervals[symbol]
        # two digits of the half width are shown
        assert float(value) == pytest.approx(found.values[symbol], abs=0.05 * (high - low))
        assert float(half) == pytest.approx(0.5 * (high - low), rel=0.05)
    lines = found.screen(40).splitlines()
    assert all(len(line) <= 40 for line in lines if "  " not in line.strip())
    assert in_a_line(found.screen(40)) == said
    assert repr(found) == found.screen().rstrip("\n")


@BOTH
def test_a_report_is_one_file_with_every_number(found):
    html = found.report()
    assert set(re.findall(r'(?:src|href)="([^:"]+:[^;"]*)', html)) == {"data:image/svg+xml"}
    assert not re.search(r"<script|<link|@import|url\(", html)
    pictures = re.findall(r'src="data:image/svg\+xml;base64,(.+?)"', html)
    assert len(pictures) == len(found.figures) + 1  # the rig
    assert all(b"prefers-color-scheme: dark" in base64.b64decode(data) for data in pictures)
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


def test_a_name_is_no_markup():
    frames = [record.to_frame() for record in read_records(FILES[::4])]
    frames[0].attrs["name"] = "<script>& at 2 m/s"
    frames[0]["<script>_V"] = frames[0]["displacement_m"]  # of which a finding tells
    found = identify(frames, PAPER.k)
    for html in (found._repr_html_(), found.report()):
        assert "<script>" not in html
        assert "&lt;script&gt;" in html


# --- pictures -------------------------------------------------------------------------------------


@BOTH
def test_every_picture_can_be_drawn(found):
    assert found.figures == tuple(PICTURES[found.basis.kind])
    for name in found.figures:
        panels = found.plot(name)
        _, wide = pyplot.subplots(1, 2)
        assert [*found.plot(name, ax=[None, wide[1]], color="r")] == [wide[1]]
        assert wide[1].get_ylabel() == panels[1].get_ylabel()
        assert {line.get_color() for line in wide[1].get_lines()} <= {"r"}
        pyplot.close("all")
    with pytest.raises(ValueError, match=f"one of {', '.join(found.figures)}, got 'loop'"):
        found.plot("loop")


def test_the_line_of_the_balance_takes_the_coefficient_that_is_given():
    given = identify(FILES[::2], PAPER.k, given={"c": 90.0})
    *_, line = given.plot("balance")[0].get_lines()
    (_, end), heights = line.get_data()
    np.testing.assert_allclose(heights, [90.0, 90.0 + given.values["F_k"] * end], rtol=1e-12)


@pytest.mark.parametrize("fitted", [True, False])
def test_the_friction_loop_takes_what_friction_takes(steady, fitted):
    """∮ f dx = a F_k; without a fit the mass is that of a contact that does not yield."""
    result = steady
    if not fitted:
        common = replace(result.basis.common, selection=None)
        result = replace(result, basis=replace(result.basis, common=common), reference=None)
    for loop in friction_loops(result, PAPER.m).values():
        v = loop["v_m_per_s"]
        off = loop["f_N"] / PAPER.F_k - np.sign(v)
        # away from the stops, about which harmonics ring; noise and fit leave less than a hundredth
        assert off[v.abs() > 0.3 * v.abs().max()].abs().max() < 0.02
    panels = result.pictures["friction"].drawn(result.coordinate).axes
    for axes, a in zip(panels, result.basis.features.a, strict=True):
        lines = {line.get_label(): line for line in axes.get_lines()}
        x, f = lines["from the record"].get_data()
        assert abs(np.trapezoid(f, 1e-3 * x)) == pytest.approx(a * PAPER.F_k, rel=0.01)
        assert ("fitted oscillator" in lines) == fitted
        if fitted:
            assert max(lines["fitted oscillator"].get_ydata()) == pytest.approx(PAPER.F_k, rel=0.01)
            (x_s, other), (up, down) = lines["onset of slip"].get_data()
            assert x_s == -other == pytest.approx(min(x), rel=0.01)
            assert up == -down == pytest.approx(PAPER.F_k, rel=0.01)


# --- files ----------------------------------------------------------------------------------------


def test_all_of_it_is_saved_and_nothing_is_replaced_unasked(decay, tmp_path, monkeypatch):
    """All is computed before a file changes; no temporary file is left."""
    found, folder = decay, tmp_path / "new" / "found"
    files = found.save(folder)
    assert {file.name for file in files} == {*TABLES, *pictures_of(found.figures), REPORT}
    document = (folder / "identification.json").read_text(encoding="utf-8")
    assert json.loads(document) == json.loads(json.dumps(found.document()))
    assert (folder / "summary.txt").read_text(encoding="utf-8") == found.text()
    with pytest.raises(ValueError, match=r"already contains .* add overwrite=True$"):
        found.save(folder)
    before = {file: file.read_bytes() for file in folder.iterdir()}

    def fails(*_):
        raise OSError("no room")

    with monkeypatch.context() as patch:
        patch.setattr(reports, "report", fails)
        with pytest.raises(OSError, match="no room"):
            found.save(folder, overwrite=True)
    assert {file: file.read_bytes() for file in folder.iterdir()} == before
    assert len(found.save(folder, figures=False, overwrite=True)) == len(TABLES)
    assert not any((folder / name).exists() for name in ALL_PICTURES)


def test_files_tables_arrays_and_a_file_for_each_channel_give_the_same(steady, tmp_path):
    frames = [record.to_frame() for record in read_records(FILES[::2])]
    arrays = [{"time_s": of.index.to_numpy(), **{q: of[q].to_numpy() for q in of}} for of in frames]
    bases, masses = ([tmp_path / f"{of}{i}.csv" for i in range(3)] for of in ("base", "mass"))
    for file, base, mass in zip(FILES[::2], bases, masses, strict=True):
        columns = pd.read_csv(file, dtype=str)
        columns.iloc[:, :3].to_csv(base, index=False)
        columns.iloc[:, [0, 3]].to_csv(mass, index=False)
        base.with_suffix(".yaml").write_text(
            "channels:\n  base_displacement: {channel: 2, unit: m}\n  displacement: {channel: 3, unit: m}\n"
            f"  acceleration: {{file: {mass.name}, channel: 2, unit: m/s^2}}\n"
        )
    for records in (frames, arrays, bases):
        found = identify(records, PAPER.k, laws=True)
        assert found.values == steady.values
        assert found.document()["approaches"] == steady.document()["approaches"]
    for record, mass in zip(found.document()["records"], masses, strict=True):
        digest = hashlib.sha256(mass.read_bytes()).hexdigest()
        assert record["others"] == [{"file": str(mass), "sha256": digest}]


@BOTH
@pytest.mark.filterwarnings("ignore:.*channels not used")
def test_files_of_a_data_logger_are_identified_by_the_mapping_that_is_suggested(
    kind, truth, tmp_path
):
    files = []
    for record in measured() if kind == "steady" else [release()]:
        sensors = {q: f"Ch {n}" for n, q in enumerate(record)}
        t = record["displacement"].t
        number = np.arange(1.0, t.size + 1.0)
        columns = {"Time": t, "No": number, "Temp": 21.0 + np.sin(0.01 * number), "Status": 0.0 * t}
        columns |= {name: 1e3 * record[q].values for q, name in sensors.items()}
        table = pd.DataFrame(columns).to_csv(index=False, float_format="%.9g")
        files.append(tmp_path / f"{len(files)}.csv")
        files[-1].write_text(f"Model,MSO24\n\nRecord Length,5714\n\n{table}", encoding="cp1252")
    with pytest.raises(RecordError, match="what do"):
        identify(files, truth.k)
    suggested = mapping_to_start_from(files[0], {"delimiter": ","})
    for reason in ("'No': rises by 1", "'Temp': a temperature", "'Status': constant"):
        assert f"# left aside: {reason}" in suggested
    mapping = filled(yaml.safe_load(suggested), sensors)
    assert mapping["delimiter"] == ","
    assert close(identify(files, truth.k, mapping=mapping), truth)
    with pytest.raises(RecordError, match=r"names the channels of .* already"):
        mapping_to_start_from(files[0], mapping)


def test_cycles_are_skipped(steady):
    part = identify(FILES[::2], PAPER.k, skip_cycles=5, frequency=3.5)
    cycles, fewer = ([r["cycles"] for r in of.document()["records"]] for of in (steady, part))
    assert [n - 5 for n in cycles] == fewer


@pytest.mark.parametrize(
    ("records", "options", "message"),
    [
        ([], {}, "no records are given"),
        ([FILES[0], FILES[0]], {}, "is named twice"),
        (FILES[:2], {"stiffness": "2310 N"}, "positive number of N/m, .*, got '2310 N'"),
        (FILES[:2], {"frequency": 7.0}, "level1.csv: the excitation oscillates"),
        (FILES[:2], {"mass": 0.0}, "mass must be a positive number of kg"),
        (FILES[:2], {"mass": 2.42e9}, "swings .* times in a cycle"),
        (FILES[:2], {"kind": "ring-down"}, "moves: this is no free decay"),
        (FILES[:2], {"kind": "forcd"}, r"one of recognised, .* \(did you mean forced\?\)"),
        (FILES[:2], {"mapping": 5}, "mapping must be what the channels hold, .*, got 5"),
        (FILES[:2], {"skip_cycles": -1}, "skip_cycles must be a whole number, 0 to .*, got -1"),
        (FILES[:2], {"terms": ["F_k", "d"]}, "'?d'?"),
    ],
)
def test_what_cannot_be_identified_is_refused_in_a_sentence(records, options, message):
    with pytest.raises(ValueError, match=message):
        identify(records, **{"stiffness": PAPER.k, **options})


# --- options: signatures are the documentation, and each kind refuses those of others --------------

K = PAPER.k
DECAY = measured_ring_down(DECAYING, x=0.012, rate_hz=500.0, duration=2.0, noise=0.001)
_T = np.arange(0.0, 8.0, 0.01)
_X, _F = np.cos(2.0 * math.pi * _T), np.clip(9.0 * np.cos(2.0 * math.pi * _T - 0.3), -5.0, 5.0)
SPEEDS = {"speed_rpm": [1, -1, 2, -2, 4, -4, 8, -8], "torque_N_m": [3, -3, 4, -4, 5, -5, 9, -9]}
RECORDS = {
    "forced": measured(rate_hz=500.0),
    "ring-down": DECAY,
    "stepped-sine": str(ROOT / "config/records/stepped/levels.csv"),
    "loops": {"time_s": _T, "displacement_mm": _X, "force_N": _F},
    "friction-speed": SPEEDS,
}
VALUES = {
    "frequency": 3.5,
    "terms": "F_k,c",
    "given": {"c": 90.0},
    "groups": {"F_k": "A,A,B"},
    "contact_to": "base",
    "fixture_mass": 0.1,
    "laws": True,
    "skip_cycles": 1,
    "pendulum": True,
    "contact": "gradual",
    "hardening": False,
    "residual": True,
    "normal_force": 5.0,
    "fixture_stiffness": 1e6,
    "backlash": False,
}
"""A value of each option that is not its default."""
TAKEN = {
    "forced": "frequency groups contact_to fixture_mass skip_cycles laws terms given",
    "ring-down": "pendulum laws",
    "stepped-sine": "terms given contact hardening residual",
    "loops": "skip_cycles normal_force fixture_stiffness backlash",
    "friction-speed": "",
}
MISPLACED = "is for .*, and these are .*: leave it out"


@pytest.mark.parametrize("kind", [*WAYS, "recognised"])
def test_signatures_write_out_the_options_of_the_table(kind):
    function = WAYS.get(kind, identify)
    named = [
        (name, eval(of.annotation, function.__globals__), of.default)
        for name, of in inspect.signature(function).parameters.items()
        if name in OPTIONS and name != "mapping"  # which may be a document, too
    ]
    # each has a stiffness, to say of some that there is none
    taken = [of for of in OPTIONS.values() if kind in (*of.kinds, "recognised")]
    taken = [OPTIONS["stiffness"], *(of for of in taken if of.name not in ("mapping", "stiffness"))]
    assert named == [(of.name, of.type, of.default) for of in taken]
    assert all(f"\n{name} : " in function.__doc__ for name, *_ in named[1:])


@pytest.mark.parametrize("kind", WAYS)
def test_each_kind_takes_its_options_and_refuses_others(kind):
    needs = {"stiffness": K} if kind in ("forced", "ring-down") else {}
    function = inspect.signature(WAYS[kind]).parameters
    for name, value in VALUES.items():
        wrong = dict(contradictions({"kind": kind, OPTIONS[name].key: value}))
        takes = name in TAKEN[kind].split()
        assert (name in function, OPTIONS[name].key in wrong) == (takes, not takes)
        if not takes:
            assert re.fullmatch(MISPLACED, wrong[OPTIONS[name].key])
            for stated in ("recognised", kind):
                with pytest.raises(ValueError, match=f"^{name} = .* {MISPLACED}$"):
                    identify(RECORDS[kind], kind=stated, **needs | {name: value})
    assert ("stiffness_N_per_m" in dict(contradictions({"kind": kind}))) == bool(needs)
    for given in {"stiffness": K}, {"mass": 2.0}:
        if kind in ("loops", "friction-speed"):
            with pytest.raises(ValueError, match=MISPLACED):
                identify(RECORDS[kind], kind=kind, **given)


def test_an_unknown_option_is_that_of_a_call_and_one_at_its_default_is_none():
    for function in (identify, *WAYS.values()):
        with pytest.raises(TypeError, match=r"'frequncy' \(did you mean frequency\?\)"):
            function(DECAY, frequncy=3.5)
    named = {name: OPTIONS[name].default for name in (*VALUES, "mass")}
    found, own = identify(DECAY, K, **named), identify_decays(DECAY, K)
    assert found.document() == own.document()
    assert found.mass == pytest.approx(DECAYING.m, rel=1e-3)  # noise of 0.1 %
    assert found.damping_ratio == pytest.approx(1.5 / (2 * math.sqrt(K * 2.0)), rel=0.1)


def test_a_configuration_has_every_argument():
    keys = read_case_schema()["properties"]["measured"]["items"]["properties"].keys()
    arguments = configured(dict.fromkeys(keys, 1.0) | {"kind": "forced"}).keys()
    assert {"records", "unknown", *arguments} == inspect.signature(identify).parameters.keys()


def test_completion_offers_what_a_user_needs(decay):
    offered = {name for name in dir(decay) if not name.startswith("_")}
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert {*re.findall(r"\bfound\.(\w+)", text), "to_frame", "document", "findings"} <= offered
    assert not offered & {"basis", "head", "hint", "odd", "rig", "unanswered"}


def test_what_no_fit_determines_is_nan():
    """Nothing slips: a linear oscillator, whose mass no fit of a slider determines."""
    still = measured((0.002, 0.004), 4.0, osc=replace(PAPER, F_k=0.0), rate_hz=500.0, noise=0.0)
    found = identify_forced(still, K)
    assert found.values["c"] == pytest.approx(90.0, rel=1e-6)
    assert all(map(math.isnan, (found.mass, found.natural_frequency, found.damping_ratio)))


def test_steady_orbits_are_those_of_an_oscillator():
    given = {"Y": 0.004, "omega": 22.0}
    with pytest.raises(ValueError, match="oscillator must be an Oscillator, got 5"):
        steady_orbits(5, **given)
    with pytest.raises(ValueError, match=r"m must be a positive number of kg, .*got None"):
        steady_orbits(**given)
