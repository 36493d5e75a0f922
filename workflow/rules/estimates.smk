# F_k and c by the four approaches, pair by pair and by least squares.


rule estimate_exact:
    input:
        features=rules.features_exact.output.features,
        modules=script_modules("estimates/estimate_exact.py"),
    output:
        estimates=f"{RESULTS}/estimates/exact/{{frequency}}.csv",
    params:
        case=of_case("oscillator", "pairs"),
    message:
        "Estimates from the exact features at {wildcards.frequency}"
    script:
        "../scripts/estimates/estimate_exact.py"


rule estimate_as_published:
    input:
        tabulated=rules.features_as_published.output.tabulated,
        two_point=rules.features_as_published.output.two_point,
        modules=script_modules("estimates/estimate_as_published.py"),
    output:
        estimates=f"{RESULTS}/estimates/as_published/{{frequency}}.csv",
    params:
        case=of_case("oscillator", "pairs"),
    message:
        "Estimates from the as-published features at {wildcards.frequency}"
    script:
        "../scripts/estimates/estimate_as_published.py"


rule estimates:
    input:
        expand(rules.estimate_exact.output.estimates, frequency=FREQUENCIES),
        expand(rules.estimate_as_published.output.estimates, frequency=FREQUENCIES),
