# F_k, c and K_z from measured records: snakemake --cores all --configfile config/measured.yaml


include: "../functions/measured.smk"


rule identify:
    input:
        records=lambda wildcards: record_files(wildcards.set),
        mappings=lambda wildcards: mapping_files(wildcards.set),
        code=PACKAGE,
    output:
        # Earlier results stay when the job fails, and only its mark goes: the next run finds that missing and tries again.
        *[update(file) for file in set_files("{set}", "forced")],
        mark=touch(f"{MEASURED_FILES}/{{set}}/.complete"),
    log:
        f"{MEASURED_LOGS}/{{set}}.log",
    wildcard_constraints:
        set=sets_of("forced"),
    params:
        settings=lambda wildcards: MEASURED[wildcards.set],
        folder=lambda wildcards: f"{MEASURED_FILES}/{wildcards.set}",
    message:
        "F_k, c and K_z from the records of {wildcards.set}"
    script:
        "../scripts/measured/identify.py"


use rule identify as identify_decays with:
    output:
        *[update(file) for file in set_files("{set}", "ring-down")],
        mark=touch(f"{MEASURED_FILES}/{{set}}/.complete"),
    wildcard_constraints:
        set=sets_of("ring-down"),


use rule identify as identify_stepped_sine with:
    output:
        *[update(file) for file in set_files("{set}", "stepped-sine")],
        mark=touch(f"{MEASURED_FILES}/{{set}}/.complete"),
    wildcard_constraints:
        set=sets_of("stepped-sine"),


use rule identify as identify_loops with:
    output:
        *[update(file) for file in set_files("{set}", "loops")],
        mark=touch(f"{MEASURED_FILES}/{{set}}/.complete"),
    wildcard_constraints:
        set=sets_of("loops"),


rule measured:
    input:
        sets=expand(f"{MEASURED_FILES}/{{set}}/identification.csv", set=MEASURED),
        code=PACKAGE,
    output:
        csv=f"{MEASURED_FILES}/identification.csv",
        summary=f"{MEASURED_FILES}/summary.txt",
    params:
        sets=list(MEASURED),
    message:
        "Estimates of all sets of records"
    script:
        "../scripts/measured/measured.py"
