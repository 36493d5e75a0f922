# Parameter studies: one file of config/studies, one study. The default target builds those that the article and the page
# cite, and no others.
#
# snakemake --cores all studies                                 all studies
# snakemake --cores all results/studies/frequency/summary.md    one
# … --dry-run                                                   what it would take: cases, chunks, bytes
#
# A large study is computed in chunks, a job each. An interrupted one goes on with the chunks that are missing.


include: "../functions/studies.smk"


STUDY_ROOMS = rooms("figures", "fit", "identification", "replication", "studies")


wildcard_constraints:
    study="[A-Za-z0-9][A-Za-z0-9_-]*",
    chunk="[0-9]+",


# Expensive and pure: with SNAKEMAKE_OUTPUT_CACHE, `make docs` has it kept for other clones. Rules that may be have no benchmark.
rule study_chunk:
    input:
        code=STUDY_ROOMS,
    output:
        chunk=temp(f"{STUDY_RESULTS}/{{study}}/chunks/{{chunk}}.parquet"),
    priority: NEXT
    threads: 1
    resources:
        mem_mb=chunk_memory_mb,
        runtime=30,
    params:
        paper=lambda wildcards: study_defaults(wildcards.study),
        file=lambda wildcards: study_file(wildcards.study),
        number=lambda wildcards: int(wildcards.chunk) + 1,
        chunks=lambda wildcards: study_plan(wildcards.study)[1].chunks,
        settings=lambda wildcards: study_settings(wildcards.study),
        computed_with=STUDY_LIBRARIES,
    message:
        "Study {wildcards.study}: chunk {params.number} of {params.chunks}"
    script:
        "../scripts/studies/study_chunk.py"


rule study_cases:
    input:
        chunks=study_chunks,
        code=STUDY_ROOMS,
    output:
        cases=f"{STUDY_RESULTS}/{{study}}/cases.parquet",
        manifest=f"{STUDY_RESULTS}/{{study}}/manifest.json",
    priority: NEXT
    threads: 1
    resources:
        mem_mb=chunk_memory_mb,
        runtime=60,
    params:
        paper=lambda wildcards: study_defaults(wildcards.study),
        file=lambda wildcards: study_file(wildcards.study),
        settings=lambda wildcards: study_settings(wildcards.study),
    message:
        "Study {wildcards.study}: all cases in one file"
    script:
        "../scripts/studies/study_cases.py"


rule study_figure:
    input:
        cases=rules.study_cases.output.cases,
        file=lambda wildcards: study_file(wildcards.study),
        code=STUDY_ROOMS,
    output:
        svg=report(
            f"{STUDY_RESULTS}/{{study}}/figure.svg",
            category="Studies",
            labels=study_title,
        ),
        png=f"{STUDY_RESULTS}/{{study}}/figure.png",
    priority: NEXT
    resources:
        mem_mb=1500,
        runtime=30,
    params:
        paper=lambda wildcards: study_defaults(wildcards.study),
    message:
        "Study {wildcards.study}: figure"
    script:
        "../scripts/studies/study_figure.py"


rule study_summary:
    input:
        cases=rules.study_cases.output.cases,
        figure=study_figure_files,
        file=lambda wildcards: study_file(wildcards.study),
        text=lambda wildcards: study_texts([wildcards.study]),
        code=STUDY_ROOMS,
    output:
        csv=f"{STUDY_RESULTS}/{{study}}/summary.csv",
        md=f"{STUDY_RESULTS}/{{study}}/summary.md",
    priority: NEXT
    resources:
        mem_mb=1500,
        runtime=30,
    params:
        paper=lambda wildcards: study_defaults(wildcards.study),
    message:
        "Study {wildcards.study}: summary"
    script:
        "../scripts/studies/study_summary.py"


rule studies:
    input:
        expand(rules.study_summary.output.md, study=STUDIES),
    message:
        "All studies are up to date"
