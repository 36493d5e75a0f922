# Studies: their files, sizes and chunks, checked before anything is computed.
import functools
import re
import sys
from importlib.metadata import version

# Studies of the project's own configuration, or of a case of one's own, whose article and page cite them.
STUDY_PLACE = (
    "studies" if CASE.name == load_configfile(BASE_CONFIG)["case"] else f"{CASE.name}/studies"
)
STUDY_RESULTS = f"results/{STUDY_PLACE}"
STUDIES = sorted(path.stem for path in (ROOT / "config/studies").glob("*.yaml"))

# A cached chunk is valid for these libraries only; Snakemake does not know their versions.
STUDY_LIBRARIES = {name: version(name) for name in ("numpy", "scipy", "numba", "pandas", "pyarrow")}


def study_file(name):
    """Return the file of a study."""
    return project_file(f"config/studies/{name}.yaml")


def study_files(names):
    """Return files of studies as inputs of a rule."""
    return [*map(study_file, names)]


def study_texts(names):
    """Return the templates of the paragraphs of studies that have one."""
    texts = (Path(study_file(name)).with_suffix(".md.j2") for name in names)
    return [str(path) for path in texts if path.exists()]


@functools.cache
def study_plan(name):
    """Return (study, its size), checked against the schema and the free disk; one clear error for a file that is wrong."""
    from dampbalance.studies.cases import check_size, size_of
    from dampbalance.studies.reading_study import read_study
    from dampbalance.studies.study_file import paper_defaults
    from dampbalance.studies.shown.paragraph import template_of

    file = Path(study_file(name))
    if not re.fullmatch(r"(?!.*(.{1,3})\1{19}$)[A-Za-z0-9][A-Za-z0-9_-]{0,59}", name):
        raise WorkflowError(
            f"{file}: the name of a study must be letters, digits, '-' and '_', 60 at most, with nothing 20 times in a row at "
            "its end; rename the file"
        )
    if not file.exists():
        known = ", ".join(STUDIES)
        raise WorkflowError(f"{file}: there is no such study; known are {known}")
    try:
        study = read_study(file, paper_defaults(config))
        template_of(study)
        size = size_of(study)
        if workflow.is_main_process and not Path(f"{STUDY_RESULTS}/{name}/cases.parquet").exists():
            check_size(study, size, STUDY_RESULTS, file)
    except ConfigurationError as error:
        raise WorkflowError(str(error)) from None
    return study, size


def requested_studies():
    """Return the studies that the command line names, from which alone the targets follow at this point."""
    if "studies" in sys.argv:
        return STUDIES
    prefix = f"{STUDY_RESULTS}/"
    named = {arg.removeprefix(prefix).split("/")[0] for arg in sys.argv if arg.startswith(prefix)}
    return sorted(named)


if workflow.is_main_process:
    for name in requested_studies():
        logger.info(f"Study {name}: {study_plan(name)[1]}")
    unbuilt = [
        name for name in requested_studies() if not Path(STUDY_RESULTS, name, "summary.md").exists()
    ]
    if REPORT and unbuilt:
        raise WorkflowError(
            f"--report: not built are the studies {', '.join(unbuilt)}. Build them first, with --cores all in place of --report."
        )


def study_settings(name):
    """Return what the numbers of a study follow from in its file: a change of the rest computes no case again."""
    return study_plan(name)[0].settings


def study_defaults(name):
    """Return what a study takes from the configuration: a change of the rest reruns nothing."""
    study, _ = study_plan(name)
    return {"base": dict(study.fixed), "levels_m": [*study.levels]}


def study_chunks(wildcards):
    """Return the chunks of a study in their order; none where one job computes the whole study."""
    _, size = study_plan(wildcards.study)
    if size.chunks == 1:
        return []
    return [
        f"{STUDY_RESULTS}/{wildcards.study}/chunks/{chunk:05d}.parquet"
        for chunk in range(size.chunks)
    ]


def chunk_memory_mb(wildcards, attempt):
    """Return the memory of a job, MB; more at a retry.

    0.5 GB for the script, whatever the size of the chunk, 0.6 GB for the Snakemakes that start it on a cluster, half as
    much again to be safe. Measured: config/studies/CLUSTER.md.
    """
    return 1650 * attempt


def study_title(wildcards):
    """Return the name in the report of the study of a job."""
    from dampbalance.project.wording import plain_text  # needed for a report only

    return {"result": plain_text(study_plan(wildcards.study)[0].title)}


def study_figure_files(wildcards):
    """Return the figure of a study, if its file asks for one."""
    study, _ = study_plan(wildcards.study)
    folder = f"{STUDY_RESULTS}/{wildcards.study}"
    return [f"{folder}/figure.svg", f"{folder}/figure.png"] if study.figure else []
