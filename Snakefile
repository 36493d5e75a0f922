"""Rebuild of Liang & Feeny, DETC2010-28049, from config/config.yaml.

snakemake --cores all            everything, with a verdict on every printed number
snakemake --cores all check      the comparison with the recorded verdicts
snakemake --cores all tables     one kind of result: orbits, records, features, estimates, tables, figures, claims
"""

from snakemake.utils import min_version

min_version("9.0")


configfile: "config/config.yaml"


include: "workflow/rules/common.smk"
include: "workflow/rules/simulate.smk"
include: "workflow/rules/features.smk"
include: "workflow/rules/estimates.smk"
include: "workflow/rules/tables.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/claims.smk"
include: "workflow/rules/studies.smk"


onsuccess:
    if config["published"] and Path(f"{RESULTS}/summary.txt").exists():
        print(Path(f"{RESULTS}/summary.txt").read_text(encoding="utf-8"))


rule all:
    default_target: True
    input:
        rules.estimates.input,
        rules.tables.output,
        rules.figures.input,
        rules.check.output if config["published"] else [],
    message:
        "Everything is rebuilt"
