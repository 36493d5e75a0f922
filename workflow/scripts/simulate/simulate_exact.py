"""Exact steady orbits at one frequency and all levels, as JSON."""

from dampbalance.motion.orbit import steady_orbit
from dampbalance.project.case import Case
from dampbalance.project.files import write_json
from dampbalance.project.troubles import brief_troubles

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    case = Case.from_config(snakemake.params.case)
    motions = case.motions(snakemake.wildcards.frequency)
    orbits = [steady_orbit(case.oscillator, motion).to_dict() for motion in motions]
    write_json(snakemake.output.orbits, orbits)
