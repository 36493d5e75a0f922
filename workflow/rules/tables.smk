# The paper's tables: printed, as published and exact side by side, and likewise at the other frequencies. One more, which the
# paper lacks, has the error of every approach at every frequency.

TABLES = ["table1", "table2", "table3", "statistics"]


def table_files(extension):
    """Return the tables: table1.csv … at the first frequency, table1_<frequency>.csv … at the others; approaches.csv."""
    names = [f"{name}{CASE.suffix(hz)}" for hz in FREQUENCIES for name in TABLES]
    return [f"{RESULTS}/tables/{name}.{extension}" for name in [*names, "approaches"]]


def reported_table(file):
    """Return a table with its name in the report."""

    def title(wildcards):
        # Needed for a report only.
        from dampbalance.project.wording import plain_text
        from dampbalance.replication.rebuilt_tables import TITLES

        name, _, frequency = Path(file).stem.partition("_")
        hz = CASE.frequencies_hz[frequency or FREQUENCIES[0]]
        where = "" if name == "approaches" else f", at {hz:g} Hz"
        return {"result": plain_text(TITLES[name]) + where}

    return report(file, category="Tables", labels=title)


rule tables:
    input:
        numbers=f"{RESULTS}/numbers.csv",
        claims=f"{RESULTS}/claims.csv" if config["published"] else [],
        code=rooms("replication"),
    output:
        csv=[reported_table(file) for file in table_files("csv")],
        md=table_files("md"),
    priority: FIRST
    params:
        folder=lambda wildcards: RESULTS,
        case=of_case("frequencies_hz"),
    message:
        "Tables"
    script:
        "../scripts/tables/tables.py"
