"""The run of a workflow as entities of an RO-Crate: parameters, steps, tools, and the actions that made the results.

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
from .entities import Entity, Place, entity, references

WORKFLOW_FILE = "Snakefile"
LANGUAGE = "https://w3id.org/workflowhub/workflow-ro-crate#snakemake"
ENGINE = "https://snakemake.github.io"
BIOSCHEMAS = "https://bioschemas.org/profiles/"
_PARAMETER_TYPES = {bool: "Boolean", int: "Integer", float: "Number", str: "Text"}


def parameters(configuration: Mapping[str, Any]) -> tuple[list[Entity], list[Entity]]:
    """The keys of a configuration as FormalParameters, and what each was set to as a PropertyValue.

    A key of a key is named `oscillator.m_kg`. What is no number, text or truth is given as JSON.
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
    """Snakemake: the language of the workflow, and what ran it."""
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


def steps(jobs: Sequence[Mapping[str, Any]], place: Place) -> list[Entity]:
    """The rules of the jobs, in an order in which they can run."""
    scripts = {job["rule"]: job["script"] for job in _in_order(jobs)}
    return [
        entity(
            _step(rule),
            "HowToStep",
            name=rule,
            position=str(position),
            workExample={"@id": place.name(script)},
        )
        for position, (rule, script) in enumerate(scripts.items(), start=1)
    ]


def actions(
    jobs: Sequence[Mapping[str, Any]],
    settings: Sequence[Entity],
    configuration: Iterable[str],
    known: set[str],
    agents: list[dict[str, str]],
    place: Place,
    ended: Mapping[str, float],
) -> list[Entity]:
    """The run, its jobs, and how the engine organised them; the run comes first.

    settings : values of the parameters.   configuration : the files that hold them; every job takes its own from there.
    known : the files that the crate describes.   agents : references to who is responsible for the run.
    ended : when each output was finished, s since 1970, as far as the crate is to tell.
    """
    configured = set(configuration)

    def made(
        identifier: str, tool: str, paths: set[str], outputs: list[str], **more: Any
    ) -> Entity:
        times = [ended[file] for file in outputs if file in ended]
        inputs = [{"@id": place.name(file)} for file in sorted(paths & known)]
        return entity(
            identifier,
            "CreateAction",
            instrument={"@id": place.name(tool)},
            agent=agents,
            object=[*inputs, *references(more.pop("values", []))],
            result=[{"@id": place.name(file)} for file in sorted(outputs)],
            endTime=_iso(max(times)) if times else None,
            **more,
        )

    results = [file for job in jobs for file in job["outputs"]]
    read = {file for job in jobs for file in job["inputs"]} - set(results)
    run = made(
        "#run",
        WORKFLOW_FILE,
        read | configured,
        results,
        values=settings,
        name="The run of the workflow",
        description=f"Snakemake ran {len(jobs)} jobs, which made {len(results)} files.",
    )
    single = {
        _action(job): made(
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
        for rule in dict.fromkeys(job["rule"] for job in _in_order(jobs))
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


def _in_order(jobs: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """The jobs, each after those whose outputs it reads."""
    maker = {file: number for number, job in enumerate(jobs) for file in job["outputs"]}
    needs = {
        number: [maker[file] for file in job["inputs"] if file in maker]
        for number, job in enumerate(jobs)
    }
    return [jobs[number] for number in TopologicalSorter(needs).static_order()]


def _step(rule: str) -> str:
    return f"#step/{quote(rule)}"


def _action(job: Mapping[str, Any]) -> str:
    return f"#job/{quote(min(job['outputs']))}"


def _iso(time: float) -> str:
    return datetime.fromtimestamp(time, UTC).isoformat(timespec="seconds")
