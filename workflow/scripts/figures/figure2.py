"""Figure 2: the loop of friction force against velocity, at the first level."""

from dampbalance.figures import ALT, friction_velocity_loop, save
from dampbalance.motion.orbit import read_orbits
from dampbalance.project.troubles import brief_troubles

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    figure = friction_velocity_loop(read_orbits(snakemake.input.orbits)[0])
    save(figure, snakemake.output.svg, snakemake.output.png, ALT["figure2"])
