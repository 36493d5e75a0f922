"""Describes the results and the run of the workflow as an RO-Crate, in the terms that data repositories read.

It follows RO-Crate 1.1 with the profiles Workflow RO-Crate 1.0 and Process, Workflow and Provenance Run Crate 0.5.
Files are named by their paths from the folder of the crate. The crate of a case lies among its results and names the
sources by relative paths (../..), so it is valid only in place. The crate of an archive has all files below its own
folder: deposit this one. If the workflow ran in another folder than its own, the crate describes the sources but does
not contain them, although the profiles require the workflow itself.

A step is a rule, its tool the script of the rule; each job is a CreateAction, from its inputs (object) by its tool
(instrument) to its outputs (result). The engine's OrganizeAction leads to one ControlAction for each step, and that to
the jobs of the step.

All recommendations of the profiles are followed, with these exceptions. Tools should have an address on the web, and
the sources have none. The crate of a case has no time of the run (`endTime`), so that the same inputs give the same
bytes; the crate of an archive, which describes one run, has it. Without a release date and a commit there is no date of
publication. The agent of the run is the author named in the citation, who is responsible for the published results.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from graphlib import TopologicalSorter
from pathlib import Path, PurePosixPath
from typing import Any
from urllib.parse import quote

from ...project.wording import dotted
from .manifest import author_name

DESCRIPTOR = "ro-crate-metadata.json"
CONTEXT = [
    "https://w3id.org/ro/crate/1.1/context",
    "https://w3id.org/ro/terms/workflow-run/context",
]
ROCRATE = "https://w3id.org/ro/crate/1.1"
WORKFLOW_CRATE = "https://w3id.org/workflowhub/workflow-ro-crate/1.0"
PROFILES = {
    "https://w3id.org/ro/wfrun/process/0.5": "Process Run Crate",
    "https://w3id.org/ro/wfrun/workflow/0.5": "Workflow Run Crate",
    "https://w3id.org/ro/wfrun/provenance/0.5": "Provenance Run Crate",
    WORKFLOW_CRATE: "Workflow RO-Crate",
}
BIOSCHEMAS = "https://bioschemas.org/profiles/"
LANGUAGE = "https://w3id.org/workflowhub/workflow-ro-crate#snakemake"
ENGINE = "https://snakemake.github.io"
LICENCES = "https://spdx.org/licenses/"
WORKFLOW_FILE = "Snakefile"
ABOUT_MANIFEST = "Configuration, code, packages, digests. Names the machine: no digest of its own."
_PARAMETER_TYPES = {bool: "Boolean", int: "Integer", float: "Number", str: "Text"}

# Everything else is text. Python's own table grows with every version and depends on the system.
_FILE_TYPES = {
    **{".css": "text/css", ".csv": "text/csv", ".html": "text/html", ".js": "text/javascript"},
    **{".md": "text/markdown", ".py": "text/x-python", ".rst": "text/x-rst"},
    **{".pdf": "application/pdf", ".png": "image/png", ".svg": "image/svg+xml"},
    **{".json": "application/json", ".ipynb": "application/x-ipynb+json"},
    **dict.fromkeys((".cff", ".yaml", ".yml"), "application/yaml"),
    **{".toml": "application/toml", ".parquet": "application/vnd.apache.parquet"},
}

Entity = dict[str, Any]


def entity(identifier: str, kind: str | list[str], /, **properties: Any) -> Entity:
    """An entity with those of its properties that have a value.

    Another entity as a value is written as a reference to it, a list of one item as that item.
    """
    entries = {key: _written(value) for key, value in properties.items()}
    return {"@id": identifier, "@type": kind} | {
        key: value for key, value in entries.items() if value not in (None, [])
    }


def _written(value: Any) -> Any:
    if isinstance(value, list):
        items = [_written(item) for item in value]
        return items[0] if len(items) == 1 else items
    return at(value["@id"]) if isinstance(value, dict) else value


def at(identifier: str) -> dict[str, str]:
    """A reference to the entity of this identifier."""
    return {"@id": identifier}


@dataclass(frozen=True, slots=True)
class CrateFolder:
    """The folder that holds a crate, and the names of files as seen from there.

    root : the folder, relative to the project; "" is the project itself.   beside_sources : whether the files of the
    project can be reached from there. They cannot when the workflow was run in another folder: then the crate only
    describes them, under names that begin with '#'.
    """

    root: str = ""
    beside_sources: bool = True

    def name(self, path: str) -> str:
        """The name of a file in the crate, which is its path from there.   path : relative to the project."""
        if not self.beside_sources and not path.startswith("results/"):
            return f"#{quote(path)}"
        return quote(Path(os.path.relpath(path, self.root or ".")).as_posix())

    def references(self, paths: Iterable[str]) -> list[dict[str, str]]:
        """References to these files, in the order of their paths."""
        return [at(self.name(path)) for path in sorted(paths)]


def crate(
    manifest: Mapping[str, Any],
    manifest_file: str,
    citation: Mapping[str, Any],
    folder: CrateFolder | None = None,
    others: Mapping[str, str] | None = None,
    ended: Mapping[str, float] | None = None,
) -> dict[str, Any]:
    """The metadata of a crate, as JSON-LD.

    manifest : from `manifest.manifest`, which stands in the file `manifest_file`.   citation : CITATION.cff.
    folder : the folder of the crate; by default the project itself.   others : further files, path → digest.
    ended : the time when each result was finished, s since 1970; without an entry, its action has no `endTime`.
    """
    made, run = manifest["reproducible"], manifest["run"]
    jobs, others, folder = made["jobs"], others or {}, folder or CrateFolder()
    results = {result["path"]: result for result in made["results"]}
    digests = {**made["sources"], **others, **{p: r["sha256"] for p, r in results.items()}}
    configuration = set(made["configuration_files"])  # every job takes its parameters from these
    scripts = sorted({job["script"] for job in jobs})
    used = {file for job in jobs for file in job["inputs"]} | configuration
    named = {*results, *others, *scripts, WORKFLOW_FILE} | (used & digests.keys())
    files = {
        path: entity(
            folder.name(path),
            "File",
            name=path,
            encodingFormat=_FILE_TYPES.get(PurePosixPath(path).suffix, "text/plain"),
            contentSize=str(results[path]["bytes"]) if path in results else None,
            sha256=digests.get(path),
        )
        for path in [*sorted(named), manifest_file]
    }
    files[manifest_file] |= {"description": ABOUT_MANIFEST}
    authors = [
        entity(
            author.get("orcid") or f"#author-{number}",
            "Organization" if "name" in author else "Person",
            name=author_name(author),
            url=author.get("website") or at(folder.name("CITATION.cff")),
        )
        for number, author in enumerate(citation.get("authors", []), 1)
    ]
    spdx = f"{LICENCES}{citation['license']}"
    licence = entity(spdx, "CreativeWork", name=citation["license"], identifier=spdx)
    keys, settings = _parameters(made["configuration"])
    steps = _steps(jobs, folder)

    def action(key: str, tool: str, inputs: set[str], outputs: list[str], **words: str) -> Entity:
        """What a tool made of files, of those that the crate describes."""
        times = [ended[file] for file in outputs if file in ended] if ended else []
        last = datetime.fromtimestamp(max(times), UTC) if times else None
        return entity(
            key,
            "CreateAction",
            instrument=at(folder.name(tool)),
            agent=authors,
            object=[
                *folder.references((inputs | configuration) & named),
                *(settings if tool == WORKFLOW_FILE else []),
            ],
            result=folder.references(outputs),
            endTime=last and last.isoformat(timespec="seconds"),
            **words,
        )

    acts = _actions(jobs, steps, authors, action)
    of_source = {"version": made["version"], "programmingLanguage": "Python"}
    for path in scripts:
        files[path] |= {"@type": ["File", "SoftwareSourceCode"], "url": at(files[path]["@id"])}
        files[path] |= of_source
    files[WORKFLOW_FILE] |= entity(
        folder.name(WORKFLOW_FILE),
        ["File", "SoftwareSourceCode", "ComputationalWorkflow", "HowTo"],
        url=at(folder.name(WORKFLOW_FILE)),
        version=made["version"],
        programmingLanguage=at(LANGUAGE),
        license=licence,
        author=authors,
        name="dampbalance",
        description=_code(run["code"]),
        conformsTo=at(f"{BIOSCHEMAS}ComputationalWorkflow/1.0-RELEASE"),
        hasPart=[files[path] for path in scripts],
        input=keys,
        step=steps,
    )
    if not folder.root and "README.md" in files:
        files["README.md"] |= {"about": at("./")}

    published = citation.get("date-released") or run["code"].get("committed")
    top = entity(
        "./",
        "Dataset",
        name=f"{citation['title']}: case '{made['case']}'",
        description=citation["abstract"],
        keywords=", ".join(citation.get("keywords", [])),
        license=licence,
        author=authors,
        publisher=[author for author in authors if author["@type"] == "Organization"],
        conformsTo=[at(profile) for profile in PROFILES],
        mainEntity=files[WORKFLOW_FILE],
        hasPart=list(files.values()),
        mentions=[act for act in acts if act["@type"] != "ControlAction"],
        datePublished=str(published) if published else None,
    )
    kept = [at(ROCRATE), at(WORKFLOW_CRATE)]
    descriptor = entity(DESCRIPTOR, "CreativeWork", conformsTo=kept, about=top)
    profiles = [
        entity(address, "CreativeWork", name=name, version=address.rsplit("/", 1)[-1])
        for address, name in PROFILES.items()
    ]
    version = run["packages"].get("snakemake")
    names = {"name": "Snakemake", "alternateName": "Snakemake workflow language"}
    language = {**names, "identifier": ENGINE, "url": ENGINE, "version": version}
    engine = {"name": "Snakemake", "url": ENGINE, "softwareVersion": version}
    software = [
        entity(LANGUAGE, "ComputerLanguage", **language),
        entity(ENGINE, "SoftwareApplication", **engine),
    ]
    graph = [descriptor, top, *files.values(), *software, *keys, *settings, *steps, *acts]
    return {"@context": CONTEXT, "@graph": [*graph, *authors, licence, *profiles]}


def _code(code: Mapping[str, Any]) -> str:
    if not code.get("commit"):
        return "Commit unknown; the digests of the sources are in the manifest."
    changed = ", with changes; their digests are in the manifest" if code.get("modified") else ""
    return f"Commit {code['commit']}{changed}."


def _parameters(configuration: Mapping[str, Any]) -> tuple[list[Entity], list[Entity]]:
    """The keys of a configuration as FormalParameters, and their values as PropertyValues.

    Nested keys are joined by dots, as in `oscillator.m_kg`. A value that is not a number, text or truth value is
    written as JSON.
    """
    keys, values = [], []
    profile = at(f"{BIOSCHEMAS}FormalParameter/1.0-RELEASE")
    for name, value in dotted(configuration):
        key, setting = f"#parameter/{quote(name)}", f"#value/{quote(name)}"
        kind = _PARAMETER_TYPES.get(type(value))
        of_key = {"additionalType": kind or "PropertyValue", "conformsTo": profile}
        of_value = {"value": value if kind else json.dumps(value), "exampleOfWork": at(key)}
        keys.append(entity(key, "FormalParameter", name=name, **of_key, workExample=at(setting)))
        values.append(entity(setting, "PropertyValue", name=name, **of_value))
    return keys, values


def _steps(jobs: Sequence[Mapping[str, Any]], folder: CrateFolder) -> list[Entity]:
    """The rules of the jobs, each after those whose outputs its first job reads."""
    maker = {file: number for number, job in enumerate(jobs) for file in job["outputs"]}
    needs = {
        number: [maker[file] for file in job["inputs"] if file in maker]
        for number, job in enumerate(jobs)
    }
    order = (jobs[number] for number in TopologicalSorter(needs).static_order())
    tools = {job["rule"]: at(folder.name(job["script"])) for job in order}
    return [
        entity(f"#step/{quote(rule)}", "HowToStep", name=rule, position=str(n), workExample=tool)
        for n, (rule, tool) in enumerate(tools.items(), start=1)
    ]


def _actions(
    jobs: Sequence[Mapping[str, Any]],
    steps: Sequence[Entity],
    agents: list[Entity],
    action: Callable[..., Entity],
) -> list[Entity]:
    """The actions of the run, of its jobs and of the engine that organised them; the run comes first.

    agents : those who are responsible for the run.   action : makes one of (key, tool, inputs, outputs, words).
    """
    results = [file for job in jobs for file in job["outputs"]]
    inputs = {file for job in jobs for file in job["inputs"]} - set(results)
    said = f"Snakemake ran {len(jobs)} jobs, which made {len(results)} files."
    words = {"name": "The run of the workflow", "description": said}
    run = action("#run", WORKFLOW_FILE, inputs, results, **words)
    single = []
    for job in jobs:
        rule, script, outputs = job["rule"], job["script"], job["outputs"]
        said = f"Rule {rule}: {script} made {', '.join(outputs)}."
        key, words = f"#job/{quote(min(outputs))}", {"name": rule, "description": said}
        single.append(action(key, script, set(job["inputs"]), outputs, **words))
    controls = [
        entity(
            f"#control/{quote(step['name'])}",
            "ControlAction",
            name=f"Snakemake ran the jobs of rule {step['name']}",
            instrument=step,
            object=[job for job in single if job["name"] == step["name"]],
        )
        for step in steps
    ]
    organised = entity(
        "#organisation",
        "OrganizeAction",
        name="Snakemake organised the run",
        instrument=at(ENGINE),
        agent=agents,
        object=controls,
        result=run,
        endTime=run.get("endTime"),
    )
    return [run, *single, *controls, organised]
