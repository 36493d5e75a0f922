"""Describe an archive and the run that made its results as an RO-Crate, in the terms that data repositories read.

It follows RO-Crate 1.1 with the profiles Workflow RO-Crate 1.0 and Process, Workflow and Provenance Run Crate 0.5.

A step is a rule, its tool the script of the rule; each job is a CreateAction, from its inputs (object) by its tool
(instrument) to its outputs (result). The engine's OrganizeAction leads to one ControlAction for each step, and that to
the jobs of the step.

All recommendations of the profiles are followed, except that tools should have an address on the web, and the sources
have none. Without a release date and a commit there is no date of publication. The agent of the run is the author named
in the citation, who is responsible for the published results.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime
from graphlib import TopologicalSorter
from mimetypes import MimeTypes
from pathlib import Path
from typing import Any
from urllib.parse import quote

from rocrate.model import ContextEntity
from rocrate.rocrate import ROCrate

from ...project.files import sha256
from ...project.wording import dotted
from .manifest import author_name

PROFILES = {
    "https://w3id.org/ro/wfrun/process/0.5": "Process Run Crate",
    "https://w3id.org/ro/wfrun/workflow/0.5": "Workflow Run Crate",
    "https://w3id.org/ro/wfrun/provenance/0.5": "Provenance Run Crate",
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0": "Workflow RO-Crate",
}
RUN_TERMS = "https://w3id.org/ro/terms/workflow-run/context"
BIOSCHEMAS = "https://bioschemas.org/profiles/"
SNAKEMAKE_SITE = "https://snakemake.github.io"
WORKFLOW_FILE = "Snakefile"
_PARAMETER_TYPES = {bool: "Boolean", int: "Integer", float: "Number", str: "Text"}

# Everything else is text.
_FILE_TYPES = MimeTypes()
for _suffix, _type in {
    **{".md": "text/markdown", ".ipynb": "application/x-ipynb+json"},
    **{".parquet": "application/vnd.apache.parquet", ".yaml": "application/yaml"},
}.items():  # types that Python does not know
    _FILE_TYPES.add_type(_type, _suffix)


def crate(
    manifest: Mapping[str, Any],
    files: Mapping[str, Path],
    citation: Mapping[str, Any],
    ended: Mapping[str, float],
) -> ROCrate:
    """Return the crate of these files, whose `write` copies them to a folder, next to their description.

    manifest : from `manifest.manifest`.   files : names in the crate, and where the files are; jobs and actions are
    described as far as they made one of them.   citation : CITATION.cff.   ended : the time when each result was
    finished, s since 1970; an action without results here has no `endTime`.
    """
    made, run = manifest["reproducible"], manifest["run"]
    jobs = [
        {**job, "outputs": [file for file in job["outputs"] if file in files]}
        for job in made["jobs"]
        if not files.keys().isdisjoint(job["outputs"])
    ]
    version = run["packages"].get("snakemake")
    described = ROCrate(version="1.1")
    described.metadata.extra_contexts.append(RUN_TERMS)
    spdx = f"https://spdx.org/licenses/{citation['license']}"
    licence = _add(described, spdx, "CreativeWork", name=citation["license"], identifier=spdx)
    authors = [
        _add(
            described,
            author.get("orcid") or f"#author-{number}",
            "Organization" if "name" in author else "Person",
            name=author_name(author),
            url=author.get("website") or {"@id": "CITATION.cff"},
        )
        for number, author in enumerate(citation.get("authors", []), 1)
    ]
    scripts = {job["script"] for job in jobs}
    entities = _files(described, files, scripts, made["version"], version)
    keys, settings = _parameters(described, made["configuration"])

    def act(
        identifier: str, tool: str, inputs: Iterable[str], outputs: Sequence[str], **words: Any
    ) -> Any:
        """Add what a tool made of files; every job takes its parameters from the configuration."""
        read = {*inputs, *made["configuration_files"]} & entities.keys()
        times = [datetime.fromtimestamp(ended[file], UTC) for file in outputs if file in ended]
        return _add(
            described,
            identifier,
            "CreateAction",
            instrument=entities[tool],
            agent=authors,
            object=[entities[file] for file in sorted(read)]
            + (settings if tool == WORKFLOW_FILE else []),
            result=[entities[file] for file in outputs],
            endTime=max(times).isoformat(timespec="seconds") if times else None,
            **words,
        )

    outputs = [file for job in jobs for file in job["outputs"]]
    inputs = {file for job in jobs for file in job["inputs"]}.difference(outputs)
    count = f"Snakemake ran {len(jobs)} jobs, which made {len(outputs)} files."
    whole = act(
        "#run", WORKFLOW_FILE, inputs, outputs, name="The run of the workflow", description=count
    )
    acts: list[Any] = [whole]
    steps: list[Any] = []
    controls: list[Any] = []
    for position, (rule, script) in enumerate(_rules(jobs).items(), start=1):
        step = _add(described, f"#step/{quote(rule)}", "HowToStep", name=rule)
        step["position"], step["workExample"] = str(position), entities[script]
        parts = [
            act(
                f"#job/{quote(min(job['outputs']))}",
                script,
                job["inputs"],
                job["outputs"],
                name=rule,
                description=f"Rule {rule}: {script} made {', '.join(job['outputs'])}.",
            )
            for job in jobs
            if job["rule"] == rule
        ]
        control = _add(described, f"#control/{quote(rule)}", "ControlAction", instrument=step)
        control["name"], control["object"] = f"Snakemake ran the jobs of rule {rule}", parts
        acts += parts
        steps.append(step)
        controls.append(control)
    organised = _add(
        described,
        "#organisation",
        "OrganizeAction",
        name="Snakemake organised the run",
        instrument=_add(
            described,
            SNAKEMAKE_SITE,
            "SoftwareApplication",
            name="Snakemake",
            url=SNAKEMAKE_SITE,
            softwareVersion=version,
        ),
        agent=authors,
        object=controls,
        result=whole,
        endTime=whole["endTime"],
    )
    published = citation.get("date-released") or run["code"].get("committed")
    common = {"license": licence, "author": authors}
    workflow = {
        **common,
        "name": "dampbalance",
        "description": _code(run["code"]),
        "conformsTo": {"@id": f"{BIOSCHEMAS}ComputationalWorkflow/1.0-RELEASE"},
        "input": keys,
        "step": steps,
        "hasPart": [entities[script] for script in sorted(scripts)],
    }
    top = {
        **common,
        "name": f"{citation['title']}: case '{made['case']}'",
        "description": citation["abstract"],
        "keywords": ", ".join(citation.get("keywords", [])),
        "publisher": [author for author in authors if author.type == "Organization"],
        "datePublished": published and str(published),
        "conformsTo": [
            _add(described, address, "CreativeWork", name=name, version=address.rpartition("/")[2])
            for address, name in PROFILES.items()
        ],
        "mentions": [*acts, organised],
    }
    for entity, properties in ((entities[WORKFLOW_FILE], workflow), (described.root_dataset, top)):
        for key, value in properties.items():
            entity[key] = value
    for properties in (entity.properties() for entity in described.get_entities()):
        for key, value in list(properties.items()):
            if value in (None, []):
                del properties[key]
            elif isinstance(value, list) and len(value) == 1:  # stands as its item
                (properties[key],) = value
    return described


def _add(described: ROCrate, identifier: str, kind: str, /, **properties: Any) -> Any:
    return described.add(ContextEntity(described, identifier, {"@type": kind, **properties}))


def _files(
    described: ROCrate, files: Mapping[str, Path], scripts: set[str], version: str, engine: str
) -> dict[str, Any]:
    """Add the files, with their digests; scripts and the workflow are code.   version, engine : of code and engine."""
    entities = {}
    for name, path in sorted(files.items()):
        properties: dict[str, Any] = {
            "name": name,
            "encodingFormat": _FILE_TYPES.guess_type(name)[0] or "text/plain",
            "sha256": sha256(path),
        }
        code = {"url": {"@id": quote(name)}, "version": version}
        given: dict[str, Any] = {"record_size": True, "properties": properties}
        if name == WORKFLOW_FILE:
            kinds = ["File", "SoftwareSourceCode", "ComputationalWorkflow", "HowTo"]
            properties |= {"@type": kinds, **code}
            language = {"main": True, "lang": "snakemake", "lang_version": engine}
            entities[name] = described.add_workflow(path, name, **language, **given)
            continue
        if name in scripts:
            kinds = ["File", "SoftwareSourceCode"]
            properties |= {"@type": kinds, "programmingLanguage": "Python", **code}
        elif name == "README.md":
            properties |= {"about": {"@id": "./"}}
        entities[name] = described.add_file(path, name, **given)
    return entities


def _parameters(
    described: ROCrate, configuration: Mapping[str, Any]
) -> tuple[list[Any], list[Any]]:
    """Add the keys of a configuration, joined by dots, and their values; what is no number, text or truth value is
    written as JSON."""
    keys, settings = [], []
    for name, value in dotted(configuration):
        kind = _PARAMETER_TYPES.get(type(value))
        identifier = f"#parameter/{quote(name)}"
        key = described.add_formal_parameter(name, kind or "PropertyValue", identifier)
        setting = _add(described, f"#value/{quote(name)}", "PropertyValue", name=name)
        setting["value"], setting["exampleOfWork"] = value if kind else json.dumps(value), key
        key["workExample"] = setting
        keys.append(key)
        settings.append(setting)
    return keys, settings


def _code(code: Mapping[str, Any]) -> str:
    if not code.get("commit"):
        return "Commit unknown; the digests of the sources are in the manifest."
    changed = ", with changes; their digests are in the manifest" if code.get("modified") else ""
    return f"Commit {code['commit']}{changed}."


def _rules(jobs: Sequence[Mapping[str, Any]]) -> dict[str, str]:
    """Return the rules of the jobs and their scripts, each after those whose outputs its first job reads."""
    maker = {file: number for number, job in enumerate(jobs) for file in job["outputs"]}
    needs = {
        number: [maker[file] for file in job["inputs"] if file in maker]
        for number, job in enumerate(jobs)
    }
    order = (jobs[number] for number in TopologicalSorter(needs).static_order())
    return {job["rule"]: job["script"] for job in order}
