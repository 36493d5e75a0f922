"""The numbers that no other result holds, and the article's own figures: how the printed digits arose, and the findings
at a glance.

Numbers: what the article argues with; what the studies that it cites show; and the environment: packages, the Python
that they need, and what CITATION.cff states of the software. Not the Python that ran, on which no result depends: the
manifest names it.
"""

from importlib.metadata import metadata, version
from pathlib import Path

import pandas as pd

from dampbalance.figures.numerics import ALT_OF_NUMERICS, GLANCE_ALT, Evidence, glance
from dampbalance.figures.numerics import numerics as how_digits_arose
from dampbalance.figures.style import save
from dampbalance.project.case import Case
from dampbalance.project.documents import read_yaml
from dampbalance.project.files import read_csv, write_rows
from dampbalance.publishing.article import compiling
from dampbalance.publishing.article import derived_numbers as derived
from dampbalance.publishing.provenance.manifest import software
from dampbalance.replication.authors_route import effective_damping
from dampbalance.replication.claims.rivals import rivals
from dampbalance.replication.numbers import by_key, features_of, with_claims
from dampbalance.studies.reading_study import read_study
from dampbalance.studies.shown.paragraph import paragraph


def of_studies(inputs, papers):
    for file, cases, paper in zip(inputs.study_files, inputs.study_cases, papers, strict=True):
        study = read_study(file, paper)
        yield from derived.of_study(study, *paragraph(study, cases)).items()


def of_environment(packages, citation):
    needed = metadata("dampbalance")["Requires-Python"].replace(">=", "≥ ")
    stated = software(read_yaml(citation))
    versions = {name: version(name) for name in packages}
    return derived.of_environment(versions, compiling.version(), needed, stated)


def figures(seen, output, case, frequency):
    oscillator, numerics = case.oscillator, case.numerics
    unit = numerics.tabulated["t_s_unit_s"]
    of_digits = how_digits_arose(seen, oscillator, numerics.step_s, unit)
    save(of_digits, output.numerics_svg, output.numerics_png, ALT_OF_NUMERICS)
    effective = effective_damping(case, case.omega(frequency))
    findings = glance(seen, oscillator.c, effective)
    save(findings, output.glance_svg, output.glance_png, GLANCE_ALT)


if __name__ == "__main__":
    i, o, p = snakemake.input, snakemake.output, snakemake.params
    case = Case.from_config(p.case)
    claims = read_csv(i.claims, dtype=str)
    numbers = with_claims(read_csv(i.numbers), claims)
    unrounded = features_of(by_key(numbers), "unrounded", p.frequency, case.omega(p.frequency))
    schemes, cycles = rivals(Path(i.rivals[0]).parent, case, p.frequency, unrounded)
    own = derived.derived_numbers(case, numbers, claims, schemes, cycles)
    rest = dict(of_studies(i, p.papers)) | of_environment(p.packages, i.citation)
    write_rows(o.derived, derived.table(own | rest))
    instants = derived.sampling_instants(cycles, numbers)
    figures(Evidence(numbers, schemes, pd.read_parquet(i.steps), instants), o, case, p.frequency)
