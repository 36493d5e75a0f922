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
ABOUT_MANIFEST = "Configuration, code, packages, digests. Names the machine: no digest of its own."

Entity = dict[str, Any]


def _entity(identifier: str, kind: str, **properties: Any) -> Entity:
    """An entity with those of its properties that are known."""
    entries = {key: value for key, value in properties.items() if value is not None}
    return {"@id": identifier, "@type": kind} | entries


DESCRIPTOR = _entity(
    "ro-crate-metadata.json",
    "CreativeWork",
    conformsTo={"@id": ROCRATE},
    about={"@id": "./"},
)
PROFILE = _entity(
    PROCESS_RUN, "CreativeWork", name="Process Run Crate", version=PROCESS_RUN.rsplit("/", 1)[-1]
)


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
    made, code = manifest["reproducible"], manifest["run"]["code"]
    others = others or {}
    results = {result["path"]: result for result in made["results"]}
    digests = {**made["sources"], **others, **{p: r["sha256"] for p, r in results.items()}}
    configuration = made["configuration_files"]  # what every job takes its parameters from
    used = {file for job in made["jobs"] for file in job["inputs"]} | set(configuration)
    named = set(results) | {file for file in used if file in digests} | set(others)

    files = [
        _file(path, root, digests[path], results.get(path, {}).get("bytes"))
        for path in sorted(named)
    ]
    files.append(_file(manifest_file, root, None, None) | {"description": ABOUT_MANIFEST})
    actions = [_action(job, configuration, root, named) for job in made["jobs"]]
    scripts = [
        _entity(_script(path), "SoftwareApplication", name=path, sha256=digests.get(path))
        for path in sorted({job["script"] for job in made["jobs"]})
    ]
    authors = [_author(author, i) for i, author in enumerate(citation.get("authors", []), start=1)]
    terms = citation["license"]
    licence = _entity(f"{LICENCES}{terms}", "CreativeWork", name=terms)
    common = {"license": {"@id": licence["@id"]}, "author": _references(authors)}
    software = _entity(
        "#dampbalance",
        "SoftwareSourceCode",
        name="dampbalance",
        version=made["version"],
        license=common["license"],
        programmingLanguage="Python",
        author=common["author"],
        description=_code(code),
        hasPart=_references(scripts),
    )
    published = citation.get("date-released") or code.get("committed")
    top = _entity(
        "./",
        "Dataset",
        name=f"{citation['title']}: case '{made['case']}'",
        description=citation["abstract"],
        keywords=", ".join(citation.get("keywords", [])),
        **common,
        conformsTo={"@id": PROCESS_RUN},
        hasPart=_references(file for file in files if file["@type"] == "File"),
        mentions=_references([*actions, software]),
        datePublished=str(published) if published else None,
    )
    graph = [DESCRIPTOR, top, *files, *actions, software, *scripts, *authors, licence, PROFILE]
    return {"@context": CONTEXT, "@graph": graph}


def _id(path: str, root: str) -> str:
    """The name of a file in the crate: its path from the root, or '#' and its path when it lies elsewhere."""
    if not PurePosixPath(path).is_relative_to(root):
        return f"#{quote(path)}"
    return quote(str(PurePosixPath(path).relative_to(root)))


def _file(path: str, root: str, digest: str | None, size: int | None) -> Entity:
    identifier = _id(path, root)
    suffix = PurePosixPath(path).suffix
    kind = _TYPES.get(suffix) or mimetypes.guess_type(path)[0] or "text/plain"
    return _entity(
        identifier,
        "CreativeWork" if identifier.startswith("#") else "File",
        name=path,
        encodingFormat=kind,
        contentSize=None if size is None else str(size),
        sha256=digest,
    )


def _action(
    job: Mapping[str, Any], configuration: Iterable[str], root: str, named: set[str]
) -> Entity:
    inputs = sorted({*job["inputs"], *configuration} & named)
    return _entity(
        f"#job/{quote(min(job['outputs']))}",
        "CreateAction",
        name=job["rule"],
        instrument={"@id": _script(job["script"])},
        object=[{"@id": _id(file, root)} for file in inputs],
        result=[{"@id": _id(file, root)} for file in sorted(job["outputs"])],
    )


def _script(path: str) -> str:
    return f"#script/{quote(path)}"


def _author(author: Mapping[str, str], number: int) -> Entity:
    person = f"{author.get('given-names', '')} {author.get('family-names', '')}".strip()
    kind = "Organization" if "name" in author else "Person"
    return _entity(f"#author-{number}", kind, name=author.get("name") or person)


def _references(entities: Iterable[Entity]) -> list[dict[str, str]]:
    return [{"@id": entity["@id"]} for entity in entities]


def _code(code: Mapping[str, Any]) -> str:
    if not code.get("commit"):
        return "Commit unknown; the digests of the sources are in the manifest."
    changed = ", with changes; their digests are in the manifest" if code.get("modified") else ""
    return f"Commit {code['commit']}{changed}."
