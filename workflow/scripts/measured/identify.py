"""F_k, c and K_z from one set of records."""

import sys

from dampbalance.identification.measured import identify
from dampbalance.project.troubles import brief_troubles

if __name__ == "__main__":
    brief_troubles()
    given = {key: value for key, value in snakemake.params.settings.items() if value is not None}
    for of_the_workflow in ("name", "records"):
        given.pop(of_the_workflow, None)
    quantities = {"stiffness_N_per_m": "stiffness", "mass_kg": "mass", "frequency_hz": "frequency"}
    given = {quantities.get(key, key): value for key, value in given.items()}
    try:
        found = identify(list(snakemake.input.records), kind="forced", **given)
    except ValueError as error:
        sys.exit(f"error: {error}")
    found.save(snakemake.params.folder, overwrite=True)
