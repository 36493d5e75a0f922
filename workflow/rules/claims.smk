# A verdict on every printed number, and the comparison with the verdicts on record.


rule claims:
    input:
        features=expand(
            f"{RESULTS}/features/{{route}}/{{frequency}}.csv", route=ROUTES, frequency=FREQUENCIES
        ),
        estimates=expand(
            f"{RESULTS}/estimates/{{route}}/{{frequency}}.csv", route=ROUTES, frequency=FREQUENCIES
        ),
        published=published_files,
        modules=script_modules("claims.py"),
    output:
        csv=f"{RESULTS}/claims.csv",
        md=f"{RESULTS}/claims.md",
    params:
        config={key: config[key] for key in ("oscillator", "excitation", "as_published")},
        results=RESULTS,
        published=config["published"],
    message:
        "Verdicts on the printed numbers"
    script:
        "../scripts/claims.py"


rule check:
    input:
        claims=rules.claims.output.csv,
        recorded=f"{config['published']}/verdicts.csv",
        modules=script_modules("check.py"),
    output:
        summary=f"{RESULTS}/summary.txt",
    message:
        "Comparison with the verdicts on record"
    script:
        "../scripts/check.py"
