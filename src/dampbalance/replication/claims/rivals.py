"""The rivals of the as-published simulation (other schemes, roundings, steps and damping), recorded in files.

Simulating them takes longer than the rest of the paper's case. A nightly test simulates them again and compares;
`trials/rivals.py` renews the records.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from ...features import Features
from ...project.case import Case
from ...project.files import read_csv
from ..authors_route import scheme_table, trial_table

FILES = "schemes.csv", "cycles.csv"


def rivals(
    folder: Path, case: Case, frequency: str, rebuilt: Features
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return `scheme_table` and `trial_table`: as recorded in a folder, or simulated for a case without records.

    rebuilt : unrounded features of the as-published simulation at this frequency; their a and W, with c, identify the
    case of the records.
    """
    schemes, cycles = (read_csv(folder / name) for name in FILES)
    own = cycles[(cycles["trial"] == "as_published") & (cycles["cycle"] == 0)]
    recorded = own[["c_N_s_per_m", "a_m", "W_J"]].to_numpy()
    c = np.full_like(rebuilt.a, case.oscillator.c)
    here = np.column_stack([c, rebuilt.a, rebuilt.W])
    # 1e-9 relative; another processor changes a and W by up to 5e-14
    if recorded.shape == here.shape and np.allclose(recorded, here, rtol=1e-9, atol=0.0):
        return schemes, cycles
    return scheme_table(case, frequency), trial_table(case, frequency)
