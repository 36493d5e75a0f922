"""The paper's tables at each frequency, and every approach at every frequency, as CSV and Markdown."""

from dampbalance.features import Features
from dampbalance.project.case import Case
from dampbalance.project.files import read_csv, read_routes, write_csv, write_text
from dampbalance.project.troubles import brief_troubles
from dampbalance.replication import comparison, tables


def at_frequency(features, estimates, frequency, claims):
    """The paper's tables: features and estimates are route → frequency → table."""
    features, estimates = (
        {route: tables_of[frequency] for route, tables_of in routes.items()}
        for routes in (features, estimates)
    )
    return {
        "table1": tables.table1(features, claims),
        "table2": tables.table2(features, estimates, claims),
        "table3": tables.table3(estimates, claims),
        "statistics": tables.statistics(estimates, claims),
    }


def compare(features, case):
    """Every approach at every frequency, from the exact features."""
    exact = {frequency: Features.from_frame(frame) for frequency, frame in features.items()}
    return comparison.approaches_table(exact, case)


if __name__ == "__main__":
    brief_troubles()
    claims, folder = snakemake.input.claims, snakemake.params.folder
    case = Case.from_config(snakemake.params.case)
    features, estimates = (
        read_routes(folder, kind, case.frequencies_hz) for kind in ("features", "estimates")
    )
    printed = read_csv(claims) if claims else None
    for frequency, hz in case.frequencies_hz.items():
        for name, table in at_frequency(features, estimates, frequency, printed).items():
            path = f"{folder}/tables/{name}{case.suffix(frequency)}"
            write_csv(f"{path}.csv", table)
            write_text(f"{path}.md", tables.markdown(table, f"{tables.TITLES[name]}, {hz:g} Hz"))
        printed = None  # the paper prints the first frequency only
    everywhere = compare(features["exact"], case)
    path = f"{folder}/tables/approaches"
    write_csv(f"{path}.csv", everywhere)
    write_text(
        f"{path}.md", comparison.approaches_markdown(everywhere, tables.TITLES["approaches"])
    )
