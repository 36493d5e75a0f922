# Figures 1–3 of the paper, and the error of every estimate against the level of excitation.


def figure_files(name, title):
    """The SVG and the PNG of a figure. title : what the report calls it."""
    return {
        "svg": report(
            f"{RESULTS}/figures/{name}.svg",
            caption=f"../report/{name}.rst",
            category="Figures",
            labels={"result": title},
        ),
        "png": f"{RESULTS}/figures/{name}.png",
    }


rule figure1:
    input:
        modules=script_modules("figures/figure1.py"),
    output:
        **figure_files("figure1", "Figure 1: the oscillator and its contact"),
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
    params:
        case=of_case("oscillator", "frequencies_hz", "levels_m"),
        folder=placed(RESULTS),
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
