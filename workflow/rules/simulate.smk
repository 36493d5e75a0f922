# The steady responses at all frequencies and levels: exactly, and as the paper's own numbers were computed. One job computes
# all frequencies of a route: that takes less time than starting.


rule simulate_exact:
    input:
        code=rooms(),
    output:
        orbits=expand(f"{RESULTS}/orbits/{{frequency}}.json", frequency=FREQUENCIES),
    priority: FIRST
    params:
        case=of_case("oscillator", "frequencies_hz", "levels_m"),
    message:
        "Exact steady orbits"
    script:
        "../scripts/simulate/simulate_exact.py"


rule simulate_as_published:
    input:
        code=rooms("replication"),
    output:
        records=expand(
            f"{RESULTS}/records/as_published/{{frequency}}.parquet", frequency=FREQUENCIES
        ),
    priority: FIRST
    params:
        case=of_case("oscillator", "frequencies_hz", "levels_m", "numerics"),
    message:
        "Fixed-step simulation"
    script:
        "../scripts/simulate/simulate_as_published.py"


rule orbits:
    input:
        rules.simulate_exact.output.orbits,


rule records:
    input:
        rules.simulate_as_published.output.records,
