"""The versions with which the results were made."""

import platform
from importlib.metadata import version

from dampbalance.project.files import write_json

if __name__ == "__main__":
    packages = {name: version(name) for name in snakemake.params.packages}
    write_json(snakemake.output.json, {"python": platform.python_version(), "packages": packages})
