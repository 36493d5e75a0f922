# Where the results come from: a manifest, the same as an RO-Crate, and an archive. Included last: it looks at the rules.
#
# The manifest is made again when a result, a source or the commit changes; nothing but crate and archive depends on it,
# so that a commit rebuilds no result.
import functools
import os

from dampbalance import __version__ as VERSION
from dampbalance.publishing.provenance.sources import COMPUTING, PROJECT, code_version, files_of
from snakemake.io import is_flagged

# A configuration that another workflow hands over stands in no file of its own; as merged it is in the manifest.
GIVEN_FILES = [os.path.relpath(file) for file in ([BASE_CONFIG] if IS_MODULE else CONFIG_FILES)]
PROVENANCE_RULES = ("manifest", "crate", "archive")
ARCHIVE_NAME = f"dampbalance-{VERSION}" + ("" if CASE.name == "paper" else f"-{CASE.name}")


def own_rules():
    """The rules of this workflow by the names that they have here; one that uses it as a module may call them otherwise."""
    return {name: proxy.rule for name, proxy in rules._rules.items()}


def own_name(file):
    """A file as the manifest names it: a result without a module's prefix, a file of the project from there on."""
    if file.startswith(placed("results/")):
        return file.removeprefix(PREFIX)
    path = Path(os.path.abspath(file))
    return path.relative_to(ROOT).as_posix() if path.is_relative_to(ROOT) else file


@functools.cache
def jobs_behind_everything():
    """The jobs behind `rule all`, each {rule, script, inputs, outputs}, found from the rules as Snakemake finds them.

    Inputs leave out the package's modules (they are sources), outputs what is temporary.
    """
    names = {rule: name for name, rule in own_rules().items()}
    producers = [rule for rule, name in names.items() if name not in PROVENANCE_RULES]
    waiting = list(rules.all.rule.expand_input({})[0])
    seen, jobs = set(), {}
    while waiting:
        file = str(waiting.pop())
        if file in seen:
            continue
        seen.add(file)
        made_by = [r for r in producers if r.is_producer(file)]
        if not made_by:
            continue
        producer = made_by[0]
        wildcards = producer.get_wildcards(file)
        job = jobs.setdefault((names[producer], *sorted(wildcards.items())), {})
        if job:
            continue
        needed = [str(f) for f in producer.expand_input(wildcards)[0]]
        inputs = {own_name(file) for file in needed}
        outputs = [f.apply_wildcards(wildcards) for f in producer.output]
        job |= {
            "rule": names[producer],
            "script": os.path.normpath(Path("workflow/rules") / producer.script),
            "inputs": sorted(file for file in inputs if not file.startswith("src/")),
            "outputs": sorted(own_name(str(f)) for f in outputs if not is_flagged(f, "temp")),
        }
        waiting.extend(needed)
        waiting.extend(str(f) for f in outputs)
    return sorted((job for job in jobs.values() if job["outputs"]), key=lambda job: job["outputs"])


def everything_built(wildcards):
    """All results of this case, and of the studies that it draws on."""
    return [file for job in jobs_behind_everything() for file in job["outputs"]]


def sources_of(names):
    """Files of the project below `names`, and configurations given on the command line: name → path."""
    own = {name: project_file(name) for name in files_of(ROOT, names)}
    given = {own_name(file): file for file in GIVEN_FILES}
    return own | {name: path for name, path in given.items() if not name.startswith("..")}


rule manifest:
    input:
        results=everything_built,
        sources=lambda wildcards: [unmoved(path) for path in sources_of(COMPUTING).values()],
    output:
        json=report(
            f"{RESULTS}/manifest.json",
            caption="../report/manifest.rst",
            category="Provenance",
            labels={"result": "What made the results: configuration, code, packages"},
        ),
    params:
        case=CASE.name,
        configuration=config,
        configuration_files=[own_name(file) for file in GIVEN_FILES],
        top=PREFIX or ".",
        sources=lambda wildcards: sources_of(COMPUTING),
        jobs=lambda wildcards: jobs_behind_everything(),
        code=lambda wildcards: code_version(ROOT, VERSION),
        lock=project_file("requirements.lock"),
    message:
        "Manifest: configuration, code, packages, digests"
    script:
        "../scripts/provenance/manifest.py"


rule crate:
    input:
        manifest=rules.manifest.output.json,
        citation=project_input("CITATION.cff"),
        modules=script_modules("provenance/crate.py"),
    output:
        json=report(
            f"{RESULTS}/ro-crate-metadata.json",
            caption="../report/crate.rst",
            category="Provenance",
            labels={"result": "The same as an RO-Crate, for repositories of data"},
        ),
    params:
        folder={"root": RESULTS, "beside_sources": Path.cwd() == ROOT and not IS_MODULE},
        manifest_name=f"{RESULTS}/manifest.json",
    message:
        "RO-Crate of the results"
    script:
        "../scripts/provenance/crate.py"


# It packs the folder of the project, which must be that of the results.
if Path.cwd() == ROOT and not IS_MODULE:

    rule archive:
        input:
            manifest=rules.manifest.output.json,
            crate=rules.crate.output.json,
            results=everything_built,
            sources=lambda wildcards: sorted(sources_of(PROJECT)),
        output:
            archive=f"results/archive/{ARCHIVE_NAME}.tar.gz",
        params:
            sources=lambda wildcards: sorted(sources_of(PROJECT)),
            citation="CITATION.cff",
            rebuild=" ".join(
                ["make"]
                if CASE.name == "paper"
                else [
                    ". .venv/bin/activate && snakemake --cores all --configfile",
                    *(os.path.relpath(file) for file in workflow.overwrite_configfiles),
                ]
            ),
        message:
            "Archive of sources and results"
        script:
            "../scripts/provenance/archive.py"
