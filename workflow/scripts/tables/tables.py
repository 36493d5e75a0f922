"""The paper's tables at each frequency, and every approach at every frequency, as CSV and Markdown."""

from dampbalance.features import Features
from dampbalance.project.case import oscillator_from, pairs_from
from dampbalance.project.files import read_csv, write_csv, write_text
from dampbalance.replication import comparison, tables

TITLES = {
    "table1": "Table 1: amplitudes, slip onset and phase",
    "table2": "Table 2: energy integrals and estimates by direct integration",
    "table3": "Table 3: estimates of the harmonic approaches, phase and slip time common to all levels",
    "approaches": "Errors of F_k and c by every approach, phase and frequency",
    "statistics": "Least squares, and mean and standard deviation of the pairs",
}


def main(folder, frequency, claims):
    features, estimates = (
        {route: read_csv(f"{folder}/{kind}/{route}/{frequency}.csv") for route in tables.ROUTES}
        for kind in ("features", "estimates")
    )
    return {
        "table1": tables.table1(features, claims),
        "table2": tables.table2(features, estimates, claims),
        "table3": tables.table3(estimates, claims),
        "statistics": tables.statistics(estimates, claims),
    }


def compare(folder, frequencies_hz, oscillator, pairs):
    features = {
        frequency: Features.from_frame(read_csv(f"{folder}/features/exact/{frequency}.csv"))
        for frequency in frequencies_hz
    }
    return comparison.approaches_table(
        features, frequencies_hz, oscillator_from(oscillator), pairs_from(pairs)
    )


if __name__ == "__main__":
    p = snakemake.params
    printed = (
        read_csv(snakemake.input.claims, dtype={"printed": str}) if snakemake.input.claims else None
    )
    for i, (frequency, hz) in enumerate(p.frequencies_hz.items()):
        made = main(p.folder, frequency, printed if i == 0 else None)
        for name, table in made.items():
            path = f"{p.folder}/tables/{name}" + (f"_{frequency}" if i else "")
            write_csv(f"{path}.csv", table)
            write_text(f"{path}.md", tables.markdown(table, f"{TITLES[name]}, {hz:g} Hz"))
    everywhere = compare(p.folder, p.frequencies_hz, p.oscillator, p.pairs)
    path = f"{p.folder}/tables/approaches"
    write_csv(f"{path}.csv", everywhere)
    write_text(f"{path}.md", comparison.approaches_markdown(everywhere, TITLES["approaches"]))
