"""The paper's tables at each frequency, and every approach at every frequency, as CSV and Markdown."""

from dampbalance.features import Features
from dampbalance.project.case import Case
from dampbalance.project.files import ROUTES, read_csv, read_routes, write_csv, write_text
from dampbalance.replication.comparison import approaches_markdown, approaches_table
from dampbalance.replication.rebuilt_tables import TITLES, RouteTables, markdown, paper_tables

if __name__ == "__main__":
    claims, folder = snakemake.input.claims, snakemake.params.folder
    case = Case.from_config(snakemake.params.case)
    features, estimates = (
        read_routes(folder, kind, case.frequencies_hz) for kind in ("features", "estimates")
    )
    routes = {route: RouteTables(features[route], estimates[route]) for route in ROUTES}
    printed = read_csv(claims) if claims else None
    for frequency, hz in case.frequencies_hz.items():
        for name, table in paper_tables(routes, frequency, printed).items():
            path = f"{folder}/tables/{name}{case.suffix(frequency)}"
            write_csv(f"{path}.csv", table)
            write_text(f"{path}.md", markdown(table, f"{TITLES[name]}, {hz:g} Hz"))
        printed = None  # the paper prints the first frequency only
    exact = {name: Features.from_frame(frame) for name, frame in features["exact"].items()}
    everywhere = approaches_table(exact, case)
    path = f"{folder}/tables/approaches"
    write_csv(f"{path}.csv", everywhere)
    write_text(f"{path}.md", approaches_markdown(everywhere, TITLES["approaches"]))
