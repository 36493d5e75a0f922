# Where the results come from: a manifest, and an archive with an RO-Crate. Included last: it looks at the rules.
#
# The manifest is made again when a result, a source or the commit changes; nothing but the archive depends on it, so that a
# commit rebuilds no result.


include: "../functions/provenance.smk"


rule manifest:
    input:
        results=everything_built,
        sources=lambda wildcards: list(sources_of(COMPUTING).values()),
    output:
        json=report(
            f"{RESULTS}/manifest.json",
            caption="../report/manifest.rst",
            category="Provenance",
            labels={"result": "What made the results: configuration, code, packages"},
        ),
    log:
        log_file("manifest"),
    conda:
        ENVIRONMENT
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


# It packs the folder of the project, which must be that of the results.
if Path.cwd() == ROOT:

    rule archive:
        input:
            manifest=rules.manifest.output.json,
            results=everything_built,
            sources=lambda wildcards: sorted(sources_of(PROJECT)),
        output:
            archive=f"results/archive/{ARCHIVE_NAME}.tar.gz",
        log:
            log_file("archive"),
        conda:
            ENVIRONMENT
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
