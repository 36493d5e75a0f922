"""A study that cannot be run is refused in a sentence that names the file, the key and the remedy; and however odd a
study is, it is refused in one line each, or all that its rules make is made; nothing else happens."""

from __future__ import annotations

import copy
import warnings

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from dampbalance.figures.style import save
from dampbalance.project.documents import ConfigurationError
from dampbalance.studies import case_files, cases, evaluate, reading_study
from dampbalance.studies.shown import summary
from dampbalance.studies.shown.study_figure import alternative_text, study_figure
from studies.documents import DOCUMENTS, REFUSALS, document

SOUND = {name: DOCUMENTS[name] for name in ("curves", "map", "steps", "scatter")}
TEXTS = ["<script>alert(1)</script>", "a | b", "$x$ $\\frac$", "`c`", "x" * 190, "two\nlines", ""]
NUMBERS = [0, -1, True, None, "x", [], {}, 1e-300, 1e300, 2**62, float("nan"), float("inf")]
NAMES = ["scheme", "phase", "case", "regime", "nowhere", "noise", "zeta", "K_z_over_k", ""]
RANGE = {"from": 1.0, "to": 2.0, "count": 3}
SAMPLE = {"method": "sobol", "seed": 2**62, "over": {"zeta": {"from": 0.1, "to": 0.9}}}
ODD = {
    ("title",): TEXTS,
    ("axes",): [[{"sample": SAMPLE | {"count": count}}] for count in (4, 2**40)],
    ("axes", 0): [{name: RANGE} for name in NAMES],
    ("axes", 1): [{"zeta": {"values": [odd, 1.0]}} for odd in NUMBERS],
    ("figure", "x"): NAMES,
    ("figure", "panels"): NAMES,
    ("figure", "kind"): ["curves", "map", "scatter"],
    ("figure", "marks"): [[{text: at}] for text in (*TEXTS, 1, True) for at in (50.0, -5.0, 1e300)],
    ("levels_m",): [[0.004, 0.004 * (1 + 1e-12)], [1e-300, 1e300]],
    ("chunk_cases",): [10**9, 1],
    ("summary_by",): [[name] for name in NAMES],
    ("read_out", "X_decimals"): NUMBERS,
    ("base",): [{"c_N_s_per_m": 1e300}, {"K_z_N_per_m": 1e-300, "F_k_N": 2**62}],
    ("route", "cycles"): [*NUMBERS, 10**5],
}
"""Key → what a study may hold there, most of it odd."""

EDITS = st.one_of(*(st.tuples(st.just(key), st.sampled_from(odd)) for key, odd in ODD.items()))


def built(study, folder) -> str:
    """Everything that the rules make of a study; returns its page."""
    chunks = []
    for number in range(cases.size_of(study).chunks):
        chunks.append(folder / f"{number:05d}.parquet")
        parts = evaluate.in_parts(study, *cases.chunk_bounds(study, number), threads=1)
        case_files.write_parts(chunks[-1], parts, study, "0")
    file = folder / "cases.parquet"
    case_files.join_chunks(file, chunks, study)
    case_files.write_manifest(folder / "manifest.json", file, study, "0")
    if study.figure:
        drawn = folder / "a.svg", folder / "a.png"
        save(study_figure(study, file), *drawn, alternative_text(study))
    return summary.summary_markdown(study, summary.summary_of(file, study), "", "figure.png")


@settings(max_examples=300)
@given(name=st.sampled_from([*SOUND]), edits=st.lists(EDITS, max_size=3))
def test_many_are_refused_or_made(tmp_path_factory, name, edits):
    folder = tmp_path_factory.mktemp("study")
    changed, file, refusal = {"title": "Test"} | copy.deepcopy(SOUND[name]), folder / "s.yaml", ""
    for (*sections, key), odd in edits:
        within = changed
        for section in sections:
            within = within.setdefault(section, {})
        if isinstance(within, dict) or len(within) > key:
            within[key] = odd
    file.write_text(yaml.safe_dump(changed), encoding="utf-8")
    try:
        study = reading_study.read_study(file)
        cases.check_size(study, cases.size_of(study), folder, file)
    except ConfigurationError as error:
        refusal = str(error)
    for line in refusal.splitlines():
        assert line.startswith((str(file), "…"))
        assert len(line) <= 300
    if not refusal:
        assert study.cases <= 20_000  # what these draws can ask for at most; the rest is refused
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # numbers that do not exist, axes without extent
            page = built(study, folder)
        assert "<script" not in page.replace("\\<", "")


@pytest.mark.parametrize("kind", ["map", "scatter"])
def test_the_studies_that_the_draws_start_from_are_sound(tmp_path, make, kind):
    assert built(make(SOUND[kind]), tmp_path).startswith("# Test")


@pytest.mark.parametrize(("name", "change", "words"), REFUSALS)
def test_a_wrong_study_is_refused_in_one_sentence(make, name, change, words):
    with pytest.raises(ConfigurationError) as caught:
        make(document(name, **change))
    assert words in str(caught.value)
    assert str(caught.value).count("test.yaml: ") == len(str(caught.value).splitlines())
