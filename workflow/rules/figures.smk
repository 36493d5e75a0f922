# Figures 1–3 of the paper, the error of every estimate against the level of excitation, and where there is something printed
# the picture of the match, which results/README.md shows (as paper/figures/match.svg). One job draws all of them.


def figure_files(name, title):
    """Return the SVG and the PNG of a figure, <name>_svg and <name>_png. title : its name in the report."""
    return {
        f"{name}_svg": report(
            f"{RESULTS}/figures/{name}.svg",
            category="Figures",
            labels={"result": title},
        ),
        f"{name}_png": f"{RESULTS}/figures/{name}.png",
    }


MATCH = report(
    f"{RESULTS}/figures/match.svg",
    category="Verdicts",
    labels={"result": "The match at a glance"},
)


rule figures:
    input:
        orbits=f"{RESULTS}/orbits/{FREQUENCIES[0]}.json",
        estimates=at_each_frequency("estimates/exact/{frequency}.csv"),
        claims=f"{RESULTS}/claims.csv" if config["published"] else [],
        code=PACKAGE,
    output:
        **figure_files("figure1", "Figure 1: the oscillator and its contact"),
        **figure_files("figure2", "Figure 2: friction force against velocity"),
        **figure_files("figure3", "Figure 3: acceleration against displacement and velocity"),
        **figure_files("estimation_error", "Error of each approach at each frequency"),
        **({"match": MATCH} if config["published"] else {}),
    priority: NEXT
    params:
        case=of_case("oscillator", "frequencies_hz", "levels_m"),
        folder=lambda wildcards: RESULTS,
    message:
        "Figures of the paper, and the error of each approach"
    script:
        "../scripts/figures/figures.py"
