# What all rules share: the checked configuration, names of results, and which modules a script depends on.
from pathlib import Path

from snakemake.exceptions import WorkflowError
from snakemake.logging import logger

ROOT = Path(workflow.current_basedir).parent.parent

try:
    from dampbalance.project.case import check
    from dampbalance.project.documents import ConfigurationError
    from dampbalance.project.dependencies import package_modules
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
        )
        for notice in check_feasible(config, CONFIG_FILES):
            logger.warning(notice)
    except ConfigurationError as error:
        raise WorkflowError(str(error)) from None

CASE = config["case"]
FREQUENCIES_HZ = {f["name"]: f["hz"] for f in config["excitation"]["frequencies"]}
FREQUENCIES = list(FREQUENCIES_HZ)
LEVELS_M = config["excitation"]["levels_m"]
ROUTES = ["exact", "as_published"]
RESULTS = f"results/{CASE}"


def frequency_hz(wildcards):
    """The drive frequency that a rule's wildcard names, Hz."""
    return FREQUENCIES_HZ[wildcards.frequency]


def script_modules(script):
    """Package files that a script depends on, as inputs of its rule: an edit of any of them reruns it, no other does."""
    return package_modules(ROOT / "workflow/scripts" / script, ROOT / "src", relative_to=Path.cwd())


wildcard_constraints:
    frequency="[A-Za-z0-9_-]+",
    route="|".join(ROUTES),
