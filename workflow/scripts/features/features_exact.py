"""Features of exact orbits: a table for each frequency, with a row per level."""

from dampbalance.features import of_orbit, stack
from dampbalance.motion.orbit import read_orbits
from dampbalance.project.case import Case
from dampbalance.project.files import write_csv

if __name__ == "__main__":
    case, files = Case.from_config(snakemake.params.case), snakemake.input.orbits
    for orbits, output in zip(files, snakemake.output.features, strict=True):
        features = stack([of_orbit(orbit) for orbit in read_orbits(orbits)])
        write_csv(output, features.with_phase(case.phase).to_frame())
