# The paper's tables: printed, as published and exact side by side; the other frequencies get tables of their own. And one that
# the paper lacks: the error of every approach at every frequency.

TABLES = ["table1", "table2", "table3", "statistics"]


def table_files(extension):
    """results/<case>/tables/table1.csv … for the first frequency, table1_<frequency>.csv … for the others."""
    suffixes = [CASE.suffix(frequency) for frequency in FREQUENCIES]
    return [
        f"{RESULTS}/tables/{name}{suffix}.{extension}" for suffix in suffixes for name in TABLES
    ]


rule tables:
    input:
        features=of_routes("features"),
        estimates=of_routes("estimates"),
        claims=f"{RESULTS}/claims.csv" if config["published"] else [],
        modules=script_modules("tables/tables.py"),
    output:
        csv=report(
            [*table_files("csv"), f"{RESULTS}/tables/approaches.csv"],
            caption="../report/table.rst",
            category="Tables",
        ),
        md=[*table_files("md"), f"{RESULTS}/tables/approaches.md"],
    params:
        folder=RESULTS,
        case=of_case("oscillator", "frequencies_hz", "pairs"),
    message:
        "Tables"
    script:
        "../scripts/tables/tables.py"
