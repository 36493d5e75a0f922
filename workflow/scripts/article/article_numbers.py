"""The numbers that no other result holds, and the article's own figures: how the printed digits arose, and the findings
at a glance.

Numbers: the integrals of Table 2 by every scheme and way of rounding; what the article argues with; what the studies
that it cites show; and the environment: packages, the Python that they need, and what CITATION.cff states of the
software. Not the Python that ran, on which no result depends: the manifest names it.
"""

from importlib.metadata import metadata, version
from pathlib import Path

import pandas as pd

from dampbalance.figures.numerics import ALT_OF_NUMERICS, GLANCE_ALT, Evidence, glance, numerics
from dampbalance.figures.style import save
from dampbalance.project.case import Case
from dampbalance.project.documents import read_yaml
from dampbalance.project.files import read_csv, read_routes, write_csv, write_json
from dampbalance.publishing.article import compiling
from dampbalance.publishing.article.derived_numbers import (
    at_a_glance,
    derived_numbers,
    sampling_instants,
)
from dampbalance.publishing.provenance.manifest import software
from dampbalance.replication.claims.rivals import rivals
from dampbalance.studies import reading_study
from dampbalance.studies.parameters import parameter
from dampbalance.studies.shown.paragraph import paragraph


def evidence(inputs, folder, case, schemes, cycles):
    return derived_numbers(
        case,
        features=read_routes(folder, "features", case.frequencies_hz),
        estimates=read_routes(folder, "estimates", case.frequencies_hz),
        claims=read_csv(inputs.claims, dtype=str),
        approaches=read_csv(inputs.approaches),
        schemes=schemes,
        cycles=cycles,
        unrounded=read_csv(inputs.unrounded),
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


def figures(inputs, output, case, schemes, cycles):
    claims = read_csv(inputs.claims, dtype=str)
    seen = Evidence(
        claims=claims,
        exact=read_csv(inputs.exact),
        estimates=read_csv(inputs.as_published),
        schemes=schemes,
        steps=pd.read_parquet(inputs.steps),
        instants=sampling_instants(cycles, claims),
    )
    unit = case.numerics.tabulated["t_s_unit_s"]
    figure = numerics(seen, case.oscillator, case.numerics.step_s, unit)
    save(figure, output.numerics_svg, output.numerics_png, ALT_OF_NUMERICS)
    findings = at_a_glance(seen, read_csv(inputs.approaches), case)
    save(glance(*findings), output.glance_svg, output.glance_png, GLANCE_ALT)


if __name__ == "__main__":
    i, o, p = snakemake.input, snakemake.output, snakemake.params
    case = Case.from_config(p.case)
    schemes, cycles = rivals(Path(i.rivals[0]).parent, case, p.frequency, read_csv(i.unrounded))
    write_csv(o.schemes, schemes)
    write_json(o.evidence, evidence(i, p.folder, case, schemes, cycles))
    studies = map(of_study, i.study_files, i.study_cases, p.papers)
    write_json(o.studies, dict(zip(p.studies, studies, strict=True)))
    write_json(o.environment, environment(p.packages, i.citation))
    figures(i, o, case, schemes, cycles)
