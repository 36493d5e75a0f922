# Shared by all rules: the project's files, the checked configuration, names of results, and the code behind a script.
#
# Results go below the folder in which the workflow runs; the project's own files are taken from its folder, ROOT. The
# two differ under `snakemake --directory`, and when another workflow uses this one as a module (config/README.md).
import copy
import functools
import os
import shlex
import sys
from pathlib import Path

from snakemake.common.configfile import load_configfile
from snakemake.logging import logger
from snakemake.utils import update_config

try:
    from dampbalance.project.case import Case, check_case, excerpt, require_own_case
    from dampbalance.project.documents import ConfigurationError
    from dampbalance.project.files import ROUTES, remove_unfinished
    from dampbalance.publishing.provenance.manifest import files_of
    from dampbalance.replication.feasibility import check_feasible
except ImportError as error:
    raise WorkflowError(
        f"{error}: the environment lacks a package of this project. Run 'make', or activate .venv ('. .venv/bin/activate')."
    ) from None

# Snakemake puts the path of its Python unquoted into the command line that starts a script: a blank would divide it.
if Path(sys.executable).exists():
    sys.executable = shlex.quote(sys.executable)


def project_file(name):
    """Return a file of the project as a path from the folder in which the workflow runs."""
    return os.path.relpath(ROOT / name)


BASE_CONFIG = project_file("config/config.yaml")

# In the order in which they were merged: files named on the command line come last, and win.
OVERRIDING = list(workflow.overwrite_configfiles)
CONFIG_FILES = [BASE_CONFIG, *OVERRIDING]

# Another workflow that uses this one as a module passes only the keys that differ from the paper's case, perhaps in no file.
other = Path(workflow.main_snakefile).resolve()
if other not in (ROOT / "Snakefile", ROOT / "workflow/Snakefile"):
    # Merged like a file of the command line, whose keys come first.
    given, config = config, copy.deepcopy(config)
    update_config(config, load_configfile(BASE_CONFIG))
    update_config(config, given)
    OVERRIDING = []
    CONFIG_FILES = []

if workflow.is_main_process:
    try:
        check_case(config, CONFIG_FILES)
        if config["case"] == load_configfile(BASE_CONFIG)["case"]:
            require_own_case(OVERRIDING)
        for notice in check_feasible(Case.from_config(config), CONFIG_FILES):
            logger.warning(notice)
    except ConfigurationError as error:
        raise WorkflowError(str(error)) from None

CASE = Case.from_config(config)
FREQUENCIES = list(CASE.frequencies_hz)
RESULTS = f"results/{CASE.name}"
FIRST = 10  # priority of jobs for the paper's tables and verdicts: these are seen before the studies are computed
NEXT = 5  # priority of studies and of inputs of article and page; jobs that nothing waits for come last


def of_case(*fields):
    """Return these fields of the case as a rule's parameter: a change of any other does not rerun it."""
    return excerpt(config, *fields)


def of_routes(kind):
    """Return the tables of features or estimates, of both routes at every frequency."""
    return expand(
        f"{RESULTS}/{kind}/{{route}}/{{frequency}}.csv", route=ROUTES, frequency=FREQUENCIES
    )


@functools.cache
def rooms(*names):
    """Return the code that a script runs, as inputs of its rule: whole rooms of the package, and the locked libraries.

    Every script has those of the method. A test misses a room that a script imports, directly or through others.
    """
    start = [f"src/dampbalance/{name}" for name in (*METHOD, *names)]
    return [*map(project_file, files_of(ROOT, ["requirements.lock", *start]))]


METHOD = (
    *("__init__.py", "arguments.py", "arrays.py", "balance.py", "estimates.py", "features.py"),
    *("findings", "jit.py", "law", "model.py", "motion", "project", "records", "signals"),
    "solver.py",
)
PACKAGE = rooms("")  # all rooms, also those that a script finds through the face of the package


wildcard_constraints:
    frequency="[A-Za-z0-9_-]+",
    route="|".join(ROUTES),
