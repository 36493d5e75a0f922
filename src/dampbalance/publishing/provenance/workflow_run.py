"""Describes the run of a workflow as entities of an RO-Crate: parameters, steps, tools and actions.

Names are those of the profiles Workflow Run Crate and Provenance Run Crate, version 0.5. A step is a rule, its tool
the script of the rule; each job is a CreateAction, from its inputs (object) by its tool (instrument) to its outputs
(result). The engine's OrganizeAction leads to one ControlAction for each step, and that to the jobs of the step.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime
from graphlib import TopologicalSorter
from typing import Any
from urllib.parse import quote

from ...project.wording import dotted
from .entities import CrateFolder, Entity, entity, references

WORKFLOW_FILE = "Snakefile"
LANGUAGE = "https://w3id.org/workflowhub/workflow-ro-crate#snakemake"
ENGINE = "https://snakemake.github.io"
BIOSCHEMAS = "https://bioschemas.org/profiles/"
_PARAMETER_TYPES = {bool: "Boolean", int: "Integer", float: "Number", str: "Text"}


def parameters(configuration: Mapping[str, Any]) -> tuple[list[Entity], list[Entity]]:
    """The keys of a configuration as FormalParameters, and their values as PropertyValues.

    Nested keys are joined by dots, as in `oscillator.m_kg`. A value that is not a number, text or truth value is
    written as JSON.
    """
    keys, values = [], []
    for name, value in dotted(configuration):
        kind = _PARAMETER_TYPES.get(type(value))
        key_id, value_id = f"#parameter/{quote(name)}", f"#value/{quote(name)}"
        keys.append(
            entity(
                key_id,
                "FormalParameter",
                name=name,
                additionalType=kind or "PropertyValue",
                conformsTo={"@id": f"{BIOSCHEMAS}FormalParameter/1.0-RELEASE"},
                workExample={"@id": value_id},
            )
        )
        values.append(
            entity(
                value_id,
                "PropertyValue",
                name=name,
                value=value if kind else json.dumps(value),
                exampleOfWork={"@id": key_id},
            )
        )
    return keys, values


def engine(version: str | None) -> list[Entity]:
    """Snakemake as the language of the workflow and as the engine that ran it."""
    language = entity(
        LANGUAGE,
        "ComputerLanguage",
        name="Snakemake",
        alternateName="Snakemake workflow language",
        identifier=ENGINE,
        url=ENGINE,
        version=version,
    )
    application = entity(
        ENGINE, "SoftwareApplication", name="Snakemake", url=ENGINE, softwareVersion=version
    )
    return [language, application]


def steps(jobs: Sequence[Mapping[str, Any]], folder: CrateFolder) -> list[Entity]:
    """The rules of the jobs, in an order in which they can run."""
    return [
        entity(
            _step(rule),
            "HowToStep",
            name=rule,
            position=str(position),
            workExample={"@id": folder.name(script)},
        )
        for position, (rule, script) in enumerate(_tools(jobs).items(), start=1)
    ]


def actions(
    jobs: Sequence[Mapping[str, Any]],
    settings: Sequence[Entity],
    configuration: Iterable[str],
    known: set[str],
    agents: list[dict[str, str]],
    folder: CrateFolder,
    ended: Mapping[str, float],
) -> list[Entity]:
    """The actions of the run, of its jobs and of the engine that organised them; the run comes first.

    settings : values of the parameters.   configuration : the files that hold them; every job takes its own from there.
    known : the files that the crate describes.   agents : references to those who are responsible for the run.
    ended : when each output was finished, s since 1970; without an entry, its action has no `endTime`.
    """
    configured = set(configuration)

    def action(
        identifier: str, tool: str, inputs: set[str], outputs: list[str], **more: Any
    ) -> Entity:
        times = [ended[file] for file in outputs if file in ended]
        return entity(
            identifier,
            "CreateAction",
            instrument={"@id": folder.name(tool)},
            agent=agents,
            object=[*folder.references(inputs & known), *references(more.pop("values", []))],
            result=folder.references(outputs),
            endTime=_iso(max(times)) if times else None,
            **more,
        )

    results = [file for job in jobs for file in job["outputs"]]
    run = action(
        "#run",
        WORKFLOW_FILE,
        {file for job in jobs for file in job["inputs"]} - set(results) | configured,
        results,
        values=settings,
        name="The run of the workflow",
        description=f"Snakemake ran {len(jobs)} jobs, which made {len(results)} files.",
    )
    single = {
        _action(job): action(
            _action(job),
            job["script"],
            {*job["inputs"], *configured},
            job["outputs"],
            name=job["rule"],
            description=f"Rule {job['rule']}: {job['script']} made {', '.join(job['outputs'])}.",
        )
        for job in jobs
    }
    controls = [
        entity(
            f"#control/{quote(rule)}",
            "ControlAction",
            name=f"Snakemake ran the jobs of rule {rule}",
            instrument={"@id": _step(rule)},
            object=references(single[_action(job)] for job in jobs if job["rule"] == rule),
        )
        for rule in _tools(jobs)
    ]
    organised = entity(
        "#organisation",
        "OrganizeAction",
        name="Snakemake organised the run",
        instrument={"@id": ENGINE},
        agent=agents,
        object=references(controls),
        result={"@id": run["@id"]},
        endTime=run.get("endTime"),
    )
    return [run, *single.values(), *controls, organised]


def _tools(jobs: Sequence[Mapping[str, Any]]) -> dict[str, str]:
    """The rules of the jobs with their scripts, each rule after those whose outputs its first job reads."""
    maker = {file: number for number, job in enumerate(jobs) for file in job["outputs"]}
    needs = {
        number: [maker[file] for file in job["inputs"] if file in maker]
        for number, job in enumerate(jobs)
    }
    order = (jobs[number] for number in TopologicalSorter(needs).static_order())
    return {job["rule"]: job["script"] for job in order}


def _step(rule: str) -> str:
    return f"#step/{quote(rule)}"


def _action(job: Mapping[str, Any]) -> str:
    return f"#job/{quote(min(job['outputs']))}"


def _iso(time: float) -> str:
    return datetime.fromtimestamp(time, UTC).isoformat(timespec="seconds")
