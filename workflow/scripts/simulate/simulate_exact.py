"""Exact steady orbits of one oscillator at one frequency and several levels, as JSON."""

from dampbalance.motion.orbit import steady_orbit
from dampbalance.project.case import motions_from, oscillator_from
from dampbalance.project.files import write_json


def main(oscillator, frequency_hz, levels_m):
    system = oscillator_from(oscillator)
    return [
        steady_orbit(system, motion).to_dict() for motion in motions_from(frequency_hz, levels_m)
    ]


if __name__ == "__main__":
    p = snakemake.params
    write_json(snakemake.output.orbits, main(p.oscillator, p.frequency_hz, p.levels_m))
