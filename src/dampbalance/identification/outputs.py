"""Names of the files that an identification is written to."""

FIGURES = ("cycles", "loops", "balance")

OUTPUTS = (
    "identification.json",
    "identification.csv",
    "features.csv",
    "summary.txt",
    *(f"{name}.{suffix}" for name in FIGURES for suffix in ("svg", "png")),
)
"""All that is known; the estimates; the features; the table of the screen; figures."""
