# What is read off the responses: X, X_s, V_s, t_s, phases, harmonics and the integrals a, b, W.


rule features_exact:
    input:
        orbits=rules.simulate_exact.output.orbits,
        modules=script_modules("features/features_exact.py"),
    output:
        features=f"{RESULTS}/features/exact/{{frequency}}.csv",
    params:
        case=of_case("phase"),
    message:
        "Exact features at {wildcards.frequency}"
    script:
        "../scripts/features/features_exact.py"


rule features_as_published:
    input:
        records=rules.simulate_as_published.output.records,
        modules=script_modules("features/features_as_published.py"),
    output:
        tabulated=f"{RESULTS}/features/as_published/{{frequency}}.csv",
        two_point=f"{RESULTS}/features/as_published/two_point/{{frequency}}.csv",
        unrounded=f"{RESULTS}/features/as_published/unrounded/{{frequency}}.csv",
    params:
        case=at_frequency("oscillator", "phase", "numerics"),
    message:
        "Features read off the fixed-step records at {wildcards.frequency}"
    script:
        "../scripts/features/features_as_published.py"


rule features:
    input:
        expand(rules.features_exact.output, frequency=FREQUENCIES),
        expand(rules.features_as_published.output, frequency=FREQUENCIES),
