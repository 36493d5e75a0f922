# What all rules share: the checked configuration, names of results, and which modules a script depends on.
from pathlib import Path

from snakemake.exceptions import WorkflowError
from snakemake.logging import logger

ROOT = Path(workflow.current_basedir).parent.parent

try:
    from dampbalance.configuration import ConfigurationError, check
    from dampbalance.dependencies import package_modules
    from dampbalance.feasibility import check_feasible
except ImportError as error:
    raise WorkflowError(
        f"{error}: the environment lacks a package of this project. Run 'make', or activate .venv ('. .venv/bin/activate')."
    ) from None

if workflow.is_main_process:
    try:
        check(
            config,
            ROOT / "workflow/schemas/config.schema.yaml",
            workflow.configfiles,
        )
        for notice in check_feasible(config, workflow.configfiles):
            logger.warning(notice)
    except ConfigurationError as error:
        raise WorkflowError(str(error)) from None

CASE = config["case"]
FREQUENCIES = list(config["excitation"]["frequencies_hz"])
ROUTES = ["exact", "as_published"]
RESULTS = f"results/{CASE}"


def frequency_hz(wildcards):
    """The drive frequency that a rule's wildcard names, Hz."""
    return config["excitation"]["frequencies_hz"][wildcards.frequency]


def script_modules(script):
    """Package files that a script depends on, as inputs of its rule: an edit of any of them reruns it, no other does."""
    return package_modules(ROOT / "workflow/scripts" / script, ROOT / "src", relative_to=Path.cwd())


def published_files(wildcards):
    """The printed numbers, without the verdicts on record, which only the check compares with."""
    files = Path(config["published"]).glob("*.csv")
    return sorted(str(file) for file in files if file.name != "verdicts.csv")


wildcard_constraints:
    frequency="[A-Za-z0-9_-]+",
    route="|".join(ROUTES),
