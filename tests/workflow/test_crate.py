"""The crate of an archive: valid by the profiles' own validator, and true to what was run.

The small case is put under version control first: the date of a crate that was never released is that of the commit.
"""

from __future__ import annotations

import json
import shutil
from datetime import UTC, datetime
from urllib.parse import unquote

import pytest
from rocrate.rocrate import ROCrate

from dampbalance.project.files import sha256
from folders import contents
from processes import git
from workflow.copies import ARCHIVE, SMALL, unpacked_archive
from workflow.validating import issues

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        shutil.which("git") is None, reason="git is not installed: a crate lacks its date"
    ),
]

METADATA = "ro-crate-metadata.json"
NO_ADDRESS = "The SoftwareApplication id SHOULD be an absolute URI"
"""The sources have no address on the web, and that of the workflow must be its place in the crate."""


@pytest.fixture(scope="module")
def committed(built):
    git(built.folder, "init", "--quiet")
    git(built.folder, "add", "--all")
    git(built.folder, "commit", "--quiet", "--message=all")
    built.made("archive", *SMALL)
    return built


@pytest.fixture(scope="module")
def folder(committed, tmp_path_factory):
    return unpacked_archive(committed.folder / ARCHIVE, tmp_path_factory.mktemp("crate"))


def described(folder):
    """The description, and its entities by their names."""
    data = json.loads((folder / METADATA).read_text(encoding="utf-8"))
    return data, {entity["@id"]: entity for entity in data["@graph"]}


@pytest.fixture
def graph(folder):
    return described(folder)[1]


def names(value):
    """The names that a property refers to, one or several."""
    return [item["@id"] for item in (value if isinstance(value, list) else [value])]


def references(value):
    """The names that stand anywhere in a property, an entity or several."""
    if isinstance(value, dict):
        if set(value) == {"@id"}:
            yield value["@id"]
        value = [*value.values()]
    if isinstance(value, list):
        for item in value:
            yield from references(item)


def of_type(graph, kind):
    return [e for e in graph.values() if kind in e["@type"] or e["@type"] == kind]


BROKEN = [
    ("#run", "instrument", {"@id": "#step/tables"}, "MUST have an instrument"),
    ("#organisation", "object", None, "must reference the ControlAction instances"),
    ("#step/tables", "workExample", None, "must refer to its corresponding tool"),
    ("#parameter/case", "additionalType", None, "MUST have an additionalType"),
    ("./", "author", None, "SHOULD have a link to a Contextual Entity representing"),
]


def test_it_lacks_an_address_on_the_web_and_the_validator_sees_what_else_could_be_missing(
    folder, tmp_path
):
    """In a crate that has one of the files that are described alike and no action names: the validator would look at
    each of eight hundred."""
    (data, graph), alike = described(folder), {}
    named = set(references([entity for name, entity in graph.items() if name != "./"]))
    for name, entity in graph.items():
        if entity["@type"] == "File" and name not in named:
            alike.setdefault((*sorted(entity), entity["encodingFormat"]), []).append(name)
    left_out = {name for group in alike.values() for name in group[1:]}
    assert len(left_out) > 500
    parts = graph["./"]["hasPart"]
    graph["./"]["hasPart"] = [part for part in parts if part["@id"] not in left_out]
    data["@graph"] = [entity for name, entity in graph.items() if name not in left_out]
    thinned = tmp_path / "crate"
    shutil.copytree(folder, thinned)
    (thinned / METADATA).write_text(json.dumps(data), encoding="utf-8")
    assert set(issues(thinned, tmp_path / "cache")) == {("RECOMMENDED", NO_ADDRESS)}

    for name, key, value, _ in BROKEN:
        assert graph[name].pop(key)
        graph[name] |= {key: value} if value else {}
    (thinned / METADATA).write_text(json.dumps(data), encoding="utf-8")
    (thinned / "Snakefile").unlink()
    found = [message for _, message in issues(thinned, tmp_path / "cache")]
    for complaint in (*(row[-1] for row in BROKEN), "Main Workflow Snakefile not found in crate"):
        assert any(complaint in message for message in found), complaint


def test_every_file_is_in_it_with_its_digest_and_size(folder):
    files = {unquote(entity.id): entity for entity in ROCrate(folder).data_entities}
    # the list of digests holds that of the metadata, and cannot be in it
    assert set(contents(folder)) - {METADATA, "SHA256SUMS"} == set(files)
    for name, entity in files.items():
        assert entity["sha256"] == sha256(folder / name), name
        assert int(entity["contentSize"]) == (folder / name).stat().st_size


def test_every_reference_within_it_is_answered(folder):
    data, graph = described(folder)
    assert len(graph) == len(data["@graph"])
    assert {name for name in references(data["@graph"]) if name not in graph} == {
        "https://w3id.org/ro/crate/1.1",
        "https://bioschemas.org/profiles/ComputationalWorkflow/1.0-RELEASE",
        "https://bioschemas.org/profiles/FormalParameter/1.0-RELEASE",
        "https://doi.org/10.1093/bioinformatics/bts480",
        "https://snakemake.readthedocs.io",
    }


def test_an_action_leads_from_the_configuration_to_its_results(graph):
    (action,) = [a for a in of_type(graph, "CreateAction") if a["name"] == "features_exact"]
    made = {f"results/small/features/exact/{name}.csv" for name in ("above", "resonance")}
    assert set(names(action["result"])) == made
    read = {f"results/small/orbits/{name}.json" for name in ("above", "resonance")}
    assert set(names(action["object"])) == read | {"config/config.yaml", "small.yaml"}
    assert action["instrument"] == {"@id": "workflow/scripts/features/features_exact.py"}


def test_the_workflow_its_steps_and_their_tools_are_those_that_ran(folder, graph):
    manifest = json.loads((folder / "results/small/manifest.json").read_text(encoding="utf-8"))
    jobs = manifest["reproducible"]["jobs"]
    workflow = graph[graph["./"]["mainEntity"]["@id"]]
    assert workflow["@id"] == "Snakefile"
    steps = {graph[name]["name"]: graph[name] for name in names(workflow["step"])}
    assert set(steps) == {job["rule"] for job in jobs}
    for job in jobs:
        tool = steps[job["rule"]]["workExample"]
        assert graph[tool["@id"]]["name"] == job["script"]
        assert tool in workflow["hasPart"]
    position = {name: int(step["position"]) for name, step in steps.items()}
    assert sorted(position.values()) == list(range(1, len(position) + 1))
    order = ["simulate_exact", "features_exact", "estimate_exact", "tables"]
    assert sorted(order, key=position.get) == order

    (organised,) = of_type(graph, "OrganizeAction")
    assert graph[organised["instrument"]["@id"]]["name"] == "Snakemake"
    assert organised["result"] == {"@id": "#run"}
    controls = [graph[name] for name in names(organised["object"])]
    reached = [name for control in controls for name in names(control["object"])]
    assert sorted(reached) == sorted({e["@id"] for e in of_type(graph, "CreateAction")} - {"#run"})
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
    assert {e["@id"] for e in values.values()} <= set(names(graph["#run"]["object"]))


def test_an_action_ended_when_its_last_result_was_written(committed, graph):
    actions = of_type(graph, "CreateAction")
    for action in actions:
        written = [committed.folder / unquote(name) for name in names(action["result"])]
        last = max(path.stat().st_mtime for path in written)
        assert datetime.fromisoformat(action["endTime"]) == datetime.fromtimestamp(int(last), UTC)
    assert max(action["endTime"] for action in actions) == graph["#run"]["endTime"]
