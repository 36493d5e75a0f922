"""What Snakemake and the scripts of rules import in every run, or in many. Nothing of the package: each run imports
that of its own folder."""

import nbformat  # noqa: F401
import scipy.stats  # noqa: F401
import smart_open  # noqa: F401
import snakemake.cli
import snakemake.report.html_reporter
import yte  # noqa: F401
from forks import prepare

prepare()
snakemake.cli.get_argument_parser()  # finds the plugins
