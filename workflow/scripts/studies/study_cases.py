"""All cases of a study in one Parquet file, from its chunks if it has any, and what it is."""

from dampbalance import __version__
from dampbalance.project.troubles import brief_troubles
from dampbalance.studies import checking, outputs

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    study = checking.read_study(
        snakemake.params.file, snakemake.params.schema, snakemake.params.base
    )
    cases = snakemake.output.cases
    if snakemake.input.chunks:
        outputs.join_chunks(cases, snakemake.input.chunks, study)
    else:
        from dampbalance.studies.evaluate import in_parts  # not needed to join

        parts = in_parts(study, 0, study.cases, threads=snakemake.threads)
        outputs.write_parts(cases, parts, study, __version__)
    outputs.write_manifest(snakemake.output.manifest, cases, study, __version__)
