"""All cases of one study in one Parquet file, from its chunks if it has any, and what it is."""

from dampbalance import __version__
from dampbalance.studies import case_files, evaluate, reading_study

if __name__ == "__main__":
    p, output, chunks = snakemake.params, snakemake.output, snakemake.input.get("chunks")
    study = reading_study.read_study(p.file, p.paper)
    if chunks:
        case_files.join_chunks(output.cases, chunks, study)
    else:
        parts = evaluate.in_parts(study, 0, study.cases, threads=snakemake.threads)
        case_files.write_parts(output.cases, parts, study, __version__)
    case_files.write_manifest(output.manifest, output.cases, study, __version__)
