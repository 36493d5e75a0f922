"""The numbers that no other result holds, and the article's own figures: how the printed digits arose, and the findings
at a glance.

Numbers: the integrals of Table 2 by every scheme and way of rounding, and a in each steady cycle, by rivals as well;
what the article argues with; what the studies that it cites show; and the environment: packages, the Python that they
need, and what CITATION.cff states of the software. Not the Python that ran, on which no result depends: the manifest
names it.
"""

from importlib.metadata import metadata, version

import pandas as pd

from dampbalance.figures.numerics import ALT_OF_NUMERICS, GLANCE_ALT, Evidence, glance
from dampbalance.figures.numerics import numerics as draw_numerics
from dampbalance.figures.style import save
from dampbalance.project.case import Case
from dampbalance.project.documents import read_yaml
from dampbalance.project.files import read_csv, write_csv, write_json
from dampbalance.publishing.article import compiling
from dampbalance.publishing.article.derived_numbers import (
    at_a_glance,
    derived_numbers,
    sampling_instants,
)
from dampbalance.publishing.provenance.manifest import software
from dampbalance.replication.authors_route import scheme_table, trial_table
from dampbalance.replication.numbers import with_claims
from dampbalance.studies import reading_study
from dampbalance.studies.parameters import parameter
from dampbalance.studies.shown.paragraph import paragraph


def numbers(inputs):
    return with_claims(read_csv(inputs.numbers), read_csv(inputs.claims, dtype=str))


def evidence(inputs, output, case):
    return derived_numbers(
        case,
        numbers=numbers(inputs),
        claims=read_csv(inputs.claims, dtype=str),
        approaches=read_csv(inputs.approaches),
        schemes=read_csv(output.schemes),
        cycles=read_csv(output.cycles),
    )


def of_study(file, cases, paper):
    study = reading_study.read_study(file, paper)
    text, numbers = paragraph(study, cases)
    ranges = {name: study.extent(name) for name in study.axis_names if not parameter(name).is_word}
    return {"cases": study.cases, "numbers": numbers, "ranges": ranges, "paragraph": text}


def environment(packages, citation):
    return {
        "python": metadata("dampbalance")["Requires-Python"].replace(">=", "≥ "),
        "packages": {name: version(name) for name in packages},
        "typesetter": compiling.version(),
        "software": software(read_yaml(citation)),
    }


def figures(inputs, output, case):
    joined = numbers(inputs)
    seen = Evidence(
        numbers=joined,
        schemes=read_csv(output.schemes),
        steps=pd.read_parquet(inputs.steps),
        instants=sampling_instants(read_csv(output.cycles), joined),
    )
    unit = case.numerics.tabulated["t_s_unit_s"]
    figure = draw_numerics(seen, case.oscillator, case.numerics.step_s, unit)
    save(figure, output.numerics_svg, output.numerics_png, ALT_OF_NUMERICS)
    findings = at_a_glance(seen, read_csv(inputs.approaches), case)
    save(glance(*findings), output.glance_svg, output.glance_png, GLANCE_ALT)


if __name__ == "__main__":
    i, o, p = snakemake.input, snakemake.output, snakemake.params
    case = Case.from_config(p.case)
    write_csv(o.schemes, scheme_table(case, p.frequency))
    write_csv(o.cycles, trial_table(case, p.frequency))
    write_json(o.evidence, evidence(i, o, case))
    studies = map(of_study, i.study_files, i.study_cases, p.papers)
    write_json(o.studies, dict(zip(p.studies, studies, strict=True)))
    write_json(o.environment, environment(p.packages, i.citation))
    figures(i, o, case)
