"""What an edit reruns: every job whose results it changes, and no other of its own accord; and no result is left that a
build from nothing would not give. The small case, with studies of its oscillator."""

from __future__ import annotations

import copy
import functools
import math
import os
import shutil
from contextlib import ExitStack, contextmanager
from hashlib import sha256

import pytest

from dampbalance.studies.reading_study import read_study
from dampbalance.studies.study_file import paper_defaults
from folders import ROOT, restored
from workflow.copies import (
    DAILY,
    EVERY,
    SMALL,
    Checkout,
    configuration,
    dump,
    edited,
    read,
    small_case,
    summaries,
)
from workflow.jobs import case_jobs, run

pytestmark = pytest.mark.slow

BASE = "config/config.yaml"
PACKAGE = "src/dampbalance"


def leaves(section, *parents):
    """The keys of a configuration, as a.b.c, and their values."""
    for key, value in section.items():
        if isinstance(value, dict):
            yield from leaves(value, *parents, key)
        else:
            yield ".".join((*parents, key)), value


CHANGED = dict(leaves(read(ROOT / "tests/workflow/changed.yaml")))
"""Another value for every key of the configuration except names of files and folders."""

FILES = {
    "Exact responses": ("orbits/*", "features/exact/*"),
    "Responses as published, by fixed steps": ("records/*", "features/as_published/**/*"),
    "Estimates from the features of the route exact": ("estimates/exact/*",),
    "Estimates from the features of the route as_published": ("estimates/as_published/*",),
    "Numbers of all routes": ("numbers.csv",),
    "Tables": ("tables/*",),
}
"""Message of a job → its results."""

WHOLE = {"cases, figure and summary": ("*.*",)}
PARTS = {
    "all cases in one file": ("cases.parquet", "manifest.json"),
    "figure": ("figure.*",),
    "summary": ("summary.*",),
}
"""The same of a study, which is made by one job, or in chunks, drawn and told by jobs of their own."""


PLACES = {  # on the x-axis of the figure of a study
    **{"Y_m": 0.01, "zeta": 0.1, "K_z_over_k": 10.0, "c_2_N_s2_per_m2": 10.0, "slip_range": 10.0},
    **{"X_decimals": 5.0, "frequency_hz": 5.0, "step_s": 2.0e-5, "noise": 0.01},
}


def another(key, value):
    """Another value of a key of a study's file, which leaves what its template asks for."""
    if key == "axes":
        block = copy.deepcopy(value[0])
        (spec,) = block.values()
        if "sample" in block:
            spec["seed"] += 1
        elif "values" in spec:
            more = spec["values"][-1]
            spec["values"].append("semi-implicit-euler" if isinstance(more, str) else 1.01 * more)
        else:
            spec["to"] *= 1.01
        return [block, *value[1:]]
    if key == "estimation":
        if "terms" in value:  # three coefficients
            return {**value, "approaches": ["direct", "X_s", "t_s"]}
        return {**value, "fits": value.get("fits", ["least_squares", [1, 2], [1, 2]])[:-1]}
    changes = {
        "title": lambda: f"{value}, again",
        "levels_m": lambda: [*value[:-1], 1.01 * value[-1]],
        "levels_of_Y": lambda: [*value[:-1], 1.01 * value[-1]],
        "route": lambda: {**value, "cycles": value["cycles"] + 1},
        "columns": lambda: [*value, "estimates"],
        "chunk_cases": lambda: value + 1,
        "summary_by": lambda: value[::-1],
        "figure": lambda: (
            value | {"within": 0.02}
            if value["kind"] == "map"
            else value | {"lines": dict([*value["lines"].items()][:-1])}
            if value["kind"] == "scatter"
            else value | {"marks": {"here": PLACES[value["x"]]}}
        ),
    }
    return changes[key]()


@contextmanager
def changed(folder, of, key):
    """Another value of a key until the end: of a study's file, of its template ("text"), or of the configuration, which
    overrides that of the paper where it has the key."""
    if of != "configuration":
        file = folder / f"config/studies/{of}.yaml"
    else:
        file = folder / ("small.yaml" if key in dict(leaves(read(folder / "small.yaml"))) else BASE)
    file = file.with_suffix(".md.j2") if key == "text" else file
    with restored(file):
        if key == "text":
            file.write_text(f"{file.read_text('utf-8')} So it is.", encoding="utf-8")
        else:
            document = read(file)
            *parents, last = key.split(".") if of == "configuration" else [key]
            part = functools.reduce(lambda part, name: part.setdefault(name, {}), parents, document)
            part[last] = CHANGED[key] if of == "configuration" else another(key, part[last])
            dump(file, document)
        yield


def digests(folder, wanted):
    """Message of each job of the case and of studies → a digest of its results below a folder.   wanted : studies with
    whether they are made by one job."""
    files = {job: [folder, *patterns] for job, patterns in FILES.items()}
    for name, whole in wanted.items():
        for job, patterns in (WHOLE if whole else PARTS).items():
            files[f"Study {name}: {job}"] = [folder / "studies" / name, *patterns]
    return {
        job: sha256(b"".join(p.read_bytes() for p in found if p.is_file())).hexdigest()
        for job, (top, *patterns) in files.items()
        if (found := sorted(path for pattern in patterns for path in top.glob(pattern)))
    }


def check(built, edits, folder, studies):
    """Compare the jobs of a dry run after edits, (of what, key), with those whose results differ when the scripts are
    run without Snakemake."""
    with ExitStack() as made:
        for of, key in edits:
            made.enter_context(changed(built.folder, of, key))
        said = built.jobs(*SMALL, "--", "tables", *summaries(studies))
        config, wanted = configuration(built.folder), {}
        paper = paper_defaults(config)
        if "configuration" in dict(edits):
            case_jobs(config, folder)
        for name in studies:
            file, own = built.folder / f"config/studies/{name}.yaml", folder / "studies" / name
            own.mkdir(parents=True)
            output = {of: own / f"figure.{of}" for of in ("svg", "png")}
            output |= {of: own / f"summary.{of}" for of in ("csv", "md")}
            output |= {"cases": own / "cases.parquet", "manifest": own / "manifest.json"}
            study, params = read_study(file, paper), {"file": file, "paper": paper}
            wanted[name] = study.cases <= study.chunk_cases
            count = 0 if wanted[name] else math.ceil(study.cases / study.chunk_cases)
            chunks = [own / f"{i}.chunk" for i in range(count)]
            for i, chunk in enumerate(chunks):
                of = {"output": {"chunk": chunk}, "wildcards": {"chunk": i}, "params": params}
                run("studies/study_chunk.py", **of)
            run("studies/study.py", input={"chunks": chunks}, output=output, params=params)
    before, after = digests(built.folder / "results/small", wanted), digests(folder, wanted)
    different = {job for job in after if before[job] != after[job]}
    assert different <= said.keys(), "stale"
    # a job whose input is made anew cannot know whether it will be another one
    own = {job for job in said.keys() & before if "updated by another job" not in said[job]}
    # what has a title or a text of its own is drawn and told again when its file changes
    files = {of for of, _ in edits} - {"configuration"}
    shown = {f"Study {name}: {job}" for name in files for job in (*WHOLE, "figure", "summary")}
    assert own - different - shown == set(), "reruns without a reason"
    assert different or files, "the other value changes nothing"


def test_every_key_of_the_configuration_has_another_value():
    assert dict(leaves(read(ROOT / BASE))).keys() - {"case", "published"} == CHANGED.keys()


def test_an_edit_of_each_kind_of_file_reruns_what_follows_from_it(built, tmp_path):
    """Of a configuration, of a study, and of the template of another one."""
    edits = [("configuration", "estimation.pairs"), ("level", "axes"), ("damping", "text")]
    check(built, edits, tmp_path, DAILY)


def test_an_edit_in_a_room_or_script_reruns_what_depends_on_it_and_no_more(built):
    room, script = (
        f"{PACKAGE}/replication/rebuilt_tables.py",
        "workflow/scripts/estimates/estimate.py",
    )
    with ExitStack() as undone:
        for file in (room, script):
            undone.enter_context(edited(built.folder / file, {'"""': '"""Edited: '}))
        jobs = built.jobs(*SMALL)
    assert {*FILES} - jobs.keys() == {"Exact responses"}


@pytest.mark.parametrize("key", CHANGED)
def test_each_key_of_the_configuration_reruns_what_follows_from_it(built, key, tmp_path):
    check(built, [("configuration", key)], tmp_path, DAILY)


@pytest.mark.parametrize(
    ("name", "key"),
    [(of, key) for of in EVERY for key in (*read(ROOT / f"config/studies/{of}.yaml"), "text")],
)
def test_each_key_of_a_study_reruns_what_follows_from_it(studied, name, key, tmp_path):
    check(studied, [(name, key)], tmp_path, [name])


# ---- Results after an edit --------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def own(tmp_path_factory):
    """The small case with one of its studies, made with the package of a project of its own."""
    top = tmp_path_factory.mktemp("own")
    project = small_case(top / "project", DAILY).folder
    made = Checkout(top / "made", project)
    made.folder.mkdir()
    build(made)
    return made


def build(one):
    """Make tables and a study in the folder of a run, from the project beside it."""
    beside = os.path.relpath(one.package, one.folder)
    case = ("--snakefile", f"{beside}/Snakefile", "--configfile", f"{beside}/small.yaml")
    one.made(*case, "--", "tables", *summaries(["level"]))


@pytest.mark.parametrize(
    ("file", "old", "new", "differs"),
    [
        ("small.yaml", "F_k_N: 1.0", "F_k_N: 1.1", "cases.parquet"),
        (f"{PACKAGE}/__init__.py", '__version__ = "', '__version__ = "9.', "manifest.json"),
        (f"{PACKAGE}/features.py", "+ 0.5 * np.pi)", "+ 0.5001 * np.pi)", "summary.csv"),
        (f"{PACKAGE}/balance.py", "a=2.0 * (features.X", "a=2.01 * (features.X", "summary.csv"),
        (f"{PACKAGE}/motion/regime.py", "one slip onset", "one slip start", "manifest.json"),
        (f"{PACKAGE}/studies/cases.py", "counted from 0", "counted from zero", "manifest.json"),
        (f"{PACKAGE}/figures/style.py", '"#E4E4E4"', '"#E3E3E3"', "figure.svg"),
    ],
)
def test_a_build_after_an_edit_is_one_from_nothing(own, file, old, new, differs):
    after, clean = (
        Checkout(own.folder.with_name(name), own.package) for name in ("after", "clean")
    )
    shutil.copytree(own.folder, after.folder)
    clean.folder.mkdir()
    try:
        with edited(own.package / file, {old: new}):
            build(after)
            build(clean)
        results, expected, before = (one.files("small") for one in (after, clean, own))
    finally:
        shutil.rmtree(after.folder)
        shutil.rmtree(clean.folder)
    assert [name for name in expected if results[name] != expected[name]] == []
    assert results[f"studies/level/{differs}"] != before[f"studies/level/{differs}"]
