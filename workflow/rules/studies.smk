# Parameter studies: one file of config/studies, one study. The default target builds those that the article and the page
# cite, and no others.
#
# snakemake --cores all studies                                 all studies
# snakemake --cores all results/studies/frequency/summary.md    one
#
# One job computes, draws and describes a study. A large one is computed in chunks, a job each: after an interruption only the
# missing chunks are computed, and a new title recomputes no case.
import re
from importlib.metadata import version

from dampbalance.project.wording import plain_text
from dampbalance.studies.cases import check_size, size_of
from dampbalance.studies.reading_study import read_study
from dampbalance.studies.shown.paragraph import template_of
from dampbalance.studies.study_file import paper_defaults

# Studies of the project's own configuration, or of a case of one's own, whose article and page cite them.
STUDY_PLACE = (
    "studies" if CASE.name == load_configfile(BASE_CONFIG)["case"] else f"{CASE.name}/studies"
)
STUDY_RESULTS = f"results/{STUDY_PLACE}"
STUDY_ROOMS = rooms("figures", "fit", "identification", "replication", "studies")
STUDY_FILES = {
    path.stem: project_file(f"config/studies/{path.name}")
    for path in sorted((ROOT / "config/studies").glob("*.yaml"))
}


def study_texts(names):
    """Return the templates of the paragraphs of studies that have one."""
    texts = (Path(STUDY_FILES[name]).with_suffix(".md.j2") for name in names)
    return [str(path) for path in texts if path.exists()]


def study_plan(name, file):
    """Return (study, its size, what it takes from the configuration), checked against the schema and the free disk."""
    if not re.fullmatch(r"(?!.*(.{1,3})\1{19}$)[A-Za-z0-9][A-Za-z0-9_-]{0,59}", name):
        raise ConfigurationError(
            f"{file}: the name of a study must be letters, digits, '-' and '_', 60 at most, with nothing 20 times in a row at "
            "its end; rename the file"
        )
    study = read_study(file, paper_defaults(config))
    template_of(study)
    size = size_of(study)
    if workflow.is_main_process and not Path(STUDY_RESULTS, name, "cases.parquet").exists():
        check_size(study, size, STUDY_RESULTS, file)
    return study, size, {"base": dict(study.fixed), "levels_m": [*study.levels]}


STUDY_PLANS = {}
for name, file in STUDY_FILES.items():
    try:
        STUDY_PLANS[name] = study_plan(name, file)
    except ConfigurationError as error:  # only this study is affected: no rule makes it
        logger.warning(str(error))

# Studies made by several jobs: those with chunks, and those without a figure.
IN_PARTS = [
    name for name, (study, size, _) in STUDY_PLANS.items() if size.chunks > 1 or not study.figure
]


def study_chunks(wildcards):
    """Return the chunks of a study in their order, none if one job computes all cases, and log its size."""
    name, (_, size, _) = wildcards.study, STUDY_PLANS[wildcards.study]
    logger.info(f"Study {name}: {size}")
    chunks = range(size.chunks if size.chunks > 1 else 0)
    return [f"{STUDY_RESULTS}/{name}/chunks/{chunk:05d}.parquet" for chunk in chunks]


wildcard_constraints:
    study="|".join(IN_PARTS) or "[.]",
    chunk="[0-9]+",


# Expensive and pure: with SNAKEMAKE_OUTPUT_CACHE, `make docs` caches it for other clones. Such rules can have no benchmark.
rule study_chunk:
    input:
        code=STUDY_ROOMS,
    output:
        chunk=temp(f"{STUDY_RESULTS}/{{study}}/chunks/{{chunk}}.parquet"),
    priority: NEXT
    # 0.5 GB for the script, whatever the size of the chunk, 0.6 GB for the Snakemakes that start it on a cluster, and half of
    # the sum in reserve; more at a retry. Measured: config/studies/CLUSTER.md.
    resources:
        mem_mb=lambda wildcards, attempt: 1650 * attempt,
        runtime=30,
    params:
        file=lambda wildcards: STUDY_FILES[wildcards.study],
        paper=lambda wildcards: STUDY_PLANS[wildcards.study][2],
        settings=lambda wildcards: STUDY_PLANS[wildcards.study][0].settings,
        number=lambda wildcards: int(wildcards.chunk) + 1,
        chunks=lambda wildcards: STUDY_PLANS[wildcards.study][1].chunks,
        # A cached chunk is valid for these libraries only; Snakemake does not know their versions.
        computed_with={
            name: version(name) for name in ("numpy", "scipy", "numba", "pandas", "pyarrow")
        },
    message:
        "Study {wildcards.study}: chunk {params.number} of {params.chunks}"
    script:
        "../scripts/studies/study_chunk.py"


rule study:
    input:
        file=lambda wildcards: STUDY_FILES[wildcards.study],
        text=lambda wildcards: study_texts([wildcards.study]),
        code=STUDY_ROOMS,
    output:
        cases=f"{STUDY_RESULTS}/{{study}}/cases.parquet",
        manifest=f"{STUDY_RESULTS}/{{study}}/manifest.json",
        svg=report(
            f"{STUDY_RESULTS}/{{study}}/figure.svg",
            category="Studies",
            labels=lambda wildcards: {"result": plain_text(STUDY_PLANS[wildcards.study][0].title)},
        ),
        png=f"{STUDY_RESULTS}/{{study}}/figure.png",
        csv=f"{STUDY_RESULTS}/{{study}}/summary.csv",
        md=f"{STUDY_RESULTS}/{{study}}/summary.md",
    wildcard_constraints:
        study="|".join(name for name in STUDY_PLANS if name not in IN_PARTS) or "[.]",
    priority: NEXT
    resources:
        mem_mb=lambda wildcards, attempt: 1650 * attempt,
        runtime=60,
    params:
        file=lambda wildcards: STUDY_FILES[wildcards.study],
        paper=lambda wildcards: STUDY_PLANS[wildcards.study][2],
        settings=lambda wildcards: STUDY_PLANS[wildcards.study][0].settings,
    message:
        "Study {wildcards.study}: cases, figure and summary"
    script:
        "../scripts/studies/study.py"


use rule study as study_cases with:
    input:
        chunks=study_chunks,
        code=STUDY_ROOMS,
    output:
        cases=rules.study.output.cases,
        manifest=rules.study.output.manifest,
    wildcard_constraints:
        study="|".join(IN_PARTS) or "[.]",
    message:
        "Study {wildcards.study}: all cases in one file"


use rule study as study_figure with:
    input:
        cases=rules.study.output.cases,
        file=lambda wildcards: STUDY_FILES[wildcards.study],
        code=STUDY_ROOMS,
    output:
        svg=rules.study.output.svg,
        png=rules.study.output.png,
    wildcard_constraints:
        study="|".join(IN_PARTS) or "[.]",
    message:
        "Study {wildcards.study}: figure"


use rule study as study_summary with:
    input:
        cases=rules.study.output.cases,
        figure=lambda wildcards: (
            rules.study.output.svg if STUDY_PLANS[wildcards.study][0].figure else []
        ),
        file=lambda wildcards: STUDY_FILES[wildcards.study],
        text=lambda wildcards: study_texts([wildcards.study]),
        code=STUDY_ROOMS,
    output:
        csv=rules.study.output.csv,
        md=rules.study.output.md,
    wildcard_constraints:
        study="|".join(IN_PARTS) or "[.]",
    message:
        "Study {wildcards.study}: summary"


rule studies:
    input:
        expand(rules.study.output.md, study=STUDY_FILES),
    message:
        "All studies are up to date"
