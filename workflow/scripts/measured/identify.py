"""F_k, c and K_z from one set of records."""

import sys

from dampbalance.identification.run import identify_files, write_results
from dampbalance.project.troubles import brief_troubles

if __name__ == "__main__":
    brief_troubles()
    given = {key: value for key, value in snakemake.params.settings.items() if value is not None}
    for of_the_workflow in ("name", "records"):
        given.pop(of_the_workflow, None)
    k, mass = given.pop("stiffness_N_per_m"), given.pop("mass_kg", None)
    try:
        results = identify_files(list(snakemake.input.records), k, mass=mass, **given)
    except ValueError as error:
        sys.exit(f"error: {error}")
    write_results(results, snakemake.params.folder)
