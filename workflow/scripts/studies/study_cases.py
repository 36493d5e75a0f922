"""All cases of a study in one Parquet file, and what it is."""

from dampbalance import __version__
from dampbalance.project.troubles import brief_troubles
from dampbalance.studies import checking, outputs

if __name__ == "__main__":
    brief_troubles()
    study = checking.read_study(
        snakemake.params.file, "workflow/schemas/study.schema.yaml", "config/config.yaml"
    )
    outputs.join_chunks(snakemake.output.cases, snakemake.input.chunks)
    outputs.write_manifest(snakemake.output.manifest, snakemake.output.cases, study, __version__)
