# F_k and c by every approach, pair by pair and by least squares, from the features of a route.


rule estimate:
    input:
        features=at_each_frequency("features/{{route}}/{frequency}.csv"),
        two_point=lambda wildcards: (
            rules.response_as_published.output.two_point
            if wildcards.route == "as_published"
            else []
        ),
        code=rooms("replication"),
    output:
        estimates=at_each_frequency("estimates/{{route}}/{frequency}.csv"),
    priority: FIRST
    params:
        case=of_case("oscillator", "pairs"),
    message:
        "Estimates from the features of the route {wildcards.route}"
    script:
        "../scripts/estimates/estimate.py"


rule estimates:
    input:
        of_routes("estimates"),
