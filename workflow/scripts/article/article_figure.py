"""How the printed digits arose: six panels."""

import pandas as pd

from dampbalance.figures.numerics import ALT, Evidence, numerics
from dampbalance.figures.style import save
from dampbalance.project.case import Case
from dampbalance.project.files import read_csv
from dampbalance.project.troubles import brief_troubles

if __name__ == "__main__":
    brief_troubles()
    i, case = snakemake.input, Case.from_config(snakemake.params.case)
    evidence = Evidence(
        claims=read_csv(i.claims, dtype=str),
        exact=read_csv(i.exact),
        estimates=read_csv(i.estimates),
        schemes=read_csv(i.schemes),
        steps=pd.read_parquet(i.steps),
    )
    unit = case.numerics.tabulated["t_s_unit_s"]
    figure = numerics(evidence, case.oscillator, case.numerics.step_s, unit)
    save(figure, snakemake.output.svg, snakemake.output.png, ALT)
