# Files of figures.
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


MATCH_FILES = {}
if config["published"]:
    MATCH_FILES["match"] = report(
        f"{RESULTS}/figures/match.svg",
        category="Verdicts",
        labels={"result": "The match at a glance"},
    )
