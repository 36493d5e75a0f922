# The steady responses at all levels and frequencies, and their features: X, X_s, V_s, t_s, phases, harmonics, and the
# integrals a, b, W. Exactly, and as the paper's own numbers were computed. One job does all frequencies of a route: each job
# more takes longer to start than to compute.


def at_each_frequency(pattern):
    """Return the results of this name, a file for each frequency."""
    return expand(f"{RESULTS}/{pattern}", frequency=FREQUENCIES)


rule response_exact:
    input:
        code=rooms(),
    output:
        orbits=at_each_frequency("orbits/{frequency}.json"),
        features=at_each_frequency("features/exact/{frequency}.csv"),
    priority: FIRST
    params:
        case=of_case("oscillator", "frequencies_hz", "levels_m", "phase"),
    message:
        "Exact responses"
    script:
        "../scripts/response/response_exact.py"


rule response_as_published:
    input:
        code=rooms("replication"),
    output:
        records=at_each_frequency("records/as_published/{frequency}.parquet"),
        tabulated=at_each_frequency("features/as_published/{frequency}.csv"),
        two_point=at_each_frequency("features/as_published/two_point/{frequency}.csv"),
        unrounded=at_each_frequency("features/as_published/unrounded/{frequency}.csv"),
    priority: FIRST
    params:
        case=of_case("oscillator", "frequencies_hz", "levels_m", "phase", "numerics"),
    message:
        "Responses as published, by fixed steps"
    script:
        "../scripts/response/response_as_published.py"


rule features:
    input:
        rules.response_exact.output,
        rules.response_as_published.output,
