"""F_k, c and K_z from one set of records."""

import sys

from dampbalance.identification.run import identify_files, write_results
from dampbalance.project.troubles import brief_troubles

if __name__ == "__main__":
    brief_troubles()
    given = {key: value for key, value in snakemake.params.settings.items() if value is not None}
    keys = {"mapping", "frequency_hz", "skip_cycles", "approaches", "phase", "replicates", "seed"}
    try:
        results = identify_files(
            list(snakemake.input.records),
            given["stiffness_N_per_m"],
            mass=given.get("mass_kg"),
            **{key: value for key, value in given.items() if key in keys},
        )
    except ValueError as error:
        sys.exit(f"error: {error}")
    write_results(results, snakemake.params.folder)
