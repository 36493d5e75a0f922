"""The cases of one chunk of a study, as Parquet; says how much of the study is done and how long the rest takes."""

import os
import sys
import time
from pathlib import Path

from dampbalance import __version__
from dampbalance.project.troubles import brief_troubles
from dampbalance.studies import checking, evaluate, outputs, plan


def main(file, chunk, threads):
    study = checking.read_study(file, "workflow/schemas/study.schema.yaml", "config/config.yaml")
    return study, evaluate.evaluate(study, *plan.chunk_bounds(study, chunk), threads=threads)


if __name__ == "__main__":
    brief_troubles()
    path = Path(snakemake.output.chunk)
    study, cases = main(snakemake.params.file, int(snakemake.wildcards.chunk), snakemake.threads)
    outputs.write_chunk(path, cases, study, __version__)
    print(
        plan.progress(
            study,
            path.parent,
            snakemake.params.chunks,
            float(os.environ.get("DAMPBALANCE_STARTED", "nan")),
            time.time(),
        ),
        file=sys.stderr,
    )
