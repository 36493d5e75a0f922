"""Rebuild of Liang & Feeny, DETC2010-28049, from config/config.yaml.

snakemake --cores all            everything, with a verdict on every printed number
snakemake --cores all check      the comparison with the recorded verdicts
snakemake --cores all --configfile config/measured.yaml     identification from measured records
snakemake --cores all results/site     the site of documentation, with all studies
snakemake --cores all tables     one kind of result: features, estimates, tables, figures, claims
"""

import sys
from os.path import relpath
from pathlib import Path

from snakemake.exceptions import WorkflowError
from snakemake.utils import min_version

min_version("9.0")

# The folder of this file must be on disk: schemas and sources are read as files, also when this workflow is a module.
ROOT = Path(str(workflow.current_basedir)).resolve()
if not ROOT.is_dir():
    raise WorkflowError(
        f"{workflow.current_basedir} is no folder on this machine: clone the project, and name the Snakefile of the clone."
    )

# The default target of a workflow that uses this one as a module.
FIRST_RULE = workflow.default_target


configfile: relpath(ROOT / "config/config.yaml")


include: "workflow/rules/common.smk"
include: "workflow/rules/response.smk"
include: "workflow/rules/estimates.smk"
include: "workflow/rules/tables.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/claims.smk"
include: "workflow/rules/studies.smk"
include: "workflow/rules/measured.smk"
include: "workflow/rules/article.smk"
include: "workflow/rules/page.smk"
include: "workflow/rules/notebook.smk"
include: "workflow/rules/site.smk"
include: "workflow/rules/provenance.smk"


onsuccess:
    if config["published"] and compared_at() != COMPARED_BEFORE:
        summary = SUMMARY.read_text(encoding="utf-8")
        # The summary's first paragraph states whether verdicts changed; the rest is for a reader of the file.
        print(summary.partition("\n\n")[0])
        if WORSE in summary:
            print(f"All of them: {SUMMARY}; why: {rules.claims.output.md}")
            sys.exit(1)


onerror:
    # A killed job leaves a temporary file. No other job of this run is still alive.
    for folder in (RESULTS, STUDY_RESULTS):
        remove_unfinished(folder)
    if MEASURED:
        script = runpy.run_path(f"{ROOT}/workflow/scripts/measured/measured.py")
        print(
            script["summarise"](
                Path(MEASURED_FILES), {name: failure(name) for name in MEASURED}
            )
        )
        for file in rules.measured.output:  # the next run makes it anew
            os.utime(file, (0, 0))
    logged = "".join(Path(file).read_text(encoding="utf-8") for file in log)
    if "SIGKILL" in logged or "exit status 137" in logged:
        print(
            "A job was killed, usually because memory ran out: use fewer cores, or smaller chunks of a study."
        )
    print(
        "Finished results are kept. Remove the cause, then repeat the command: it continues from there."
    )
    sys.exit(1)


rule all:
    default_target: FIRST_RULE is None
    input:
        # Intermediate results are inputs as well: a job that fails removes its results, and Snakemake misses them only when
        # they are inputs here.
        rules.features.input if not MEASURED else [],
        rules.estimates.input if not MEASURED else [],
        [*rules.numbers.output, *rules.tables.output] if not MEASURED else [],
        rules.figures.output if not MEASURED else [],
        [*rules.claims.output, *rules.check.output] if config["published"] else [],
        rules.article.output if config["published"] else [],
        rules.notebook.output if config["published"] else [],
        [*rules.page.output, *rules.manifest.output] if not MEASURED else [],
        [*rules.measured.output, *measured_files()] if MEASURED else [],
    message:
        "Everything is rebuilt"
