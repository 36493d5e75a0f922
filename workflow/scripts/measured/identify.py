"""F_k, c and K_z from one set of records."""

import sys

from dampbalance.measured import configured, identify
from dampbalance.project.troubles import brief_troubles

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    p = snakemake.params
    try:
        answer = identify(list(snakemake.input.records), **configured(p.settings))
    except ValueError as error:
        sys.exit(f"error: {error}")
    answer.save(p.folder, overwrite=True)
