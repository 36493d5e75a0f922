"""Names of the files that an identification is written to."""

FIGURES = ("cycles", "loops", "balance")

TABLES = ("identification.json", "identification.csv", "features.csv", "summary.txt")
"""All that is known; the estimates; the features; the table of the screen."""

PICTURES = tuple(f"{name}.{suffix}" for name in FIGURES for suffix in ("svg", "png"))

OUTPUTS = (*TABLES, *PICTURES)

RING_DOWN_FIGURES = ("decays",)
"""The picture of an identification from free decays, in the place of FIGURES."""

RING_DOWN_PICTURES = tuple(
    f"{name}.{suffix}" for name in RING_DOWN_FIGURES for suffix in ("svg", "png")
)

ALL_PICTURES = (*PICTURES, *RING_DOWN_PICTURES)
