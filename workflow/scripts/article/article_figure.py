"""The article's own figures: how the printed digits arose, and the findings at a glance."""

import pandas as pd

from dampbalance.figures.numerics import ALT, GLANCE_ALT, Evidence, glance, numerics
from dampbalance.figures.style import save
from dampbalance.project.case import Case
from dampbalance.project.files import read_csv
from dampbalance.project.troubles import brief_troubles
from dampbalance.publishing.article.derived_numbers import at_a_glance, sampling_instants

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    i, case = snakemake.input, Case.from_config(snakemake.params.case)
    claims = read_csv(i.claims, dtype=str)
    evidence = Evidence(
        claims=claims,
        exact=read_csv(i.exact),
        estimates=read_csv(i.estimates),
        schemes=read_csv(i.schemes),
        steps=pd.read_parquet(i.steps),
        instants=sampling_instants(read_csv(i.cycles), claims),
    )
    unit = case.numerics.tabulated["t_s_unit_s"]
    figure = numerics(evidence, case.oscillator, case.numerics.step_s, unit)
    o = snakemake.output
    save(figure, o.numerics_svg, o.numerics_png, ALT)
    findings = at_a_glance(evidence, read_csv(i.approaches), case)
    save(glance(*findings), o.glance_svg, o.glance_png, GLANCE_ALT)
