"""What an edit reruns: every job whose results it changes, and no other of its own accord; and no result is left that a
build from nothing would not give. The small case, with studies of its oscillator."""

from __future__ import annotations

import copy
import functools
import re
import shutil
from hashlib import sha256
from typing import Any

import pytest
import yaml
from snakemake.utils import update_config

from dampbalance.studies.reading_study import read_study
from dampbalance.studies.study_file import paper_defaults
from folders import ROOT, restored
from workflow.copies import SMALL, copied
from workflow.jobs import case_jobs, run

pytestmark = pytest.mark.slow

BASE = "config/config.yaml"
OVERRIDING = ROOT / "tests/workflow/small.yaml"
DAILY = ("level", "damping")  # c is taken from the configuration, and set by an axis
EVERY = tuple(sorted(path.stem for path in (ROOT / "config/studies").glob("*.yaml")))

CHANGED: dict[str, Any] = {
    "oscillator.m_kg": 2.5,
    "oscillator.c_N_s_per_m": 45.0,
    "oscillator.k_N_per_m": 2400.0,
    "oscillator.K_z_N_per_m": 150000.0,
    "oscillator.F_k_N": 1.1,
    "excitation.frequencies": [{"name": "resonance", "hz": 5.0}, {"name": "above", "hz": 9.0}],
    "excitation.levels_m": [0.0001, 0.004, 0.008, 0.013],
    "estimation.pairs": [[1, 2], [2, 3], [3, 4]],
    "estimation.phase": "fundamental",
    "as_published.scheme": "trapezoidal",
    "as_published.step_s": 2.5e-5,
    "as_published.cycles": 7,
    "as_published.c_over_m_decimals": 1,
    "as_published.k_over_m_decimals": 1,
    "as_published.slip_samples": [3, 3, 3, 3, 3],
    "as_published.tabulated.X_decimals": 4,
    "as_published.tabulated.X_s_decimals": 4,
    "as_published.tabulated.V_s_decimals": 3,
    "as_published.tabulated.phi_decimals": 2,
    "as_published.tabulated.t_s_inset_s": 1.0e-3,
    "as_published.tabulated.t_s_unit_s": 1.0e-3,
    "as_published.two_point.X_decimals": 4,
    "as_published.two_point.X_s_mark_m": 1.0e-5,
    "as_published.two_point.t_s_inset_s": 1.0e-3,
    "as_published.two_point.t_s_unit_s": 1.0e-3,
    "as_published.two_point.common_phi_decimals": 2,
    "as_published.two_point.common_t_s_decimals": 3,
}
"""Another value for every key of the configuration except names of files and folders."""

NAMES = {"case", "published"}

FILES = {
    "Exact responses": ("orbits/*", "features/exact/*"),
    "Responses as published, by fixed steps": ("records/*", "features/as_published/**/*"),
    "Estimates from the features of the route exact": ("estimates/exact/*",),
    "Estimates from the features of the route as_published": ("estimates/as_published/*",),
    "Numbers of all routes": ("numbers.csv",),
    "Tables": ("tables/*",),
}
"""Message of a job → its results."""


def leaves(section, *parents):
    """The keys of a configuration, as a.b.c."""
    for key, value in section.items():
        if isinstance(value, dict):
            yield from leaves(value, *parents, key)
        else:
            yield ".".join((*parents, key))


def replaced(document, key, value):
    """The document with another value at a key a.b.c."""
    document = copy.deepcopy(document)
    *parents, last = key.split(".")
    section = functools.reduce(lambda part, name: part.setdefault(name, {}), parents, document)
    section[last] = value
    return document


def dump(path, document):
    path.write_text(yaml.safe_dump(document, allow_unicode=True, sort_keys=False), encoding="utf-8")


def shrunken(copy, names):
    """Put small variants of studies in place of the shipped ones."""
    for name in names:
        own = yaml.safe_load((ROOT / f"tests/workflow/studies/{name}.yaml").read_text("utf-8"))
        path = copy.folder / f"config/studies/{name}.yaml"
        dump(path, yaml.safe_load(path.read_text("utf-8")) | own)
    shutil.copy2(OVERRIDING, copy.folder)
    return copy


def targets(names):
    return ["tables", *(f"results/small/studies/{name}/summary.md" for name in names)]


@pytest.fixture(scope="module")
def made(checkout):
    """Makes the small case with some of the studies, once."""

    @functools.cache
    def make(names):
        copy = shrunken(checkout(), names)
        copy.made(*SMALL, "--", *targets(names))
        return copy

    return make


def jobs_of(copy, names):
    """Message → reason of each job that a run would start."""
    said = copy.made("--dry-run", *SMALL, "--", *targets(names))
    return dict(re.findall(r"^Job \d+: (.*)\nReason: (.*)", said, re.MULTILINE))


def digest(files):
    return sha256(
        b"".join(path.read_bytes() for path in sorted(files) if path.is_file())
    ).hexdigest()


def of_case(config, folder):
    """Message of each job → what its results are, computed without Snakemake."""
    case_jobs(config, folder)
    return {
        job: digest(file for pattern in patterns for file in folder.glob(pattern))
        for job, patterns in FILES.items()
    }


def of_study(copy, config, name, folder):
    """The same of a study, which is made by one job, or in chunks, drawn and told by jobs of their own."""
    file, paper = copy.folder / f"config/studies/{name}.yaml", paper_defaults(config)
    made = {of: folder / f"figure.{of}" for of in ("svg", "png")}
    made |= {of: folder / f"summary.{of}" for of in ("csv", "md")}
    made |= {"cases": folder / "cases.parquet", "manifest": folder / "manifest.json"}
    run("studies/study.py", output=made, params={"file": file, "paper": paper})
    study = read_study(file, paper)
    jobs = {WHOLE: made} if study.cases <= study.chunk_cases else PARTS
    return {f"Study {name}: {job}": digest(made[of] for of in files) for job, files in jobs.items()}


WHOLE = "cases, figure and summary"
PARTS = {
    "all cases in one file": ("cases", "manifest"),
    "figure": ("svg", "png"),
    "summary": ("csv", "md"),
}


def compared(copy, names, truths, excused=()):
    """Compare the jobs of a dry run with those whose results differ."""
    before, after = truths
    changed = {job for job in after if before.get(job) != after[job]}
    said = jobs_of(copy, names)
    assert changed <= said.keys(), "stale"
    # a job whose input is made anew cannot know whether it will be another one
    own = {job for job in said.keys() & before if "updated by another job" not in said[job]}
    assert own - changed - {*excused} == set(), "reruns without a reason"
    return changed


def small_config(folder):
    config = yaml.safe_load((folder / BASE).read_text("utf-8"))
    update_config(config, yaml.safe_load((folder / OVERRIDING.name).read_text("utf-8")))
    return config


def check_key(copy, names, key, tmp_path):
    """Change a key of the file that overrides the configuration, or of the configuration where it has no such key."""
    config = small_config(copy.folder)
    given = yaml.safe_load((copy.folder / OVERRIDING.name).read_text("utf-8"))
    file = copy.folder / (OVERRIDING.name if key in leaves(given) else BASE)
    truths = []
    for i, one in enumerate((config, replaced(config, key, CHANGED[key]))):
        folder = tmp_path / str(i)
        truths.append(of_case(one, folder))
        for name in names:
            (folder / name).mkdir()
            truths[-1] |= of_study(copy, one, name, folder / name)
    with restored(file):
        dump(file, replaced(yaml.safe_load(file.read_text("utf-8")), key, CHANGED[key]))
        assert compared(copy, names, truths), "the other value changes nothing"


def test_every_key_of_the_configuration_has_another_value():
    keys = set(leaves(yaml.safe_load((ROOT / BASE).read_text("utf-8"))))
    assert keys - NAMES == CHANGED.keys()


@pytest.mark.parametrize(
    "key", ["oscillator.c_N_s_per_m", "excitation.levels_m", "estimation.phase"]
)
def test_a_key_of_the_configuration_reruns_what_follows_from_it(made, key, tmp_path):
    check_key(made(DAILY), DAILY, key, tmp_path)


@pytest.mark.parametrize("key", CHANGED)
def test_each_key_of_the_configuration_reruns_what_follows_from_it(made, key, tmp_path):
    check_key(made(DAILY), DAILY, key, tmp_path)


# ---- The files of studies ---------------------------------------------------------------------------------------


PLACES = {  # on the x-axis of the figure of a study
    **{"Y_m": 0.01, "zeta": 0.1, "K_z_over_k": 10.0, "c_2_N_s2_per_m2": 10.0, "slip_range": 10.0},
    **{"X_decimals": 5.0, "frequency_hz": 5.0, "step_s": 2.0e-5, "noise": 0.01},
}


def another(key, value):
    """Another value of a key of a study's file, which leaves what its template asks for."""
    if key == "title":
        return f"{value}, again"
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


def check_study(copy, names, name, key, tmp_path):
    """Change a key of a study's file, or "text", its template."""
    config, file = small_config(copy.folder), copy.folder / f"config/studies/{name}.yaml"
    template, truths = file.with_suffix(".md.j2"), []
    with restored(file), restored(template):
        for i in range(2):
            folder = tmp_path / str(i)
            folder.mkdir()
            if i and key == "text":
                template.write_text(f"{template.read_text('utf-8')} So it is.", encoding="utf-8")
            elif i:
                document = yaml.safe_load(file.read_text("utf-8"))
                dump(file, document | {key: another(key, document[key])})
            truths.append(of_study(copy, config, name, folder))
        # what has a title or a text of its own is drawn and told again when the file changes
        shown = [f"Study {name}: {job}" for job in (WHOLE, "figure", "summary")]
        assert compared(copy, names, truths, shown)


@pytest.mark.parametrize("key", ["title", "axes", "text"])
def test_a_key_of_a_study_reruns_what_follows_from_it(made, key, tmp_path):
    check_study(made(DAILY), DAILY, "level", key, tmp_path)


@pytest.mark.parametrize(
    ("name", "key"),
    [
        (name, key)
        for name in EVERY
        for key in (
            *yaml.safe_load((ROOT / f"config/studies/{name}.yaml").read_text("utf-8")),
            "text",
        )
    ],
)
def test_each_key_of_a_study_reruns_what_follows_from_it(made, name, key, tmp_path):
    check_study(made(EVERY), EVERY, name, key, tmp_path)


# ---- Results after an edit --------------------------------------------------------------------------------------

F_K = ("small.yaml", "F_k_N: 1.0", "F_k_N: 1.1")
VERSION = ("src/dampbalance/__init__.py", '__version__ = "', '__version__ = "9.')
ROOMS = {
    "features": ("src/dampbalance/features.py", "+ 0.5 * np.pi)", "+ 0.5001 * np.pi)"),
    "balance": ("src/dampbalance/balance.py", "a=2.0 * (features.X - ", "a=2.01 * (features.X - "),
    "motion": ("src/dampbalance/motion/regime.py", "contact only sticks", "contact just sticks"),
    "studies": ("src/dampbalance/studies/cases.py", "counted from 0", "counted from zero"),
    "figures": ("src/dampbalance/figures/style.py", '"#E4E4E4"', '"#E3E3E3"'),
}


def edited(copy, edits):
    for file, old, new in edits:
        path = copy.folder / file
        text = path.read_text(encoding="utf-8")
        assert old in text
        path.write_text(text.replace(old, new, 1), encoding="utf-8")


def check_edits(made, checkout, tmp_path, edits, changes, more=()):
    """A build after edits equals one from nothing, and the edits do change it."""
    wanted = [*targets(["level"]), *more]
    after = copied(made.folder, tmp_path / "after", "small.yaml", "results/small", ".snakemake")
    before = after.files("small")
    clean = shrunken(checkout(), DAILY)
    for one in (after, clean):
        edited(one, edits)
        one.made(*SMALL, "--", *wanted)
    results, expected = after.files("small"), clean.files("small")
    assert [file for file in expected if results[file] != expected[file]] == []
    changed = {file for file, content in results.items() if before.get(file) != content}
    assert changes <= changed


def test_a_build_after_edits_is_one_from_nothing(made, checkout, tmp_path):
    """Of a file that overrides the configuration, of the version, and of two rooms."""
    edits = [F_K, VERSION, ROOMS["balance"], ROOMS["studies"]]
    changes = {
        f"studies/level/{file}" for file in ("cases.parquet", "manifest.json", "summary.csv")
    }
    changes |= {"tables/table3.csv", "estimates/exact/above.csv"}
    check_edits(made(DAILY), checkout, tmp_path, edits, changes)


@pytest.mark.parametrize(
    ("room", "file"),
    [
        ("features", "studies/level/summary.csv"),
        ("balance", "tables/approaches.csv"),
        ("motion", "features/exact/above.csv"),
        ("studies", "studies/level/manifest.json"),
        ("figures", "studies/level/figure.svg"),
    ],
)
def test_a_build_after_an_edit_in_a_room_is_one_from_nothing(made, checkout, tmp_path, room, file):
    check_edits(made(DAILY), checkout, tmp_path, [ROOMS[room]], {file})


def test_the_tour_follows_the_rooms_that_it_finds_through_the_face(made, checkout, tmp_path):
    """Such as `identification`, of which it imports nothing by name."""
    tour = "results/small/notebook/tour.ipynb"
    made(DAILY).made(*SMALL, "--", tour)
    edit = ("src/dampbalance/identification/screen.py", "If your rig", "Where your rig")
    check_edits(made(DAILY), checkout, tmp_path, [edit], {"notebook/tour.ipynb"}, [tour])
