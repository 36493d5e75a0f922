# The paper's tables: printed, as published and exact side by side; the other frequencies get tables of their own. And one that
# the paper lacks: the error of every approach at every frequency.


include: "../functions/tables.smk"


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
