"""The facts of the parameter studies that the article cites, in one file."""

import pandas as pd

from dampbalance.project.files import write_json
from dampbalance.project.troubles import brief_troubles
from dampbalance.studies import checking
from dampbalance.studies.shown import facts


def main(file, cases, params):
    study = checking.read_study(file, params.schema, params.base)
    statements = {name: facts.fact(study, cases, spec) for name, spec in study.facts.items()}
    axes = pd.read_parquet(cases, columns=list(study.axis_names)).select_dtypes("number")
    ranges = {name: [float(axes[name].min()), float(axes[name].max())] for name in axes}
    return {"cases": study.cases, "facts": statements, "specs": study.facts, "ranges": ranges}


if __name__ == "__main__":
    brief_troubles(snakemake.log)
    i = snakemake.input
    studies = {
        name: main(file, cases, snakemake.params)
        for name, file, cases in zip(snakemake.params.studies, i.files, i.cases, strict=True)
    }
    write_json(snakemake.output.json, studies)
