# What all rules share: the project's files, the checked configuration, names of results, and which modules a script depends on.
#
# Results go below the folder in which the workflow runs; what the project brings along is taken from its own folder, ROOT. The
# two differ under `snakemake --directory`, and when another workflow uses this one as a module (config/README.md).
import copy
import os
import shlex
import sys
from pathlib import Path

from snakemake.common.configfile import load_configfile
from snakemake.logging import logger
from snakemake.utils import update_config

try:
    from dampbalance.balance import checks
    from dampbalance.project.case import Case, check, excerpt, require_own_case
    from dampbalance.project.documents import ConfigurationError, section_of
    from dampbalance.project.dependencies import package_modules
    from dampbalance.project.files import ROUTES, remove_unfinished
    from dampbalance.replication.feasibility import check_feasible
except ImportError as error:
    raise WorkflowError(
        f"{error}: the environment lacks a package of this project. Run 'make', or activate .venv ('. .venv/bin/activate')."
    ) from None

# Snakemake starts scripts by a line for the shell, which the path of its Python enters as it is: with a blank in it, in two words.
if Path(sys.executable).exists():
    sys.executable = shlex.quote(sys.executable)

IS_MODULE = not workflow.modifier.is_main_snakefile()
if workflow.modifier.path_modifier.modifies_prefixes:
    raise WorkflowError("replace_prefix would tear the results apart: use prefix instead.")
# What a module's `prefix` puts before the paths of its results.
PREFIX = str(workflow.modifier.modify_path(""))


def unmoved(path):
    """An input that the workflow does not make, before which a module's `prefix` is not put."""
    return local(str(path)) if IS_MODULE else str(path)


def project_file(name):
    """A file of the project, as a path from the folder in which the workflow runs."""
    return os.path.relpath(ROOT / name)


def named_file(name):
    """What a configuration names: a file or folder from the folder in which the workflow runs, or else the project's."""
    return name if Path.cwd() == ROOT or Path(name).exists() else project_file(name)


def placed(path):
    """Where a result is. Snakemake puts the prefix before inputs and outputs of rules, and before nothing else."""
    return f"{PREFIX}{path}"


BASE_CONFIG = project_file("config/config.yaml")

# A module's configuration holds what differs from the paper's case, like a file of the command line, and is merged like one:
# its keys come first.
if IS_MODULE:
    given, config = config, copy.deepcopy(config)
    update_config(config, load_configfile(BASE_CONFIG))
    update_config(config, given)

# In the order in which they were merged: files named on the command line come last, and win.
CONFIG_FILES = [
    *(file for file in workflow.configfiles if file not in workflow.overwrite_configfiles),
    *workflow.overwrite_configfiles,
]
if IS_MODULE:  # errors name the place where the other workflow sets a value
    theirs = os.path.relpath(str(workflow.main_snakefile))
    CONFIG_FILES = [BASE_CONFIG, *([section_of(given, CONFIG_FILES, theirs)] if given else [])]

if workflow.is_main_process:
    try:
        check(
            config,
            project_file("workflow/schemas/config.schema.yaml"),
            CONFIG_FILES,
            checks(),
        )
        if not IS_MODULE and config["case"] == load_configfile(BASE_CONFIG)["case"]:
            require_own_case(workflow.overwrite_configfiles)
        for notice in check_feasible(Case.from_config(config), CONFIG_FILES):
            logger.warning(notice)
    except ConfigurationError as error:
        raise WorkflowError(str(error)) from None

# Where jobs run in environments of conda, the package is that of the project's folder.
if any(str(method) == "conda" for method in workflow.deployment_settings.deployment_method):
    os.environ.update(PYTHONPATH=str(ROOT / "src"))

CASE = Case.from_config(config)
FREQUENCIES = list(CASE.frequencies_hz)
RESULTS = f"results/{CASE.name}"
LOGS = f"results/logs/{CASE.name}"
FIRST = 10  # priority of what leads to the paper's tables and verdicts: they are seen before the studies are computed
NEXT = 5  # of studies, and of what article and page wait for: jobs that nothing waits for fill the gaps
ENVIRONMENT = "../envs/dampbalance.yaml"
STUDY_DEFAULTS = {  # what a script needs to read the file of a study
    "schema": project_file("src/dampbalance/studies/study.schema.yaml"),
    "base": BASE_CONFIG,
}


def of_case(*fields):
    """Those fields of the case as a rule's parameter: a change of any other does not rerun it."""
    return excerpt(config, *fields)


def log_file(job, extension="log"):
    """What a job says, or how long it took (tsv)."""
    return f"{LOGS}/{job}.{extension}"


def study_log(job, extension="log"):
    """The same of a job of a study."""
    return f"results/logs/studies/{{study}}/{job}.{extension}"


def of_routes(kind):
    """The tables of features or estimates, of both routes at every frequency."""
    return expand(
        f"{RESULTS}/{kind}/{{route}}/{{frequency}}.csv", route=ROUTES, frequency=FREQUENCIES
    )


def script_modules(script):
    """Package files that a script depends on, as inputs of its rule: an edit of any of them reruns it, no other does."""
    return modules_behind(f"workflow/scripts/{script}")


def modules_behind(file):
    """Package files that a Python file of the project depends on."""
    modules = package_modules(ROOT / file, ROOT / "src", relative_to=Path.cwd())
    return [unmoved(module) for module in modules]


def project_input(name):
    """A file of the project as an input of a rule."""
    return unmoved(project_file(name))


wildcard_constraints:
    frequency="[A-Za-z0-9_-]+",
    route="|".join(ROUTES),
