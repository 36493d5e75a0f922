# Figures 1–3 of the paper, and the error of every estimate against the level of excitation.


include: "../functions/figures.smk"


rule figure1:
    input:
        modules=script_modules("figures/figure1.py"),
    output:
        **figure_files("figure1", "Figure 1: the oscillator and its contact"),
    log:
        log_file("figure1"),
    conda:
        ENVIRONMENT
    message:
        "Figure 1: the oscillator and its contact"
    script:
        "../scripts/figures/figure1.py"


rule figure2:
    input:
        orbits=f"{RESULTS}/orbits/{FREQUENCIES[0]}.json",
        modules=script_modules("figures/figure2.py"),
    output:
        **figure_files("figure2", "Figure 2: friction force against velocity"),
    log:
        log_file("figure2"),
    conda:
        ENVIRONMENT
    message:
        "Figure 2: friction force against velocity"
    script:
        "../scripts/figures/figure2.py"


rule figure3:
    input:
        orbits=f"{RESULTS}/orbits/{FREQUENCIES[0]}.json",
        modules=script_modules("figures/figure3.py"),
    output:
        **figure_files("figure3", "Figure 3: acceleration against displacement and velocity"),
    log:
        log_file("figure3"),
    conda:
        ENVIRONMENT
    message:
        "Figure 3: acceleration against displacement and velocity"
    script:
        "../scripts/figures/figure3.py"


rule estimation_error:
    input:
        estimates=expand(f"{RESULTS}/estimates/exact/{{frequency}}.csv", frequency=FREQUENCIES),
        modules=script_modules("figures/estimation_error.py"),
    output:
        **figure_files("estimation_error", "Error of each approach at each frequency"),
    log:
        log_file("estimation_error"),
    conda:
        ENVIRONMENT
    params:
        case=of_case("oscillator", "frequencies_hz", "levels_m"),
        folder=lambda wildcards: placed(RESULTS),
    message:
        "Estimation error of each approach"
    script:
        "../scripts/figures/estimation_error.py"


rule figures:
    input:
        rules.figure1.output,
        rules.figure2.output,
        rules.figure3.output,
        rules.estimation_error.output,
