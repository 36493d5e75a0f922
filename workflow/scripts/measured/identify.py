"""F_k, c and K_z from one set of records."""

import sys
from pathlib import Path

from dampbalance.measured import identify
from dampbalance.project.options import configured

if __name__ == "__main__":
    p = snakemake.params
    try:
        answer = identify(list(snakemake.input.records), **configured(p.settings))
    except ValueError as error:
        Path(snakemake.log[0]).write_text(str(error), encoding="utf-8")
        sys.exit(f"error: {error}")
    answer.save(p.folder, overwrite=True)
    print(answer.text())
