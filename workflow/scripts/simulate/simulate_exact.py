"""Exact steady orbits at all levels, as JSON: a file for each frequency."""

from dampbalance.motion.orbit import steady_orbit
from dampbalance.project.case import Case
from dampbalance.project.files import write_json

if __name__ == "__main__":
    case = Case.from_config(snakemake.params.case)
    for frequency, file in zip(case.frequencies_hz, snakemake.output.orbits, strict=True):
        motions = case.motions(frequency)
        write_json(file, [steady_orbit(case.oscillator, one).to_dict() for one in motions])
