# F_k, c and K_z from measured records: snakemake --cores all --configfile config/measured.yaml
import glob
import runpy

from dampbalance.identification.outputs import PICTURES, outputs_of
from dampbalance.project.documents import refuse

MEASURED = {one["name"]: one for one in config.get("measured") or []}
MEASURED_FILES = f"{RESULTS}/measured"
MEASURED_LOG = f"results/logs/{CASE.name}/{{}}.log"
FROM = "relative to the folder of the run"

if MEASURED:  # slow to import
    from dampbalance.law.law import law_of
    from dampbalance.records.errors import RecordError
    from dampbalance.records.mapping import mapping_file, mapping_for, parts_of


def names_of(kind):
    """Return the names of the sets of a kind of records."""
    return [name for name, one in MEASURED.items() if one.get("kind", "forced") == kind]


def set_files(name, kind):
    """Return the results of a set of a kind."""
    return [f"{MEASURED_FILES}/{name}/{file}" for file in outputs_of(kind)]


def measured_files():
    """Return the results of all sets, and their marks."""
    files = [file for kind in PICTURES for name in names_of(kind) for file in set_files(name, kind)]
    return files + [f"{MEASURED_FILES}/{name}/.complete" for name in MEASURED]


def failure(name):
    """Return why a set could not be identified, from its log; "" where it was."""
    log = Path(MEASURED_LOG.format(name))
    if Path(MEASURED_FILES, name, ".complete").exists():
        return ""
    return log.read_text(encoding="utf-8").strip() if log.exists() else "its job did not start"


def refuse_of(name, *key, text):
    """Refuse a key of a set."""
    refuse(("measured", list(MEASURED).index(name), *key), text, CONFIG_FILES)


def record_files(name):
    """Return the records of a set, sorted; each pattern must match some, relative to the folder of the run."""
    records = []
    for i, pattern in enumerate(MEASURED[name]["records"]):
        # the name of a file may have brackets
        found = [pattern] if Path(pattern).is_file() else glob.glob(pattern)
        files = sorted(file for file in found if not file.endswith((".yaml", ".md")))
        for folder in filter(os.path.isdir, files):
            refuse_of(name, "records", i, text=f"{folder} is a folder: name its files, {folder}/*")
        if not files:
            text = f"no file {pattern}: name files, or a pattern, {FROM}"
            refuse_of(name, "records", i, text=text)
        records.extend(file for file in files if file not in records)
    return records


def mapping_files(name):
    """Return the mappings of a set, and the further files of its records that these name."""
    records, given = record_files(name), MEASURED[name].get("mapping")
    mappings = {mapping_file(file, given) for file in records} - {None}
    parts = {part for file in records for part in parts_of(file, mapping_for(file, given))}
    return sorted(str(file) for file in mappings | (parts - {Path(file) for file in records}))


def require_files(name):
    """Refuse a set that names a missing file: Snakemake does not miss it as long as the results are there."""
    given = MEASURED[name].get("mapping")
    if given and not Path(given).exists():
        refuse_of(name, "mapping", text=f"no file or folder {given}: name one, {FROM}")
    for file in map(Path, record_files(name)):
        if given and mapping_file(file, given) is None:
            text = f"the folder {given} has no mapping of {file.name}: add {file.stem}.yaml"
            refuse_of(name, "mapping", text=text)
        rules = mapping_for(file, given)
        for quantity, channel in rules.channels.items():
            part = channel.file
            if part is not None and not (file.parent / part).is_file():
                text = f"no file {file.parent / part}: name one, from the record's folder on"
                refuse(("channels", quantity, "file"), text, [rules.source])


if MEASURED and workflow.is_main_process:
    try:
        if len({name.casefold() for name in MEASURED}) < len(config["measured"]):
            text = "two sets have the same name, capital or small; rename one"
            refuse(("measured",), text, CONFIG_FILES)
        for name, one in MEASURED.items():
            require_files(name)
            try:
                law = law_of(one.get("terms"), one.get("given"), one.get("groups"))
                law.require_labels(len(record_files(name)))
            except ValueError as error:
                refuse_of(name, text=str(error))
    except (ConfigurationError, RecordError) as error:
        raise WorkflowError(str(error)) from None


for kind in PICTURES:

    rule:
        name:
            f"identify_{kind.replace('-', '_')}"
        input:
            records=lambda wildcards: record_files(wildcards.set),
            mappings=lambda wildcards: mapping_files(wildcards.set),
            code=PACKAGE,
        output:
            # Earlier results stay when the job fails, and only its mark goes: the next run finds that missing and tries again.
            *map(update, set_files("{set}", kind)),
            mark=touch(f"{MEASURED_FILES}/{{set}}/.complete"),
        log:
            MEASURED_LOG.format("{set}"),
        wildcard_constraints:
            set="|".join(names_of(kind)) or "[.]",
        params:
            settings=lambda wildcards: MEASURED[wildcards.set],
            folder=lambda wildcards: f"{MEASURED_FILES}/{wildcards.set}",
        message:
            "F_k, c and K_z from the records of {wildcards.set}"
        script:
            "../scripts/measured/identify.py"


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
