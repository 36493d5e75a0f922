"""Figure 1: the oscillator and its contact."""

from dampbalance.figures import ALT, save, schematic

if __name__ == "__main__":
    save(schematic(), snakemake.output.svg, snakemake.output.png, ALT["figure1"])
