# Files of a figure.
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
