"""How the printed digits arose: six panels."""

import pandas as pd

from dampbalance.figures.numerics import ALT, Evidence, numerics
from dampbalance.figures.style import save
from dampbalance.project.case import oscillator_from
from dampbalance.project.files import read_csv

if __name__ == "__main__":
    i, p = snakemake.input, snakemake.params
    evidence = Evidence(
        claims=read_csv(i.claims, dtype=str),
        exact=read_csv(i.exact),
        estimates=read_csv(i.estimates),
        schemes=read_csv(i.schemes),
        steps=pd.read_parquet(i.steps),
    )
    numbers = p.numerics
    unit = numbers["tabulated"]["t_s_unit_s"]
    figure = numerics(evidence, oscillator_from(p.oscillator), numbers["step_s"], unit)
    save(figure, snakemake.output.svg, snakemake.output.png, ALT)
