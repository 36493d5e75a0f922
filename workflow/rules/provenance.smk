# Where the results come from: a manifest. Included last: it looks at the rules.
#
# The manifest is made again when a result, a source or the commit changes; nothing depends on it, so that a
# commit rebuilds no result.


include: "../functions/provenance.smk"


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
