"""The numbers that no other result holds: what the article argues with, the facts of the studies that it cites, and the
environment: packages, the Python that they need, and what CITATION.cff states of the software.

Not the Python that ran, on which no result depends: the manifest names it.
"""

from importlib.metadata import metadata, version
from pathlib import Path

import pandas as pd
import yaml

from dampbalance.project.case import Case
from dampbalance.project.files import read_csv, read_routes, write_json
from dampbalance.project.troubles import brief_troubles
from dampbalance.publishing.article import compiling
from dampbalance.publishing.article.derived_numbers import derived_numbers
from dampbalance.publishing.provenance.manifest import software
from dampbalance.studies import checking
from dampbalance.studies.shown import facts


def evidence(inputs, folder, case):
    return derived_numbers(
        case,
        features=read_routes(folder, "features", case.frequencies_hz),
        estimates=read_routes(folder, "estimates", case.frequencies_hz),
        claims=read_csv(inputs.claims, dtype=str),
        approaches=read_csv(inputs.approaches),
        schemes=read_csv(inputs.schemes),
        cycles=read_csv(inputs.cycles),
        unrounded=read_csv(inputs.unrounded),
    )


def of_study(file, cases, params):
    study = checking.read_study(file, params.schema, params.base)
    statements = {name: facts.fact(study, cases, spec) for name, spec in study.facts.items()}
    axes = pd.read_parquet(cases, columns=list(study.axis_names)).select_dtypes("number")
    ranges = {name: [float(axes[name].min()), float(axes[name].max())] for name in axes}
    return {"cases": study.cases, "facts": statements, "specs": study.facts, "ranges": ranges}


def environment(packages, citation):
    return {
        "python": metadata("dampbalance")["Requires-Python"].replace(">=", "≥ "),
        "packages": {name: version(name) for name in packages},
        "typesetter": compiling.version(),
        "software": software(yaml.safe_load(Path(citation).read_text(encoding="utf-8"))),
    }


if __name__ == "__main__":
    brief_troubles(snakemake.log)
    i, o, p = snakemake.input, snakemake.output, snakemake.params
    write_json(o.evidence, evidence(i, p.folder, Case.from_config(p.case)))
    studies = zip(p.studies, i.study_files, i.study_cases, strict=True)
    write_json(o.studies, {name: of_study(file, cases, p) for name, file, cases in studies})
    write_json(o.environment, environment(p.packages, i.citation))
