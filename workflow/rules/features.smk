# Features of the responses: X, X_s, V_s, t_s, phases, harmonics and the integrals a, b, W. One job reads all frequencies of a
# route: later rules need them all, and reading takes less time than starting.


rule features_exact:
    input:
        orbits=rules.simulate_exact.output.orbits,
        code=rooms(),
    output:
        features=expand(f"{RESULTS}/features/exact/{{frequency}}.csv", frequency=FREQUENCIES),
    priority: FIRST
    params:
        case=of_case("phase"),
    message:
        "Exact features"
    script:
        "../scripts/features/features_exact.py"


rule features_as_published:
    input:
        records=rules.simulate_as_published.output.records,
        code=rooms("replication"),
    output:
        **{
            name: expand(f"{RESULTS}/features/{folder}/{{frequency}}.csv", frequency=FREQUENCIES)
            for name, folder in {
                "tabulated": "as_published",
                "two_point": "as_published/two_point",
                "unrounded": "as_published/unrounded",
            }.items()
        },
    priority: FIRST
    params:
        case=of_case("oscillator", "frequencies_hz", "phase", "numerics"),
    message:
        "Features read off the fixed-step records"
    script:
        "../scripts/features/features_as_published.py"


rule features:
    input:
        rules.features_exact.output,
        rules.features_as_published.output,
