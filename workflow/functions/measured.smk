# Sets of measured records: their files, and checks of them before anything is read.
import glob
import logging
import runpy

from snakemake.common import NOTHING_TO_BE_DONE_MSG
from dampbalance.project.documents import refuse
from dampbalance.identification.outputs import OVERVIEW, SUMMARY as SET_SUMMARY, outputs_of

if config.get("measured"):  # slow to import
    from dampbalance.measured import not_taken
    from dampbalance.law.law import law_of
    from dampbalance.records.errors import RecordError
    from dampbalance.records.mapping import mapping_file, mapping_for, parts_of

MEASURED = {one["name"]: one for one in config.get("measured") or []}
MEASURED_FILES = f"{RESULTS}/measured"
MEASURED_LOGS = f"results/logs/{CASE.name}"
FROM = "relative to the folder of the run"


def kind_of(name):
    """Return the kind of records of a set: forced, ring-down for free decays, stepped-sine for tables, or loops."""
    return MEASURED[name].get("kind", "forced")


def sets_of(kind):
    """Return a pattern for the names of the sets of a kind; one that matches no name where there is none."""
    return "|".join(name for name in MEASURED if kind_of(name) == kind) or "[.]"


def set_files(name, kind):
    """Return the results of a set of a kind."""
    return [f"{MEASURED_FILES}/{name}/{file}" for file in outputs_of(kind)]


def measured_files():
    """Return the results of all sets."""
    return [
        *(file for name in MEASURED for file in set_files(name, kind_of(name))),
        *(f"{MEASURED_FILES}/{name}/.complete" for name in MEASURED),
    ]


def show_tables(names):
    """Print the tables of sets, and the table of all where there are several."""
    several = [f"{MEASURED_FILES}/{SET_SUMMARY}"] if len(MEASURED) > 1 else []
    for file in [*(f"{MEASURED_FILES}/{name}/{SET_SUMMARY}" for name in names), *several]:
        if Path(file).is_file():
            print(Path(file).read_text(encoding="utf-8"))


class NothingToDo(logging.Filter):
    """Shows the table again when nothing was to be done, as Snakemake then calls no hook."""

    def filter(self, record):
        if record.getMessage() == NOTHING_TO_BE_DONE_MSG and not workflow.dryrun:
            show_tables([] if len(MEASURED) > 1 else MEASURED)
        return True


if MEASURED and workflow.is_main_process:
    logger.addFilter(NothingToDo())


def overview_with_failures():
    """Write and return the table of all sets when some could not be identified; the next run makes it anew."""
    folder = Path(MEASURED_FILES)
    folder.mkdir(parents=True, exist_ok=True)
    script = runpy.run_path(f"{ROOT}/workflow/scripts/measured/measured.py")
    text = script["summarise"](folder, failures())
    for name in OVERVIEW:
        os.utime(folder / name, (0, 0))
    return text


def failures():
    """Return, for each set, why it could not be identified, from its log; "" where it was."""
    errors = dict.fromkeys(MEASURED, "")
    for name in MEASURED:
        if not Path(f"{MEASURED_FILES}/{name}/.complete").exists():
            log = Path(f"{MEASURED_LOGS}/{name}.log")
            lines = log.read_text(encoding="utf-8").split("\n") if log.exists() else []
            filled = [line for line in lines if line.strip()] or ["its job did not start"]
            errors[name] = filled[-1].removeprefix("error: ")
    return errors


def refuse_of(name, *key, text):
    """Refuse a key of a set."""
    refuse(("measured", list(MEASURED).index(name), *key), text, CONFIG_FILES)


def matching(pattern):
    """Return the files that match a pattern, relative to the folder of the run."""
    if Path(pattern).is_file():  # its name may have brackets
        return [pattern]
    return glob.glob(pattern)


def record_files(name):
    """Return the records of a set, sorted; each pattern must match some."""
    records = []
    for i, pattern in enumerate(MEASURED[name]["records"]):
        files = sorted(file for file in matching(pattern) if not file.endswith((".yaml", ".md")))
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
            for key, text in not_taken(one).items():
                refuse_of(name, key, text=text)
            try:
                law_of(one.get("terms"), one.get("given"), one.get("groups")).require_labels(
                    len(record_files(name))
                )
            except ValueError as error:
                refuse_of(name, text=str(error))
    except (ConfigurationError, RecordError) as error:
        raise WorkflowError(str(error)) from None
