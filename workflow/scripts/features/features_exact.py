"""Features of exact orbits, as a table with a row per level."""

from dampbalance.features import of_orbit, stack
from dampbalance.motion.orbit import read_orbits
from dampbalance.project.files import write_csv


def main(orbits_file, phase):
    features = stack([of_orbit(orbit) for orbit in read_orbits(orbits_file)])
    return features.with_phase(phase).to_frame()


if __name__ == "__main__":
    write_csv(snakemake.output.features, main(snakemake.input.orbits, snakemake.params.phase))
