# One table of the numbers of all routes; a verdict on every printed number; the comparison with the verdicts on record.


include: "../functions/claims.smk"


rule numbers:
    input:
        features=of_routes("features"),
        estimates=of_routes("estimates"),
        unrounded=expand(
            f"{RESULTS}/features/as_published/unrounded/{{frequency}}.csv",
            frequency=FREQUENCIES,
        ),
        published=published_files if config["published"] else [],
        code=rooms("replication"),
    output:
        csv=f"{RESULTS}/numbers.csv",
    priority: FIRST
    params:
        case=of_case("oscillator", "frequencies_hz", "pairs"),
        folder=lambda wildcards: RESULTS,
        published=PUBLISHED,
    message:
        "Numbers of all routes"
    script:
        "../scripts/claims/numbers.py"


rule claims:
    input:
        numbers=rules.numbers.output.csv,
        published=published_files,
        code=rooms("replication"),
    output:
        csv=report(
            f"{RESULTS}/claims.csv",
            category="Verdicts",
            labels={"result": "Every printed number, its verdict and the reason"},
        ),
        md=f"{RESULTS}/claims.md",
    priority: FIRST
    params:
        case=of_case("oscillator", "frequencies_hz", "levels_m", "numerics"),
        published=PUBLISHED,
    message:
        "Verdicts on the printed numbers"
    script:
        "../scripts/claims/claims.py"


# Never fails, so that everything else is built: the run fails at its end (onsuccess in the Snakefile).
rule check:
    input:
        claims=rules.claims.output.csv,
        recorded=f"{PUBLISHED}/verdicts.csv",
        code=rooms("replication"),
    output:
        summary=report(
            f"{RESULTS}/summary.txt",
            category="Verdicts",
            labels={"result": "How many numbers earn which verdict"},
        ),
    priority: FIRST
    params:
        again=rerun_while_worse,
    message:
        "Comparison with the verdicts on record"
    script:
        "../scripts/claims/check.py"
