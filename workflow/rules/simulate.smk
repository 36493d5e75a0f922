# The steady responses of one frequency at all levels: exactly, and as the paper's own numbers were computed.


rule simulate_exact:
    input:
        modules=script_modules("simulate/simulate_exact.py"),
    output:
        orbits=f"{RESULTS}/orbits/{{frequency}}.json",
    log:
        log_file("simulate_exact_{frequency}"),
    priority: FIRST
    conda:
        ENVIRONMENT
    params:
        case=at_frequency("oscillator", "levels_m"),
    message:
        "Exact steady orbits at {wildcards.frequency}"
    script:
        "../scripts/simulate/simulate_exact.py"


rule simulate_as_published:
    input:
        modules=script_modules("simulate/simulate_as_published.py"),
    output:
        records=f"{RESULTS}/records/as_published/{{frequency}}.parquet",
    log:
        log_file("simulate_as_published_{frequency}"),
    benchmark:
        log_file("simulate_as_published_{frequency}", "tsv")
    priority: FIRST
    conda:
        ENVIRONMENT
    params:
        case=at_frequency("oscillator", "levels_m", "numerics"),
    message:
        "Fixed-step simulation at {wildcards.frequency}"
    script:
        "../scripts/simulate/simulate_as_published.py"


rule orbits:
    input:
        expand(rules.simulate_exact.output.orbits, frequency=FREQUENCIES),


rule records:
    input:
        expand(rules.simulate_as_published.output.records, frequency=FREQUENCIES),
