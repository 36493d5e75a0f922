# What all rules share: the checked configuration, names of results, and which modules a script depends on.
from pathlib import Path

from snakemake.exceptions import WorkflowError
from snakemake.logging import logger

ROOT = Path(workflow.current_basedir).parent.parent

try:
    from dampbalance.balance import APPROACHES
    from dampbalance.project.case import Case, check, excerpt
    from dampbalance.project.documents import ConfigurationError
    from dampbalance.project.dependencies import package_modules
    from dampbalance.project.files import ROUTES
    from dampbalance.replication.feasibility import check_feasible
except ImportError as error:
    raise WorkflowError(
        f"{error}: the environment lacks a package of this project. Run 'make', or activate .venv ('. .venv/bin/activate')."
    ) from None

# In the order in which they were merged: files named on the command line come last, and win.
CONFIG_FILES = [
    *(file for file in workflow.configfiles if file not in workflow.overwrite_configfiles),
    *workflow.overwrite_configfiles,
]

if workflow.is_main_process:
    try:
        check(
            config,
            ROOT / "workflow/schemas/config.schema.yaml",
            CONFIG_FILES,
            APPROACHES,
        )
        for notice in check_feasible(Case.from_config(config), CONFIG_FILES):
            logger.warning(notice)
    except ConfigurationError as error:
        raise WorkflowError(str(error)) from None

CASE = Case.from_config(config)
FREQUENCIES = list(CASE.frequencies_hz)
RESULTS = f"results/{CASE.name}"


def of_case(*fields):
    """Those fields of the case as a rule's parameter: a change of any other does not rerun it."""
    return excerpt(config, *fields)


def at_frequency(*fields):
    """The same with the drive frequency that the rule's wildcard names, and no other."""
    return lambda wildcards: excerpt(config, *fields, frequency=wildcards.frequency)


def of_routes(kind):
    """The tables of features or estimates, of both routes at every frequency."""
    return expand(
        f"{RESULTS}/{kind}/{{route}}/{{frequency}}.csv", route=ROUTES, frequency=FREQUENCIES
    )


def script_modules(script):
    """Package files that a script depends on, as inputs of its rule: an edit of any of them reruns it, no other does."""
    return package_modules(ROOT / "workflow/scripts" / script, ROOT / "src", relative_to=Path.cwd())


wildcard_constraints:
    frequency="[A-Za-z0-9_-]+",
    route="|".join(ROUTES),
