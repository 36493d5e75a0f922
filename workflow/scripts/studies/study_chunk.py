"""The cases of one chunk of a study, as Parquet; says how much of the study is done and how long the rest takes."""

import os
import sys
import time
from pathlib import Path

from dampbalance import __version__
from dampbalance.project.troubles import brief_troubles
from dampbalance.studies import case_files, cases, checking, evaluate


def main(path, params, chunk, threads):
    study = checking.read_study(params.file, params.base)
    parts = evaluate.in_parts(study, *cases.chunk_bounds(study, chunk), threads=threads)
    case_files.write_parts(path, parts, study, __version__)
    return study


if __name__ == "__main__":
    brief_troubles(snakemake.log)
    path = Path(snakemake.output.chunk)
    study = main(path, snakemake.params, int(snakemake.wildcards.chunk), snakemake.threads)
    print(
        cases.progress(
            study,
            path.parent,
            snakemake.params.chunks,
            float(os.environ.get("DAMPBALANCE_STARTED", "nan")),
            time.time(),
        ),
        file=sys.stderr,
    )
