# F_k, c and K_z from measured records: snakemake --cores all --configfile config/measured.yaml
import glob

from dampbalance.project.documents import refuse
from dampbalance.records.errors import RecordError
from dampbalance.records.mapping import mapping_file, mapping_for, parts_of
from dampbalance.identification.outputs import OUTPUTS
from dampbalance.law.law import law_of

MEASURED = {one["name"]: {**one} for one in config.get("measured") or []}
for one in MEASURED.values():
    if one.get("mapping"):
        one["mapping"] = named_file(one["mapping"])
MEASURED_FILES = f"{RESULTS}/measured"


def record_files(name):
    """The records of a set, sorted; each pattern must find some."""
    place = list(MEASURED).index(name)
    found = []
    for i, pattern in enumerate(MEASURED[name]["records"]):
        found_here = glob.glob(pattern) or glob.glob(project_file(pattern))
        files = sorted(file for file in found_here if not file.endswith((".yaml", ".md")))
        if not files:
            refuse(
                ("measured", place, "records", i),
                f"no file {pattern}: name files, or a pattern, from the folder of the run or of the project on",
                CONFIG_FILES,
            )
        found.extend(file for file in files if file not in found)
    return found


def mapping_files(name):
    """The files that name the channels of a set, and those of its records that they name beside these."""
    records, given = record_files(name), MEASURED[name].get("mapping")
    found = {mapping_file(file, given) for file in records} - {None}
    try:
        parts = {part for file in records for part in parts_of(file, mapping_for(file, given))}
    except RecordError:  # the job will say it
        parts = set()
    return sorted(str(file) for file in found | (parts - {Path(file) for file in records}))


if MEASURED and workflow.is_main_process:
    try:
        if len(MEASURED) < len(config["measured"]):
            refuse(("measured",), "two sets have the same name; rename one", CONFIG_FILES)
        for place, (name, one) in enumerate(MEASURED.items()):
            records = len(record_files(name))
            try:
                law_of(one.get("terms"), one.get("given"), one.get("groups")).require_labels(
                    records
                )
            except ValueError as error:
                refuse(("measured", place), str(error), CONFIG_FILES)
    except ConfigurationError as error:
        raise WorkflowError(str(error)) from None


rule identify:
    input:
        records=lambda wildcards: [unmoved(file) for file in record_files(wildcards.set)],
        mappings=lambda wildcards: [unmoved(file) for file in mapping_files(wildcards.set)],
        modules=script_modules("measured/identify.py"),
    output:
        # Earlier results stay when the job fails, and only its mark goes: the next run finds that missing and tries again.
        **{name.replace(".", "_"): update(f"{MEASURED_FILES}/{{set}}/{name}") for name in OUTPUTS},
        mark=touch(f"{MEASURED_FILES}/{{set}}/.complete"),
    wildcard_constraints:
        set="[A-Za-z0-9_-]+",
    params:
        settings=lambda wildcards: MEASURED[wildcards.set],
        folder=lambda wildcards: placed(f"{MEASURED_FILES}/{wildcards.set}"),
    message:
        "F_k, c and K_z from the records of {wildcards.set}"
    script:
        "../scripts/measured/identify.py"


rule measured:
    input:
        sets=expand(f"{MEASURED_FILES}/{{set}}/identification.csv", set=MEASURED),
        modules=script_modules("measured/measured.py"),
    output:
        csv=f"{MEASURED_FILES}/identification.csv",
    params:
        names=list(MEASURED),
    message:
        "Estimates of all sets of records"
    script:
        "../scripts/measured/measured.py"
