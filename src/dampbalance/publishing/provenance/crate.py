"""The manifest as an RO-Crate: results, and the actions that made them, in terms that repositories understand.

RO-Crate 1.1 with the profile Process Run Crate: each job is a CreateAction, from its inputs (object) by a script
(instrument) to its outputs (result). Files below the root of the crate are its data; what lies elsewhere is described
with its digest, under a name that begins with '#'. The crate holds no time of the run, so that it stays the same from
run to run; the profile wishes for one (endTime) but does not ask for it.
"""

from __future__ import annotations

import mimetypes
from collections.abc import Iterable, Mapping
from pathlib import PurePosixPath
from typing import Any
from urllib.parse import quote

CONTEXT = [
    "https://w3id.org/ro/crate/1.1/context",
    "https://w3id.org/ro/terms/workflow-run/context",
]
ROCRATE = "https://w3id.org/ro/crate/1.1"
PROCESS_RUN = "https://w3id.org/ro/wfrun/process/0.5"
LICENCES = "https://spdx.org/licenses/"
_TYPES = {
    ".csv": "text/csv",
    ".md": "text/markdown",
    ".yaml": "application/yaml",
    ".parquet": "application/vnd.apache.parquet",
    ".ipynb": "application/x-ipynb+json",
    ".svg": "image/svg+xml",
    ".json": "application/json",
    ".py": "text/x-python",
}
Entity = dict[str, Any]


def crate(
    manifest: Mapping[str, Any],
    manifest_file: str,
    citation: Mapping[str, Any],
    root: str = "",
    others: Mapping[str, str] | None = None,
) -> dict[str, Any]:
    """The metadata of a crate, as JSON-LD.

    manifest : from `manifest.manifest`, which stands in the file `manifest_file`.   citation : CITATION.cff.
    root : folder of the crate, relative to the project; "" is the project itself.   others : more files of the crate,
    path → digest.
    """
    run, made = manifest["run"], manifest["reproducible"]
    results = {result["path"]: result for result in made["results"]}
    digests = {**made["sources"], **(others or {}), **{p: r["sha256"] for p, r in results.items()}}
    configuration = made["configuration_files"]  # what every job takes its parameters from
    used = {file for job in made["jobs"] for file in job["inputs"]} | set(configuration)
    named = set(results) | {file for file in used if file in digests} | set(others or {})

    entities = [
        _file(path, root, digests[path], results.get(path, {}).get("bytes"))
        for path in sorted(named)
    ]
    entities.append(_file(manifest_file, root, None, None))
    entities[-1]["description"] = (
        "Configuration, code, packages, digests. Names the machine: no digest of its own."
    )
    actions = [_action(job, configuration, root, named) for job in made["jobs"]]
    scripts = [
        _script(script, digests.get(script))
        for script in sorted({j["script"] for j in made["jobs"]})
    ]
    authors = [
        {
            "@id": f"#author-{i}",
            "@type": "Organization" if "name" in author else "Person",
            "name": _name(author),
        }
        for i, author in enumerate(citation.get("authors", []), start=1)
    ]
    licence = {
        "@id": f"{LICENCES}{citation['license']}",
        "@type": "CreativeWork",
        "name": citation["license"],
    }
    software = {
        "@id": "#dampbalance",
        "@type": "SoftwareSourceCode",
        "name": "dampbalance",
        "version": made["version"],
        "license": {"@id": licence["@id"]},
        "programmingLanguage": "Python",
        "author": _references(authors),
        "description": _code(run["code"]),
        "hasPart": _references(scripts),
    }
    profile = {
        "@id": PROCESS_RUN,
        "@type": "CreativeWork",
        "name": "Process Run Crate",
        "version": PROCESS_RUN.rsplit("/", 1)[-1],
    }
    top: Entity = {
        "@id": "./",
        "@type": "Dataset",
        "name": f"{citation['title']}: case '{made['case']}'",
        "description": citation["abstract"],
        "keywords": ", ".join(citation.get("keywords", [])),
        "license": {"@id": licence["@id"]},
        "author": _references(authors),
        "conformsTo": {"@id": PROCESS_RUN},
        "hasPart": [{"@id": e["@id"]} for e in entities if e["@type"] == "File"],
        "mentions": [*_references(actions), {"@id": software["@id"]}],
    }
    published = citation.get("date-released") or run["code"].get("committed")
    if published:
        top["datePublished"] = str(published)
    descriptor = {
        "@id": "ro-crate-metadata.json",
        "@type": "CreativeWork",
        "conformsTo": {"@id": ROCRATE},
        "about": {"@id": "./"},
    }
    graph = [descriptor, top, *entities, *actions, software, *scripts, *authors, licence, profile]
    return {"@context": CONTEXT, "@graph": graph}


def _id(path: str, root: str) -> str:
    """The name of a file in the crate: its path from the root, or '#' and its path when it lies elsewhere."""
    inside = not root or PurePosixPath(path).is_relative_to(root)
    text = str(PurePosixPath(path).relative_to(root)) if root and inside else path
    return quote(text) if inside else f"#{quote(text)}"


def _file(path: str, root: str, digest: str | None, size: int | None) -> Entity:
    name = _id(path, root)
    suffix = PurePosixPath(path).suffix
    kind = _TYPES.get(suffix) or mimetypes.guess_type(path)[0] or "text/plain"
    entity: Entity = {
        "@id": name,
        "@type": "CreativeWork" if name.startswith("#") else "File",
        "name": path,
        "encodingFormat": kind,
    }
    if size is not None:
        entity["contentSize"] = str(size)
    if digest is not None:
        entity["sha256"] = digest
    return entity


def _action(
    job: Mapping[str, Any], configuration: Iterable[str], root: str, named: set[str]
) -> Entity:
    inputs = sorted({*job["inputs"], *configuration} & named)
    return {
        "@id": f"#job/{quote(min(job['outputs']))}",
        "@type": "CreateAction",
        "name": job["rule"],
        "instrument": {"@id": f"#script/{quote(job['script'])}"},
        "object": [{"@id": _id(file, root)} for file in inputs],
        "result": [{"@id": _id(file, root)} for file in sorted(job["outputs"])],
    }


def _script(path: str, digest: str | None) -> Entity:
    entity: Entity = {
        "@id": f"#script/{quote(path)}",
        "@type": "SoftwareApplication",
        "name": path,
    }
    return entity if digest is None else entity | {"sha256": digest}


def _references(entities: Iterable[Entity]) -> list[dict[str, str]]:
    return [{"@id": entity["@id"]} for entity in entities]


def _name(author: Mapping[str, str]) -> str:
    given = f"{author.get('given-names', '')} {author.get('family-names', '')}"
    return author.get("name") or given.strip()


def _code(code: Mapping[str, Any]) -> str:
    if not code.get("commit"):
        return "Commit unknown; the digests of the sources are in the manifest."
    changed = ", with changes; their digests are in the manifest" if code.get("modified") else ""
    return f"Commit {code['commit']}{changed}."
