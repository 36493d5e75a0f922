"""Describes an archive and the run that made its results as an RO-Crate, in the terms that data repositories read.

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
ENGINE = "https://snakemake.github.io"
WORKFLOW_FILE = "Snakefile"
_PARAMETER_TYPES = {bool: "Boolean", int: "Integer", float: "Number", str: "Text"}

# Everything else is text.
_FILE_TYPES = MimeTypes()
for _suffix, _type in {
    **{".md": "text/markdown", ".ipynb": "application/x-ipynb+json"},
    **{".parquet": "application/vnd.apache.parquet", ".yaml": "application/yaml"},
}.items():  # what Python does not know
    _FILE_TYPES.add_type(_type, _suffix)


def crate(
    manifest: Mapping[str, Any],
    files: Mapping[str, Path],
    citation: Mapping[str, Any],
    ended: Mapping[str, float],
) -> ROCrate:
    """Returns the crate of these files, whose `write` copies them to a folder, next to their description.

    manifest : from `manifest.manifest`.   files : names in the crate, and where the files are; jobs and actions are
    described as far as they made one of them.   citation : CITATION.cff.   ended : the time when each result was
    finished, s since 1970; an action without results here has no `endTime`.
    """
    made, run = manifest["reproducible"], manifest["run"]
    jobs = [job for job in made["jobs"] if not files.keys().isdisjoint(job["outputs"])]
    described = ROCrate(version="1.1")
    described.metadata.extra_contexts.append(RUN_TERMS)

    def add(identifier: str, kind: str, /, **properties: Any) -> ContextEntity:
        given = {key: value for key, value in properties.items() if value not in (None, [])}
        return described.add(ContextEntity(described, identifier, {"@type": kind, **given}))

    spdx = f"https://spdx.org/licenses/{citation['license']}"
    licence = add(spdx, "CreativeWork", name=citation["license"], identifier=spdx)
    authors = [
        add(
            author.get("orcid") or f"#author-{number}",
            "Organization" if "name" in author else "Person",
            name=author_name(author),
            url=author.get("website") or {"@id": "CITATION.cff"},
        )
        for number, author in enumerate(citation.get("authors", []), 1)
    ]
    version = run["packages"].get("snakemake")
    engine = add(
        ENGINE, "SoftwareApplication", name="Snakemake", url=ENGINE, softwareVersion=version
    )
    keys, settings = [], []
    for name, value in dotted(made["configuration"]):
        kind = _PARAMETER_TYPES.get(type(value))
        text = value if kind else json.dumps(value)
        key = described.add_formal_parameter(
            name, kind or "PropertyValue", f"#parameter/{quote(name)}"
        )
        setting = add(
            f"#value/{quote(name)}", "PropertyValue", name=name, value=text, exampleOfWork=key
        )
        key["workExample"] = setting
        keys.append(key)
        settings.append(setting)

    entities = {}
    scripts = {job["script"] for job in jobs}
    for name in sorted(files):
        properties: dict[str, Any] = {
            "name": name,
            "encodingFormat": _FILE_TYPES.guess_type(name)[0] or "text/plain",
            "sha256": sha256(files[name]),
        }
        if name in scripts | {WORKFLOW_FILE}:
            properties |= {"url": {"@id": quote(name)}, "version": made["version"]}
        if name == WORKFLOW_FILE:
            entities[name] = described.add_workflow(
                files[name],
                name,
                main=True,
                lang="snakemake",
                lang_version=version,
                record_size=True,
                properties=properties
                | {
                    "@type": ["File", "SoftwareSourceCode", "ComputationalWorkflow", "HowTo"],
                    "name": "dampbalance",
                    "description": _code(run["code"]),
                    "conformsTo": {"@id": f"{BIOSCHEMAS}ComputationalWorkflow/1.0-RELEASE"},
                    "license": licence,
                    "author": authors,
                    "input": keys,
                },
            )
            continue
        if name in scripts:
            properties |= {"@type": ["File", "SoftwareSourceCode"], "programmingLanguage": "Python"}
        if name == "README.md":
            properties |= {"about": {"@id": "./"}}
        entities[name] = described.add_file(
            files[name], name, properties=properties, record_size=True
        )

    def refer(names: Iterable[str]) -> list[Any]:
        return [entities[name] for name in sorted(names) if name in entities]

    def act(
        identifier: str, tool: str, inputs: set[str], outputs: Sequence[str], **words: Any
    ) -> Any:
        """Adds what a tool made of files; every job takes its parameters from the configuration."""
        times = [ended[file] for file in outputs if file in ended]
        last = (
            datetime.fromtimestamp(max(times), UTC).isoformat(timespec="seconds") if times else None
        )
        used = refer(inputs.union(made["configuration_files"]))
        return add(
            identifier,
            "CreateAction",
            instrument=entities[tool],
            agent=authors,
            object=[*used, *(settings if tool == WORKFLOW_FILE else [])],
            result=refer(outputs),
            endTime=last,
            **words,
        )

    outputs = [file for job in jobs for file in job["outputs"] if file in files]
    inputs = {file for job in jobs for file in job["inputs"]}.difference(outputs)
    count = f"Snakemake ran {len(jobs)} jobs, which made {len(outputs)} files."
    words = {"name": "The run of the workflow", "description": count}
    acts = [whole := act("#run", WORKFLOW_FILE, inputs, outputs, **words)]
    steps, controls = [], []
    for position, (rule, script) in enumerate(_rules(jobs).items(), start=1):
        step = add(f"#step/{quote(rule)}", "HowToStep", name=rule, position=str(position))
        step["workExample"] = entities[script]
        parts = []
        for job in (job for job in jobs if job["rule"] == rule):
            of_job = [file for file in job["outputs"] if file in files]
            said = f"Rule {rule}: {script} made {', '.join(of_job)}."
            key = f"#job/{quote(min(of_job))}"
            parts.append(act(key, script, {*job["inputs"]}, of_job, name=rule, description=said))
        name = f"Snakemake ran the jobs of rule {rule}"
        key = f"#control/{quote(rule)}"
        controls.append(add(key, "ControlAction", name=name, instrument=step, object=parts))
        steps.append(step)
        acts += parts
    organised = add(
        "#organisation",
        "OrganizeAction",
        name="Snakemake organised the run",
        instrument=engine,
        agent=authors,
        object=controls,
        result=whole,
        endTime=whole.get("endTime"),
    )
    entities[WORKFLOW_FILE]["step"] = steps
    entities[WORKFLOW_FILE]["hasPart"] = refer(scripts)

    top = described.root_dataset
    published = citation.get("date-released") or run["code"].get("committed")
    for key, value in {
        "name": f"{citation['title']}: case '{made['case']}'",
        "description": citation["abstract"],
        "keywords": ", ".join(citation.get("keywords", [])),
        "license": licence,
        "author": authors,
        "publisher": [author for author in authors if author.type == "Organization"],
        "datePublished": published and str(published),
        "conformsTo": [
            add(address, "CreativeWork", name=name, version=address.rsplit("/", 1)[-1])
            for address, name in PROFILES.items()
        ],
        "mentions": [*acts, organised],
    }.items():
        top[key] = value
    for entity in described.get_entities():  # a list of one stands as its item
        for key, value in entity.properties().items():
            if isinstance(value, list) and len(value) == 1:
                entity.properties()[key] = value[0]
    return described


def _code(code: Mapping[str, Any]) -> str:
    if not code.get("commit"):
        return "Commit unknown; the digests of the sources are in the manifest."
    changed = ", with changes; their digests are in the manifest" if code.get("modified") else ""
    return f"Commit {code['commit']}{changed}."


def _rules(jobs: Sequence[Mapping[str, Any]]) -> dict[str, str]:
    """Rules of the jobs and their scripts, each after those whose outputs its first job reads."""
    maker = {file: number for number, job in enumerate(jobs) for file in job["outputs"]}
    needs = {
        number: [maker[file] for file in job["inputs"] if file in maker]
        for number, job in enumerate(jobs)
    }
    order = (jobs[number] for number in TopologicalSorter(needs).static_order())
    return {job["rule"]: job["script"] for job in order}
