# F_k and c by every approach, pair by pair and by least squares. One job estimates at all frequencies of a route.


rule estimate_exact:
    input:
        features=rules.features_exact.output.features,
        code=rooms(),
    output:
        estimates=expand(f"{RESULTS}/estimates/exact/{{frequency}}.csv", frequency=FREQUENCIES),
    priority: FIRST
    params:
        case=of_case("oscillator", "pairs"),
    message:
        "Estimates from the exact features"
    script:
        "../scripts/estimates/estimate_exact.py"


rule estimate_as_published:
    input:
        tabulated=rules.features_as_published.output.tabulated,
        two_point=rules.features_as_published.output.two_point,
        code=rooms("replication"),
    output:
        estimates=expand(
            f"{RESULTS}/estimates/as_published/{{frequency}}.csv", frequency=FREQUENCIES
        ),
    priority: FIRST
    params:
        case=of_case("oscillator", "pairs"),
    message:
        "Estimates from the as-published features"
    script:
        "../scripts/estimates/estimate_as_published.py"


rule estimates:
    input:
        rules.estimate_exact.output.estimates,
        rules.estimate_as_published.output.estimates,
