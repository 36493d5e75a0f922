"""Modules that Snakemake imports in every run, and the Snakefile in many.

None is of the package: each run imports that of its own folder.
"""

import jsonschema  # noqa: F401
import nbformat  # noqa: F401
import numba.np.arraymath  # noqa: F401
import pandas as pd  # noqa: F401
import scipy.linalg
import scipy.optimize
import scipy.stats  # noqa: F401
import smart_open  # noqa: F401
import snakemake.cli
import snakemake.report.html_reporter
import yte  # noqa: F401

snakemake.cli.get_argument_parser()  # finds the plugins
