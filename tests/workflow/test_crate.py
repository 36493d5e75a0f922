"""The crates of a case and of an archive: valid by the profiles' own validator, and true to what was run.

The small case is put under version control first: the date of a crate that was never released is that of the commit.
"""

from __future__ import annotations

import json
import shutil
import tarfile
from datetime import UTC, datetime
from urllib.parse import unquote

import pytest
from rocrate.rocrate import ROCrate

from dampbalance import __version__
from dampbalance.project.files import sha256
from folders import contents
from processes import git
from workflow.copies import SMALL
from workflow.validating import issues

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        shutil.which("git") is None, reason="git is not installed: a crate lacks its date"
    ),
]

RESULTS = "results/small"
METADATA = "ro-crate-metadata.json"
NAME = f"dampbalance-{__version__}-small"

# What the profiles recommend and a crate here does not have, with the reason.
NO_ADDRESS = "The SoftwareApplication id SHOULD be an absolute URI"
"""The sources have no address on the web, and that of the workflow must be its place in the crate."""
NO_TIME = "The Action SHOULD have an endTime in ISO 8601 format"
"""The same inputs give the same bytes of the case's crate. That of the archive is of one run, and has the times."""
NO_README = {
    "The README.md SHOULD be about the crate",
    "The README.md SHOULD have text/markdown as its encodingFormat",
}
"""One README, results/README.md, says what the results of every case mean."""


@pytest.fixture(scope="module")
def committed(built):
    git(built.folder, "init", "--quiet")
    git(built.folder, "add", "--all")
    git(built.folder, "commit", "--quiet", "--message=all", "--date=2001-02-03T12:00:00Z")
    built.made("archive", *SMALL)
    return built


@pytest.fixture(scope="module")
def case(committed):
    return committed.folder / RESULTS


@pytest.fixture(scope="module")
def unpacked(committed, tmp_path_factory):
    folder = tmp_path_factory.mktemp("elsewhere")
    with tarfile.open(committed.folder / f"results/archive/{NAME}.tar.gz") as tar:
        tar.extractall(folder, filter="data")
    return folder / NAME


@pytest.fixture(params=["case", "unpacked"])
def folder(request):
    return request.getfixturevalue(request.param)


@pytest.fixture
def graph(folder):
    return entities(folder)


def entities(folder):
    """The entities of a crate by their names."""
    return {entity["@id"]: entity for entity in read(folder)["@graph"]}


def read(folder):
    return json.loads((folder / METADATA).read_text(encoding="utf-8"))


def names(value):
    """The names that a property refers to, one or several."""
    return [item["@id"] for item in (value if isinstance(value, list) else [value])]


def references(value):
    """The names that stand anywhere in a property, an entity or several."""
    if isinstance(value, dict):
        if set(value) == {"@id"}:
            yield value["@id"]
        for item in value.values():
            yield from references(item)
    elif isinstance(value, list):
        for item in value:
            yield from references(item)


def of_type(graph, kind):
    return [e for e in graph.values() if kind in e["@type"] or e["@type"] == kind]


# --- validity ------------------------------------------------------------------------------------


@pytest.fixture
def thinned(unpacked, tmp_path):
    """The archive with a crate that has one of the files that are described alike and no action names: the validator
    would look at each of eight hundred."""
    data, described = read(unpacked), {}
    graph = {entity["@id"]: entity for entity in data["@graph"]}
    named = set(references([entity for name, entity in graph.items() if name != "./"]))
    for name, entity in graph.items():
        if entity["@type"] == "File" and name not in named:
            kind = tuple(sorted(entity)), str(entity.get("encodingFormat"))
            described.setdefault(kind, []).append(name)
    left_out = {name for alike in described.values() for name in alike[1:]}
    assert len(left_out) > 500
    parts = graph["./"]["hasPart"]
    graph["./"]["hasPart"] = [part for part in parts if part["@id"] not in left_out]
    data["@graph"] = [entity for name, entity in graph.items() if name not in left_out]
    shutil.copytree(unpacked, tmp_path / "crate")
    (tmp_path / "crate" / METADATA).write_text(json.dumps(data), encoding="utf-8")
    return tmp_path / "crate"


def test_the_crate_of_a_case_lacks_no_more_than_it_says(case, tmp_path):
    found = issues(case, tmp_path / "cache")
    assert {message for _, message in found} == {NO_ADDRESS, NO_TIME, *NO_README}
    assert {severity for severity, _ in found} == {"RECOMMENDED"}


def test_the_crate_of_an_archive_lacks_an_address_on_the_web_and_nothing_else(thinned, tmp_path):
    assert set(issues(thinned, tmp_path / "cache")) == {("RECOMMENDED", NO_ADDRESS)}


BROKEN = [
    ("#run", "instrument", {"@id": "#step/tables"}, "MUST have an instrument"),
    ("#organisation", "object", None, "must reference the ControlAction instances"),
    ("#step/tables", "workExample", None, "must refer to its corresponding tool"),
    ("#parameter/case", "additionalType", None, "MUST have an additionalType"),
    ("./", "author", None, "SHOULD have a link to a Contextual Entity representing"),
]


def test_the_validator_sees_what_is_missing(thinned, tmp_path):
    data = read(thinned)
    graph = {entity["@id"]: entity for entity in data["@graph"]}
    for name, key, value, _ in BROKEN:
        assert graph[name].pop(key)
        if value:
            graph[name][key] = value
    (thinned / METADATA).write_text(json.dumps(data), encoding="utf-8")
    (thinned / "Snakefile").unlink()
    found = [message for _, message in issues(thinned, tmp_path / "cache")]
    for complaint in (*(row[-1] for row in BROKEN), "Main Workflow Snakefile not found in crate"):
        assert any(complaint in message for message in found), complaint


# --- files ---------------------------------------------------------------------------------------


def test_every_file_is_there_with_that_digest_and_size(folder):
    files = [e for e in ROCrate(folder).data_entities if "File" in e.type]
    without = []
    for entity in files:
        path = folder / unquote(entity.id)
        assert path.is_file(), entity.id
        if entity.get("sha256") is None:
            without.append(path.name)
        else:
            assert entity["sha256"] == sha256(path), entity.id
        assert int(entity.get("contentSize", path.stat().st_size)) == path.stat().st_size
    assert without == ["manifest.json"]  # names the machine


def test_every_result_of_the_case_is_in_its_crate(case):
    assert set(contents(case)) - {METADATA} <= {e.id for e in ROCrate(case).data_entities}


def test_every_file_of_the_archive_is_in_its_crate(unpacked):
    described = {unquote(e.id) for e in ROCrate(unpacked).data_entities}
    # the list of digests holds that of the metadata, and cannot be in it
    assert set(contents(unpacked)) - {METADATA, "SHA256SUMS"} == described


def test_every_reference_within_the_crate_is_answered(folder):
    data = read(folder)
    known = {entity["@id"] for entity in data["@graph"]}
    assert len(known) == len(data["@graph"])

    outside = {name for name in references(data["@graph"]) if name not in known}
    if folder.name == "small":
        outside.remove("../../CITATION.cff")  # lies where it says, is no input of a job
        assert (folder / "../../CITATION.cff").is_file()
    assert outside == {
        "https://w3id.org/ro/crate/1.1",
        "https://bioschemas.org/profiles/ComputationalWorkflow/1.0-RELEASE",
        "https://bioschemas.org/profiles/FormalParameter/1.0-RELEASE",
    }


# --- the run -------------------------------------------------------------------------------------


def test_an_action_leads_from_the_configuration_to_its_results(case):
    graph = entities(case)
    (action,) = [e for e in graph.values() if e.get("name") == "features_exact"][1:]
    assert set(names(action["result"])) == {
        "features/exact/above.csv",
        "features/exact/resonance.csv",
    }
    assert set(names(action["object"])) == {
        "orbits/above.json",
        "orbits/resonance.json",
        "../../config/config.yaml",
        "../../small.yaml",
    }
    tool = graph[action["instrument"]["@id"]]
    assert tool["name"] == "workflow/scripts/features/features_exact.py"
    assert tool["url"] == {"@id": "../../workflow/scripts/features/features_exact.py"}


def test_the_workflow_its_steps_and_their_tools_are_those_that_ran(graph, case):
    manifest = json.loads((case / "manifest.json").read_text(encoding="utf-8"))
    jobs = manifest["reproducible"]["jobs"]
    workflow = graph[graph["./"]["mainEntity"]["@id"]]
    assert workflow["@id"].endswith("Snakefile")
    steps = {graph[name]["name"]: graph[name] for name in names(workflow["step"])}
    assert set(steps) == {job["rule"] for job in jobs}
    for job in jobs:
        tool = steps[job["rule"]]["workExample"]
        assert graph[tool["@id"]]["name"] == job["script"]
        assert tool in workflow["hasPart"]


def test_steps_stand_in_an_order_in_which_they_can_run(graph):
    position = {e["name"]: int(e["position"]) for e in of_type(graph, "HowToStep")}
    assert sorted(position.values()) == list(range(1, len(position) + 1))
    order = ["simulate_exact", "features_exact", "estimate_exact", "tables"]
    assert sorted(order, key=position.get) == order


def test_the_engine_leads_to_every_job_through_the_steps(graph):
    (organised,) = of_type(graph, "OrganizeAction")
    assert graph[organised["instrument"]["@id"]]["name"] == "Snakemake"
    assert organised["result"] == {"@id": "#run"}
    controls = [graph[name] for name in names(organised["object"])]
    reached = [name for control in controls for name in names(control["object"])]
    jobs = {e["@id"] for e in of_type(graph, "CreateAction")} - {"#run"}
    assert sorted(reached) == sorted(jobs)
    for control in controls:
        rule = graph[control["instrument"]["@id"]]["name"]
        assert {graph[name]["name"] for name in names(control["object"])} == {rule}


def test_the_parameters_are_the_configuration_as_merged(graph):
    values = {e["name"]: e for e in of_type(graph, "PropertyValue")}
    assert values["case"]["value"] == "small"
    assert values["oscillator.m_kg"]["value"] == 2.42  # from config.yaml
    assert values["as_published.cycles"]["value"] == 6  # from small.yaml
    assert json.loads(values["estimation.pairs"]["value"]) == [[1, 2], [2, 3], [2, 4]]
    assert json.loads(values["published"]["value"]) is None
    kinds = {e["name"]: e["additionalType"] for e in of_type(graph, "FormalParameter")}
    assert kinds["oscillator.m_kg"] == "Number"
    assert kinds["as_published.cycles"] == "Integer"
    assert kinds["estimation.pairs"] == "PropertyValue"
    (run,) = [e for e in of_type(graph, "CreateAction") if e["@id"] == "#run"]
    assert {e["@id"] for e in values.values()} <= set(names(run["object"]))


def test_an_action_of_an_archive_ended_when_its_last_result_was_written(committed, unpacked):
    graph = entities(unpacked)
    actions = of_type(graph, "CreateAction")
    for action in actions:
        written = [committed.folder / unquote(name) for name in names(action["result"])]
        last = max(path.stat().st_mtime for path in written)
        assert datetime.fromisoformat(action["endTime"]) == datetime.fromtimestamp(int(last), UTC)
    assert max(action["endTime"] for action in actions) == graph["#run"]["endTime"]
