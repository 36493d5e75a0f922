"""Features of exact orbits, as a table with a row per level."""

from dampbalance.features import of_orbit, stack
from dampbalance.motion.orbit import read_orbits
from dampbalance.project.case import Case
from dampbalance.project.files import write_csv
from dampbalance.project.troubles import brief_troubles

if __name__ == "__main__":
    brief_troubles()
    case = Case.from_config(snakemake.params.case)
    features = stack([of_orbit(orbit) for orbit in read_orbits(snakemake.input.orbits)])
    write_csv(snakemake.output.features, features.with_phase(case.phase).to_frame())
