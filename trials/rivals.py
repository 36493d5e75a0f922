"""Record anew the rivals of the as-published simulation, beside the printed numbers: a few seconds.

python trials/rivals.py [FOLDER]        default: paper/published
"""

from __future__ import annotations

import sys
from pathlib import Path

from dampbalance.project.case import Case
from dampbalance.project.documents import read_yaml
from dampbalance.project.files import write_csv
from dampbalance.replication.authors_route import scheme_table, trial_table
from dampbalance.replication.claims.rivals import FILES

if __name__ == "__main__":
    root = Path(__file__).resolve().parents[1]
    folder = Path(*sys.argv[1:]) if sys.argv[1:] else root / "paper/published"
    case = Case.from_config(read_yaml(root / "config/config.yaml"))
    frequency = next(iter(case.frequencies_hz))
    for name, table in zip(FILES, (scheme_table, trial_table), strict=True):
        write_csv(folder / name, table(case, frequency))
