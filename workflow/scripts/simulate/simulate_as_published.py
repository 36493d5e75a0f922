"""Fixed-step records of one oscillator at one frequency and several levels, stacked in one table by level."""

import pandas as pd

from dampbalance.motion.fixed_step import simulate
from dampbalance.project.case import motions_from, oscillator_from
from dampbalance.project.files import write_parquet

KEPT_CYCLES = 3  # one to wait for the reversal, one to read, and one for the lock-in


def main(oscillator, frequency_hz, levels_m, numerics):
    system = oscillator_from(oscillator)
    coefficients = {
        "c_over_m": rounded(system.c / system.m, numerics["c_over_m_decimals"]),
        "k_over_m": rounded(system.k / system.m, numerics["k_over_m_decimals"]),
    }
    records = []
    for level, motion in enumerate(motions_from(frequency_hz, levels_m), start=1):
        record = simulate(
            system,
            motion,
            scheme=numerics["scheme"],
            step=numerics["step_s"],
            cycles=numerics["cycles"],
            keep_cycles=KEPT_CYCLES,
            **coefficients,
        )
        records.append(record.to_frame().assign(level=level))
    return pd.concat(records, ignore_index=True)


def rounded(value, decimals):
    return value if decimals is None else round(value, decimals)


if __name__ == "__main__":
    p = snakemake.params
    table = main(p.oscillator, p.frequency_hz, p.levels_m, p.numerics)
    write_parquet(snakemake.output.records, table)
