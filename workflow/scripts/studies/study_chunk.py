"""The cases of one chunk of a study, as Parquet."""

from dampbalance import __version__
from dampbalance.studies import case_files, cases, evaluate, reading_study

if __name__ == "__main__":
    study = reading_study.read_study(snakemake.params.file, snakemake.params.paper)
    start, stop = cases.chunk_bounds(study, int(snakemake.wildcards.chunk))
    parts = evaluate.in_parts(study, start, stop, threads=snakemake.threads)
    case_files.write_parts(snakemake.output.chunk, parts, study, __version__)
