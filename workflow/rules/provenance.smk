# Where the results come from: a manifest. Included last: it looks at the rules.
#
# The manifest is made again when a result, a source or the commit changes; nothing depends on it, so that a
# commit rebuilds no result.

import functools
import os

from dampbalance import __version__ as VERSION
from dampbalance.publishing.provenance.manifest import COMPUTING, code_version, files_of
from snakemake.io import is_flagged

# A configuration that another workflow hands over stands in no file; the manifest has it as merged.
GIVEN_FILES = [os.path.relpath(file) for file in [BASE_CONFIG, *OVERRIDING]]
MANIFEST = f"{RESULTS}/manifest.json"


def own_name(file):
    """Return a file's name in the manifest: relative to the folder of the run for results, else to the project."""
    if file.startswith("results/"):
        return file
    path = Path(os.path.abspath(file))
    return path.relative_to(ROOT).as_posix() if path.is_relative_to(ROOT) else file


@functools.cache
def jobs_behind_everything():
    """Return the jobs behind `rule all`, each {rule, script, inputs, outputs}, as Snakemake resolves its rules.

    Inputs leave out the code (it is among the sources), outputs what is temporary.
    """
    waiting, jobs = [*map(str, rules.all.rule.expand_input({})[0])], {}
    for file in waiting:  # it grows
        made_by = (rule for rule in workflow.rules if rule.is_producer(file))
        producer = next(made_by, None) if file.startswith("results/") else None
        if producer is None or file == MANIFEST:
            continue
        wildcards = producer.get_wildcards(file)
        name = (producer.name, *sorted(wildcards.items()))
        if name in jobs:
            continue
        needed = [str(f) for f in producer.expand_input(wildcards)[0]]
        outputs = [f.apply_wildcards(wildcards) for f in producer.output]
        kept = [own_name(str(f)) for f in outputs if not is_flagged(f, "temp")]
        jobs[name] = {
            "rule": producer.name,
            "script": os.path.normpath(Path("workflow/rules") / producer.script),
            "inputs": sorted({own_name(file) for file in needed if file not in PACKAGE}),
            "outputs": sorted(kept),
        }
        waiting += [*needed, *map(str, outputs)]
    return sorted((job for job in jobs.values() if job["outputs"]), key=lambda job: job["outputs"])


def everything_built(wildcards):
    """Return all results of this case, and of the studies that it draws on."""
    return [file for job in jobs_behind_everything() for file in job["outputs"]]


@functools.cache
def sources_of(names):
    """Return files of the project below `names`, and configurations given on the command line: name → path."""
    own = {name: project_file(name) for name in files_of(ROOT, names)}
    given = {own_name(file): file for file in GIVEN_FILES}
    return own | {name: path for name, path in given.items() if not name.startswith("..")}


rule manifest:
    input:
        results=everything_built,
        sources=lambda wildcards: list(sources_of(COMPUTING).values()),
    output:
        json=report(
            f"{RESULTS}/manifest.json",
            category="Provenance",
            labels={"result": "What made the results: configuration, code, packages"},
        ),
    params:
        case=CASE.name,
        configuration=config,
        configuration_files=[own_name(file) for file in GIVEN_FILES],
        sources=lambda wildcards: sources_of(COMPUTING),
        jobs=lambda wildcards: jobs_behind_everything(),
        code=lambda wildcards: code_version(ROOT, VERSION),
        lock=project_file("requirements.lock"),
    message:
        "Manifest: configuration, code, packages, digests"
    script:
        "../scripts/provenance/manifest.py"
