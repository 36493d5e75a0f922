"""All cases of each small study of the paper in one Parquet file, and what it is."""

from dampbalance import __version__
from dampbalance.project.troubles import brief_troubles
from dampbalance.studies import checking, evaluate, outputs

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    p, output = snakemake.params, snakemake.output
    for file, cases, manifest in zip(p.files, output.cases, output.manifests, strict=True):
        study = checking.read_study(file, p.schema, p.base)
        parts = evaluate.in_parts(study, 0, study.cases, threads=snakemake.threads)
        outputs.write_parts(cases, parts, study, __version__)
        outputs.write_manifest(manifest, cases, study, __version__)
