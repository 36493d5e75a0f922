"""A study that cannot be run is refused in a sentence that names the file, the key and the remedy; and however odd a
study is, it is refused in one line each, or all that its rules make is made; nothing else happens.

The studies are drawn by Hypothesis: a sound one of each kind, with up to three things in it that are not.
"""

from __future__ import annotations

import copy
import random
import warnings

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from dampbalance.figures.style import save
from dampbalance.project.documents import ConfigurationError
from dampbalance.studies import case_files, cases, evaluate, reading_study
from dampbalance.studies.shown import summary
from dampbalance.studies.shown.paragraph import paragraph
from dampbalance.studies.shown.study_figure import alternative_text, study_figure
from studies.documents import DOCUMENTS, REFUSALS, document

LONGEST = 300  # characters of a line
SOUND = {name: DOCUMENTS[name] for name in ("curves", "map", "steps", "scatter")}
TEXTS = ["<script>alert(1)</script>", "a | b", "$x$ $\\frac$", "$", "`c`", "x" * 190, "two\nlines", ""]  # fmt: skip
NUMBERS = [0, -1, True, None, "x", "", [], {}, 1e-300, 1e300, 2**62, float("nan"), float("inf")]
PLACES = [0.5, 50.0, -5.0, 1e300]
NAMES = ["scheme", "phase", "case", "regime", "nowhere", "noise", "zeta", "K_z_over_k", ""]


def of_axes(draw, study):
    block = draw.choice(study["axes"])
    name = draw.choice(list(block))
    values = [[draw.choice(NUMBERS), 1.0], [10**30, 10**18], [1.0], list(range(1, 15001))]
    ranges = [(1.0, 2.0, draw.choice([2, 10**5, 10**9, 2**62])), (1.0, 1.0 + 1e-15, 50), (0, 3, 10)]
    specs = [{"values": given} for given in values]
    specs += [{"from": low, "to": high, "count": count} for low, high, count in ranges]
    specs += [{"from": 1e-300, "to": 1e300, "count": 3, "spacing": "log"}]
    block[name] = draw.choice(specs)


def of_sample(draw, study):
    ends = {"from": draw.choice([0.1, 1e-300]), "to": draw.choice([0.9, 1e300])}
    over = {draw.choice(NAMES): ends}
    count = draw.choice([4, 10**9, 2**40])
    study["axes"] = [{"sample": {"method": "sobol", "count": count, "seed": 2**62, "over": over}}]


def of_figure(draw, study):
    keys = {
        "x": NAMES,
        "y": NAMES,
        "panels": NAMES,
        "kind": ["curves", "map", "scatter"],
        "phase": ["fundamental"],
    }
    keys |= {"fit": ["pairs", "pair_1_2", "pair_9_9"], "contact": ["rigid"], "within": [1e300]}
    keys |= {"marks": [{draw.choice([*TEXTS, 1, True, "omega1"]): draw.choice(PLACES)}]}
    key = draw.choice(list(keys))
    study["figure"][key] = draw.choice(keys[key])


def of_text(draw, study):
    study["title"] = draw.choice(TEXTS)


def of_settings(draw, study):
    values = {
        "levels_m": [[0.004, 0.004 * (1 + 1e-12)], [1e-300, 1e300]],
        "levels_of_Y": [list(range(1, 2000))],
        "chunk_cases": [10**9, 1],
        "columns": [["errors", "intervals"], ["parameters"]],
        "summary_by": [[draw.choice(NAMES)]],
        "read_out": [{"X_decimals": 400}, {"t_s_unit_s": 1e-300}],
        "base": [{"c_N_s_per_m": 1e300}, {"K_z_N_per_m": 1e-300, "F_k_N": 2**62}],
        "estimation": [{"fits": [[1, 1]]}, {"fits": [[1, 9]]}],
        "route": [
            {"kind": "fixed_step", "scheme": "rk4", "step_s": 1e-12},
            {"kind": "sampled", "sampling_hz": 1e9},
            SOUND["scatter"]["route"] | {"noise": 0.0, "cycles": 10**5},
        ],
    }
    key = draw.choice(list(values))
    study[key] = draw.choice(values[key])


EDITS = (of_axes, of_sample, of_figure, of_figure, of_text, of_settings)


def drawn(draw: random.Random) -> dict:
    study = {"title": "Test"} | copy.deepcopy(SOUND[draw.choice(list(SOUND))])
    for _ in range(draw.choice([0, 1, 1, 2, 3])):
        draw.choice(EDITS)(draw, study)
    return study


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
        text = alternative_text(study)
        save(study_figure(study, file), folder / "a.svg", folder / "a.png", text)
    table = summary.summary_of(file, study)
    return summary.summary_markdown(study, table, paragraph(study, file)[0], "figure.png")


@settings(max_examples=15)
@given(draw=st.randoms())
def test_it_is_refused_or_made(tmp_path_factory, draw):
    refused_or_made(drawn(draw), tmp_path_factory.mktemp("study"))


@settings(max_examples=300)
@given(draw=st.randoms())
def test_many_are_refused_or_made(tmp_path_factory, draw):
    refused_or_made(drawn(draw), tmp_path_factory.mktemp("study"))


def refused_or_made(document, tmp_path):
    file = tmp_path / "study.yaml"
    text = yaml.safe_dump(document)
    file.write_text(text, encoding="utf-8")
    refusal = ""
    try:
        study = reading_study.read_study(file)
        cases.check_size(study, cases.size_of(study), tmp_path, file)
    except ConfigurationError as error:
        refusal = str(error)
    for line in refusal.splitlines():
        assert line.startswith((str(file), "…"))
        assert len(line) <= LONGEST
    if not refusal:
        assert study.cases <= 20_000  # what these draws can ask for at most; the rest is refused
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # numbers that do not exist, axes without extent
            page = built(study, tmp_path)
        assert "<script" not in page.replace("\\<", "")
    assert file.read_text(encoding="utf-8") == text


@pytest.mark.parametrize("kind", SOUND)
def test_the_studies_that_the_draws_start_from_are_sound(tmp_path, make, kind):
    assert built(make(SOUND[kind]), tmp_path).startswith("# Test")


@pytest.mark.parametrize(("name", "change", "words"), REFUSALS)
def test_a_wrong_study_is_refused_in_one_sentence(make, name, change, words):
    if words is None:
        make(document(name, **change))
        return
    with pytest.raises(ConfigurationError) as caught:
        make(document(name, **change))
    assert words in str(caught.value)
    assert str(caught.value).count("test.yaml: ") == len(str(caught.value).splitlines())
