"""Exact steady orbits at all levels, as JSON, and their features, a row per level: files for each frequency."""

from dampbalance.features import of_orbit, stack
from dampbalance.motion.orbit import steady_orbit
from dampbalance.project.case import Case
from dampbalance.project.files import write_csv, write_json

if __name__ == "__main__":
    case, output = Case.from_config(snakemake.params.case), snakemake.output
    for i, frequency in enumerate(case.frequencies_hz):
        orbits = [steady_orbit(case.oscillator, one) for one in case.motions(frequency)]
        features = stack([of_orbit(orbit) for orbit in orbits])
        write_json(output.orbits[i], [orbit.to_dict() for orbit in orbits])
        write_csv(output.features[i], features.with_phase(case.phase).to_frame())
