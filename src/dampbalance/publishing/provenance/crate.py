"""Describes the results and the run of the workflow as an RO-Crate, in the terms that data repositories read.

It follows RO-Crate 1.1 with the profiles Workflow RO-Crate 1.0 and Process, Workflow and Provenance Run Crate 0.5.
Files are named by their paths from the folder of the crate. The crate of a case lies among its results and names the
sources by relative paths (../..), so it is valid only in place. The crate of an archive has all files below its own
folder: deposit this one. If the workflow ran in another folder than its own, the crate describes the sources but does
not contain them, although the profiles require the workflow itself.

All recommendations of the profiles are followed, with these exceptions. Tools should have an address on the web, and
the sources have none. The crate of a case has no time of the run (`endTime`), so that the same inputs give the same
bytes; the crate of an archive, which describes one run, has it. If neither a release date nor a commit is known, the
date of publication (`datePublished`) is missing. The agent of the run is the author named in the citation, who is
responsible for the published results.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .entities import CrateFolder, Entity, entity, references
from .workflow_run import BIOSCHEMAS, LANGUAGE, WORKFLOW_FILE, actions, engine, parameters, steps

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
SOURCE = ["File", "SoftwareSourceCode"]
LICENCES = "https://spdx.org/licenses/"
ABOUT_MANIFEST = "Configuration, code, packages, digests. Names the machine: no digest of its own."


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
    ended : the time when each result was finished, path → s since 1970; empty for a crate without times.
    """
    made, run = manifest["reproducible"], manifest["run"]
    jobs, others, folder = made["jobs"], others or {}, folder or CrateFolder()
    results = {result["path"]: result for result in made["results"]}
    digests = {**made["sources"], **others, **{p: r["sha256"] for p, r in results.items()}}
    configuration = made["configuration_files"]  # every job takes its parameters from these
    scripts = {job["script"] for job in jobs}
    used = {file for job in jobs for file in job["inputs"]} | set(configuration)
    named = {*results, *others, *scripts, WORKFLOW_FILE} | (used & digests.keys())

    files = {
        path: folder.file(path, digests.get(path), results.get(path, {}).get("bytes"))
        for path in sorted(named)
    }
    files[manifest_file] = folder.file(manifest_file) | {"description": ABOUT_MANIFEST}
    authors = [
        _author(author, i, folder) for i, author in enumerate(citation.get("authors", []), 1)
    ]
    terms = citation["license"]
    licence = entity(
        f"{LICENCES}{terms}", "CreativeWork", name=terms, identifier=f"{LICENCES}{terms}"
    )
    responsible = references(authors)
    common = {"license": {"@id": licence["@id"]}, "author": responsible}
    keys, settings = parameters(made["configuration"])
    howto = steps(jobs, folder)
    acts = actions(jobs, settings, configuration, named, responsible, folder, ended or {})

    version = made["version"]
    tools = {path: files[path] for path in sorted(scripts)}
    for path, tool in tools.items():
        tool |= _software(folder.name(path), SOURCE, version, "Python")
    files[WORKFLOW_FILE] |= _software(
        folder.name(WORKFLOW_FILE),
        [*SOURCE, "ComputationalWorkflow", "HowTo"],
        version,
        {"@id": LANGUAGE},
        **common,
        name="dampbalance",
        description=_code(run["code"]),
        conformsTo={"@id": f"{BIOSCHEMAS}ComputationalWorkflow/1.0-RELEASE"},
        hasPart=references(tools.values()),
        input=references(keys),
        step=references(howto),
    )
    if not folder.root and "README.md" in files:
        files["README.md"] |= {"about": {"@id": "./"}}

    published = citation.get("date-released") or run["code"].get("committed")
    top = entity(
        "./",
        "Dataset",
        name=f"{citation['title']}: case '{made['case']}'",
        description=citation["abstract"],
        keywords=", ".join(citation.get("keywords", [])),
        **common,
        publisher=references(a for a in authors if a["@type"] == "Organization"),
        conformsTo=[{"@id": profile} for profile in PROFILES],
        mainEntity={"@id": folder.name(WORKFLOW_FILE)},
        hasPart=references(files.values()),
        mentions=references(a for a in acts if a["@type"] != "ControlAction"),
        datePublished=str(published) if published else None,
    )
    descriptor = entity(
        DESCRIPTOR,
        "CreativeWork",
        conformsTo=[{"@id": ROCRATE}, {"@id": WORKFLOW_CRATE}],
        about={"@id": "./"},
    )
    profiles = [
        entity(address, "CreativeWork", name=name, version=address.rsplit("/", 1)[-1])
        for address, name in PROFILES.items()
    ]
    software = engine(run["packages"].get("snakemake"))
    graph = [descriptor, top, *files.values(), *software, *keys, *settings, *howto, *acts]
    return {"@context": CONTEXT, "@graph": [*graph, *authors, licence, *profiles]}


def _software(
    at: str, kind: list[str], version: str, language: str | dict[str, str], **more: Any
) -> Entity:
    """The properties of a file that is software; its URL is its path in the crate."""
    return entity(at, kind, url={"@id": at}, version=version, programmingLanguage=language, **more)


def _author(author: Mapping[str, str], number: int, folder: CrateFolder) -> Entity:
    """A person or an organisation named in the citation; without a website, the citation file serves as its URL."""
    person = f"{author.get('given-names', '')} {author.get('family-names', '')}".strip()
    return entity(
        author.get("orcid") or f"#author-{number}",
        "Organization" if "name" in author else "Person",
        name=author.get("name") or person,
        url=author.get("website") or {"@id": folder.name("CITATION.cff")},
    )


def _code(code: Mapping[str, Any]) -> str:
    if not code.get("commit"):
        return "Commit unknown; the digests of the sources are in the manifest."
    changed = ", with changes; their digests are in the manifest" if code.get("modified") else ""
    return f"Commit {code['commit']}{changed}."
